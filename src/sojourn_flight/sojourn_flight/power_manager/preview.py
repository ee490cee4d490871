"""Hours and days of a machine's power ahead: the network of `sojourn_machine.power` under the law of the power manager,
in steps of a minute or more, without the motion of the machine.

Each step is one period of the closed loop: the law hears what the network showed at the end of the step before, and
sets its switches; the network takes what is planned (`activities`) and what falls on it. What the law counts in
seconds (levels shed one after the other, a limit that comes back) so takes at least one step. A load that is shed
within a step is served to its end: an energy is out by at most one load over one step.
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple, TypeAlias

import numpy as np

from sojourn_flight.power_manager import law
from sojourn_flight.power_manager.activities import Activities
from sojourn_flight.power_manager.law import PowerManagerInput, PowerManagerOutput, PowerManagerState
from sojourn_flight.power_manager.modes import SLEEP
from sojourn_flight.power_manager.params import PowerManagerParams
from sojourn_flight.power_manager.reading import StoreReading
from sojourn_machine.evolution import replace
from sojourn_machine.params import FloatArray
from sojourn_machine.power.network import PowerNetwork
from sojourn_machine.power.network_state import NetworkOutput, NetworkState
from sojourn_machine.power.surroundings import PowerSurroundings
from sojourn_machine.thermal.machine_heat import AroundHeat, HeatState, MachineHeat, Supplied

Around: TypeAlias = Callable[[float], PowerSurroundings]
"""Light and warmth at the machine, by the time after the start of the run [s]."""


class Warmth(NamedTuple):
    """The heat of a machine and what is round it."""

    heat: MachineHeat
    around: AroundHeat


class PreviewState(NamedTuple):
    """Where a preview is."""

    time: float
    """After the start of the run [s]."""
    network: NetworkState
    manager: PowerManagerState
    seen: NetworkOutput
    """Of the step before."""
    heat: HeatState | None = None
    """Of a machine whose heat is looked at."""
    held: FloatArray | float = 0.0
    """Drawn by motors that stand, (loads,) or the same of all loads [W]."""


class PreviewStep(NamedTuple):
    """What one step showed."""

    time: float
    """Its end, after the start of the run [s]."""
    network: NetworkOutput
    manager: PowerManagerOutput
    """At the beginning of the step."""
    charges: tuple[float, ...]
    """Of each store at its end [1]."""
    temperatures: tuple[float, ...]
    """Likewise [K]."""
    sleeps_by_plan: bool
    nodes: FloatArray | None = None
    """Temperatures of the nodes of the thermal network at its end, (nodes,) [K]; None without one."""


class Preview:
    """A machine and its plan.

    Args:
        params: of the manager; charges are counted, whatever its estimator: nothing is measured here.
        network: as it is, or as it is believed to be.
        activities: what is planned. around: light and warmth. warmth: its own heat, where that is looked at.
    """

    def __init__(
        self,
        params: PowerManagerParams,
        network: PowerNetwork,
        activities: Activities,
        around: Around,
        warmth: Warmth | None = None,
    ) -> None:
        self._warmth = warmth
        self.params = params.model_copy(update={"law": params.law.model_copy(update={"estimator": "coulomb"})})
        self.network = network
        self._activities = activities
        self.around = around

    def begin(
        self,
        time: float,
        manager: PowerManagerState,
        network: NetworkState,
        heat: HeatState | None = None,
        held: FloatArray | float = 0.0,
    ) -> PreviewState:
        """At a time [s] with what is known of manager, network, heat and motors that stand; left out: heat as at the
        start of a run, motors that draw nothing.
        """
        if self._warmth is not None and heat is None:
            heat = self._warmth.heat.initial_state()
        return PreviewState(time, network, manager, self.network.at_rest(network), heat, held)

    def initial_state(self, soc: float) -> PreviewState:
        """At the start of a run, all stores rested at a state of charge [0..1], the law told of it."""
        manager = law.initial_state(self.params, soc)
        return self.begin(0.0, manager, self.network.initial_state(soc))

    def step(self, state: PreviewState, dt: float) -> tuple[PreviewState, PreviewStep]:
        """One step of `dt` [s]. Raises InvalidValueError as the law and the network do."""
        params, network = self.params, self.network
        manager = self._asked(state, dt)
        manager, commanded = law.decided(params, manager, PowerManagerInput(self.readings(state)), dt)
        middle = state.time + 0.5 * dt
        around = self.around(middle)
        demand = np.maximum(self._activities.demand(middle), state.held)
        fractions = network.as_switched(np.array(commanded.fractions))
        if self._warmth is not None and state.heat is not None:
            around = around._replace(
                round_stores=self._warmth.heat.store_surroundings(state.heat, state.network.stores, dt)
            )
            switches = self._warmth.heat.through_thermostats(state.heat, fractions)
            powered, seen = network.step(state.network, switches, demand, dt, around)
            supplied = Supplied(state.network, powered, fractions, seen.load_power)
            heat = self._warmth.heat.step(state.heat, self._warmth.around(middle), supplied, dt)
        else:
            powered, seen = network.step(state.network, fractions, demand, dt, around)
            heat = None
        stores = powered.stores
        shown = PreviewStep(
            state.time + dt,
            seen,
            commanded,
            tuple([store.soc for store in stores]),
            tuple([store.temperature for store in stores]),
            manager.sleep.requested,
            None if heat is None else heat.thermal.temperatures,
        )
        return PreviewState(state.time + dt, powered, manager, seen, heat, state.held), shown

    def run(self, state: PreviewState, dt: float, count: int) -> list[PreviewStep]:
        """So many steps of `dt` [s]."""
        steps = []
        for _ in range(count):
            state, step = self.step(state, dt)
            steps.append(step)
        return steps

    def _asked(self, state: PreviewState, dt: float) -> PowerManagerState:
        """After what the plan changes at this step; at the first one, all that it wants."""
        middle = state.time + 0.5 * dt
        now, before = self._activities.asked(middle), self._activities.asked(middle - dt)
        new = {name: on for name, on in now.items() if on != before[name]}
        if state.manager.sleep.foreseen and new.get(SLEEP) is False:
            del new[SLEEP]  # the planned sleep is over, what the machine itself sleeps for is not
        return law.requested(self.params, state.manager, new) if new else state.manager

    def readings(self, state: PreviewState) -> tuple[StoreReading, ...]:
        """As ideal sensors of voltage, current and temperature have them."""
        voltages = [state.seen.voltages[bus] for bus in self.network.store_bus]
        stores = zip(voltages, state.seen.store_currents, state.network.stores, strict=True)
        return tuple([StoreReading(volts, amps, store.temperature) for volts, amps, store in stores])


def believed(network: PowerNetwork, state: PowerManagerState, readings: Sequence[StoreReading]) -> NetworkState:
    """The network as its manager believes it to be: stores rested, at estimated charges and measured temperatures."""
    known = zip(network.stores, state.stores, readings, strict=True)
    stores = tuple([store.initial_state(one.charge, reading.temperature) for store, one, reading in known])
    rested = network.initial_state(1.0)
    voltages = tuple(
        [
            readings[network.store_bus.index(bus)].voltage if bus in network.store_bus else volts
            for bus, volts in enumerate(rested.voltages)
        ]
    )
    return replace(rested, stores=stores, voltages=voltages)
