"""The inclinometer: its data sheet over seeds, weight and acceleration, range, damping, what it refuses."""

from math import atan2, cos, hypot, nan, radians, sin

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray
from sojourn_physics.sensors import inclinometer
from sojourn_physics.sensors.inclinometer import InclinometerParams

MOON = 1.62
PERFECT = InclinometerParams(link="deck", range_deg=80.0, resolution_deg=1e-9, noise_deg=0.0, bias_deg=0.0)
TSD = InclinometerParams(
    link="deck",
    range_deg=30.0,
    resolution_deg=0.001,
    noise_deg=0.001,
    bias_deg=0.03,
    bias_deg_per_kelvin=0.00056,
    scale_factor=0.001,
    misalignment_deg=0.5,
    time_constant=0.05,
)


def read(params: InclinometerParams, force: FloatArray, seed: int = 0, warmer: float = 0.0) -> FloatArray:
    state = inclinometer.initial_state(params, seed, MOON, "tilt")
    reading = inclinometer.step(params, state, force, 0.1, warmer)[1]
    assert reading is not None
    return reading


@given(elevation=st.floats(-1.2, 1.2), other=st.floats(-1.2, 1.2))
def test_at_rest_it_tells_how_far_its_axes_point_up(elevation: float, other: float) -> None:
    x, y = sin(elevation), cos(elevation) * sin(other)
    force = MOON * np.array([x, y, cos(elevation) * cos(other)])
    reading = read(PERFECT, force)
    assert reading[0] == pytest.approx(elevation, abs=1e-9)
    assert reading[1] == pytest.approx(atan2(y, hypot(x, force[2] / MOON)), abs=1e-9)


def test_acceleration_is_taken_for_tilt() -> None:
    reading = read(PERFECT, np.array([0.081, 0.0, MOON]))
    assert reading[0] == pytest.approx(0.05, rel=1e-3) and reading[1] == pytest.approx(0.0, abs=1e-9)


@given(force=st.lists(st.floats(-100.0, 100.0), min_size=3, max_size=3), seed=st.integers(0, 50))
def test_no_reading_is_beyond_the_range_or_between_the_steps(force: list[float], seed: int) -> None:
    reading = np.degrees(read(TSD, np.array(force), seed))
    assert (np.abs(reading) <= 30.0 + 1e-9).all()
    np.testing.assert_allclose(reading, np.round(reading, 3), atol=1e-9)


def test_bias_noise_and_temperature_are_those_of_the_data_sheet_over_seeds() -> None:
    level, cold, noise = [], [], []
    for seed in range(600):
        state = inclinometer.initial_state(TSD, seed, MOON, "tilt")
        state, reading = inclinometer.step(TSD, state, np.array([0.0, 0.0, MOON]), 0.1)
        _, again = inclinometer.step(TSD, state, np.array([0.0, 0.0, MOON]), 0.1)
        assert reading is not None and again is not None
        level.append(np.degrees(reading))
        noise.append(np.degrees(again - reading))
        cold.append(np.degrees(read(TSD, np.array([0.0, 0.0, MOON]), seed, -50.0) - reading))
    assert np.std(level) == pytest.approx(0.03, rel=0.06)
    assert np.std(noise) == pytest.approx(np.sqrt(2.0 * (0.001**2 + 0.001**2 / 12.0)), rel=0.08)
    assert np.std(cold) == pytest.approx(50.0 * 0.00056, rel=0.08)


def test_scale_factor_and_misalignment_over_seeds() -> None:
    force = MOON * np.array([sin(0.2), 0.0, cos(0.2)])
    readings = [read(TSD, force, seed) - read(TSD, np.array([0.0, 0.0, MOON]), seed) for seed in range(600)]
    along, across = np.array(readings).T
    noise = radians(0.001) * np.sqrt(2.0)
    assert along.std() == pytest.approx(np.hypot(0.001 * np.tan(0.2), noise), rel=0.1)
    assert across.std() == pytest.approx(np.hypot(sin(0.2) * radians(0.5), noise), rel=0.1)


def test_the_damping_follows_with_its_time_constant() -> None:
    params = PERFECT.model_copy(update={"time_constant": 2.0})
    state = inclinometer.initial_state(params, 0, MOON, "tilt")
    state, _ = inclinometer.step(params, state, np.array([0.0, 0.0, MOON]), 0.1)
    for _ in range(20):
        state, reading = inclinometer.step(params, state, MOON * np.array([0.1, 0.0, 1.0]), 0.1)
    assert reading is not None
    assert reading[0] == pytest.approx(np.arcsin(0.1) * (1.0 - np.exp(-1.0)), rel=1e-6)


def test_what_weighs_nothing_has_no_tilt() -> None:
    state = inclinometer.initial_state(TSD, 0, 0.0, "tilt")
    after, reading = inclinometer.step(TSD, state, np.zeros(3), 0.1)
    assert reading is None and after.stream.row == state.stream.row + 1


def test_bad_input_is_refused() -> None:
    state = inclinometer.initial_state(TSD, 0, MOON, "tilt")
    for force in (np.zeros(2), np.array([nan, 0.0, 1.0])):
        with pytest.raises(InvalidValueError, match="specific_force"):
            inclinometer.step(TSD, state, force, 0.1)
    with pytest.raises(InvalidValueError, match="temperature"):
        inclinometer.step(TSD, state, np.array([0.0, 0.0, MOON]), 0.1, nan)
    with pytest.raises(InvalidValueError, match="gravity"):
        inclinometer.initial_state(TSD, 0, -1.0, "tilt")
