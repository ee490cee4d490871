"""Simulated days of resting IMUs have the Allan deviation of their data sheets, and of the closed form of the model."""

from math import degrees, log, pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_analysis.inertial.allan import FLOOR, allan_deviation, modelled_deviation, stated_deviation
from sojourn_analysis.inertial.rest_record import rest_record
from sojourn_config.machine_reader import joined_machine
from sojourn_machine.params import FloatArray
from sojourn_physics.sensors import imu
from sojourn_physics.sensors.imu import STANDARD_GRAVITY, ImuParams
from sojourn_physics.sensors.inertial_errors import FLICKER, RANDOM_WALK, RATE_WALK, STATED

MACHINES = {"LN-200S": "explorer", "STIM300": "micro"}
SHORT, LONG = (0.02, 900_000), (0.2, 1_800_000)
"""Time of a reading [s] and count: five hours for what is short, a hundred for what is long."""


def params_of(part: str) -> ImuParams:
    params = joined_machine(MACHINES[part]).sensors.first(ImuParams)
    assert params is not None
    return params


def deviations(record: FloatArray, dt: float, times: tuple[float, ...]) -> FloatArray:
    """Of gyros and accelerometers, root mean square over the axes, shape (times, 2)."""
    found = [np.square(allan_deviation(record, dt, round(time / dt))).reshape(2, 3).mean(axis=1) for time in times]
    deviation: FloatArray = np.sqrt(np.array(found))
    return deviation


@pytest.mark.published("Allan deviation of the data sheet, 0.1 to 1000 s")
@pytest.mark.parametrize("part", MACHINES)
@pytest.mark.parametrize(
    "record,times",
    [(SHORT, (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 30.0)), (LONG, (3.0, 10.0, 30.0, 100.0, 300.0, 1000.0))],
    ids=["short", "long"],
)
def test_hours_at_rest_have_the_curve_of_the_data_sheet(
    part: str, record: tuple[float, int], times: tuple[float, ...]
) -> None:
    params = params_of(part)
    found = deviations(rest_record(params, 7, 3.7, *record), record[0], times)
    for triad in (0, 1):
        assert found[:, triad] == pytest.approx(stated_deviation(params.stated[triad], np.array(times)), rel=0.1)
        assert found[:, triad] == pytest.approx(modelled_deviation(params.stated[triad], np.array(times)), rel=0.1)


def test_the_curve_has_a_lowest_point_and_turns_up() -> None:
    params, dt = params_of("LN-200S"), 2.0
    times = (100.0, 1500.0, 100_000.0)
    found = deviations(rest_record(params, 3, 3.7, dt, 3_000_000), dt, times)  # seventy days
    before, lowest, after = np.degrees(found[:, 0]) * 3600.0
    assert lowest < 0.7 * before and after > 1.2 * lowest
    assert 0.2 < lowest < 0.3, "0.22 deg/h of flicker, and what the random walks add there"


@pytest.mark.published("data sheets of the LN-200S (Northrop Grumman) and the STIM300 (Sensonor)")
def test_published_figures_are_on_the_curves() -> None:
    per_hour, micro_g, times = pi / 180.0 / 3600.0, 1e-6 * STANDARD_GRAVITY, np.geomspace(0.1, 1e5, 400)
    ln200s, stim300 = params_of("LN-200S").stated, params_of("STIM300").stated
    assert degrees(ln200s[0, RANDOM_WALK]) * 60.0 == pytest.approx(0.07)
    assert ln200s[1, RANDOM_WALK] / micro_g == pytest.approx(35.0)
    assert FLOOR * ln200s[0, FLICKER] == pytest.approx(0.618 * 0.35 * per_hour, rel=0.02)
    assert FLOOR * ln200s[1, FLICKER] == pytest.approx(0.618 * 50.0 * micro_g, rel=0.02)
    assert degrees(stim300[0, RANDOM_WALK]) * 60.0 == pytest.approx(0.15)
    assert stim300[1, RANDOM_WALK] * 60.0 == pytest.approx(0.06, rel=0.01)
    assert stated_deviation(stim300[0], times).min() == pytest.approx(0.5 * per_hour, rel=0.02)
    assert stated_deviation(stim300[1], times).min() == pytest.approx(50.0 * micro_g, rel=0.02)


@given(instability=st.floats(1e-9, 1e-2), exponent=st.floats(log(0.3), log(5000.0)))
def test_the_flicker_of_the_model_is_flat(instability: float, exponent: float) -> None:
    triad = np.zeros(STATED)
    triad[FLICKER] = instability
    time = np.exp([exponent])
    assert modelled_deviation(triad, time) == pytest.approx(stated_deviation(triad, time), rel=0.021)
    assert stated_deviation(triad, time) == pytest.approx(0.664 * instability, rel=1e-3)


@settings(max_examples=10, deadline=None)
@given(walk=st.floats(1e-6, 1.0), rate_walk=st.floats(1e-6, 1.0), averaged=st.integers(1, 50))
def test_the_estimator_finds_what_went_in(walk: float, rate_walk: float, averaged: int) -> None:
    random, dt, count = np.random.default_rng(5), 0.5, 400_000
    white = walk / np.sqrt(dt) * random.standard_normal((count, 3))
    walked = np.cumsum(rate_walk * np.sqrt(dt) * random.standard_normal((count, 3)), axis=0)
    time = averaged * dt
    for samples, expected in ((white, walk / np.sqrt(time)), (walked, rate_walk * np.sqrt(time / 3.0))):
        found = np.sqrt((allan_deviation(samples, dt, averaged) ** 2).mean())
        slack = 0.05 if samples is white else 0.05 + 1.0 / averaged**2  # a walk in steps of dt, not one within them
        assert found == pytest.approx(expected, rel=slack)


@pytest.mark.parametrize("part", MACHINES)
def test_the_record_is_what_the_sensor_reads(part: str) -> None:
    params, still, up = params_of(part), np.zeros(3), np.array([0.0, 0.0, 3.7])
    record = rest_record(params, 9, 3.7, 0.02, 700)
    state = imu.initial_state(params, 9, 0.0, 3.7)
    for row in record:
        state, reading = imu.step(params, state, still, up, 0.02)
        np.testing.assert_allclose(row[:3], reading.angular_velocity, rtol=1e-9, atol=1e-15)
        np.testing.assert_allclose(row[3:], reading.specific_force, rtol=1e-9)


def test_without_rate_random_walk_and_flicker_the_curve_only_falls() -> None:
    triad = params_of("LN-200S").stated[0].copy()
    triad[[FLICKER, RATE_WALK]] = 0.0
    times = np.geomspace(0.1, 1e5, 50)
    assert (np.diff(stated_deviation(triad, times)) < 0.0).all()
