"""The Kalman filter of the charge: honest against the truth, better than counting, and never out of its range."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_config.scenario import load_scenario
from sojourn_flight.power_manager import law as manager
from sojourn_flight.power_manager.kalman import KalmanParams, KalmanState, initial_state, step
from sojourn_flight.power_manager.law import PowerManagerInput
from sojourn_flight.power_manager.reading import StoreReading
from sojourn_machine.params import FloatArray
from sojourn_machine.power.network import PowerNetwork

SCENARIO = load_scenario("flat_drive")
POWER = SCENARIO.power
BATTERY = next(iter(POWER.all_stores.values()))
PARAMS = KalmanParams()
SEEDS, PERIOD, CHECK, END = 20, 2.0, 1800.0, 7200.0


def driven(seed: int) -> list[tuple[float, ...]]:
    """Two hours of starts and stops; capacity up to 10 % off, offsets and noise of the explorer's telemetry. At each
    check: error of the charge, its deviation, error by counting, error of the capacity, its deviation."""
    random = np.random.default_rng(seed)
    factor = 1.0 + 0.1 * random.uniform(-1.0, 1.0)
    true = BATTERY.model_copy(update={"capacity_ah": factor * BATTERY.capacity_ah})  # type: ignore[attr-defined]
    network = PowerNetwork(POWER.model_copy(update={"battery": true}))
    offset_v, offset_i = 0.02 * random.standard_normal(), 0.01 * random.standard_normal()
    state, known, found = network.initial_state(random.uniform(0.85, 0.97)), None, []
    moving, power, counted = False, 0.0, 0.0
    for k in range(1, round(END / PERIOD) + 1):
        moving ^= bool(random.random() < PERIOD / 120.0)
        power = max(60.0 + 20.0 * random.standard_normal(), 0.0) * moving
        demand = [power if load.name == "drive" else 0.0 for load in POWER.loads]
        state, output = network.step(state, [1.0] * len(demand), demand, PERIOD)
        reading = StoreReading(
            0.01 * round((output.voltage + offset_v + 0.01 * random.standard_normal()) / 0.01),
            0.02 * round((output.store_currents[0] + offset_i + 0.02 * random.standard_normal()) / 0.02),
            0.1 * round((state.stores[0].temperature + 0.1 * random.standard_normal()) / 0.1),
        )
        if known is None:
            known = initial_state(PARAMS, BATTERY, reading)
            counted = known.soc
        else:
            known = step(PARAMS, BATTERY, known, reading, PERIOD)
            counted -= reading.current * PERIOD / BATTERY.charge_capacity
        if k % round(CHECK / PERIOD) == 0:
            soc = state.stores[0].soc
            capacity = known.capacity_factor - factor
            found.append((known.soc - soc, known.sigma, counted - soc, capacity, known.capacity_sigma))
    return found


@pytest.fixture(scope="module")
def runs() -> FloatArray:
    """(seeds, checks, 5)"""
    return np.array([driven(seed) for seed in range(SEEDS)])


def test_the_truth_is_within_the_bound_of_95_percent(runs: FloatArray) -> None:
    for check in range(runs.shape[1]):
        error, sigma, _, capacity, of_capacity = runs[:, check].T
        assert np.mean(np.abs(error) < 1.96 * sigma) >= 0.9
        assert np.mean(np.abs(capacity) < 1.96 * of_capacity) >= 0.9
        assert np.all(sigma < 0.01), "a bound that says something"


def test_it_is_better_than_counting_with_a_capacity_that_is_off(runs: FloatArray) -> None:
    error, _, counted, capacity, _ = runs[:, -1].T
    assert np.sqrt(np.mean(error**2)) < 0.3 * np.sqrt(np.mean(counted**2))
    assert np.sqrt(np.mean(capacity**2)) < 0.02


@settings(max_examples=60, deadline=None)
@given(
    st.lists(
        st.tuples(st.floats(0.0, 40.0), st.floats(-40.0, 40.0), st.floats(240.0, 330.0), st.floats(0.01, 100.0)),
        min_size=2,
        max_size=40,
    )
)
def test_whatever_is_read_the_charge_is_one_and_the_covariance_is_one(
    readings: list[tuple[float, float, float, float]],
) -> None:
    known: KalmanState | None = None
    for *measured, dt in readings:
        reading = StoreReading(*measured)
        known = initial_state(PARAMS, BATTERY, reading) if known is None else step(PARAMS, BATTERY, known, reading, dt)
        assert 0.0 <= known.soc <= 1.0 and np.all(np.isfinite(known.mean))
        assert np.linalg.eigvalsh(known.covariance).min() > -1e-9 * np.trace(known.covariance)


def test_the_manager_goes_by_it_where_the_law_says_so() -> None:
    believed = SCENARIO.power_manager
    params = believed.model_copy(update={"law": believed.law.model_copy(update={"estimator": "kalman"})})
    state, telemetry = manager.initial_state(params), PowerManagerInput((StoreReading(29.0, 3.0, 290.0),))
    for _ in range(600):
        state, output = manager.step(params, state, telemetry, 0.1)
    known = output.filters[0]
    assert known is not None and output.charges == (known.soc,) and 0.0 < known.sigma < PARAMS.charge_sigma
    counted, _ = manager.step(believed, manager.initial_state(believed), telemetry, 0.1)
    assert counted.stores[0].filter is None
    assert abs(output.soc - counted.stores[0].charge) < 0.05
