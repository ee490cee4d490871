"""Clothoids by integrating the heading; limits on curves by the balance of moments and forces."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from sojourn_analysis.vehicle.rollover import curve_limit, curve_speed, roll_over_factor
from sojourn_flight.planning.clothoid import Piece, Pose, along_clothoid, end_of, sample_path, turn_pieces
from sojourn_machine.errors import InvalidValueError


@given(
    curvature=st.floats(-1.0, 1.0),
    sharpness=st.floats(-0.5, 0.5),
    length=st.floats(0.0, 6.0),
    heading=st.floats(-3.0, 3.0),
)
def test_fresnel_is_the_integral_of_the_heading(
    curvature: float, sharpness: float, length: float, heading: float
) -> None:
    start = Pose(1.0, -2.0, heading)
    found = along_clothoid(start, curvature, sharpness, [length])[0]
    angle = lambda s: heading + curvature * s + 0.5 * sharpness * s * s  # noqa: E731
    x = 1.0 + quad(lambda s: math.cos(angle(s)), 0.0, length, epsabs=1e-11, limit=200)[0]
    y = -2.0 + quad(lambda s: math.sin(angle(s)), 0.0, length, epsabs=1e-11, limit=200)[0]
    assert found == pytest.approx([x, y, angle(length)], abs=1e-6)
    assert end_of(start, Piece(length, curvature, sharpness)) == pytest.approx(found, abs=1e-12)


@given(angle=st.floats(-3.0, 3.0).filter(lambda value: abs(value) > 1e-3))
def test_turn_turns_by_its_angle(angle: float) -> None:
    pieces = turn_pieces(angle, 0.5, 0.2)
    pose = Pose(0.0, 0.0, 0.3)
    curvature = 0.0
    for piece in pieces:
        assert piece.curvature == pytest.approx(curvature, abs=1e-9)
        pose = end_of(pose, piece)
        curvature = piece.curvature + piece.sharpness * piece.length
        assert abs(curvature) <= 0.5 + 1e-12
    assert curvature == pytest.approx(0.0, abs=1e-12)
    assert pose.heading == pytest.approx(0.3 + angle)


def test_samples_are_as_far_apart_as_their_distances_say() -> None:
    path = sample_path(Pose(0.0, 0.0, 0.0), (Piece(1.0, 0.0, 0.0), *turn_pieces(1.2, 0.5, 0.2)), 0.01)
    steps = np.hypot(np.diff(path[:, 1]), np.diff(path[:, 2]))
    assert steps == pytest.approx(np.diff(path[:, 0]), abs=1e-6)
    assert len(turn_pieces(0.1, 5.0, 0.2)) == 2  # no arc: the greatest curvature is not reached


@given(track=st.floats(0.5, 2.0), height=st.floats(0.3, 1.5), bank=st.floats(-0.3, 0.3), friction=st.floats(0.2, 0.9))
def test_limits_balance_moment_and_force(track: float, height: float, bank: float, friction: float) -> None:
    limit = curve_limit(roll_over_factor(track, height), friction, bank)
    if not math.isinf(limit.roll_over):
        a = limit.roll_over
        down, out = math.cos(bank) + a * math.sin(bank), a * math.cos(bank) - math.sin(bank)
        assert down * 0.5 * track == pytest.approx(out * height, abs=1e-9 * (1.0 + a))
    if not math.isinf(limit.sliding):
        a = limit.sliding
        down, out = math.cos(bank) + a * math.sin(bank), a * math.cos(bank) - math.sin(bank)
        assert out == pytest.approx(friction * down)
    assert limit.least == min(limit.roll_over, limit.sliding)


def test_soft_springs_lower_the_limit() -> None:
    rigid = roll_over_factor(1.4, 0.7)
    soft = roll_over_factor(1.4, 0.7, sprung_height=0.5, flexibility=0.4)
    assert rigid == pytest.approx(1.0)
    assert 0.7 < soft < rigid


def test_speed_on_a_curve() -> None:
    speed = curve_speed(0.5, 10.0, 1.62)
    assert speed**2 / 10.0 == pytest.approx(0.5 * 1.62)
    assert curve_speed(-0.1, 10.0, 1.62) == 0.0


def test_refusals() -> None:
    with pytest.raises(InvalidValueError, match="track"):
        roll_over_factor(0.0, 1.0)
    with pytest.raises(InvalidValueError, match="upright"):
        roll_over_factor(1.0, 1.0, 1.0, 1.0)
    with pytest.raises(InvalidValueError, match="s = "):
        along_clothoid(Pose(0.0, 0.0, 0.0), 0.1, 0.1, [-1.0])
    with pytest.raises(InvalidValueError, match="sharpness"):
        turn_pieces(1.0, 1.0, 0.0)
    with pytest.raises(InvalidValueError, match="spacing"):
        sample_path(Pose(0.0, 0.0, 0.0), (), 0.0)
