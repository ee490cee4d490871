"""What the role remembers."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from sojourn_sensors.fault_hooks import FaultyState
from sojourn_sensors.timing import LateReading


@dataclass(frozen=True, slots=True)
class SensorsRestart:
    """Of sensors whose process is not the run's first."""

    number: int
    """Control period in which it began."""
    lost: tuple[str, ...] = ()
    """What of the process before is not known any more, in words."""
    hardware: Mapping[str, Any] = field(default_factory=dict)
    """What the parts remember as JSON has it, by the names of their sensors, until the first truth, with which these
    begin.
    """
    repeated: Mapping[str, Any] = field(default_factory=dict)
    """Likewise what those say that are stuck."""

    @property
    def alarm(self) -> str:
        """In words."""
        lost = f"; not known any more: {', '.join(self.lost)}" if self.lost else ""
        return f"the sensors were restarted{lost}"


@dataclass(frozen=True, slots=True)
class SensorsState:
    """See the module."""

    sensors: tuple[Any, ...] | None = None
    """State of each sensor; None until the first truth says which joints there are and how the machine stands."""
    readings: tuple[Any, ...] = ()
    """The last of each sensor, which is told again where the truth cannot be used; None without power."""
    dead: frozenset[str] = frozenset()
    """Sensors without power."""
    faulty: Mapping[str, FaultyState] = field(default_factory=dict)
    """What is wrong with the readings of sensors, by the names of those that have faults."""
    waiting: Mapping[str, Sequence[LateReading]] = field(default_factory=dict)
    """Readings that are told later, by the names of the sensors that have a timing of their own."""
    off: frozenset[str] = frozenset()
    """Sensors on demand to which nobody listens: they neither measure nor speak."""
    measured_at: int = 0
    """Stamp of the last truth that could be used [ns]; zero where it is not known."""
    restart: SensorsRestart | None = None
    """None of the run's first process."""
