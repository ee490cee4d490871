"""The thermal network of a machine beside its power network: what warms what, step by step.

    loads        what a load draws is heat in the node that `warms` names; of what moves the machine the plant tells
                 the heat of the motors, a plan of days takes all of it, work on the ground included
    heaters      a thermostat is a contact in series with the load of its name: the part of a step for which it was
                 closed (its duty) is the part of its power that the load may take in the next one
    stores       have a temperature of their own and lose heat to the node that `warms` names, which is what is round
                 them; a store that is not named has the surroundings of its own parameters. A store of capacity C with
                 conductance G to a node of capacity N (its part of it, where it shares the node) approaches in a step
                 T + (T_N - T) k, with k = N/(N + C) (1 - exp(-G dt (1/C + 1/N)))/(1 - exp(-G dt/C)): so it comes as far
                 as the two do by themselves, and however long the step, no further than where both are as warm
    sources      give their waste heat to the node that `warms` names

So all electrical energy of a heater is heat in its node, one step later. The step is the plant's control period or a
minute of a forecast alike.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import expm1
from typing import NamedTuple, TypeAlias

import numpy as np

from sojourn_machine.evolution import replace
from sojourn_machine.params import FloatArray
from sojourn_machine.power.network_state import NetworkState
from sojourn_machine.power.power_params import PowerParams
from sojourn_machine.power.stores import StoreParams, StoreState
from sojourn_machine.thermal.network import ThermalNetwork, ThermalState, ThermalSurroundings
from sojourn_machine.thermal.thermal_params import ThermalParams

AroundHeat: TypeAlias = Callable[[float], ThermalSurroundings]
"""Ground, sky, light and air about the machine, by the time after the start of the run [s]."""


@dataclass(frozen=True, eq=False, slots=True)
class HeatState:
    """What is remembered of the heat."""

    thermal: ThermalState
    duty: FloatArray
    """Part of the last step for which each heater's thermostat was closed, shape (heaters,) [1]."""


class Supplied(NamedTuple):
    """What the power network did in a step."""

    before: NetworkState
    after: NetworkState
    fractions: FloatArray
    """Switch of each load as it was commanded, mean of the step, (loads,) [1]."""
    power: FloatArray
    """Taken by each load, or of what moves the machine the part that stays in it, mean of the step, (loads,) [W]."""


class Exchange(NamedTuple):
    """Of heat between a store and its node."""

    conductance: float
    """[W/K]"""
    store: float
    """Heat capacity [J/K]."""
    node: float
    """Likewise, the part of it for this store [J/K]."""

    def share(self, dt: float) -> float:
        """k of the module, in a step of `dt` [s] [1]."""
        alone = self.conductance * dt / self.store
        both = alone * (1.0 + self.store / self.node)
        return self.node / (self.node + self.store) * expm1(-both) / expm1(-alone)


class MachineHeat:
    """The heat of a machine.

    Args:
        params: nodes and what warms them. power: loads and stores, which these name.
    """

    def __init__(self, params: ThermalParams, power: PowerParams) -> None:
        self.network = ThermalNetwork(params)
        self._loads = [load.name for load in power.loads]
        self._stores = list(power.all_stores.values())
        places = {name: place for place, name in enumerate(self._loads)}
        self._heaters = [places[name] for name in params.heaters]
        self._rated = [heater.power_w for heater in params.heaters.values()]
        nodes = {name: place for place, name in enumerate(self.network.names)}
        self._load_nodes = [
            (place, nodes[params.warms[name]])
            for place, name in enumerate(self._loads)
            if name in params.warms and name not in params.heaters
        ]
        self._sources = [
            (place, source, nodes[params.warms[name]])
            for place, (name, source) in enumerate(power.sources.items())
            if name in params.warms
        ]
        self._store_nodes = [nodes[params.warms[name]] if name in params.warms else None for name in power.all_stores]
        self._exchanges = [
            self._exchange(store, node) for store, node in zip(self._stores, self._store_nodes, strict=True)
        ]

    def _exchange(self, store: StoreParams, node: int | None) -> Exchange | None:
        """None for a store that is as warm as what is round it, or exchanges nothing."""
        conductance, capacity = store.exchange
        if node is None or conductance * capacity == 0.0:
            return None
        there = [self._stores[place] for place, other in enumerate(self._store_nodes) if other == node]
        of_node = list(self.network.params.nodes.values())[node].heat_capacity
        return Exchange(conductance, capacity, of_node / sum(other.exchange[0] > 0.0 for other in there))

    def initial_state(self) -> HeatState:
        """Nodes at their temperatures of the start, thermostats as these have them."""
        thermal = self.network.initial_state()
        return HeatState(thermal, thermal.heating.copy())

    def through_thermostats(self, state: HeatState, fractions: FloatArray) -> FloatArray:
        """Switches of all loads with the thermostats in series, (loads,) [1]."""
        passed = np.array(fractions, dtype=np.float64)
        for heater, duty in zip(self._heaters, state.duty.tolist(), strict=True):
            passed[heater] *= duty
        return passed

    def node_of(self, name: str) -> int | None:
        """Place of the node that a load or a store of a name warms; None: none does."""
        node = self.network.params.warms.get(name)
        return None if node is None else self.network.names.index(node)

    def store_surroundings(self, state: HeatState, stores: Sequence[StoreState], dt: float) -> tuple[float | None, ...]:
        """What is round each store in a step of `dt` [s]; None for the temperature of its own parameters [K].

        Args:
            stores: at the beginning of the step.
        """
        around = list[float | None]()
        for store, node, exchange in zip(stores, self._store_nodes, self._exchanges, strict=True):
            if node is None:
                around.append(None)
                continue
            there = float(state.thermal.temperatures[node])
            around.append(store.temperature + (there - store.temperature) * exchange.share(dt) if exchange else there)
        return tuple(around)

    def step(self, state: HeatState, around: ThermalSurroundings, supplied: Supplied, dt: float) -> HeatState:
        """After a step of `dt` [s] of the power network. Raises InvalidValueError as the thermal network does."""
        power = supplied.power.tolist()  # numbers one by one, of which a machine has few: arrays take longer
        heat = self._heat_given(supplied, power, dt)
        fed = self._fed(state, supplied, power)
        thermal = self.network.step(state.thermal, around, np.array(heat), dt, fed=np.array(fed))
        return replace(state, thermal=thermal, duty=np.array(self._closed(state.thermal, thermal, fed, dt)))

    def _heat_given(self, supplied: Supplied, power: Sequence[float], dt: float) -> list[float]:
        """Of loads, stores and sources to each node [W]."""
        heat, before, after = [0.0] * len(self.network.names), supplied.before, supplied.after
        for load, node in self._load_nodes:
            heat[node] += power[load]
        for store, old, new, place in zip(self._stores, before.stores, after.stores, self._store_nodes, strict=True):
            if place is not None:
                heat[place] += store.heat_given(old, new) / dt
        for place, source, node in self._sources:
            heat[node] += source.heat_given(before.sources[place], after.sources[place]) / dt
        return heat

    def _fed(self, state: HeatState, supplied: Supplied, power: Sequence[float]) -> list[float]:
        """Part of its power that each heater has while its contact is closed [1]: a closed one passes what the bus
        gave, an open one would have passed as much as its switch allows.
        """
        heaters = zip(self._heaters, self._rated, state.duty.tolist(), strict=True)
        return [
            power[place] / (duty * rated) if duty * rated > 0.0 else float(supplied.fractions[place])
            for place, rated, duty in heaters
        ]

    def _closed(self, before: ThermalState, after: ThermalState, fed: Sequence[float], dt: float) -> list[float]:
        """Part of the step for which the contact of each heater was closed [1]; as it stands at the end where it passed
        nothing.
        """
        heating = after.heating.tolist()
        earlier, energy = _heater_energies(before), _heater_energies(after)
        of_each = zip(self._rated, fed, heating, earlier, energy, strict=True)
        return [
            min(max((new - old) / (part * rated * dt), 0.0), 1.0) if part * rated * dt > 0.0 else closed
            for rated, part, closed, old, new in of_each
        ]


def _heater_energies(state: ThermalState) -> list[float]:
    """Of each heater since the start [J]."""
    return [0.0] * len(state.heating) if state.heater_energy is None else state.heater_energy.tolist()
