"""Thresholds of the power manager where no file says them: from the first store of power.yaml.

They are those of the rovers that were tuned here, as parts of the span of volts from an empty to a full battery.
"""

from sojourn_config.derived import Derivation, DerivedValue
from sojourn_machine.power.battery import SECONDS_PER_HOUR
from sojourn_machine.power.power_params import PowerParams

VOLTS = {
    "shed_voltage": 0.222,
    "shed_voltage_hysteresis": 0.155,
    "derate_start_voltage": 0.344,
    "derate_stop_voltage": 0.189,
}
"""Part of the span; hysteresis is a difference, the others are above empty [-]."""
HOURS_OF_REST = 5.0
"""A current that empties the battery in so long is rest [h]."""


def derived_power(power: PowerParams) -> Derivation:
    """Keys of the table `power_manager` of flight.yaml; none for a machine without a store."""
    if not power.all_stores:
        return {}
    name, store = next(iter(power.all_stores.items()))
    empty, full = store.open_circuit_voltage(0.0), store.open_circuit_voltage(1.0)
    why = f"in proportion to {name}, {empty:.1f} V empty and {full:.1f} V full"
    found = {
        key: DerivedValue(round(part * (full - empty) + (0.0 if "hysteresis" in key else empty), 2), why)
        for key, part in VOLTS.items()
    }
    rest = round(store.charge_capacity / SECONDS_PER_HOUR / HOURS_OF_REST, 2)
    found["rest_current"] = DerivedValue(rest, f"a fifth of the capacity of {name} in an hour")
    return {"power_manager": found}
