"""Key frames: what a camera tells the odometry of slip and drift, what it must not, and the covariance that is left."""

import math
from dataclasses import replace

import numpy as np
import pytest
from rough_ground import STEREO, NoisyCamera, ground, nodes, rough

from sojourn_flight.mobility.steering_geometry import SteeringGeometryParams
from sojourn_flight.odometry import key_frames
from sojourn_flight.odometry.key_frames import TerrainMatcher, TerrainMatchState, match_ground, match_status
from sojourn_flight.odometry.odometry import OdometryState
from sojourn_flight.odometry.odometry_kernels import AddedVariances, Ways, cloned, propagate, widened
from sojourn_flight.odometry.relative_fix import Fix
from sojourn_flight.odometry.terrain_match import Match
from sojourn_flight.supervision.params import DriveParams
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray
from sojourn_physics.terrain.height_field import HeightField
from wheel_drive import WheelMeasured, initial_wheels, step_wheels

DT, SPEED, RADIUS = 0.25, 0.1, 0.125
GYRO = (0.0, 0.0, 0.0)


@pytest.fixture(scope="session")
def matcher(drive_params: DriveParams) -> TerrainMatcher:
    assert drive_params.terrain_match is not None
    return TerrainMatcher(drive_params.terrain_match, STEREO)


class Drive:
    """A rover that drives along x: its odometry, its key frames, and where it truly is."""

    def __init__(
        self,
        params: DriveParams,
        wheels: SteeringGeometryParams,
        matcher: TerrainMatcher,
        field: HeightField,
        seed: int,
    ) -> None:
        self._params, self._table, self._matcher, self._field = params.odometry, wheels.table(), matcher, field
        self._camera, self._turned = NoisyCamera(seed), 0.0
        self.odometry = initial_wheels(params.odometry, key_frames=1)
        self.seen = TerrainMatchState()
        self.x = self.y = 0.0

    def go(self, seconds: float, slip: float, drift: float = 0.0, speed: float = SPEED, blind: bool = False) -> None:
        """So long with the wheels at `speed`, a true slip, and a true drift to the left over the way."""
        rates, straight = np.full(6, speed / RADIUS), np.zeros(6)
        for period in range(1, round(seconds / DT) + 1):
            self._turned += speed / RADIUS * DT
            way = speed * DT * (1.0 - slip)
            self.x, self.y = self.x + way, self.y + drift * abs(way)
            measured = WheelMeasured(
                np.full(6, self._turned), rates, straight, GYRO, (0.0, 0.0), commanded_still=speed == 0.0
            )
            self.odometry = step_wheels(self._params, self._table, self.odometry, measured, DT)
            if period % round(1.0 / DT) == 0 and not blind:
                self.observe(self._field)

    def observe(self, field: HeightField) -> None:
        """One cloud, of this ground, from the true place."""
        cloud = self._camera.cloud(field, self.x, self.y)
        self.odometry, self.seen = match_ground(self._matcher, self.odometry, self.seen, cloud)

    @property
    def error(self) -> FloatArray:
        """In x and y [m]."""
        return np.array((self.odometry.x - self.x, self.odometry.y - self.y))

    @property
    def squared(self) -> float:
        """The error over its covariance, squared."""
        return float(self.error @ np.linalg.solve(self.odometry.covariance[:2, :2], self.error))


def test_slip_and_drift_that_nobody_expected_are_found(
    drive_params: DriveParams, explorer: SteeringGeometryParams, matcher: TerrainMatcher
) -> None:
    """Wheels and gyro alone would be 0.9 m off; what is learnt holds on after the last cloud."""
    drive = Drive(drive_params, explorer, matcher, rough(1), 1)
    drive.go(3.0, 0.0, speed=0.0)
    drive.go(30.0, slip=0.3, drift=0.05)
    assert np.linalg.norm(drive.error) < 0.03 * 2.1
    assert drive.squared < 9.2
    assert drive.seen.matches > 15 and drive.seen.rejected <= 1
    assert drive.odometry.slip_error == pytest.approx(0.3, abs=0.04)
    assert drive.odometry.side_error == pytest.approx(0.05, abs=0.04)
    drive.go(5.0, slip=0.3, drift=0.05, blind=True)
    assert np.linalg.norm(drive.error) < 0.07
    assert match_status(drive.seen, drive.odometry)["terrain_matches"] == drive.seen.matches


def test_a_motor_that_dies_is_believed(
    drive_params: DriveParams, explorer: SteeringGeometryParams, matcher: TerrainMatcher
) -> None:
    """Slip jumps far beyond what the odometry thinks possible: matches are not taken for errors."""
    drive = Drive(drive_params, explorer, matcher, rough(2), 2)
    drive.go(10.0, slip=0.0)
    drive.go(15.0, slip=0.65)
    assert np.linalg.norm(drive.error) < 0.05
    assert drive.seen.rejected <= 1


def test_the_covariance_is_right_over_seeds(
    drive_params: DriveParams, explorer: SteeringGeometryParams, matcher: TerrainMatcher
) -> None:
    """Slips drawn as the odometry believes them: two on average for x and y, and far less than wheels alone leave."""
    squares, sigmas = [], []
    for seed in range(24):
        slip, drift = np.random.default_rng(seed).standard_normal(2) * (0.1, 0.05)
        drive = Drive(drive_params, explorer, matcher, rough(seed), 50 + seed)
        drive.go(16.0, slip=float(slip), drift=float(drift))
        squares.append(drive.squared)
        sigmas.append(math.sqrt(drive.odometry.covariance[0, 0]))
        assert np.linalg.eigvalsh(drive.odometry.covariance).min() > 0.0
    assert 0.3 < np.mean(squares) < 3.0
    assert np.mean(np.array(squares) < 5.991) >= 0.9
    assert np.median(sigmas) < 0.02


def test_an_even_ground_leaves_the_odometry_alone(
    drive_params: DriveParams, explorer: SteeringGeometryParams, matcher: TerrainMatcher
) -> None:
    even = Drive(drive_params, explorer, matcher, ground(0.0 * nodes()[0]), 3)
    blind = Drive(drive_params, explorer, matcher, ground(0.0 * nodes()[0]), 3)
    even.go(12.0, slip=0.2)
    blind.go(12.0, slip=0.2, blind=True)
    assert np.linalg.norm(even.error - blind.error) < 0.05
    assert even.odometry.covariance[0, 0] > 0.7 * blind.odometry.covariance[0, 0]
    assert even.seen.text == "the ground is too even to tell" and even.seen.matches <= 2


def test_clouds_at_a_stand_add_nothing(
    drive_params: DriveParams, explorer: SteeringGeometryParams, matcher: TerrainMatcher
) -> None:
    drive = Drive(drive_params, explorer, matcher, rough(4), 4)
    drive.go(8.0, slip=0.1)
    covariance, matches, frames = drive.odometry.covariance, drive.seen.matches, drive.seen.key_frames
    drive.go(1.0, slip=0.0, speed=0.0)
    settled = drive.odometry.covariance[:2, :2]
    drive.go(20.0, slip=0.0, speed=0.0)
    np.testing.assert_array_equal(drive.odometry.covariance[:2, :2], settled)
    assert settled[0, 0] == pytest.approx(covariance[0, 0], rel=0.2)
    assert (drive.seen.matches, drive.seen.key_frames) == (matches, frames)
    assert drive.seen.text == "standing, no match"


def test_a_wrong_cloud_is_rejected_and_changes_nothing(
    drive_params: DriveParams, explorer: SteeringGeometryParams, matcher: TerrainMatcher
) -> None:
    drive = Drive(drive_params, explorer, matcher, rough(5, 4.0), 5)
    drive.go(6.0, slip=0.1)
    drive.go(0.75, slip=0.1)
    before = drive.odometry
    drive.observe(rough(77, 4.0))
    assert drive.seen.text.startswith("rejected")
    assert (drive.odometry.x, drive.odometry.y, drive.odometry.slip_error) == (before.x, before.y, before.slip_error)
    rejected = drive.seen.rejected
    drive.odometry, drive.seen = match_ground(matcher, drive.odometry, drive.seen, np.zeros((0, 3)))
    assert drive.seen.text == "only 0 points of the ground in view" and drive.seen.rejected == rejected


def test_a_clone_goes_with_its_pose() -> None:
    """The difference of pose and key frame is known as well as the clone was made, however bad the pose."""
    factor = np.random.default_rng(6).standard_normal((12, 12))
    covariance = factor @ factor.T
    copy = cloned(covariance, 1e-4)
    difference = np.zeros((3, 12))
    difference[:, :3], difference[:, 9:] = np.eye(3), -np.eye(3)
    np.testing.assert_allclose(difference @ copy @ difference.T, np.diag((1e-4, 1e-4, 1e-10)), atol=1e-12)
    np.testing.assert_array_equal(copy[:9, :9], covariance[:9, :9])


def test_the_widened_covariance_is_that_of_an_unknown_slip_on_the_way() -> None:
    wide = widened(np.zeros((6, 6)), 0.3, 0.1, 0.5)
    slip = np.array((-0.3, -0.1, 0.0, 1.0, 0.0, 0.0))
    side = np.array((-0.1, 0.3, 0.0, 0.0, 1.0, 0.0))
    np.testing.assert_allclose(wide, 0.25 * (np.outer(slip, slip) + np.outer(side, side)), atol=1e-15)


def test_the_covariance_grows_as_the_product_of_matrices_says() -> None:
    """The kernel leaves out what is zero: against F P F^T + Q in full."""
    factor = np.random.default_rng(7).standard_normal((12, 12))
    covariance = factor @ factor.T
    move, told, side, gain, kept = (0.02, -0.01), (0.05, -0.025), (0.01, 0.02), 0.02, 0.99
    noise = (1e-3, 2e-3, 3e-3, 4e-3, 5e-3)
    found = propagate(covariance, Ways(move, told, side), gain, kept, AddedVariances(*noise))
    jacobian = np.eye(12)
    jacobian[0, 2:6] = -move[1], -told[0], side[0], 0.5 * gain * move[1]
    jacobian[1, 2:6] = move[0], -told[1], side[1], -0.5 * gain * move[0]
    jacobian[2, 5] = -gain
    jacobian[3, 3] = jacobian[4, 4] = kept
    slip, drift, travel, yaw, bias = noise
    expected = jacobian @ covariance @ jacobian.T
    expected[np.arange(6), np.arange(6)] += (travel, travel, yaw, slip, drift, bias)
    np.testing.assert_allclose(found, expected, rtol=1e-12)
    np.testing.assert_array_equal(found, found.T)


def test_an_odometry_without_a_key_frame_is_refused(drive_params: DriveParams, matcher: TerrainMatcher) -> None:
    odometry: OdometryState = replace(initial_wheels(drive_params.odometry))
    with pytest.raises(InvalidValueError, match="key"):
        match_ground(matcher, odometry, TerrainMatchState(), np.zeros((0, 3)))


def test_one_match_alone_does_not_say_that_the_ground_slips_otherwise(
    matcher: TerrainMatcher, drive_params: DriveParams, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One edge on even ground fits in more than one place: a false match made half of the way be taken for slip."""
    odometry = initial_wheels(drive_params.odometry, key_frames=1)
    moved, answers = replace(odometry, x=0.5), iter([True, True, True, False, True])
    monkeypatch.setattr(key_frames, "fix_way", lambda *_: Fix(moved, 0.5, 9.0, next(answers)))
    found = Match(np.zeros(6), np.eye(2), 500, 0, 1.0, True)
    state, used = TerrainMatchState(), []
    for _ in range(5):
        after, state = key_frames._updated(matcher.params, odometry, state, found, np.zeros(2))
        used.append(after is moved)
    assert used == [False, True, False, True, False]
    assert state.text.startswith("doubted") and state.matches == 2
