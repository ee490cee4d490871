"""Sets of messages to compare, without a bag: some periods of the contract's topics, and changes to one value."""

import array
import math
from typing import Any

import numpy as np
from diagnostic_msgs.msg import DiagnosticArray
from nav_msgs.msg import Odometry
from sensor_msgs.msg import Imu, JointState
from synthetic import PERIOD, cdr

from ros_messages import ros_message, ros_time
from sojourn_bags.definitions import full_type
from sojourn_bags.layout import layout_of
from sojourn_bags.messages import Messages
from sojourn_contract.heartbeat import status_message
from sojourn_contract.messages import CONTACT_FIELDS, battery_state, contact_cloud
from sojourn_contract.topics import topic

JOINTS = ("wheel_front_left_joint", "wheel_front_right_joint", "arm_elbow_joint")


def as_messages(name: str, contents: list[Any]) -> Messages:
    """Messages of a topic of the table."""
    return Messages(name, full_type(topic(name).type), data=[cdr(content) for content in contents])


def joint_states(count: int, names: tuple[str, ...] = JOINTS, effort: bool = True) -> list[JointState]:
    """Joints that turn."""
    found = []
    for period in range(1, count + 1):
        message = JointState(name=list(names))
        message.header.stamp = ros_time(period * PERIOD)
        message.position = array.array("d", [0.1 * period + index for index in range(len(names))])
        message.velocity = array.array("d", [0.5] * len(names))
        message.effort = array.array("d", [math.nan] * len(names) if effort else [])
        found.append(message)
    return found


def odometry(count: int) -> list[Odometry]:
    """A machine that drives ahead and turns."""
    found = []
    for period in range(1, count + 1):
        message = Odometry(child_frame_id="base_link")
        message.header.frame_id = "odom"
        message.header.stamp = ros_time(period * PERIOD)
        message.pose.pose.position.x = 0.01 * period
        yaw = 0.02 * period
        message.pose.pose.orientation.z, message.pose.pose.orientation.w = math.sin(yaw / 2), math.cos(yaw / 2)
        found.append(message)
    return found


def imu(count: int) -> list[Imu]:
    """At rest."""
    found = []
    for period in range(1, count + 1):
        message = Imu()
        message.header.frame_id = "imu_link"
        message.header.stamp = ros_time(period * PERIOD)
        message.linear_acceleration.z = 1.62
        found.append(message)
    return found


def contacts(count: int, points: int = 4) -> list[Any]:
    """Clouds of contacts."""
    report = np.arange(points * len(CONTACT_FIELDS), dtype=np.float64).reshape(points, len(CONTACT_FIELDS))
    return [ros_message(contact_cloud(period * PERIOD, report + period)) for period in range(1, count + 1)]


def batteries(count: int) -> list[Any]:
    """Telemetry of the bus, whose charge nobody measures: NaN."""
    return [
        ros_message(battery_state(5 * period * PERIOD, 28.0 + period, 2.0, 290.0, math.nan, math.nan, math.nan))
        for period in range(1, count + 1)
    ]


def status(stamp: int, values: dict[str, str], name: str = "drive") -> DiagnosticArray:
    """A status message."""
    return ros_message(status_message(stamp, name, values))


def one_run(count: int = 6) -> dict[str, Messages]:
    """Some periods of a run."""
    return {
        "/joint_states": as_messages("/joint_states", joint_states(count)),
        "/imu/data": as_messages("/imu/data", imu(count)),
        "/odom": as_messages("/odom", odometry(count)),
        "/truth/contacts": as_messages("/truth/contacts", contacts(count)),
        "/bus/state": as_messages("/bus/state", batteries(count)),
    }


def with_value(messages: Messages, index: int, path: str, element: int, value: float) -> tuple[Messages, float, float]:
    """The same messages but for one number: also what it was, and what it is after its type has rounded it."""
    data = bytearray(messages.data[index])
    number = layout_of(messages.type, bytes(data)).numbers[path]
    offset = number.offset + element * number.dtype.itemsize
    before = np.frombuffer(data, number.dtype, 1, offset)[0]
    with np.errstate(over="ignore"):
        after = np.array(value).astype(number.dtype)
    data[offset : offset + number.dtype.itemsize] = after.tobytes()
    changed = [*messages.data]
    changed[index] = bytes(data)
    return Messages(messages.topic, messages.type, data=changed), float(before), float(after)
