"""A machine's heat in its plant.

Little of it changes in a second, so the thermal network takes one step a second, with the means of the power network's
periods in it. Its thermostats and temperatures hold for the next second.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from sojourn_machine.evolution import replace
from sojourn_machine.params import FloatArray
from sojourn_machine.power.network import PowerNetwork
from sojourn_machine.power.network_state import NetworkState
from sojourn_machine.sunlight import Sunlight
from sojourn_machine.thermal.machine_heat import HeatState, MachineHeat, Supplied
from sojourn_physics.plant.supply_kernels import HEAT, SWITCHED, with_period
from sojourn_physics.thermal.site_heat import SiteHeat

STEP = 1.0
"""Of the thermal network [s]."""


@dataclass(frozen=True, eq=False, slots=True)
class PlantHeatState:
    """What is remembered of the heat."""

    nodes: HeatState
    """At the last step of the thermal network."""
    power: NetworkState
    """Likewise."""
    contacts: FloatArray
    """As the thermostats stand since then, the part of its power that each load may take, (loads,) [1]."""
    round_stores: tuple[float | None, ...]
    """Temperature since then of what is round each store; None for that of its own parameters [K]."""
    sums: FloatArray
    """Of each load since then, (2, loads), see `supply_kernels`."""
    periods: int = 0
    """Since then."""


class Moved(NamedTuple):
    """What moved the machine in a control period."""

    energy: FloatArray
    """Of each load, of what moves nothing 0, (loads,) [J]."""
    heat: float
    """Of all motors, gears and stops [J]."""


class PlantHeat:
    """The thermal network beside the power network of a plant.

    Args:
        site: what is round the machine, with its nodes. power: its power network. period: control period [s].
    """

    def __init__(self, site: SiteHeat, power: PowerNetwork, period: float) -> None:
        self.machine = MachineHeat(site.params, power.params)
        self._site, self._period = site, period
        self._every = max(round(STEP / period), 1)
        self._loads = len(power.params.loads)
        self._moves = np.array([load.kind == "commanded" for load in power.params.loads])

    def first(self, power: NetworkState) -> PlantHeatState:
        """At the start of a run."""
        return self._held(self.machine.initial_state(), power)

    def _held(self, nodes: HeatState, power: NetworkState) -> PlantHeatState:
        """What holds from a step of the thermal network on."""
        contacts = self.machine.through_thermostats(nodes, np.ones(self._loads))
        around = self.machine.store_surroundings(nodes, power.stores, self._every * self._period)
        return PlantHeatState(nodes, power, contacts, around, np.zeros((2, self._loads)))

    def round_stores(self, state: PlantHeatState, power: NetworkState, periods: int) -> tuple[float | None, ...]:
        """What is round each store in the periods that begin; where the clock leaps, for so long [K]."""
        if periods <= self._every:
            return state.round_stores
        return self.machine.store_surroundings(state.nodes, power.stores, periods * self._period)

    def round_drives(self, state: PlantHeatState, loads: Sequence[str]) -> list[float | None]:
        """Temperature of the nodes that the loads of drives warm; None where one warms none [K]."""
        nodes = [self.machine.node_of(load) for load in loads]
        temperatures = state.nodes.thermal.temperatures
        return [None if node is None else float(temperatures[node]) for node in nodes]

    def is_due(self, state: PlantHeatState, periods: int = 1) -> bool:
        """Whether the periods that begin end with a step of the thermal network, which needs the light."""
        return state.periods + periods >= self._every

    def after(
        self, state: PlantHeatState, supplied: Supplied, moved: Moved, time: float, light: Sunlight | None, passed: int
    ) -> PlantHeatState:
        """After so many control periods.

        Args:
            supplied: what the power network did in them. moved: what moved the machine. time: of their end after the
                start of the run [s]. light: on the machine, where `is_due`.
        """
        drawn = (supplied.power, supplied.fractions, self._moves, moved.energy, moved.heat)
        sums, periods = with_period(state.sums, *drawn, passed, self._period), state.periods + passed
        if light is None:
            return replace(state, sums=sums, periods=periods)
        dt = periods * self._period
        means = Supplied(state.power, supplied.after, sums[SWITCHED] / periods, sums[HEAT] / dt)
        nodes = self.machine.step(state.nodes, self._site.around(time - 0.5 * dt, light), means, dt)
        return self._held(nodes, supplied.after)
