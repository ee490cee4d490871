"""Heading fix: geometry against rotations, covariance against many seeds, and sightings that are refused."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation
from scipy.stats import chi2

from sojourn_flight.mobility.steering_geometry import SteeringGeometryParams
from sojourn_flight.odometry.heading_fix import (
    HeadingFixState,
    SunSighting,
    fix_heading,
    levelled_on,
    mounting_variances,
    turned_on,
)
from sojourn_flight.odometry.odometry import OdometryState, wrap_angle
from sojourn_flight.odometry.odometry_kernels import START_YAW_VARIANCE
from sojourn_flight.odometry.odometry_params import HeadingFixParams
from sojourn_flight.supervision.params import DriveParams
from sojourn_machine.params import FloatArray
from sojourn_physics.sensors import imu
from sojourn_physics.sensors.imu import ImuParams
from wheel_drive import WheelMeasured, initial_wheels, step_wheels

START = HeadingFixState()


@pytest.fixture(scope="session")
def trust(drive_params: DriveParams) -> HeadingFixParams:
    assert drive_params.heading_fix is not None
    return drive_params.heading_fix


def attitude(yaw: float, pitch: float, roll: float) -> Rotation:
    return Rotation.from_euler("ZYX", [yaw, pitch, roll])


def unit(azimuth: float, elevation: float) -> FloatArray:
    level = math.cos(elevation)
    return np.array((math.cos(azimuth) * level, math.sin(azimuth) * level, math.sin(elevation)))


def at(
    params: DriveParams, trust: HeadingFixParams, yaw: float, sigma: float, tilt: tuple[float, float]
) -> OdometryState:
    """A state that does not know its heading by `sigma`."""
    state = initial_wheels(params.odometry, yaw=yaw, mounting=mounting_variances(trust))
    covariance = state.covariance.copy()
    covariance[2, 2] = sigma**2
    return replace(state, roll=tilt[0], pitch=tilt[1], covariance=covariance)


@settings(deadline=None)
@given(st.floats(-3.1, 3.1), st.floats(-0.4, 0.4), st.floats(-0.4, 0.4), st.floats(-3.1, 3.1), st.floats(0.05, 0.7))
def test_a_perfect_sighting_gives_the_heading(
    drive_params: DriveParams,
    trust: HeadingFixParams,
    yaw: float,
    pitch: float,
    roll: float,
    azimuth: float,
    elevation: float,
) -> None:
    sun = unit(azimuth, elevation)
    nothing = {"misalignment_sigma": 1e-9, "levelling_sigma": 1e-9, "levelling_bias_sigma": 1e-9}
    sure = trust.model_copy(update={"noise_sigma": 1e-6, **nothing})
    state = at(drive_params, sure, wrap_angle(yaw + 0.3), 0.1, (roll, pitch))
    sighting = SunSighting(attitude(yaw, pitch, roll).inv().apply(sun), sun)
    found, told = fix_heading(sure, state, START, sighting)
    assert told.text == "heading fixed" and told.fixes == 1
    assert wrap_angle(found.yaw - yaw) == pytest.approx(0.0, abs=1e-6)
    assert told.innovation == pytest.approx(-0.3, abs=1e-6)


@settings(max_examples=30, deadline=None)
@given(st.floats(-3.1, 3.1), st.floats(-0.3, 0.3), st.floats(-0.3, 0.3), st.floats(0.1, 1.0))
def test_an_error_of_the_mounting_shows_as_the_law_says(
    drive_params: DriveParams, trust: HeadingFixParams, yaw: float, pitch: float, roll: float, elevation: float
) -> None:
    """Innovations of sightings turned by small rotations, against those that the known mounting takes out again."""
    sun, state = unit(0.4, elevation), at(drive_params, trust, yaw, 1.0, (roll, pitch))
    loose = trust.model_copy(update={"misalignment_sigma": 0.2})
    in_base = attitude(yaw, pitch, roll).inv().apply(sun)
    for axis in np.eye(3):
        turned = SunSighting(Rotation.from_rotvec(1e-4 * axis).apply(in_base), sun)
        _, ignorant = fix_heading(loose, state, START, turned)
        _, knowing = fix_heading(loose, replace(state, mounting=np.append(1e-4 * axis, np.zeros(4))), START, turned)
        assert abs(knowing.innovation) < 1e-7
        assert abs(ignorant.innovation - knowing.innovation) > 1e-5 or axis[2] == 0.0


def drive_about(
    params: DriveParams, trust: HeadingFixParams, geometry: SteeringGeometryParams, seed: int, seconds: int
) -> tuple[OdometryState, float, FloatArray, HeadingFixState]:
    """Turns and straights for a while, a sighting a second: estimate, true heading, true errors of mounting and
    levelling in the order of the state, told. The levelling is integrated in small steps, as the attitude filter does.
    """
    random = np.random.default_rng(seed)
    dt, table, still = 0.1, geometry.table(), np.zeros(6)
    odometry_params = params.odometry.model_copy(update={"gyro_random_walk": 2e-4, "gyro_bias_sigma": 3e-4})
    bias = 3e-4 * random.standard_normal()
    mounting = trust.misalignment_sigma * random.standard_normal(3)
    tilt_bias = trust.levelling_bias_sigma * random.standard_normal(2)
    levelling = tilt_bias + trust.levelling_sigma * random.standard_normal(2)
    walk = trust.levelling_sigma * math.sqrt(2.0 * dt / trust.levelling_time)
    sun = unit(0.7, 0.5)
    yaw = math.sqrt(START_YAW_VARIANCE) * random.standard_normal()
    state = initial_wheels(odometry_params, mounting=mounting_variances(trust))
    told = HeadingFixState()
    for period in range(1, 10 * seconds + 1):
        rate = 0.1 if (period // 200) % 2 else 0.0
        yaw += rate * dt
        back = rate * np.array((levelling[1], -levelling[0])) - (levelling - tilt_bias) / trust.levelling_time
        levelling = levelling + back * dt + walk * random.standard_normal(2)
        gyro = rate + bias + 2e-4 / math.sqrt(dt) * random.standard_normal()
        measured = WheelMeasured(np.full(6, 0.01 * period), still, still, (0.0, 0.0, gyro), (0.0, 0.0))
        state = step_wheels(odometry_params, table, state, measured, dt)
        told = turned_on(told, state.yaw_rate, dt)
        if period % 10 == 0:
            noise = Rotation.from_rotvec(trust.noise_sigma * random.standard_normal(3))
            off = Rotation.from_rotvec(mounting + np.append(levelling, 0.0))
            in_base = (noise * off).apply(attitude(yaw, 0.0, 0.0).inv().apply(sun))
            state, told = fix_heading(trust, state, told, SunSighting(in_base, sun))
    return state, yaw, np.concatenate((mounting, tilt_bias, levelling - tilt_bias)), told


def test_the_covariance_is_right_over_seeds(
    drive_params: DriveParams, trust: HeadingFixParams, explorer: SteeringGeometryParams
) -> None:
    """NEES of heading, mounting and levelling within the 99.9 % bounds of its mean: a lasting error must not be
    averaged away, and one that wanders must not be taken for lasting.
    """
    runs, heading, all_of_them = 60, [], []
    for seed in range(runs):
        state, yaw, errors, told = drive_about(drive_params, trust, explorer, seed, 120)
        assert told.fixes + told.rejected == 120 and told.rejected <= 1
        error = np.array((wrap_angle(yaw - state.yaw), *(errors - state.mounting)))
        places = (2, *range(6, 13))
        block = state.covariance[np.ix_(places, places)]
        heading.append(error[0] ** 2 / block[0, 0])
        all_of_them.append(error @ np.linalg.solve(block, error))
        assert np.linalg.eigvalsh(state.covariance).min() > 0.0
    assert 0.7 < np.mean(heading[:40]) < 1.3, "over the forty seeds that the drive's figure is asked for"
    assert max(heading) < 3.5**2, "sigma squared"
    for values, freedom in ((heading, 1), (all_of_them, 8)):
        low, high = chi2.ppf((0.0005, 0.9995), freedom * runs) / runs
        assert low < np.mean(values) < high


def tilt_of(orientation: FloatArray) -> FloatArray:
    """Roll and pitch of a quaternion x y z w, shape (2,) [rad]."""
    x, y, z, w = orientation
    return np.array((math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)), math.asin(2 * (w * y - z * x))))


@pytest.mark.parametrize("turn", [0.5, 2.0, math.pi])
def test_the_levelling_of_the_attitude_filter_goes_as_the_law_says(
    drive_params: DriveParams, trust: HeadingFixParams, turn: float
) -> None:
    """Two biases, a turn on the spot within 30 s, and half a minute of standing: against the filter of the IMU."""
    perfect = ImuParams(
        gyro_arw_deg_per_sqrt_hour=0.0, gyro_bias_deg_per_hour=0.0, accelerometer_noise_micro_g_per_sqrt_hz=0.0,
        accelerometer_bias_micro_g=300.0, attitude_gain=1.0 / trust.levelling_time, alignment_time=100.0,
        attitude_gate=0.1,
    )  # fmt: skip
    gravity, dt = 1.625, 0.02
    up, still = np.array((0.0, 0.0, gravity)), np.zeros(3)
    state, read = imu.step(perfect, imu.initial_state(perfect, 4, 0.0, gravity), still, up, dt)
    bias = tilt_of(read.orientation)
    odometry = initial_wheels(drive_params.odometry, mounting=mounting_variances(trust))
    odometry = replace(odometry, mounting=np.array((0.0, 0.0, 0.0, *bias, 0.0, 0.0)))
    for period in range(3000):
        rate = turn / 30.0 if period < 1500 else 0.0
        state, read = imu.step(perfect, state, np.array((0.0, 0.0, rate)), up, dt)
        odometry = levelled_on(trust, odometry, dt, rate * dt)
    end = tilt_of(read.orientation)
    assert np.linalg.norm(end - bias) > 0.2 * np.linalg.norm(bias)
    np.testing.assert_allclose(odometry.mounting[3:5] + odometry.mounting[5:7], end, atol=1e-6)


def test_fixes_hold_a_heading_that_the_gyro_alone_loses(
    drive_params: DriveParams, trust: HeadingFixParams, explorer: SteeringGeometryParams
) -> None:
    state, yaw, _, _ = drive_about(drive_params, trust, explorer, 2, 600)
    gyro_alone = math.sqrt((3e-4 * 600.0) ** 2 + 2e-4**2 * 600.0)
    assert math.sqrt(state.covariance[2, 2]) < 0.02 * gyro_alone
    assert abs(wrap_angle(yaw - state.yaw)) < 0.02 * gyro_alone
    assert math.sqrt(state.covariance[5, 5]) < 0.1 * 3e-4


@pytest.mark.parametrize(
    "in_base,in_odom,text",
    [
        (np.zeros(3), unit(0.0, 0.5), "no Sun in view"),
        (unit(0.0, 1.3), unit(0.0, 1.3), "the Sun stands too high for a heading"),
        (unit(0.5, 0.5), unit(0.0, 0.5), "rejected: heading off by -28.6 deg"),
        (unit(0.0, 0.6), unit(0.0, 0.5), "rejected: elevation off by 5.7 deg"),
    ],
    ids=["no sun", "too high", "a glint beside it", "a glint above it"],
)
def test_what_does_not_fit_changes_nothing(
    drive_params: DriveParams, trust: HeadingFixParams, in_base: FloatArray, in_odom: FloatArray, text: str
) -> None:
    state = at(drive_params, trust, 0.0, 0.01, (0.0, 0.0))
    after, told = fix_heading(trust, state, START, SunSighting(in_base, in_odom))
    assert after is state and told.text.startswith(text)
    assert told.rejected == text.startswith("rejected") and told.fixes == 0
