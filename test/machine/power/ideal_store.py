"""A store of a force and a resistance that are set from outside, for tests of a bus."""

from dataclasses import dataclass

from sojourn_machine.evolution import replace
from sojourn_machine.power.loads import BusParams, BusState
from sojourn_machine.power.network import PowerNetwork
from sojourn_machine.power.network_state import NetworkOutput
from sojourn_machine.power.power_params import PowerParams
from sojourn_machine.power.stores import StoreParams, StorePoint


@dataclass(frozen=True, slots=True)
class IdealState:
    """Force [V] and resistance [ohm]; charge [1] and temperature [K] do not matter."""

    source: float
    resistance: float
    soc: float = 0.5
    temperature: float = 290.0


class IdealStore(StoreParams):
    """`IdealState` says all."""

    kind: str = "ideal"
    ceiling: float = 1e9
    discharges: bool = True
    charges: bool = True

    def initial_state(self, soc: float, temperature: float | None = None) -> IdealState:
        """28 V behind 0.1 ohm."""
        return IdealState(28.0, 0.1, soc)

    def point(self, state: IdealState) -> StorePoint:
        """As the state has it."""
        return StorePoint(state.source, state.resistance, self.ceiling, self.discharges, self.charges)

    def step(
        self, state: IdealState, current: float, dt: float, temperature_surroundings: float | None = None
    ) -> IdealState:
        """Nothing changes."""
        return state

    @property
    def charge_capacity(self) -> float:
        """So much that it is never empty."""
        return 1e12

    def open_circuit_voltage(self, soc: float) -> float:
        """28 V."""
        return 28.0


def one_bus(
    bus: BusParams,
    before: BusState,
    source: float,
    resistance: float,
    fractions: tuple[float, ...],
    demand: tuple[float, ...],
    dt: float,
) -> tuple[BusState, NetworkOutput]:
    """One period of a bus on an ideal store."""
    network = PowerNetwork(PowerParams(stores={"ideal": IdealStore()}, bus=bus))
    state = replace(network.initial_state(0.5), stores=(IdealState(source, resistance),), buses=(before,))
    after, output = network.step(state, fractions, demand, dt)
    return after.buses[0], output
