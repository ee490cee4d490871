"""Ideal steering against the kinematics of the drive node, errors against perturbation, linkage against its length."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sojourn_analysis.vehicle.steering_geometry import (
    ideal_angles,
    off_tracking,
    path_radii,
    steering_error,
    trapezoid_right_angle,
    turn_of_outer_wheel,
)
from sojourn_machine.errors import InvalidValueError

WHEELS = np.array([[1.2, 0.5], [1.2, -0.5], [0.1, 0.5], [0.1, -0.5], [-0.9, 0.5], [-0.9, -0.5]])


@given(x=st.floats(-1.5, 1.5), y=st.one_of(st.floats(0.8, 50.0), st.floats(-50.0, -0.8)))
def test_ideal_wheels_do_not_slide(x: float, y: float) -> None:
    """The velocity of every wheel, from rotation about the centre, is along its heading."""
    angles = ideal_angles(WHEELS, x, y)
    velocity = np.column_stack([-(WHEELS[:, 1] - y), WHEELS[:, 0] - x])
    across = -velocity[:, 0] * np.sin(angles) + velocity[:, 1] * np.cos(angles)
    assert np.abs(across).max() < 1e-9 * (1.0 + abs(y))


@given(x=st.floats(-0.5, 0.5), y=st.floats(1.5, 40.0))
def test_ideal_angles_have_no_error(x: float, y: float) -> None:
    found = steering_error(WHEELS, ideal_angles(WHEELS, x, y))
    assert found.rms < 1e-8
    assert (found.x, found.y) == (pytest.approx(x, abs=1e-4), pytest.approx(y, rel=1e-4))


def test_error_is_the_least_of_all_centres() -> None:
    angles = ideal_angles(WHEELS, 0.0, 4.0) + np.radians([2.0, -1.0, 0.0, 0.0, 0.5, 1.0])
    best = steering_error(WHEELS, angles)
    assert best.rms > 1e-3
    for dx, dy in ((0.02, 0.0), (-0.02, 0.0), (0.0, 0.05), (0.0, -0.05)):
        moved = ideal_angles(WHEELS, best.x + dx, best.y + dy) - angles
        assert np.sqrt(np.mean(moved**2)) > best.rms


def test_straight_wheels_go_straight() -> None:
    found = steering_error(WHEELS, np.zeros(6))
    assert found.rms == pytest.approx(0.0, abs=1e-12)
    assert abs(found.y) >= 1e6


@given(angle=st.floats(0.05, 0.7))
def test_ackermann_of_one_axle(angle: float) -> None:
    """cot(outer) - cot(inner) = track over wheelbase."""
    car = np.array([[2.0, 0.7], [2.0, -0.7], [0.0, 0.7], [0.0, -0.7]])
    turn = turn_of_outer_wheel(car, 1, angle, 0.0)
    assert 1.0 / math.tan(turn.angles[1]) - 1.0 / math.tan(turn.angles[0]) == pytest.approx(1.4 / 2.0)
    assert turn.angles[2:] == pytest.approx(0.0)
    radii = path_radii(car, turn)
    assert radii[1] == pytest.approx(2.0 / math.sin(angle))


def test_off_tracking_is_the_difference_of_the_paths() -> None:
    assert off_tracking(2.0, 5.0) == pytest.approx(5.0 - math.hypot(0.0, math.sqrt(21.0)))
    with pytest.raises(InvalidValueError, match="radius"):
        off_tracking(2.0, 1.0)


@given(left=st.floats(-0.5, 0.5))
def test_trapezoid_keeps_its_rod(left: float) -> None:
    right = trapezoid_right_angle(1.4, 0.2, 0.3, left)
    # arms point back and to the inside; each turns with its wheel about the vertical, to the left for positive angles
    ends = []
    for y, angle in ((0.7, left), (-0.7, right)):
        arm = 0.2 * np.array([-math.cos(0.3), -math.copysign(math.sin(0.3), y)])
        turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
        ends.append(np.array([0.0, y]) + turn @ arm)
    left_end, right_end = ends
    assert np.linalg.norm(left_end - right_end) == pytest.approx(1.4 - 0.4 * math.sin(0.3), rel=1e-9)
    assert trapezoid_right_angle(1.4, 0.2, 0.3, -right) == pytest.approx(-left, abs=1e-9)  # the mirror image


def test_trapezoid_comes_near_to_ackermann() -> None:
    """Arms that point to the middle of the rear axle: the usual first design."""
    inclination = math.atan(0.7 / 2.0)
    inner = 0.3
    outer = trapezoid_right_angle(1.4, 0.2, inclination, inner)
    ideal = math.atan(1.0 / (1.0 / math.tan(inner) + 0.7))
    assert 0.0 < outer < inner
    # far better than parallel wheels, though not exact: no four-bar linkage is
    assert 0.0 < abs(outer - ideal) < 0.4 * (inner - ideal)


def test_refusals() -> None:
    with pytest.raises(InvalidValueError, match="centre"):
        ideal_angles(WHEELS, 1.2, 0.5)
    with pytest.raises(InvalidValueError, match="angle"):
        turn_of_outer_wheel(WHEELS, 0, 0.0, 0.0)
    with pytest.raises(InvalidValueError, match="outer"):
        turn_of_outer_wheel(WHEELS, 0, 0.3, 1.2)
    with pytest.raises(InvalidValueError, match="shape"):
        steering_error(WHEELS, [0.0])
    with pytest.raises(InvalidValueError, match="linkage"):
        trapezoid_right_angle(1.4, 0.6, 0.3, 1.5)
