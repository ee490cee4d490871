"""What the drive knows of the battery: the newest /battery_state, as energy above the power manager's reserve."""

from typing import Any

from sojourn_drive.measurements import DRIVE_LOADS
from sojourn_mechanics.power.battery import stored_energy
from sojourn_mechanics.power.manager_params import PowerManagerParams
from sojourn_mechanics.steering.energy_forecast import Supply


class ChargeGauge:
    """Keeps the newest reading.

    Args:
        manager: what the power manager believes of the battery, and when it takes the drive's power away.
    """

    def __init__(self, manager: PowerManagerParams) -> None:
        self._battery = manager.battery
        self._reserve = manager.reserve(DRIVE_LOADS)
        self.supply: Supply | None = None
        """None until the first reading."""

    def hear(self, message: Any) -> None:
        """Take a reading; None (not due, refused or too old) leaves the last one."""
        if message is None:
            return
        soc = min(max(message.charge / message.capacity, 0.0), 1.0) if message.capacity > 0.0 else 0.0
        left = stored_energy(self._battery, soc) - stored_energy(self._battery, self._reserve)
        self.supply = Supply(left, soc, self._reserve, max(-message.voltage * message.current, 0.0))
