"""Thresholds of the power manager where no file says them: from the battery and the loads of power.yaml.

They are those of the rovers that were tuned here, as parts of the span of volts from an empty to a full battery.
"""

from sojourn_config.derived import Derivation, DerivedValue
from sojourn_machine.power.battery import SECONDS_PER_HOUR, BatteryParams
from sojourn_machine.power.loads import BusParams

VOLTS = {
    "shed_voltage": 0.222,
    "shed_voltage_hysteresis": 0.155,
    "derate_start_voltage": 0.344,
    "derate_stop_voltage": 0.189,
}
"""Part of the span; hysteresis is a difference, the others are above empty [-]."""
HOURS_OF_REST = 5.0
"""A current that empties the battery in so long is rest [h]."""


def derived_power(battery: BatteryParams, bus: BusParams) -> Derivation:
    """Keys of the table `power_manager` of flight.yaml."""
    empty, full = (battery.cells_series * battery.ocv_points[end] for end in (0, -1))
    why = f"in proportion to {battery.name}, {empty:.1f} V empty and {full:.1f} V full"
    found = {
        key: DerivedValue(round(part * (full - empty) + (0.0 if "hysteresis" in key else empty), 2), why)
        for key, part in VOLTS.items()
    }
    rest = round(battery.charge_capacity / SECONDS_PER_HOUR / HOURS_OF_REST, 2)
    found["rest_current"] = DerivedValue(rest, f"a fifth of the capacity of {battery.name} in an hour")
    driving = sum(load.power_w for load in bus.loads if load.group == "drive")
    if driving > 0.0:
        found["drive_power_limit"] = DerivedValue(driving, "all that the loads of the drive may draw")
    return {"power_manager": found}
