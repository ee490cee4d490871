"""Numbers to messages and back, for the types that several nodes use.

Arrays go in through `array.array`, the only form that rclpy takes without looking at every element; a
message object may be filled again and published again, since publishing serialises it at once.
"""

import array
import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from geometry_msgs.msg import Point, Quaternion, Vector3, WrenchStamped
from numpy.typing import NDArray
from sensor_msgs.msg import BatteryState, JointState, PointCloud2, PointField

from sojourn_contract import stamps
from sojourn_machine.contact_report import ReportColumn

ABSOLUTE_ZERO_C = -273.15
CONTACT_FIELDS = tuple(column.name.lower() for column in ReportColumn)
"""Fields of /truth/contacts, all float64."""


def doubles(values: Any) -> "array.array[float]":
    """A numpy array or a sequence of numbers as the array that rclpy takes for float64[]."""
    if isinstance(values, np.ndarray):
        return array.array("d", np.ascontiguousarray(values, dtype=np.float64).tobytes())
    return array.array("d", values)


def numbers(values: Any) -> NDArray[np.float64]:
    """A float64[] field as a numpy array of its own."""
    return np.array(values, dtype=np.float64)


def joint_state(names: Sequence[str]) -> JointState:
    """An empty JointState of these joints, to be filled by `fill_joint_state`."""
    message = JointState()
    message.name = list(names)
    return message


def fill_joint_state(
    message: JointState,
    stamp: int,
    position: NDArray[np.float64],
    velocity: NDArray[np.float64],
    effort: NDArray[np.float64] | None = None,
) -> JointState:
    """Fill and return `message`. Positions [rad], rates [rad/s], efforts [N m]; one for each name."""
    message.header.stamp = stamps.to_message(stamp)
    message.position = doubles(position)
    message.velocity = doubles(velocity)
    if effort is not None:
        message.effort = doubles(effort)
    return message


def joint_columns(message: JointState, index: dict[str, int]) -> list[int]:
    """Place of each named joint in an array of ours. `index`: joint name -> place."""
    return [index[name] for name in message.name]


def set_xyz(target: Point | Vector3, values: Sequence[float] | NDArray[np.float64]) -> None:
    """Write three numbers into a Point or a Vector3."""
    target.x, target.y, target.z = float(values[0]), float(values[1]), float(values[2])


def xyz(source: Point | Vector3) -> NDArray[np.float64]:
    """A Point or Vector3 as an array (3,)."""
    return np.array((source.x, source.y, source.z))


def set_quaternion(target: Quaternion, values: Sequence[float] | NDArray[np.float64]) -> None:
    """Write x y z w."""
    target.x, target.y, target.z, target.w = (float(value) for value in values)


def quaternion(source: Quaternion) -> NDArray[np.float64]:
    """x y z w as an array (4,)."""
    return np.array((source.x, source.y, source.z, source.w))


def yaw_of(orientation: Quaternion) -> float | None:
    """Heading of an orientation of any length [rad], or None for one of zero length, which asks for none."""
    x, y, z, w = orientation.x, orientation.y, orientation.z, orientation.w
    if x * x + y * y + z * z + w * w < 1e-6:
        return None
    return math.atan2(2.0 * (w * z + x * y), w * w + x * x - y * y - z * z)


def wrench_stamped(stamp: int, frame: str, values: NDArray[np.float64] | None) -> WrenchStamped:
    """Force and moment, (6,) [N], [N m], in a frame; NaN throughout where it is not measured (None)."""
    message = WrenchStamped()
    message.header.stamp = stamps.to_message(stamp)
    message.header.frame_id = frame
    numbers = np.full(6, math.nan) if values is None else values
    set_xyz(message.wrench.force, numbers[:3])
    set_xyz(message.wrench.torque, numbers[3:])
    return message


def wrench_values(message: WrenchStamped) -> NDArray[np.float64] | None:
    """Force and moment of a message, (6,), or None where it is not measured."""
    values = np.concatenate([xyz(message.wrench.force), xyz(message.wrench.torque)])
    return None if np.isnan(values).any() else values


def _single(value: float) -> float:
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
) -> BatteryState:
    """State of an energy store.

    Args:
        voltage: [V]. current_out: out of the store positive [A]; the message counts it negative.
        temperature: [K]. soc: 0 to 1. charge, capacity: [C]; the message has ampere hours. NaN where not
            known.
    """
    message = BatteryState()
    message.header.stamp = stamps.to_message(stamp)
    message.voltage = _single(voltage)
    message.current = -_single(current_out)
    message.temperature = _single(float(temperature) + ABSOLUTE_ZERO_C)
    message.percentage = _single(soc)
    message.charge = _single(float(charge) / 3600.0)
    message.capacity = _single(float(capacity) / 3600.0)
    message.design_capacity = message.capacity
    message.power_supply_status = (
        BatteryState.POWER_SUPPLY_STATUS_DISCHARGING
        if current_out >= 0.0
        else BatteryState.POWER_SUPPLY_STATUS_CHARGING
    )
    message.power_supply_technology = BatteryState.POWER_SUPPLY_TECHNOLOGY_LION
    message.present = True
    return message


def battery_readings(message: BatteryState) -> tuple[float, float, float]:
    """Voltage [V], current out of the store [A], temperature [K] of a message."""
    return message.voltage, -message.current, message.temperature - ABSOLUTE_ZERO_C


def contact_cloud() -> PointCloud2:
    """An empty cloud of contacts in map, to be filled by `fill_contact_cloud`."""
    cloud = PointCloud2()
    cloud.header.frame_id = "map"
    cloud.height = 1
    cloud.fields = [
        PointField(name=name, offset=8 * place, datatype=PointField.FLOAT64, count=1)
        for place, name in enumerate(CONTACT_FIELDS)
    ]
    cloud.point_step = 8 * len(CONTACT_FIELDS)
    cloud.is_dense = True
    return cloud


def fill_contact_cloud(cloud: PointCloud2, stamp: int, report: NDArray[np.float64]) -> PointCloud2:
    """Fill and return `cloud`. report: (contacts, 16), columns as CONTACT_FIELDS, contiguous."""
    cloud.header.stamp = stamps.to_message(stamp)
    cloud.width = report.shape[0]
    cloud.row_step = report.shape[0] * cloud.point_step
    data = array.array("B")
    data.frombytes(report.tobytes())
    cloud.data = data
    return cloud
