"""What the drive knows of the charge: the newest /battery_state of each store, as energy above the power manager's
reserve.
"""

from collections.abc import Collection, Sequence

from sojourn_contract.values import BatteryState
from sojourn_flight.planning.energy_forecast import EnergyLeft
from sojourn_flight.power_manager.params import PowerManagerParams


class ChargeGauge:
    """Reads the stores.

    Args:
        manager: what the power manager believes of them, and when it takes a load's power away.
        loads: without which the machine does not move.
    """

    def __init__(self, manager: PowerManagerParams, loads: Collection[str]) -> None:
        self._manager = manager
        self._reserve = manager.reserve(loads)
        self._kept = manager.stored_energy([self._reserve] * len(manager.stores))

    def supply(self, messages: Sequence[BatteryState | None], before: EnergyLeft | None) -> EnergyLeft | None:
        """By a reading of each store; where one is None (not due, refused or too old) what was known before."""
        found = [message for message in messages if message is not None]
        if len(found) < len(messages):
            return before
        charges = [_charge(message) for message in found]
        left = self._manager.stored_energy(charges) - self._kept
        soc = sum([share * charge for share, charge in zip(self._manager.shares, charges, strict=True)])
        power = sum([-message.voltage * message.current for message in found])
        return EnergyLeft(left, soc, self._reserve, max(power, 0.0))


def _charge(message: BatteryState) -> float:
    return min(max(message.charge / message.capacity, 0.0), 1.0) if message.capacity > 0.0 else 0.0
