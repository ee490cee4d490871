"""The Kalman filter of the charge over courses of days: stands, nights in the cold, charging to the brim."""

from collections.abc import Callable

import numpy as np
import pytest

from sojourn_config.scenario import load_scenario
from sojourn_flight.power_manager.kalman import KalmanParams, KalmanState, initial_state, step
from sojourn_flight.power_manager.reading import StoreReading
from sojourn_machine.params import FloatArray
from sojourn_machine.power.battery import BatteryParams

BATTERY = next(iter(load_scenario("flat_drive").power.all_stores.values()))
PARAMS = KalmanParams()
SEEDS, HOUR = range(5), 3600.0
EMPTY = 0.03
"""Charge at which the loads are cut off [1]."""


def a_long_stand(random: np.random.Generator, period: float) -> tuple[FloatArray, float]:
    """Three days of a watchman's current, which goes through most of the charge; currents [A], temperature [K]."""
    times = np.arange(0.0, 72.0 * HOUR, period)
    return 0.12 + 0.02 * np.sin(times / 10_000.0 + random.uniform(0.0, 6.0)), 288.15


def cold_nights(random: np.random.Generator, period: float) -> tuple[FloatArray, float]:
    """Work, rest, work and a long rest, twice, in a cold that allows no charging; it ends empty."""
    parts = [(3.0, random.uniform(1.0, 2.0)), (0.0, 1.0), (2.0, random.uniform(0.5, 1.5)), (0.1, 3.0)]
    return np.concatenate([np.full(round(hours * HOUR / period), amperes) for amperes, hours in 2 * parts]), 268.0


def days_of_sun(random: np.random.Generator, period: float) -> tuple[FloatArray, float]:
    """Two days of six hours of light, which fills it, and eight of night, with work now and then."""
    hours = np.arange(0.0, 28.0, period / HOUR) % 14.0
    light = np.where(hours < 6.0, 6.5 * np.sin(np.pi * hours / 6.0), 0.0)
    work = np.repeat(random.choice([0.0, 0.0, 2.0, 4.0], hours.size // 60 + 1), 60)[: hours.size]
    return 1.0 - light + work, 288.15


def at_the_brim(_: np.random.Generator, period: float) -> tuple[FloatArray, float]:
    """Two days of light that would charge it further, then work."""
    return np.concatenate((np.full(round(48.0 * HOUR / period), -1.0), np.full(round(HOUR / period), 4.0))), 288.15


def errors(course: Callable[..., tuple[FloatArray, float]], seed: int, period: float) -> FloatArray:
    """At every half hour: error of the charge and its deviation, error of the capacity and its deviation, shape (n, 4).

    The capacity is up to 10 % off; the sensors have constant offsets, noise and steps of the explorer's telemetry.
    """
    assert isinstance(BATTERY, BatteryParams)
    random = np.random.default_rng(seed)
    factor = 1.0 + 0.1 * random.uniform(-1.0, 1.0)
    true = BATTERY.model_copy(update={"capacity_ah": factor * BATTERY.capacity_ah})
    currents, around = course(random, period)
    offset_v, offset_i = 0.02 * random.standard_normal(), 0.01 * random.standard_normal()
    state, found = true.initial_state(random.uniform(0.6, 0.95), around), []
    known: KalmanState | None = None
    for k, wanted in enumerate(currents.tolist(), 1):
        point = true.point(state)
        allowed = point.discharges and state.soc > EMPTY if wanted > 0.0 else point.charges
        current = max(wanted, (point.source - point.ceiling) / point.resistance) if allowed else 0.0
        state = true.step(state, current, period, around)
        voltage = point.source - point.resistance * current
        reading = StoreReading(
            0.01 * round((voltage + offset_v + 0.01 * random.standard_normal()) / 0.01),
            0.02 * round((current + offset_i + 0.02 * random.standard_normal()) / 0.02),
            0.1 * round((state.temperature + 0.1 * random.standard_normal()) / 0.1),
        )
        if known is None:
            known = initial_state(PARAMS, BATTERY, reading)
        else:
            known = step(PARAMS, BATTERY, known, reading, period)
        if k % round(0.5 * HOUR / period) == 0:
            capacity = known.capacity_factor - factor
            found.append((known.soc - state.soc, known.sigma, capacity, known.capacity_sigma))
    return np.array(found)


@pytest.mark.parametrize(
    ("course", "period"), [(a_long_stand, 20.0), (cold_nights, 10.0), (days_of_sun, 10.0), (at_the_brim, 20.0)]
)
def test_the_truth_is_within_the_bound_of_95_percent(
    course: Callable[..., tuple[FloatArray, float]], period: float
) -> None:
    """Where the offset of the voltage was taken to fade in an hour, three days of standing, read each two seconds, had
    it outside half of the time: the filter believed to know the charge better than a constant offset lets it."""
    error, sigma, capacity, of_capacity = np.concatenate([errors(course, seed, period) for seed in SEEDS]).T
    assert np.mean(np.abs(error) < 1.96 * sigma) >= 0.9
    assert np.mean(np.abs(capacity) < 1.96 * of_capacity) >= 0.9
    assert np.all(sigma < 0.012), "a bound that says something"
    assert np.sqrt(np.mean(error**2)) > 0.25 * np.sqrt(np.mean(sigma**2)), "and no more than that"
