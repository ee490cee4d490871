"""What the drive knows of the charge: the newest /battery_state of each store, as energy above the power manager's
reserve.

Nobody measures what sources give, only what comes out of the stores. But what goes on at a stand is known, so

    given = P_house - P_off - power out of the stores,    at a stand, smoothed and at least 0

where P_off is what is switched off would draw; and in motion all that is taken is the power out of the stores and what
was given at the last stand. A machine that has not stood since it was started, as in a run that begins with a drive,
adds to P_house what its motion costs on the level.

Range: as long as the light is the same; stores that are so full that sources are held back do not show what these
could give more; what thermostats do not draw counts as given.
"""

from collections.abc import Collection, Mapping, Sequence
from typing import NamedTuple

from sojourn_contract.switches import fraction_of
from sojourn_contract.values import BatteryState
from sojourn_flight.planning.energy_forecast import EnergyLeft, on_grade
from sojourn_flight.planning.energy_params import EnergyParams
from sojourn_flight.power_manager.params import PowerManagerParams

NEW = 0.2
"""Weight of a new reading in what sources give [-]: with one a second, five seconds smooth away most of its noise."""


class PowerSituation(NamedTuple):
    """Of the machine: whether it stands, speed [m/s] and yaw rate [rad/s], and what is off would draw [W]."""

    stands: bool
    speed: float = 0.0
    yaw_rate: float = 0.0
    off: float = 0.0


class ChargeGauge:
    """Reads the stores.

    Args:
        manager: what the power manager believes of them, and when it takes a load's power away.
        loads: without which the machine does not move.
        costs: of driving, None where they are not known.
    """

    def __init__(self, manager: PowerManagerParams, loads: Collection[str], costs: EnergyParams | None) -> None:
        self._manager = manager
        self._costs = costs if manager.power.sources else None
        self._draws = {load.name: load.power_w for load in manager.loads if load.kind != "commanded"}
        self._reserve = manager.reserve(loads)
        self._kept = manager.stored_energy([self._reserve] * len(manager.stores))

    def off(self, switches: Mapping[str, str]) -> float:
        """What the loads would draw that are switched off [W]."""
        return sum(draw for load, draw in self._draws.items() if fraction_of(switches.get(load, "on")) == 0.0)

    def supply(
        self, messages: Sequence[BatteryState | None], before: EnergyLeft | None, situation: PowerSituation
    ) -> EnergyLeft | None:
        """By a reading of each store; what was known before where one is None (not due, refused or too old), or none
        is new: in real time the same reading is heard period by period.
        """
        found = [message for message in messages if message is not None]
        if len(found) < len(messages):
            return before
        stamp = max(message.stamp for message in found)
        if before is not None and stamp == before.stamp:
            return before
        charges = [_charge(message) for message in found]
        left = self._manager.stored_energy(charges) - self._kept
        soc = sum([share * charge for share, charge in zip(self._manager.shares, charges, strict=True)])
        power = sum([-message.voltage * message.current for message in found])
        has_stood, given = (False, 0.0) if before is None else (before.has_stood, before.given)
        if self._costs is not None and (situation.stands or not has_stood):
            now = max(self._expected(self._costs, situation) - power, 0.0)
            is_first = before is None or (situation.stands and not has_stood)
            given = now if is_first else given + NEW * (now - given)
        return EnergyLeft(
            left, soc, self._reserve, max(power + given, 0.0), given, stamp, has_stood or situation.stands
        )

    def _expected(self, costs: EnergyParams, situation: PowerSituation) -> float:
        """What is taken now by all that is known [W]."""
        house = costs.house_power - situation.off
        if situation.stands:
            return house
        along = abs(situation.speed) * on_grade(costs, costs.energy_per_metre, 0.0)
        return house + max(along, abs(situation.yaw_rate) * costs.energy_per_radian)


def _charge(message: BatteryState) -> float:
    return min(max(message.charge / message.capacity, 0.0), 1.0) if message.capacity > 0.0 else 0.0
