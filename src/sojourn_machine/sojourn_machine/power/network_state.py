"""What a power network remembers, and what is seen of it in a period."""

from dataclasses import dataclass
from typing import Any, NamedTuple

from sojourn_machine.params import FloatArray
from sojourn_machine.power.fuses import FuseState
from sojourn_machine.power.loads import BusState
from sojourn_machine.power.sources import SourcePoint
from sojourn_machine.power.stores import StoreState
from sojourn_machine.power.surroundings import DARK, PowerSurroundings


class NetworkEnergy(NamedTuple):
    """Energies over the buses since the start [J]: sources + stores = loads + converters + shunts."""

    sources: float = 0.0
    stores: float = 0.0
    """Out of all stores, net."""
    loads: float = 0.0
    converters: float = 0.0
    """Lost in them."""
    shunts: float = 0.0
    """Returned by loads, and more than anything could take."""


NO_ENERGY = NetworkEnergy()


@dataclass(frozen=True, slots=True)
class NetworkState:
    """What the network remembers, in the order of the parameters."""

    stores: tuple[StoreState, ...]
    sources: tuple[Any, ...]
    buses: tuple[BusState, ...]
    voltages: tuple[float, ...]
    """Of each bus in the last period [V]."""
    served: tuple[float, ...]
    """Part of the power asked of each bus that it can give, 1 unless browned out [1]."""
    energy: NetworkEnergy = NO_ENERGY
    fuses: FuseState | None = None
    """Of a network whose loads have some."""
    surroundings: PowerSurroundings = DARK
    """In the last period."""
    offers: tuple[SourcePoint, ...] = ()
    """Of the sources in the last period."""


class NetworkOutput(NamedTuple):
    """The operating point of one period, in the order of the parameters."""

    voltages: tuple[float, ...]
    """Of each bus [V]."""
    served: tuple[float, ...]
    """Part of the power asked of each bus that it can give [1]."""
    load_power: FloatArray
    """That each load receives (loads,) [W]."""
    load_current: FloatArray
    """Likewise [A]."""
    store_currents: tuple[float, ...]
    """Out of each store [A]."""
    source_powers: tuple[float, ...]
    """Of each source [W]."""
    converter_powers: tuple[float, ...]
    """Into the bus that each converter feeds [W]."""
    locked_out: tuple[bool, ...]
    """Whether the lockout is holding loads of each bus off in this period."""
    offered: float = 0.0
    """The most that all sources could have given [W]."""

    @property
    def voltage(self) -> float:
        """Of the bus `main` [V]."""
        return self.voltages[0]

    @property
    def brownout(self) -> bool:
        """A bus cannot give the power that is asked of it."""
        return min(self.served) < 1.0
