"""Errors of the IMU that a file may ask for, one at a time; and what it says of them, against many seeds."""

from math import nan, pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from sojourn_analysis.inertial.rest_record import rest_record
from sojourn_config.machine_reader import joined_machine
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray
from sojourn_physics.sensors import imu
from sojourn_physics.sensors.imu import STANDARD_GRAVITY, ImuParams, ImuReading
from sojourn_physics.sensors.imu_variance import variances

PER_HOUR, MICRO_G, GRAVITY = pi / 180.0 / 3600.0, 1e-6 * STANDARD_GRAVITY, 3.7
STILL, UP = np.zeros(3), np.array([0.0, 0.0, GRAVITY])
PERFECT: dict[str, float] = {
    "gyro_arw_deg_per_sqrt_hour": 0.0,
    "gyro_bias_deg_per_hour": 0.0,
    "accelerometer_noise_micro_g_per_sqrt_hz": 0.0,
    "accelerometer_bias_micro_g": 0.0,
    "attitude_gain": 0.01,
    "alignment_time": 100.0,
    "attitude_gate": 0.1,
}
DRIFTS = {
    "gyro_bias_instability_deg_per_hour": 0.5,
    "gyro_rate_random_walk_deg_per_hour_per_sqrt_hour": 0.3,
    "accelerometer_bias_instability_micro_g": 50.0,
    "accelerometer_random_walk_micro_g_per_sqrt_hour": 20.0,
}


def with_errors(**errors: float) -> ImuParams:
    return ImuParams(**(PERFECT | errors))


def first(params: ImuParams, seed: int, rate: FloatArray = STILL, force: FloatArray = UP, **given: float) -> ImuReading:
    return imu.step(params, imu.initial_state(params, seed, 0.0, GRAVITY), rate, force, 0.02, **given)[1]


def test_drift_changes_nothing_of_the_noise_that_was_there() -> None:
    noisy = {"gyro_arw_deg_per_sqrt_hour": 0.07, "accelerometer_noise_micro_g_per_sqrt_hz": 35.0}
    bare, drifting = with_errors(**noisy), with_errors(**noisy, **DRIFTS)
    drift = rest_record(drifting, 4, GRAVITY, 0.02, 600) - rest_record(bare, 4, GRAVITY, 0.02, 600)
    only = rest_record(with_errors(**DRIFTS), 4, GRAVITY, 0.02, 600)
    only[:, 5] -= GRAVITY
    np.testing.assert_allclose(drift, only, rtol=1e-6, atol=1e-14)
    assert (np.ptp(only, axis=0) > 0.0).all()


@given(
    rate=st.floats(-3.0, 3.0),
    quantum=st.floats(1e-7, 1e-3),
    periods=st.integers(1, 40),
)
def test_quantised_increments_lose_nothing(rate: float, quantum: float, periods: int) -> None:
    params = with_errors(gyro_angle_quantum=quantum)
    state = imu.initial_state(params, 1, 0.0, GRAVITY)
    angle = 0.0
    for _ in range(periods):
        state, reading = imu.step(params, state, np.array([rate, 0.0, 0.0]), UP, 0.02)
        increment = reading.angular_velocity[0] * 0.02
        assert increment / quantum == pytest.approx(
            round(increment / quantum), abs=1e-6 * max(1.0, abs(rate) / quantum)
        )
        angle += increment
    assert abs(angle - rate * 0.02 * periods) <= 0.5 * quantum + 1e-12


def test_velocities_come_in_steps_of_their_quantum() -> None:
    params = with_errors(accelerometer_velocity_quantum=1e-3)
    counts = first(params, 1).specific_force * 0.02 / 1e-3
    np.testing.assert_allclose(counts, [0.0, 0.0, 74.0], atol=1e-9)


@given(true=st.floats(-50.0, 50.0))
def test_readings_end_at_the_range(true: float) -> None:
    params = with_errors(gyro_range_deg_per_second=400.0, accelerometer_range_g=2.0)
    reading = first(params, 1, np.array([true, 0.0, 0.0]), np.array([true, 0.0, GRAVITY]))
    rate, force = np.radians(400.0), 2.0 * STANDARD_GRAVITY
    assert reading.angular_velocity[0] == pytest.approx(min(max(true, -rate), rate))
    assert reading.specific_force[0] == pytest.approx(min(max(true, -force), force))


def test_bias_and_scale_factor_change_with_the_temperature() -> None:
    params = with_errors(
        gyro_bias_deg_per_hour_per_kelvin=0.2,
        gyro_scale_factor_ppm_per_kelvin=10.0,
        accelerometer_bias_micro_g_per_kelvin=50.0,
        calibration_temperature=290.0,
    )
    np.testing.assert_allclose(first(params, 3, temperature=290.0).angular_velocity, STILL, atol=1e-18)
    bias, force, scale = [], [], []
    for seed in range(500):
        cold, turning = first(params, seed, temperature=270.0), first(params, seed, np.ones(3), temperature=270.0)
        bias.append(cold.angular_velocity)
        force.append(cold.specific_force - UP)
        scale.append(turning.angular_velocity - cold.angular_velocity - 1.0)
    for values, sigma in ((bias, 0.2 * PER_HOUR), (force, 50.0 * MICRO_G), (scale, 10e-6)):
        assert np.std(values) == pytest.approx(20.0 * sigma, rel=0.06)
    assert cold.angular_velocity_variance == pytest.approx((20.0 * 0.2 * PER_HOUR) ** 2)
    warmer = first(params, 3, temperature=300.0).angular_velocity
    np.testing.assert_allclose(warmer, -0.5 * first(params, 3, temperature=270.0).angular_velocity)


def test_gyros_feel_the_specific_force() -> None:
    params = with_errors(gyro_bias_deg_per_hour_per_g=7.0)
    readings = np.array([first(params, seed).angular_velocity for seed in range(500)])
    assert readings.std() == pytest.approx(7.0 * PER_HOUR * GRAVITY / STANDARD_GRAVITY, rel=0.06)
    assert first(params, 1).angular_velocity_variance == pytest.approx(readings.var(), rel=0.12)
    sideways = first(params, 2, force=np.array([GRAVITY, 0.0, 0.0])).angular_velocity
    both = first(params, 2, force=np.array([GRAVITY, 0.0, GRAVITY])).angular_velocity
    np.testing.assert_allclose(both, sideways + first(params, 2).angular_velocity)


@pytest.mark.parametrize("machine", ["explorer", "micro"])
@pytest.mark.parametrize("seconds", [60.0, 3600.0])
def test_the_heading_is_within_its_own_bound_over_seeds(machine: str, seconds: float) -> None:
    """With all errors of the part: the 95 % bound holds at least 90 % of 300 headings, and not all are far inside."""
    params = joined_machine(machine).sensors.first(ImuParams)
    assert params is not None
    dt, seeds = seconds / 3000.0, 300
    errors = np.empty(seeds)
    for seed in range(seeds):
        errors[seed] = rest_record(params, seed, GRAVITY, dt, round(seconds / dt))[:, 2].sum() * dt
    bound = 1.96 * np.sqrt(variances(params.stated, 0.01, GRAVITY, dt, seconds, 0.0, 0.0)[2, 2])
    inside = np.mean(np.abs(errors) < bound)
    assert inside >= 0.9
    assert np.std(errors) == pytest.approx(bound / 1.96, rel=0.15)


@pytest.mark.parametrize("error", [*DRIFTS][:2])
@pytest.mark.parametrize("seconds", [30.0, 300.0, 3000.0])
def test_the_heading_drifts_as_the_closed_form_of_each_process(error: str, seconds: float) -> None:
    params, dt, seeds = with_errors(**{error: DRIFTS[error]}), seconds / 600.0, 250
    columns = [rest_record(params, seed, GRAVITY, dt, round(seconds / dt))[:, :3].sum(axis=0) for seed in range(seeds)]
    variance = variances(params.stated, 0.01, GRAVITY, dt, seconds, 0.0, 0.0)[2, 2]
    assert (np.array(columns) * dt).std() == pytest.approx(np.sqrt(variance), rel=0.1)


@pytest.mark.parametrize("error", [*DRIFTS])
def test_tilt_is_as_large_as_the_balance_of_the_filter_says(error: str) -> None:
    params = with_errors(**{error: DRIFTS[error], "attitude_gain": 0.05, "alignment_time": 20.0})
    tilts = []
    for seed in range(120):
        reading = at_rest(params, seed, 600, 0.2)
        x, y, z, w = reading.orientation
        tilts += [2.0 * (x * z - w * y), 2.0 * (y * z + w * x)]
    assert np.std(tilts) == pytest.approx(np.sqrt(reading.orientation_variance[0]), rel=0.25)


def at_rest(params: ImuParams, seed: int, periods: int, dt: float) -> ImuReading:
    state = imu.initial_state(params, seed, 0.0, GRAVITY)
    for _ in range(periods):
        state, reading = imu.step(params, state, STILL, UP, dt)
    return reading


def test_a_heading_goes_by_the_temperature_that_there_was() -> None:
    """Warm for half of the time, cold by as much for the other: the drift is undone, and the IMU knows it."""
    params = with_errors(gyro_bias_deg_per_hour_per_kelvin=5.0)
    state, said = imu.initial_state(params, 6, 0.0, GRAVITY), []
    for period in range(400):
        temperature = params.calibration_temperature + (10.0 if period < 200 else -10.0)
        state, reading = imu.step(params, state, STILL, UP, 0.1, temperature)
        said.append(np.sqrt(reading.orientation_variance[2]))
    assert max(said) == pytest.approx(5.0 * PER_HOUR * 10.0 * 20.0, rel=0.01)
    assert said[-1] < 0.01 * max(said)
    assert abs(imu.heading_of(reading.orientation)) < 0.02 * max(said)


def test_two_imus_of_one_seed_drift_each_in_its_own_way() -> None:
    params = with_errors(**DRIFTS)
    one, other = (imu.initial_state(params, 1, 0.0, GRAVITY, name) for name in ("imu", "imu_rear"))
    assert not np.allclose(one.memory, other.memory)
    again = imu.initial_state(params, 1, 0.0, GRAVITY)
    np.testing.assert_array_equal(one.memory, again.memory)


@pytest.mark.parametrize("name", sorted(set(ImuParams.model_fields) - set(PERFECT)))
def test_a_negative_or_endless_error_is_refused(name: str) -> None:
    for value in (-1e-3, float("inf")):
        with pytest.raises(ValidationError, match=name):
            with_errors(**{name: value})


def test_a_temperature_that_is_no_number_is_refused() -> None:
    with pytest.raises(InvalidValueError, match="temperature"):
        first(with_errors(), 1, temperature=nan)
