"""What the role remembers."""

from dataclasses import dataclass

from sojourn_flight.power_manager.law import PowerManagerState
from sojourn_flight.power_manager.reading import StoreReading
from sojourn_machine.thermal.machine_heat import HeatState
from sojourn_power.requests import NO_REQUEST, LastRequest


@dataclass(frozen=True, slots=True)
class PowerState:
    """See the module."""

    manager: PowerManagerState
    telemetry: tuple[StoreReading | None, ...]
    """The last good one of each store; None until it has come."""
    request: LastRequest = NO_REQUEST
    stepped_at: int | None = None
    """Stamp of the last step [ns]; None where it is not known."""
    heat: HeatState | None = None
    """Of the machine as it is believed to be, where its files say it."""
    looked_at: int = 0
    """Stamp of that [ns]."""
    clean: float | None = None
    """Part of their light that is believed to reach the cells of the arrays [1]; None: as their files have it."""
    held: float = 0.0
    """Believed to be drawn at rest beyond what is known of the loads [W]."""
    ahead: str = ""
    """What the last forecast comes to, in words."""
    alarm: str = ""
    """That its process is not the run's first, until an operator asks for something; see `restart`."""
