"""Force sensor of the wrist: steps, noise, bias, range."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_physics.sensors import wrench
from sojourn_physics.sensors.wrench import AxesParams, WrenchSensorParams

PARAMS = WrenchSensorParams(
    force=AxesParams(resolution=0.05, noise=0.1, bias=0.3, largest=100.0),
    moment=AxesParams(resolution=0.002, noise=0.004, bias=0.01, largest=5.0),
)


def readings(truth: np.ndarray, count: int, seed: int = 1) -> np.ndarray:
    state = wrench.initial_state(PARAMS, seed)
    rows = []
    for _ in range(count):
        state, row = wrench.step(state, truth)
        rows.append(row)
    return np.array(rows)


def test_noise_and_resolution_are_those_of_the_data_sheet() -> None:
    truth = np.array([1.0, -2.0, 3.0, 0.1, -0.2, 0.3])
    rows = readings(truth, 4000)
    steps = np.array([0.05] * 3 + [0.002] * 3)
    assert np.allclose(rows / steps, np.round(rows / steps), atol=1e-6)
    # white noise and, evenly over a step, the rounding
    expected = np.sqrt(np.array([0.1] * 3 + [0.004] * 3) ** 2 + steps**2 / 12.0)
    assert rows.std(axis=0) == pytest.approx(expected, rel=0.06)


def test_the_bias_is_that_of_the_run() -> None:
    biases = np.array([readings(np.zeros(6), 1, seed)[0] for seed in range(400)])
    spread = np.sqrt(np.array([0.3] * 3 + [0.01] * 3) ** 2 + np.array([0.1] * 3 + [0.004] * 3) ** 2)
    assert biases.std(axis=0) == pytest.approx(spread, rel=0.12)
    assert np.array_equal(readings(np.ones(6), 5, 7), readings(np.ones(6), 5, 7))


@settings(max_examples=50, deadline=None)
@given(st.lists(st.floats(-1e4, 1e4), min_size=6, max_size=6))
def test_a_reading_stays_within_the_range(truth: list[float]) -> None:
    row = readings(np.array(truth), 1)[0]
    assert np.all(np.abs(row) <= [100.0] * 3 + [5.0] * 3)
