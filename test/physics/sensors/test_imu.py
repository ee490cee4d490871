"""The IMU: Allan variance against the data sheet, biases over seeds, attitude against rigid rotation."""

from math import atan2, cos, nan, pi, sin, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray
from sojourn_physics.sensors import imu
from sojourn_physics.sensors.imu import ImuParams
from sojourn_physics.sensors.inertial_errors import BIAS, MATRIX_ROW

MICRO_G = 9.80665e-6
LN200S = ImuParams(
    gyro_arw_deg_per_sqrt_hour=0.07,
    gyro_bias_deg_per_hour=1.0,
    accelerometer_noise_micro_g_per_sqrt_hz=35.0,
    accelerometer_bias_micro_g=300.0,
    attitude_gain=0.01,
    attitude_gate=0.1,
)
PERFECT = ImuParams(
    gyro_arw_deg_per_sqrt_hour=0.0,
    gyro_bias_deg_per_hour=0.0,
    accelerometer_noise_micro_g_per_sqrt_hz=0.0,
    accelerometer_bias_micro_g=0.0,
    attitude_gain=0.01,
    attitude_gate=0.1,
)
REST = np.array([0.0, 0.0, 1.62])


def allan_deviation(samples: FloatArray, dt: float, average: int) -> FloatArray:
    """Overlapping Allan deviation (IEEE 952, eq. C.2) of the columns at a cluster of `average` samples."""
    angle = np.concatenate([np.zeros((1, samples.shape[1])), np.cumsum(samples, axis=0)]) * dt
    second = angle[2 * average :] - 2.0 * angle[average:-average] + angle[: -2 * average]
    deviation: FloatArray = np.sqrt((second**2).mean(axis=0) / (2.0 * (average * dt) ** 2))
    return deviation


def vertical(orientation: FloatArray) -> FloatArray:
    """Up of the world in the body of a quaternion x y z w: the third row of its rotation matrix."""
    x, y, z, w = orientation
    return np.array([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)])


def test_allan_deviation_gives_back_the_random_walks_of_the_data_sheet() -> None:
    dt, count = 0.02, 30000
    state = imu.initial_state(LN200S, 11, 0.0, 1.62)
    gyro, force = np.empty((count, 3)), np.empty((count, 3))
    for k in range(count):
        state, reading = imu.step(LN200S, state, np.zeros(3), REST, dt)
        gyro[k], force[k] = reading.angular_velocity, reading.specific_force
    for average in (1, 5, 20):
        root = sqrt(average * dt)
        arw = np.sqrt((allan_deviation(gyro, dt, average) ** 2).mean()) * root  # over the three axes
        assert np.degrees(arw) * 60.0 == pytest.approx(0.07, rel=0.05)
        noise = np.sqrt((allan_deviation(force, dt, average) ** 2).mean()) * root
        assert noise / MICRO_G == pytest.approx(35.0, rel=0.05)
    assert gyro.std(axis=0) ** 2 + gyro.mean(axis=0) ** 2 == pytest.approx(reading.angular_velocity_variance, rel=0.1)


def test_biases_over_seeds_have_the_deviation_of_the_data_sheet_and_no_mean() -> None:
    states = [imu.initial_state(LN200S, seed, 0.0, 3.7) for seed in range(700)]
    gyro = np.degrees(np.array([state.axes[:3, BIAS] for state in states])) * 3600.0
    force = np.array([state.axes[3:, BIAS] for state in states]) / MICRO_G
    for values, sigma in ((gyro, 1.0), (force, 300.0)):
        assert values.std() == pytest.approx(sigma, rel=0.06)
        assert abs(values.mean()) < 4.0 * sigma / sqrt(values.size)
        assert abs(np.corrcoef(values.T)[0, 1]) < 0.15


def test_a_perfect_imu_reads_the_truth() -> None:
    state = imu.initial_state(PERFECT, 0, 0.0, 1.62)
    rate, force = np.array([0.1, -0.2, 0.3]), np.array([0.2, 0.1, 1.5])
    _, reading = imu.step(PERFECT, state, rate, force, 0.02)
    assert np.array_equal(reading.angular_velocity, rate)
    assert np.array_equal(reading.specific_force, force)


def test_scale_factor_and_misalignment_are_drawn_with_their_size() -> None:
    params = ImuParams(
        **(
            PERFECT.model_dump()
            | {"gyro_scale_factor_ppm": 100.0, "accelerometer_scale_factor_ppm": 300.0, "misalignment": 1e-3}
        )
    )
    states = [imu.initial_state(params, seed, 0.0, 1.62) for seed in range(400)]
    for triad, scale in ((slice(0, 3), 100e-6), (slice(3, 6), 300e-6)):
        errors = np.array([state.axes[triad, MATRIX_ROW:] for state in states]) - np.eye(3)
        diagonal = errors[:, range(3), range(3)]
        assert diagonal.std() == pytest.approx(scale, rel=0.1)
        assert errors[:, ~np.eye(3, dtype=bool)].std() == pytest.approx(1e-3, rel=0.1)
    rate = np.array([1.0, 0.0, 0.0])
    _, reading = imu.step(params, states[0], rate, REST, 0.02)
    assert reading.angular_velocity == pytest.approx(states[0].axes[:3, MATRIX_ROW])


@settings(max_examples=60, deadline=None)
@given(roll=st.floats(-3.0, 3.0), pitch=st.floats(-1.4, 1.4), heading=st.floats(-pi, pi))
def test_the_first_reading_levels_and_keeps_the_given_heading(roll: float, pitch: float, heading: float) -> None:
    up = np.array([-sin(pitch), sin(roll) * cos(pitch), cos(roll) * cos(pitch)])
    state = imu.initial_state(PERFECT, 0, heading, 3.7)
    _, reading = imu.step(PERFECT, state, np.zeros(3), 3.7 * up, 0.02)
    assert vertical(reading.orientation) == pytest.approx(up, abs=1e-9)
    found = imu.heading_of(reading.orientation)
    assert abs(atan2(sin(found - heading), cos(found - heading))) < 1e-9


@pytest.mark.parametrize("axis", [(0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.6, 0.0, 0.8), (0.0, -0.6, 0.8)])
def test_a_steady_turn_is_integrated_to_the_rotation_it_is(axis: tuple[float, float, float]) -> None:
    dt, speed, steps = 0.02, 0.2, 400
    unit = np.array(axis)
    state = imu.initial_state(PERFECT, 0, 0.0, 1.62)
    state, _ = imu.step(PERFECT, state, np.zeros(3), REST, dt)
    for k in range(1, steps + 1):
        angle = speed * dt * k
        # Rodrigues for the body's turn by `angle`: the world's up in the body is turned back by it.
        up = np.array([0.0, 0.0, 1.0])
        turned = up * cos(angle) - np.cross(unit, up) * sin(angle) + unit * unit.dot(up) * (1 - cos(angle))
        state, reading = imu.step(PERFECT, state, speed * unit, 1.62 * turned, dt)
    half = 0.5 * speed * dt * steps
    expected = np.array([*(unit * sin(half)), cos(half)])
    assert abs(expected @ reading.orientation) == pytest.approx(1.0, abs=1e-8)


def test_levelling_removes_a_wrong_tilt_and_leaves_the_heading() -> None:
    params = ImuParams(**(PERFECT.model_dump() | {"attitude_gain": 0.5}))
    state = imu.initial_state(params, 0, 0.7, 1.62)
    tilted = 1.62 * np.array([-sin(0.05), 0.0, cos(0.05)])
    for _ in range(200):
        state, _ = imu.step(params, state, np.zeros(3), tilted, 0.02)
    for _ in range(1500):  # 30 s at a time constant of 2 s
        state, reading = imu.step(params, state, np.zeros(3), REST, 0.02)
    assert vertical(reading.orientation) == pytest.approx([0.0, 0.0, 1.0], abs=1e-6)
    assert imu.heading_of(reading.orientation) == pytest.approx(0.7, abs=1e-9)


def test_levelling_is_left_out_while_specific_force_is_not_gravity() -> None:
    params = ImuParams(**(PERFECT.model_dump() | {"attitude_gain": 1.0}))
    state = imu.initial_state(params, 0, 0.0, 1.62)
    state, first = imu.step(params, state, np.zeros(3), REST, 0.02)
    for _ in range(100):  # falling, and a push sideways of twice gravity
        state, _ = imu.step(params, state, np.zeros(3), np.zeros(3), 0.02)
        state, reading = imu.step(params, state, np.zeros(3), np.array([3.2, 0.0, 1.62]), 0.02)
    assert reading.orientation == pytest.approx(first.orientation, abs=1e-12)


def test_errors_of_attitude_stay_within_their_variances_over_seeds() -> None:
    tilts, headings = [], []
    for seed in range(40):
        state = imu.initial_state(LN200S, seed, 0.0, 1.62)
        for _ in range(150):
            state, reading = imu.step(LN200S, state, np.zeros(3), REST, 0.1)
        up = vertical(reading.orientation)
        tilts += [up[0], up[1]]
        headings.append(imu.heading_of(reading.orientation))
    sigma_tilt, _, sigma_heading = np.sqrt(reading.orientation_variance)
    assert np.std(tilts) == pytest.approx(sigma_tilt, rel=0.25)
    assert np.std(headings) == pytest.approx(sigma_heading, rel=0.35)


def test_in_free_fall_it_starts_level_and_goes_by_the_gyros() -> None:
    state = imu.initial_state(LN200S, 3, 0.4, 0.0)
    state, first = imu.step(LN200S, state, np.zeros(3), np.zeros(3), 0.02)
    assert vertical(first.orientation) == pytest.approx([0.0, 0.0, 1.0], abs=1e-12)
    assert imu.heading_of(first.orientation) == pytest.approx(0.4, abs=1e-12)
    for _ in range(500):  # a turn about y, which weight would call a wrong one
        state, reading = imu.step(LN200S, state, np.array([0.0, 0.02, 0.0]), np.zeros(3), 0.02)
    wanted = Rotation.from_euler("ZY", [0.4, 0.2])
    assert (wanted.inv() * Rotation.from_quat(reading.orientation)).magnitude() < 2e-3
    assert np.isfinite(reading.orientation_variance).all()


def test_the_heading_drifts_with_the_bias_of_the_gyro() -> None:
    params = ImuParams(**(PERFECT.model_dump() | {"gyro_bias_deg_per_hour": 10.0}))
    state = imu.initial_state(params, 3, 0.2, 1.62)
    for _ in range(501):
        state, reading = imu.step(params, state, np.zeros(3), REST, 0.02)
    drift = imu.heading_of(reading.orientation) - 0.2
    assert drift == pytest.approx(state.axes[2, BIAS] * 10.0, rel=1e-2)


def test_bad_starts_are_refused() -> None:
    with pytest.raises(InvalidValueError, match="heading"):
        imu.initial_state(PERFECT, 0, nan, 1.62)
    for gravity in (-1.0, nan):
        with pytest.raises(InvalidValueError, match="gravity"):
            imu.initial_state(PERFECT, 0, 0.0, gravity)
    with pytest.raises(InvalidValueError, match="seed"):
        imu.initial_state(PERFECT, -1, 0.0, 1.62)


def test_driving_off_is_not_taken_for_tilt_after_an_alignment() -> None:
    """One second at 0.1 m/s^2 on the Moon: 3.5 degrees of seeming tilt; aligned, it takes a hundredth."""
    pitches = {}
    for alignment in (0.0, 100.0):
        params = ImuParams(**(PERFECT.model_dump() | {"alignment_time": alignment}))
        state = imu.initial_state(params, 1, 0.0, 1.62)
        for period in range(60):
            force = np.array([0.1 if period >= 10 else 0.0, 0.0, 1.62])
            state, reading = imu.step(params, state, np.zeros(3), force, 0.02)
        pitches[alignment] = abs(Rotation.from_quat(reading.orientation).as_euler("ZYX")[1])
    assert pitches[0.0] > 0.03
    assert pitches[100.0] == pytest.approx(0.0617 * 0.01, rel=0.05)


def test_an_alignment_averages_the_noise_of_the_first_attitude() -> None:
    params = ImuParams(
        **(PERFECT.model_dump() | {"accelerometer_noise_micro_g_per_sqrt_hz": 350.0, "alignment_time": 50.0})
    )
    rolls = []
    for seed in range(300):
        state = imu.initial_state(params, seed, 0.0, 1.62)
        _, reading = imu.step(params, state, np.zeros(3), np.array([0.0, 0.0, 1.62]), 0.02)
        rolls.append(Rotation.from_quat(reading.orientation).as_euler("ZYX")[2])
    assert np.std(rolls) == pytest.approx(350e-6 * 9.80665 / sqrt(50.0) / 1.62, rel=0.15)
