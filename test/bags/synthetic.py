"""Writes the bag of a made-up run, message by message, without any node."""

import array
import math
from pathlib import Path
from typing import Any

import numpy as np
from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import Odometry
from nav_msgs.msg import Path as Route
from rclpy.serialization import serialize_message
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import BatteryState, JointState, PointCloud2, PointField

from ros_messages import as_ros, ros_time
from sojourn_bags.completeness import RECORD, account
from sojourn_bags.definitions import RUN_RECORD, ChannelSpec, qos_entry
from sojourn_bags.description import Run
from sojourn_bags.layout import layout_of
from sojourn_bags.provenance import versions_attachment
from sojourn_bags.writer import BagWriter
from sojourn_config.scenario import load_scenario
from sojourn_contract import qos, stamps
from sojourn_contract.heartbeat import status_message
from sojourn_contract.topics import TOPICS, topic

PERIOD = stamps.CONTROL_PERIOD_NS
CHANNELS = {row.name: number for number, row in enumerate(TOPICS)}
FIELDS = (
    "x",
    "y",
    "z",
    "sinkage",
    "slip_ratio",
    "slip_angle",
    "force_x",
    "force_y",
    "force_z",
    "torque",
    "soil",
)


def cdr(message: Any) -> bytes:
    """Serialised message of exact length; rclpy may append bytes."""
    message = as_ros(message)
    package, _, _ = type(message).__module__.partition(".")
    data = bytes(serialize_message(message))
    return data[: layout_of(f"{package}/msg/{type(message).__name__}", data).size]


class SyntheticRun:
    """A run that is written message by message.

    Args:
        folder: bag to write. scenario: whose description to attach.
    """

    def __init__(self, folder: Path, scenario: str = "lunar_sample") -> None:
        self.run = Run.of_scenario(load_scenario(scenario))
        specs = [ChannelSpec(row.name, row.type, qos_entry(qos.profile(row, True))) for row in TOPICS]
        self.writer = BagWriter(folder, specs, [*self.run.attachments(), versions_attachment()])

    def write(self, name: str, stamp: int, message: Any, log_time: int | None = None) -> None:
        """Stamp and write a message of the ROS library, or a value as one."""
        message = as_ros(message)
        if isinstance(message, Clock):
            message.clock = ros_time(stamp)
        else:
            message.header.stamp = ros_time(stamp)
        self.writer.write(CHANNELS[name], stamp if log_time is None else log_time, stamp, cdr(message))

    def close(self, last_stamp: int, participants: str = "plant,sensors,drive,arm,power,operator,recorder") -> None:
        """Finish with an account in which everything is there."""
        recorded = self.writer.recorded()
        completeness = account(TOPICS, recorded, recorded, last_stamp)
        self.writer.close({RUN_RECORD: {"participants": participants}, RECORD: completeness.as_record()})

    def truth(
        self, stamp: int, pose: tuple[float, float, float, float], joints: dict[str, float], effort: float
    ) -> None:
        """Clock, pose (x, y, z, yaw) and joints."""
        self.write("/clock", stamp, Clock())
        odometry = Odometry(child_frame_id="base_link")
        odometry.header.frame_id = "map"
        _set_pose(odometry.pose.pose, *pose)
        self.write("/truth/odom", stamp, odometry)
        state = JointState(name=list(joints))
        state.position = array.array("d", joints.values())
        state.velocity = array.array("d", [0.0] * len(joints))
        state.effort = array.array("d", [effort * math.cos(index + stamp * 2e-11) for index in range(len(joints))])
        self.write("/truth/joint_states", stamp, state)

    def contacts(self, stamp: int, points: np.ndarray) -> None:
        """Contacts of shape (points, 11)."""
        cloud = PointCloud2(height=1, width=len(points), point_step=4 * len(FIELDS), is_dense=True)
        cloud.row_step = cloud.point_step * cloud.width
        cloud.fields = [PointField(name=name, offset=4 * i, datatype=7, count=1) for i, name in enumerate(FIELDS)]
        cloud.data = array.array("B", points.astype("<f4").tobytes())
        self.write("/truth/contacts", stamp, cloud)

    def electrical(self, stamp: int, power: float, charge: float) -> None:
        """Battery at 28 V."""
        self.write("/truth/electrical", stamp, BatteryState(voltage=28.0, current=-power / 28.0, percentage=charge))

    def status(self, name: str, stamp: int, state: str, goal_stamp: int, reason: str = "") -> None:
        """Status of drive or arm."""
        values = {"state": state, "goal_stamp": str(goal_stamp), "reason": reason}
        message = status_message(stamp, topic(name).publisher, values)
        self.write(name, stamp, message)

    def goal(self, name: str, stamp: int, points: list[tuple[float, float, float]], frame: str = "map") -> None:
        """A goal pose, or waypoints where there are several points."""
        poses = []
        for point in points:
            pose = PoseStamped()
            pose.header.frame_id = frame
            pose.pose.position.x, pose.pose.position.y, pose.pose.position.z = point
            poses.append(pose)
        if name != "/waypoints":
            self.write(name, stamp, poses[0])
            return
        route = Route(poses=poses)
        route.header.frame_id = frame
        self.write(name, stamp, route)

    def named_pose(self, stamp: int, name: str) -> None:
        """A joint goal by name."""
        goal = JointState()
        goal.header.frame_id = name
        self.write("/arm/joint_goal", stamp, goal)


def _set_pose(pose: Any, x: float, y: float, z: float, yaw: float) -> None:
    pose.position.x, pose.position.y, pose.position.z = float(x), float(y), float(z)
    pose.orientation.z, pose.orientation.w = math.sin(yaw / 2.0), math.cos(yaw / 2.0)
