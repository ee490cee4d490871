"""What the drive knows of the battery: the newest /battery_state, as energy above the power manager's reserve."""

from collections.abc import Collection

from sojourn_contract.values import BatteryState
from sojourn_flight.planning.energy_forecast import EnergyLeft
from sojourn_flight.power_manager.params import PowerManagerParams
from sojourn_machine.power.battery import stored_energy


class ChargeGauge:
    """Reads the battery.

    Args:
        manager: what the power manager believes of the battery, and when it takes a load's power away.
        loads: without which the machine does not move.
    """

    def __init__(self, manager: PowerManagerParams, loads: Collection[str]) -> None:
        self._battery = manager.battery
        self._reserve = manager.reserve(loads)

    def supply(self, message: BatteryState | None, before: EnergyLeft | None) -> EnergyLeft | None:
        """By a reading; None (not due, refused or too old) leaves what was known before."""
        if message is None:
            return before
        soc = min(max(message.charge / message.capacity, 0.0), 1.0) if message.capacity > 0.0 else 0.0
        left = stored_energy(self._battery, soc) - stored_energy(self._battery, self._reserve)
        return EnergyLeft(left, soc, self._reserve, max(-message.voltage * message.current, 0.0))
