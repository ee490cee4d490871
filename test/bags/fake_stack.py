"""Stand-in nodes that keep the contract: each publishes what its role owes, with made-up content.

Run as a program it is a whole stack in one process: `python fake_stack.py BAG PERIODS [REALTIME]`.
"""

import array
import math
import struct
import sys
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from nav_msgs.msg import Odometry
from sensor_msgs.msg import BatteryState, Imu, JointState, PointCloud2, PointField
from std_msgs.msg import Header

sys.path.insert(0, str(Path(__file__).parents[1]))

from ros_messages import as_ros, ros_time, value_of
from sojourn_bags.recorder_node import RecorderNode
from sojourn_contract import process, stamps, values
from sojourn_contract.events import format_tick
from sojourn_contract.heartbeat import READY, read_heartbeats, status_message
from sojourn_contract.node import ContractNode
from sojourn_contract.topic_types import Topic
from sojourn_contract.types import message_class

SCENARIO = "flat_drive"
WHEELS = ("front_left", "front_right", "middle_left", "middle_right", "rear_left", "rear_right")
JOINTS = tuple(f"wheel_{wheel}_joint" for wheel in WHEELS)
POINT_FIELDS = (
    "x", "y", "z", "sinkage", "slip_ratio", "slip_angle", "force_x", "force_y", "force_z", "torque", "soil",
)  # fmt: skip
PERIOD = stamps.CONTROL_PERIOD_NS


def contacts(stamp: int) -> PointCloud2:
    """Six points with eleven fields: positions in float64, the rest in float32."""
    cloud = PointCloud2(height=1, width=len(WHEELS), is_dense=True)
    offset = 0
    for name in POINT_FIELDS:
        wide = name in ("x", "y", "z")
        cloud.fields.append(PointField(name=name, offset=offset, datatype=8 if wide else 7, count=1))
        offset += 8 if wide else 4
    cloud.point_step, cloud.row_step = offset, offset * len(WHEELS)
    seconds = stamps.seconds(stamp)
    data = b"".join(
        struct.pack("<3d8f", seconds, number, 0.0, 0.01 * (number + 1), 0.1, 0.0, 1.0, 2.0, 50.0, 3.0, 0.0)
        for number in range(len(WHEELS))
    )
    cloud.data = array.array("B", data)
    return cloud


def content(row: Topic, stamp: int) -> Any:
    """A message of a row with made-up but definite content."""
    seconds = stamps.seconds(stamp)
    kind = message_class(row.type)
    if kind is DiagnosticArray:
        return status_message(stamp, row.publisher, {"state": "idle", "goal_stamp": "0", "soc": f"{seconds:.2f}"})
    if kind is Header:
        return Header(stamp=ros_time(stamp))
    message = contacts(stamp) if kind is PointCloud2 else kind()
    if kind is JointState:
        message.name = list(JOINTS)
        message.position = array.array("d", [seconds + number for number in range(len(JOINTS))])
        message.velocity = array.array("d", [math.sin(seconds)] * len(JOINTS))
        if row.publisher == "plant":
            message.effort = array.array("d", [seconds] * len(JOINTS))
    elif kind is Odometry:
        message.child_frame_id = "base_link"
        message.pose.pose.position.x = 0.1 * seconds
        message.pose.pose.orientation.w = 1.0
    elif kind is BatteryState:
        message.voltage, message.current, message.percentage = 28.0, -2.0, 0.8
    elif kind is Imu:
        message.linear_acceleration.z = 1.62
    if hasattr(message, "header"):
        message.header.frame_id = "odom" if row.name == "/odom" else "map"
        message.header.stamp = ros_time(stamp)
    else:
        message.clock = ros_time(stamp)
    return message


class FakeNode(ContractNode):
    """Publishes at each period what its role owes, except for the (topic, period) in `forget`."""

    def __init__(self, role: str, participants: list[str], **parameters: Any) -> None:
        super().__init__(role, overrides={"participants": participants, "scenario": SCENARIO, **parameters})
        self.forget: set[tuple[str, int]] = set()
        owed = self.endpoints.outputs.values()
        self._owed = [row for row in owed if not row.is_event and row.publisher == role]

    def on_period(self, stamp: int, inputs: Mapping[str, Any], goals: list[tuple[str, Any]]) -> None:
        """Publish what is due."""
        for row in self._owed:
            if (stamp // PERIOD) % row.every == 0:
                if (row.name, stamp // PERIOD) in self.forget:
                    self.counters.count_published(row.name)  # counted, but lost on the way
                else:
                    self.publish(row.name, value_of(as_ros(content(row, stamp))))


class FakeOperator(FakeNode):
    """Sends a goal every 25 periods, five periods ahead, and the ticks that announce it."""

    sent = 0

    def on_period(self, stamp: int, inputs: Mapping[str, Any], goals: list[tuple[str, Any]]) -> None:
        """A goal, then the tick."""
        if (stamp // PERIOD) % 25 == 0:
            place = np.array([stamps.seconds(stamp), 0.0, 0.0])
            self.publish("/goal_pose", values.PoseStamped(stamp + 5 * PERIOD, "map", place))
            self.sent += 1
        if (stamp // PERIOD) % 5 == 0:
            tick = format_tick({"/goal_pose": self.sent}, False)
            self.publish("/operator/tick", values.Header(stamp, tick))


class FakePlant(FakeNode):
    """Starts when all are ready, runs for so many periods, and ends the run."""

    def __init__(self, participants: list[str], periods: int, **parameters: Any) -> None:
        super().__init__("plant", participants, **parameters)
        self.periods = periods
        self.ends_the_run = True
        self._ready: set[str] = set()
        self.period = 0
        self.next_at = 0.0
        self.before_period: Callable[[int], None] = lambda period: None

    def on_heartbeat(self, message: Any) -> None:
        """Note who is ready."""
        self._ready |= {beat.role for beat in read_heartbeats(message) if beat.state == READY}

    def poll(self) -> None:
        """The first period when all are ready; in real time each period by the wall clock."""
        super().poll()
        now = time.monotonic()
        if self._ready >= set(self.participants) and (self.period == 0 or (not self.lockstep and now > self.next_at)):
            self.next_at = now + 0.01
            self.step()

    def step(self) -> None:
        """Publish the truth of the next period."""
        self.period += 1
        self.before_period(self.period)
        FakeNode.on_period(self, self.period * PERIOD, {}, [])
        if not self.lockstep:
            self.now = self.period * PERIOD
            self.finished = self.period >= self.periods

    def on_period(self, stamp: int, inputs: Mapping[str, Any], goals: list[tuple[str, Any]]) -> None:
        """All commands of this period are in: on to the next."""
        if not self.lockstep:
            return
        if stamp // PERIOD >= self.periods:
            self.finished = True
        else:
            self.step()


def build(
    bag: Path,
    periods: int,
    lockstep: bool = True,
    roles: tuple[str, ...] = (),
    bundled: bool = False,
    foreign: tuple[str, ...] = (),
) -> list[ContractNode]:
    """The nodes of a stack, plant first, recorder last; `bundled`: all but foreign ones hear bundles."""
    roles = roles or ("plant", "sensors", "drive", "arm", "power", "operator")
    participants = [*roles, "recorder"]
    companions = [role for role in participants if bundled and role not in foreign]

    def parameters(role: str) -> dict[str, Any]:
        return {"lockstep": lockstep} | ({"companions": companions} if role in companions else {})

    nodes: list[ContractNode] = [FakePlant(participants, periods, **parameters("plant"))]
    for role in roles[1:]:
        kind = FakeOperator if role == "operator" else FakeNode
        nodes.append(kind(role, participants, **parameters(role)))
    own = {"participants": participants, "scenario": SCENARIO, "bag": str(bag)}
    nodes.append(RecorderNode(overrides=own | parameters("recorder")))
    return nodes


def run(nodes: list[ContractNode], limit_s: float = 900.0) -> int:
    """Run a stack to its end. Returns the exit status; 99 if it hangs."""
    deadline = time.monotonic() + limit_s
    try:
        status = process.spin(nodes, process.StopFlag(), lambda: time.monotonic() > deadline)
        return status if time.monotonic() < deadline else 99
    finally:
        for node in nodes:
            node.destroy_node()


if __name__ == "__main__":
    rclpy.init(args=[], signal_handler_options=rclpy.signals.SignalHandlerOptions.NO)
    status = run(build(Path(sys.argv[1]), int(sys.argv[2]), lockstep=len(sys.argv) < 4))
    rclpy.try_shutdown()
    sys.exit(status)
