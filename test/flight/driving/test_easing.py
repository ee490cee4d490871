"""What is published of a correction: all of it in the end, and never faster than it may."""

import math
from dataclasses import replace

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_contract.field_rules import ESTIMATED_TWIST
from sojourn_flight.mobility.easing import (
    CORRECTION_RATE,
    CORRECTION_SPEED,
    CORRECTION_TIME,
    NOTHING,
    eased,
)
from sojourn_flight.odometry.odometry import initial_odometry
from sojourn_flight.supervision.params import DriveParams


@settings(max_examples=20, deadline=None)
@given(st.floats(-0.2, 0.2), st.floats(-0.2, 0.2), st.floats(-0.1, 0.1), st.floats(-3.1, 3.1))
def test_corrections_go_in_by_and_by(drive_params: DriveParams, x: float, y: float, turn: float, yaw: float) -> None:
    rolled = initial_odometry(drive_params.odometry, yaw=yaw)
    fixed = replace(rolled, x=rolled.x + x, y=rolled.y + y, yaw=math.remainder(rolled.yaw + turn, 2 * math.pi))
    dt, behind, last = 0.02, NOTHING, rolled
    for period in range(1500):  # 0.28 m at 15 mm/s, the last 20 mm at 5 mm/s: 25 s
        published, behind = eased(rolled if period == 0 else fixed, fixed, behind, dt)
        speed = max(CORRECTION_SPEED, math.dist((last.x, last.y), (fixed.x, fixed.y)) / CORRECTION_TIME)
        speed = min(speed, ESTIMATED_TWIST[0].rate_tolerance)
        assert math.hypot(published.x - last.x, published.y - last.y) <= speed * dt + 1e-12
        assert abs(math.remainder(published.yaw - last.yaw, 2 * math.pi)) <= CORRECTION_RATE * dt + 1e-12
        last = published
    assert math.dist((last.x, last.y), (fixed.x, fixed.y)) < 1e-9
    assert abs(math.remainder(last.yaw - fixed.yaw, 2 * math.pi)) < 1e-9


@settings(max_examples=20, deadline=None)
@given(st.floats(-0.2, 0.2), st.floats(-0.2, 0.2), st.floats(-0.1, 0.1))
def test_what_is_still_behind_is_in_the_covariance(drive_params: DriveParams, x: float, y: float, turn: float) -> None:
    """0.1 m behind a filter that is good to 0.02 m was published with 0.02 m: six deviations with a dead wheel."""
    rolled = initial_odometry(drive_params.odometry)
    fixed = replace(rolled, x=rolled.x + x, y=rolled.y + y, yaw=rolled.yaw + turn)
    behind = NOTHING
    for period in range(800):
        published, behind = eased(rolled if period == 0 else fixed, fixed, behind, 0.02)
        off = np.array((published.x - fixed.x, published.y - fixed.y, published.yaw - fixed.yaw))
        added = published.covariance - fixed.covariance
        np.testing.assert_allclose(added[:3, :3], np.outer(off, off), rtol=1e-6, atol=1e-12)
        assert not added[3:].any() and not added[:, 3:].any()
        assert off @ np.linalg.solve(published.covariance[:3, :3], off) <= 1.0, "of this it never is more than one"


def test_without_a_correction_it_is_the_odometry_itself(drive_params: DriveParams) -> None:
    odometry = initial_odometry(drive_params.odometry)
    assert eased(odometry, odometry, NOTHING, 0.02) == (odometry, NOTHING)
