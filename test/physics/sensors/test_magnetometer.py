"""Magnetometer: statistics of its readings against its parameters."""

import numpy as np
import pytest

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray
from sojourn_physics.sensors.magnetometer import MagnetometerParams, deviation, initial_state, step

FIELD = np.array([20e-6, -5e-6, 43e-6])
PERFECT = MagnetometerParams(link="base_link", range=2e-4, resolution=1e-12, noise=0.0)


def readings(params: MagnetometerParams, count: int, seed: int = 1, field: FloatArray = FIELD) -> FloatArray:
    state, found = initial_state(params, seed, "mag"), []
    for _ in range(count):
        state, reading = step(params, state, field)
        found.append(reading)
    return np.array(found)


def test_one_without_errors_reads_the_field() -> None:
    np.testing.assert_allclose(readings(PERFECT, 1)[0], FIELD, atol=1e-12)


def test_noise_is_as_told_and_new_in_every_reading() -> None:
    noisy = readings(PERFECT.model_copy(update={"noise": 7e-9}), 4000)
    assert noisy.std(axis=0) == pytest.approx(7e-9, rel=0.05)
    assert abs(np.corrcoef(noisy[1:, 0], noisy[:-1, 0])[0, 1]) < 0.06


def test_lasting_errors_have_the_deviation_that_it_tells_over_seeds() -> None:
    params = PERFECT.model_copy(update={"hard_iron": 1e-7, "soft_iron": 0.005, "noise": 7e-9, "resolution": 6.7e-9})
    off = np.array([readings(params, 1, seed)[0] - FIELD for seed in range(400)])
    assert off.std(axis=0) == pytest.approx(deviation(params, FIELD), rel=0.12)
    same = readings(params.model_copy(update={"noise": 0.0}), 2)
    assert np.array_equal(same[0], same[1])


def test_turning_about_tells_hard_from_soft_iron() -> None:
    """Hard iron is what a reading and that of the field turned about have in common; soft iron grows with the field."""
    hard = PERFECT.model_copy(update={"hard_iron": 1e-7})
    there, back = readings(hard, 1)[0], readings(hard, 1, field=-FIELD)[0]
    assert 0.5 * np.linalg.norm(there + back) > 2e-8
    np.testing.assert_allclose(0.5 * (there - back), FIELD, atol=2e-12)
    soft = PERFECT.model_copy(update={"soft_iron": 0.01})
    once, twice = (readings(soft, 1, field=times * FIELD)[0] - times * FIELD for times in (1.0, 2.0))
    np.testing.assert_allclose(twice, 2.0 * once, atol=3e-12)


def test_range_and_least_bit() -> None:
    coarse = PERFECT.model_copy(update={"resolution": 6.7e-9, "range": 30e-6})
    reading = readings(coarse, 1)[0]
    assert reading[2] == 30e-6 and reading[:2] / 6.7e-9 == pytest.approx(np.round(reading[:2] / 6.7e-9), abs=1e-6)


def test_a_field_that_is_no_number_is_refused() -> None:
    with pytest.raises(InvalidValueError, match="field in the magnetometer"):
        step(PERFECT, initial_state(PERFECT, 1, "mag"), np.array([0.0, np.nan, 0.0]))
