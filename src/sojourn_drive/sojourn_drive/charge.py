"""What the drive knows of the charge: the newest /battery_state of each store, as energy above the power manager's
reserve.

Nobody measures what sources give, only what comes out of the stores. But what goes on at a stand is known, so

    given = P_house - power out of the stores,    at a stand, smoothed and at least 0

and in motion all that is taken is the power out of the stores and what was given at the last stand. The first reading
of all counts as one at a stand. Range: as long as the light is the same; stores that are so full that sources are held
back do not show what these could give more; what thermostats do not draw counts as given; where a run begins with a
drive, what that takes in the first second is missing in what is given.
"""

from collections.abc import Collection, Sequence

from sojourn_contract.values import BatteryState
from sojourn_flight.planning.energy_forecast import EnergyLeft
from sojourn_flight.power_manager.params import PowerManagerParams

NEW = 0.2
"""Weight of a new reading in what sources give [-]: with one a second, five seconds smooth away most of its noise."""


class ChargeGauge:
    """Reads the stores.

    Args:
        manager: what the power manager believes of them, and when it takes a load's power away.
        loads: without which the machine does not move.
        house_power: of all that goes on at a stand [W], None where that is not known.
    """

    def __init__(self, manager: PowerManagerParams, loads: Collection[str], house_power: float | None) -> None:
        self._manager = manager
        self._house_power = house_power if manager.power.sources else None
        self._reserve = manager.reserve(loads)
        self._kept = manager.stored_energy([self._reserve] * len(manager.stores))

    def supply(
        self, messages: Sequence[BatteryState | None], before: EnergyLeft | None, stands: bool
    ) -> EnergyLeft | None:
        """By a reading of each store; where one is None (not due, refused or too old) what was known before.

        Args:
            stands: whether the machine does, so that nothing is taken but what goes on then.
        """
        found = [message for message in messages if message is not None]
        if len(found) < len(messages):
            return before
        charges = [_charge(message) for message in found]
        left = self._manager.stored_energy(charges) - self._kept
        soc = sum([share * charge for share, charge in zip(self._manager.shares, charges, strict=True)])
        power = sum([-message.voltage * message.current for message in found])
        given = 0.0 if before is None else before.given
        if self._house_power is not None and (stands or before is None):
            now = max(self._house_power - power, 0.0)
            given = now if before is None else given + NEW * (now - given)
        return EnergyLeft(left, soc, self._reserve, max(power + given, 0.0), given)


def _charge(message: BatteryState) -> float:
    return min(max(message.charge / message.capacity, 0.0), 1.0) if message.capacity > 0.0 else 0.0
