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
    energy: FloatArray
    """Taken by each load since then, (loads,) [J]."""
    switched: FloatArray
    """Sum of the switches of each load since then, (loads,) [1]."""
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
        self._moves = [place for place, load in enumerate(power.params.loads) if load.kind == "commanded"]

    def first(self, power: NetworkState) -> PlantHeatState:
        """At the start of a run."""
        return PlantHeatState(self.machine.initial_state(), power, np.zeros(self._loads), np.zeros(self._loads))

    def round_drives(self, state: PlantHeatState, loads: Sequence[str]) -> list[float | None]:
        """Temperature of the nodes that the loads of drives warm; None where one warms none [K]."""
        nodes = [self.machine.node_of(load) for load in loads]
        temperatures = state.nodes.thermal.temperatures
        return [None if node is None else float(temperatures[node]) for node in nodes]

    def warming(self, power: FloatArray, moved: Moved, periods: int = 1) -> FloatArray:
        """Of the power that loads take (loads,) [W], what is heat in the machine: of those that move it their part of
        the motors' heat, by the energy that each took or gave back in so many periods; the rest is work on the ground.
        """
        energies = moved.energy.tolist()
        turned = [abs(energies[place]) for place in self._moves]
        total = sum(turned)
        share = moved.heat / total if total > 0.0 else 0.0
        heat = power.copy()
        heat[self._moves] = [share * energy / (periods * self._period) for energy in turned]
        return heat

    def is_due(self, state: PlantHeatState, periods: int = 1) -> bool:
        """Whether the periods that begin end with a step of the thermal network, which needs the light."""
        return state.periods + periods >= self._every

    def after(
        self, state: PlantHeatState, supplied: Supplied, time: float, light: Sunlight | None, passed: int = 1
    ) -> PlantHeatState:
        """After so many control periods.

        Args:
            supplied: what the power network did in them. time: of their end after the start of the run [s].
            light: on the machine, where `is_due`.
        """
        energy = state.energy + supplied.power * (passed * self._period)
        switched = state.switched + passed * supplied.fractions
        periods = state.periods + passed
        if light is None:
            return replace(state, energy=energy, switched=switched, periods=periods)
        dt = periods * self._period
        means = Supplied(state.power, supplied.after, switched / periods, energy / dt)
        nodes = self.machine.step(state.nodes, self._site.around(time - 0.5 * dt, light), means, dt)
        return PlantHeatState(nodes, supplied.after, np.zeros(self._loads), np.zeros(self._loads))
