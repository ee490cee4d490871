"""Numbers to the values of messages and back, for what several roles say."""

import math

import numpy as np

from sojourn_contract.values import (
    FLOAT64,
    NOT_MEASURED,
    BatteryState,
    PointCloud2,
    PointField,
    WrenchStamped,
)
from sojourn_machine.contact_report import ReportColumn
from sojourn_machine.params import FloatArray

ABSOLUTE_ZERO_C = -273.15
CHARGING, DISCHARGING, LITHIUM_ION = 1, 2, 2
"""Of the enumerations in sensor_msgs/BatteryState."""
CONTACT_FIELDS = tuple(column.name.lower() for column in ReportColumn)
"""Fields of /truth/contacts, all float64."""
_CONTACT_FIELDS = tuple(PointField(name, 8 * place, FLOAT64) for place, name in enumerate(CONTACT_FIELDS))
_CONTACT_STEP = 8 * len(CONTACT_FIELDS)
_UNMEASURED = np.full(3, NOT_MEASURED)
_UNMEASURED.flags.writeable = False


def yaw_of(orientation: FloatArray) -> float | None:
    """Heading of an orientation x y z w of any length [rad], or None for one of zero length, which asks for none."""
    x, y, z, w = orientation.tolist()
    if x * x + y * y + z * z + w * w < 1e-6:
        return None
    return math.atan2(2.0 * (w * z + x * y), w * w + x * x - y * y - z * z)


def wrench_stamped(stamp: int, frame: str, wrench: FloatArray | None) -> WrenchStamped:
    """Force and moment, (6,) [N], [N m], in a frame; NaN throughout where it is not measured (None)."""
    if wrench is None:
        return WrenchStamped(stamp, frame, _UNMEASURED, _UNMEASURED)
    return WrenchStamped(stamp, frame, wrench[:3], wrench[3:])


def wrench_of(message: WrenchStamped) -> FloatArray | None:
    """Force and moment of a message, (6,), or None where it is not measured."""
    wrench = np.concatenate([message.force, message.torque])
    return None if any(map(math.isnan, wrench.tolist())) else wrench


def single(value: float) -> float:
    """As the message's fields of 32 bits hold it: the same to whom it is handed as it is, and over the wire."""
    return float(np.float32(value))


def battery_state(
    stamp: int,
    voltage: float,
    current_out: float,
    temperature: float,
    soc: float,
    charge: float,
    capacity: float,
    design_capacity: float | None = None,
) -> BatteryState:
    """State of an energy store.

    Args:
        voltage: [V]. current_out: out of the store positive [A]; the message counts it negative.
        temperature: [K]. soc: 0 to 1. charge, capacity: [C]; the message has ampere hours. NaN where not
            known. design_capacity: when it was new [C], left out: the same.
    """
    ampere_hours = single(float(capacity) / 3600.0)
    return BatteryState(
        stamp,
        voltage=single(voltage),
        current=-single(current_out),
        temperature=single(float(temperature) + ABSOLUTE_ZERO_C),
        percentage=single(soc),
        charge=single(float(charge) / 3600.0),
        capacity=ampere_hours,
        design_capacity=ampere_hours if design_capacity is None else single(design_capacity / 3600.0),
        power_supply_status=DISCHARGING if current_out >= 0.0 else CHARGING,
        power_supply_technology=LITHIUM_ION,
    )


def battery_readings(message: BatteryState) -> tuple[float, float, float]:
    """Voltage [V], current out of the store [A], temperature [K] of a message."""
    return message.voltage, -message.current, message.temperature - ABSOLUTE_ZERO_C


def contact_cloud(stamp: int, report: FloatArray) -> PointCloud2:
    """A cloud of contacts in map. report: (contacts, 16), columns as CONTACT_FIELDS."""
    count = len(report)
    return PointCloud2(
        stamp, "map", count, _CONTACT_FIELDS, _CONTACT_STEP, report.tobytes(), row_step=count * _CONTACT_STEP
    )
