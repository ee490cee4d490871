"""The tracking law: its errors fall as the header says, by integrating a unicycle along curves."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_flight.planning.clothoid import Piece, Pose, turn_pieces
from sojourn_flight.planning.path import Leg
from sojourn_flight.planning.path_tracking import track

LATERAL, HEADING = 0.6, 0.3
STEP = 0.01
CURVE = Leg.of(Pose(0.0, 0.0, 0.0), (Piece(2.0, 0.0, 0.0), *turn_pieces(1.5, 0.5, 1.0), *turn_pieces(-2.0, 0.4, 0.5)))


def errors(leg: Leg, lateral: float, course: float, drift: float = 0.0, told: float = 0.0, grip: float = 1.0) -> list:
    """Lateral errors every STEP of a unicycle that drifts by an angle and is told of one."""
    x, y, yaw, near, found = 0.0, lateral, course, 0.0, []
    while near < leg.length - STEP:
        place = leg.nearest(x, y, near)
        near = place.distance
        found.append(place.lateral)
        curvature = grip * track(place, yaw, told, LATERAL, HEADING).curvature
        middle = yaw + 0.5 * curvature * STEP + drift
        x, y, yaw = x + STEP * math.cos(middle), y + STEP * math.sin(middle), yaw + STEP * curvature
    return found


def test_the_feed_forward_alone_keeps_it_on_the_path() -> None:
    assert max(map(abs, errors(CURVE, 0.0, 0.0))) < 2e-3


@settings(max_examples=25, deadline=None)
@given(st.floats(-0.5, 0.5), st.floats(-1.2, 1.2))
def test_errors_fall_and_do_not_oscillate(lateral: float, course: float) -> None:
    found = np.array(errors(CURVE, lateral, course))
    assert abs(found[-1]) < 0.01
    sides = np.sign(found[np.abs(found) > 4e-3])
    assert (np.diff(sides) != 0).sum() <= 1  # across the path at most once


def test_a_small_error_falls_with_the_two_lengths() -> None:
    """e'' + e' (1/L + 1/l) + e / (L l) = 0 from e = e0, e' = 0."""
    straight, start = Leg.of(Pose(0.0, 0.0, 0.0), (Piece(4.0, 0.0, 0.0),)), 0.02
    s = STEP * np.arange(300)
    expected = start * (LATERAL * np.exp(-s / LATERAL) - HEADING * np.exp(-s / HEADING)) / (LATERAL - HEADING)
    assert errors(straight, start, 0.0)[:300] == pytest.approx(expected, abs=2e-4)


def test_a_drift_that_it_is_told_of_leaves_no_error() -> None:
    straight = Leg.of(Pose(0.0, 0.0, 0.0), (Piece(8.0, 0.0, 0.0),))
    assert abs(errors(straight, 0.0, 0.0, drift=0.15, told=0.15)[-1]) < 1e-3
    untold = errors(straight, 0.0, 0.0, drift=0.15)[-1]
    balance = 0.15 + HEADING * LATERAL * math.sin(0.15) / (
        LATERAL**2 + untold**2
    )  # of the header, with p = -0.15, k = 0
    assert math.atan(untold / LATERAL) == pytest.approx(balance, rel=0.01)


def test_wide_turning_leaves_the_error_that_the_header_states() -> None:
    circle = Leg.of(Pose(0.0, 0.0, 0.0), (Piece(30.0, 0.3, 0.0),))
    widening = 0.1
    found = errors(circle, 0.0, 0.0, grip=1.0 / (1.0 + widening))[-1]
    assert found == pytest.approx(-LATERAL * HEADING * 0.3 * widening, rel=0.1)
