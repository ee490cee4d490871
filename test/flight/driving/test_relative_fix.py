"""The update with a way from the key frame: it must hold afterwards, and what it is not about must stay."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_flight.odometry.odometry import OdometryState, initial_odometry
from sojourn_flight.odometry.odometry_kernels import AddedVariances, Ways, propagate
from sojourn_flight.odometry.relative_fix import Seen, fix_way, key_frame, with_key_frame
from sojourn_flight.supervision.params import DriveParams

SINCE = (0.1, 0.0)


def believed(params: DriveParams, yaw: float, seed: int, sigma: float = 0.02) -> OdometryState:
    """A pose a metre from its key frame, all errors correlated, of about `sigma`."""
    factor = np.random.default_rng(seed).standard_normal((9, 9))
    start = initial_odometry(params.odometry, 1.0, -2.0, yaw, key_frames=1)
    key = np.array((1.0 - math.cos(yaw + 0.3), -2.0 - math.sin(yaw + 0.3), yaw))
    return replace(start, keys=key[np.newaxis], covariance=sigma**2 * factor @ factor.T / 9.0)


@settings(max_examples=30, deadline=None)
@given(st.floats(-3.0, 3.0), st.floats(-0.01, 0.01), st.floats(-0.01, 0.01), st.integers(0, 50))
def test_a_way_without_error_holds_after_the_update(
    drive_params: DriveParams, yaw: float, off_x: float, off_y: float, seed: int
) -> None:
    """Whatever the covariance: position, key frame and its heading move until the way between is the one seen."""
    assert drive_params.terrain_match is not None
    odometry = believed(drive_params, yaw, seed)
    way = np.array((math.cos(0.3) + off_x, math.sin(0.3) + off_y))
    fixed = fix_way(drive_params.terrain_match, odometry, Seen(0, way, 1e12 * np.eye(2)), SINCE).odometry
    assert fixed is not None and fixed.keys is not None
    x, y, heading = fixed.keys[0]
    apart = np.array((fixed.x - x, fixed.y - y))
    c, s = math.cos(heading), math.sin(heading)
    np.testing.assert_allclose((c * apart[0] + s * apart[1], c * apart[1] - s * apart[0]), way, atol=5e-4)
    assert np.linalg.eigvalsh(fixed.covariance).min() > -1e-12


def test_one_direction_alone_leaves_the_other(drive_params: DriveParams) -> None:
    """Information along the key frame's x axis only, independent errors: nothing is learnt across it."""
    assert drive_params.terrain_match is not None
    odometry = believed(drive_params, 0.0, 1)
    odometry = replace(odometry, covariance=np.diag(np.diag(odometry.covariance)))
    trust = drive_params.terrain_match.model_copy(update={"slip_walk": 0.0})
    way = np.array((odometry.x - key_frame(odometry, 0)[0] + 0.01, 0.0))
    fixed = fix_way(trust, odometry, Seen(0, way, np.diag((1e6, 0.0))), SINCE).odometry
    assert fixed is not None
    assert fixed.x > odometry.x + 0.003
    assert fixed.y == pytest.approx(odometry.y, abs=1e-12)
    assert fixed.covariance[1, 1] == pytest.approx(odometry.covariance[1, 1])


def test_what_no_slip_explains_is_refused(drive_params: DriveParams) -> None:
    """A way of 0.1 m since the last match, and one that is 0.5 m off; one that is 0.06 m off is another slip."""
    assert drive_params.terrain_match is not None
    odometry = believed(drive_params, 0.0, 2, sigma=0.003)
    seen = np.array((math.cos(0.3), math.sin(0.3)))
    far = fix_way(drive_params.terrain_match, odometry, Seen(0, seen - (0.5, 0.0), 1e5 * np.eye(2)), SINCE)
    assert far.odometry is None and far.off == pytest.approx(0.5)
    slip = fix_way(drive_params.terrain_match, odometry, Seen(0, seen - (0.06, 0.0), 1e5 * np.eye(2)), SINCE)
    assert slip.odometry is not None and slip.widened
    assert slip.odometry.slip_error == pytest.approx(0.6, abs=0.15)


def test_ground_that_slips_otherwise_may_change_back(drive_params: DriveParams) -> None:
    """Lunokhod slipped by 0.53 for a moment; the filter held that for the metres that came, 4.6 sigma off."""
    assert drive_params.terrain_match is not None
    odometry = believed(drive_params, 0.0, 2, sigma=0.003)
    seen, information = np.array((math.cos(0.3), math.sin(0.3))), 1e5 * np.eye(2)
    slipping = fix_way(drive_params.terrain_match, odometry, Seen(0, seen - (0.06, 0.0), information), SINCE).odometry
    assert slipping is not None
    slip = slipping.slip_error
    unchanged = AddedVariances(slip=0.0, side=0.0, move=0.0, yaw=0.0, bias=0.0)
    gone = SINCE[0] * (1.0 - slip), SINCE[1]
    covariance = propagate(slipping.covariance, Ways(gone, SINCE, (0.0, gone[0])), 0.0, 1.0, unchanged)
    further = replace(slipping, x=slipping.x + gone[0], covariance=covariance)
    gripping = fix_way(drive_params.terrain_match, further, Seen(0, seen - (-0.04, 0.0), information), SINCE)
    assert gripping.odometry is not None and not gripping.widened
    assert abs(gripping.odometry.slip_error) < 0.5 * slip
    assert gripping.odometry.covariance[3, 3] < 0.5 * slipping.covariance[3, 3]


@pytest.mark.parametrize("way", [0.0, 0.02, 0.06])
def test_a_machine_that_was_dragged_aside_is_not_said_to_slip(drive_params: DriveParams, way: float) -> None:
    """A rover that scrubs in a turn on the spot came 0.03 m off its place; the match made a slip of 0.99 of it, with
    which the odometry stood still for ever.
    """
    assert drive_params.terrain_match is not None
    odometry = believed(drive_params, 0.0, 2, sigma=0.003)
    seen = np.array((math.cos(0.3), math.sin(0.3)))
    fix = fix_way(drive_params.terrain_match, odometry, Seen(0, seen - (0.03, 0.0), 1e5 * np.eye(2)), (way, 0.0))
    assert fix.odometry is not None and abs(fix.odometry.slip_error) < 0.1
    assert math.hypot(fix.odometry.x - odometry.x, fix.odometry.y - odometry.y) == pytest.approx(0.03, abs=0.015)


def test_two_cameras_have_key_frames_of_their_own_and_a_turn_is_taken_as_well(drive_params: DriveParams) -> None:
    """The second one's goes with its pose, the first one's stays; a way and a turn without error hold afterwards."""
    assert drive_params.terrain_match is not None
    factor = np.random.default_rng(4).standard_normal((12, 12))
    start = initial_odometry(drive_params.odometry, 1.0, -2.0, 0.3, key_frames=2)
    odometry = with_key_frame(replace(start, covariance=1e-4 * factor @ factor.T), 1)
    difference = np.zeros((3, 12))
    difference[:, :3], difference[:, 9:] = np.eye(3), -np.eye(3)
    np.testing.assert_allclose(difference @ odometry.covariance @ difference.T, np.diag((0, 0, 1e-10)), atol=1e-12)
    np.testing.assert_allclose(odometry.covariance[:9, :9], 1e-4 * factor[:9] @ factor[:9].T, atol=1e-15)
    moved = replace(
        odometry, x=odometry.x + 0.1, yaw=odometry.yaw + 0.02, covariance=odometry.covariance + 1e-4 * np.eye(12)
    )
    seen = Seen(1, np.array((0.09, -0.02, 0.03)), 1e12 * np.eye(3))
    fixed = fix_way(drive_params.terrain_match, moved, seen, SINCE).odometry
    assert fixed is not None
    x, y, yaw = key_frame(fixed, 1)
    c, s = math.cos(yaw), math.sin(yaw)
    apart = fixed.x - x, fixed.y - y
    found = c * apart[0] + s * apart[1], c * apart[1] - s * apart[0], fixed.yaw - yaw
    np.testing.assert_allclose(found, seen.way, atol=1e-3)
