"""What a machine is believed to draw at rest comes to what its motors hold with, and stays where nothing is told."""

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

NIGHT, NOON = 14.0 * 3600.0, 4.0 * 3600.0
"""After the start of the sol [s]."""


@lru_cache
def machine(name: str) -> LoadedScenario:
    return load_scenario("mars_sol", [f"machine={name}", "activities=[]"])


def looks(
    name: str, drawn: list[float], time: float = NIGHT, soc: float = 0.5
) -> tuple[list[float], Forecaster, Known]:
    """What is believed after each look, a minute apart, while motors draw so much [W]."""
    known = machine(name).as_believed()
    around, params = expected_light(known), known.power_manager
    forecaster, network = Forecaster(params, (), around), PowerNetwork(machine(name).power)
    state, noise = network.initial_state(soc), np.random.default_rng(3)
    loads = [load.name for load in params.loads]
    manager, held, seen = law.initial_state(params, soc), 0.0, []
    last = Known(time, manager, ())
    for watts in drawn:
        demand = np.zeros(len(loads))
        demand[loads.index("drive")] = watts
        time += 60.0
        state, output = network.step(state, np.ones(len(loads)), demand, 60.0, around(time))
        (store,), (current,) = state.stores, output.store_currents
        window = tuple(output.voltage * current + 0.3 * noise.standard_normal(50))
        switches = SwitchState(on=(True,) * len(loads), window=window)
        charged = replace(manager.stores[0], soc=store.soc)
        manager = replace(manager, stores=(charged,), faults=replace(manager.faults, switches=switches))
        last = Known(time, manager, (StoreReading(output.voltage, current, store.temperature),), None, 1.0, held)
        held = forecaster.held_after(last)
        seen.append(held)
    return seen, forecaster, last._replace(held=held)


@pytest.mark.parametrize("name", ["explorer", "explorer_solar", "explorer_isotope"])
def test_it_comes_to_what_motors_hold_with(name: str) -> None:
    seen, _, _ = looks(name, [1.8] * 40)
    assert seen[0] < 0.6 and seen[-1] == pytest.approx(1.8, abs=0.15)


def test_a_drive_that_was_taken_for_rest_is_forgotten_at_the_first_look_after_it() -> None:
    seen, _, _ = looks("explorer", [40.0] * 10 + [1.8])
    assert seen[9] > 20.0 and seen[-1] == pytest.approx(1.8, abs=0.15)


def test_in_the_light_of_arrays_and_where_sources_are_held_back_nothing_is_told() -> None:
    assert looks("explorer_solar", [1.8] * 5, NOON)[0] == [0.0] * 5
    assert looks("explorer_isotope", [1.8] * 5, soc=1.0)[0] == [0.0] * 5


def test_a_forecast_has_it_and_a_planned_drive_takes_its_place() -> None:
    _, forecaster, known = looks("explorer", [1.8] * 40)
    used = [forecaster.forecast(one).values[0, 4] for one in (known, known._replace(held=0.0))]
    assert used[0] - used[1] == pytest.approx(known.held, rel=0.01)  # a heater by the voltage
