"""What arrays are believed to give comes to what they give, and stays where nothing can be told."""

from dataclasses import replace
from functools import lru_cache

import numpy as np
import pytest

from sojourn_config.expected_light import expected_light
from sojourn_config.scenario import LoadedScenario, load_scenario
from sojourn_flight.power_manager import law
from sojourn_flight.power_manager.forecast import Forecaster, Known
from sojourn_flight.power_manager.reading import StoreReading
from sojourn_flight.power_manager.switch_watch import SwitchState
from sojourn_machine.power.network import PowerNetwork

NOON = 4.0 * 3600.0
"""After the start of the scenario [s]."""


@lru_cache
def sol(clean: float = 1.0) -> LoadedScenario:
    return load_scenario("mars_sol", [f"sources.array.clean={clean}", "activities=[]"])


def believed_after(
    looks: int, truth: float, soc: float = 0.5, begun: float | None = None, start: float = NOON
) -> list[float | None]:
    """What is believed look by look, a minute apart, where the arrays are truly so clean."""
    real, known = sol(truth), sol().as_believed()
    around = expected_light(known)
    forecaster = Forecaster(known.power_manager, (), around)
    network, draw = PowerNetwork(real.power), np.random.default_rng(5)
    state = network.initial_state(soc)
    on, loads = np.ones(len(real.power.loads)), [load.name for load in real.power.loads]
    demand = np.zeros(len(loads))
    manager, clean, seen = law.initial_state(known.power_manager, soc), begun, []
    for minute in range(30 + looks):  # warm in the light first
        time = start + 60.0 * minute
        state, output = network.step(state, on, demand, 60.0, around(time))
        if minute < 30:
            continue
        (store,), (current,) = state.stores, output.store_currents
        power = output.voltage * current
        window = tuple(power + 0.6 * draw.standard_normal(50))
        switches = SwitchState(on=(True,) * len(loads), window=window)
        charged = replace(manager.stores[0], soc=store.soc)
        manager = replace(manager, stores=(charged,), faults=replace(manager.faults, switches=switches))
        reading = StoreReading(output.voltage, current, store.temperature)
        clean = forecaster.clean_after(Known(time, manager, (reading,), None, clean))
        seen.append(clean)
    return seen


@pytest.mark.parametrize("truth", [0.35, 0.6, 0.9])
def test_belief_of_dust_comes_to_the_truth_within_half_an_hour(truth: float) -> None:
    seen = believed_after(30, truth)
    assert seen[0] is not None and seen[0] > truth
    assert seen[-1] == pytest.approx(truth, abs=0.03)


def test_an_array_that_a_wind_has_swept_is_believed_sooner() -> None:
    assert believed_after(12, 1.0, begun=0.5)[-1] == pytest.approx(1.0, abs=0.05)


def test_nothing_is_learned_by_night_nor_of_arrays_that_are_held_back() -> None:
    assert believed_after(10, 0.5, start=14.0 * 3600.0) == [1.0] * 10
    assert believed_after(10, 0.9, soc=1.0) == [1.0] * 10


def test_a_forecast_with_the_belief_offers_what_comes() -> None:
    known = sol().as_believed()
    around = expected_light(known)
    forecaster = Forecaster(known.power_manager, (), around)
    manager = law.initial_state(known.power_manager, 0.5)
    reading = (StoreReading(28.0, 1.0, 280.0),)
    full, dusty = (
        forecaster.forecast(Known(NOON, manager, reading, None, clean)).values[:, 3].sum() for clean in (1.0, 0.6)
    )
    assert dusty == pytest.approx(0.6 * full, rel=0.06)  # a colder array is a little better
    assert forecaster.forecast(Known(NOON, manager, reading)).values[:, 3].sum() == full


def test_a_machine_without_arrays_believes_nothing_of_them() -> None:
    known = load_scenario("flat_drive").as_believed()
    forecaster = Forecaster(known.power_manager, (), expected_light(known))
    manager = law.initial_state(known.power_manager, 0.5)
    assert forecaster.clean_after(Known(0.0, manager, (StoreReading(28.0, 1.0, 280.0),))) is None
