"""Power network and heat of the machine over a control period, in the light where it stands."""

from sojourn_machine.params import FloatArray
from sojourn_machine.power.network_state import NetworkOutput, NetworkState
from sojourn_machine.thermal.machine_heat import Supplied
from sojourn_physics.plant.heat import Moved, PlantHeatState
from sojourn_physics.plant.light import light_for_power, surroundings_of
from sojourn_physics.plant.model import PlantModel
from sojourn_physics.plant.state import PlantState


def powered(
    model: PlantModel, state: PlantState, fractions: FloatArray, moved: Moved, periods: int = 1
) -> tuple[NetworkState, NetworkOutput, PlantHeatState | None]:
    """Power network and heat after the control periods that have passed, in one step, its loads switched by fractions
    (loads,) [1], with what moves the machine; the light is that of the state.
    """
    period, before, heat = periods * model.simulation.control_period, state.power, state.heat
    demand = moved.energy / period
    if model.heat is None or heat is None:
        return *model.power.step(before, fractions, demand, period, surroundings_of(model, state)), None
    surroundings = surroundings_of(model, state, heat.round_stores)
    network, supply = model.power.step(before, fractions * heat.contacts, demand, period, surroundings)
    light = light_for_power(model, state) if model.heat.is_due(heat, periods) else None
    supplied = Supplied(before, network, fractions, supply.load_power)
    time = (state.tick + periods) * model.simulation.control_period
    return network, supply, model.heat.after(heat, supplied, moved, time, light, periods)
