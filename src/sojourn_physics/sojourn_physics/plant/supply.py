"""Power network and heat of the machine over a control period, in the light where it stands."""

from sojourn_machine.params import FloatArray
from sojourn_machine.power.network_state import NetworkOutput, NetworkState
from sojourn_machine.power.surroundings import PowerSurroundings
from sojourn_machine.thermal.machine_heat import Supplied
from sojourn_physics.plant.heat import Moved, PlantHeatState
from sojourn_physics.plant.light import light_for_power, surroundings_of
from sojourn_physics.plant.model import PlantModel
from sojourn_physics.plant.state import PlantState

HELD_PERIODS = 5
"""Control periods for which the network has one direction of the light: 0.1 s, in which the machine hardly turns."""


def powered(
    model: PlantModel, state: PlantState, fractions: FloatArray, moved: Moved, periods: int = 1
) -> tuple[NetworkState, NetworkOutput, PlantHeatState | None]:
    """Power network and heat after the control periods that have passed, in one step, its loads switched by fractions
    (loads,) [1], with what moves the machine; the light is that of the state.
    """
    period, before, heat = periods * model.simulation.control_period, state.power, state.heat
    demand = moved.energy / period
    if model.heat is None or heat is None:
        return *model.power.step(before, fractions, demand, period, _surroundings(model, state, (), periods)), None
    surroundings = _surroundings(model, state, model.heat.round_stores(heat, before, periods), periods)
    network, supply = model.power.step(before, fractions * heat.contacts, demand, period, surroundings)
    light = light_for_power(model, state) if model.heat.is_due(heat, periods) else None
    supplied = Supplied(before, network, fractions, supply.load_power)
    time = (state.tick + periods) * model.simulation.control_period
    return network, supply, model.heat.after(heat, supplied, moved, time, light, periods)


def _surroundings(
    model: PlantModel, state: PlantState, round_stores: tuple[float | None, ...], periods: int
) -> PowerSurroundings:
    """As `surroundings_of`, or those of the period before where that will do."""
    held = state.power.surroundings
    is_new = periods > 1 or state.tick % HELD_PERIODS == 0 or not model.power.takes_light
    return surroundings_of(model, state, round_stores) if is_new or held.round_stores != round_stores else held
