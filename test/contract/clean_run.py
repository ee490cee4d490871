"""A made-up run in which every message keeps the contract: the rover drives a circle. Tests break one thing in it."""

import array
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import cache
from typing import Any

import numpy as np
from geometry_msgs.msg import PoseStamped, Vector3Stamped, WrenchStamped
from nav_msgs.msg import OccupancyGrid, Odometry, Path
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import BatteryState, Imu, JointState
from std_msgs.msg import Header

from ros_messages import ros_message, ros_time
from sojourn_config.scenario import load_scenario
from sojourn_contract import stamps
from sojourn_contract.clouds import point_cloud
from sojourn_contract.conformance.findings import Report
from sojourn_contract.conformance.judge import Judge
from sojourn_contract.conformance.machine import JudgedMachine
from sojourn_contract.heartbeat import RUNNING, Counters, heartbeat_message, status_message
from sojourn_contract.messages import CONTACT_FIELDS, contact_cloud
from sojourn_contract.topic_types import Topic
from sojourn_contract.topics import ROLES, TOPICS, outputs_of

PERIOD = stamps.CONTROL_PERIOD_NS
PERIODS = 110
"""Two seconds and some, so that two heartbeats of each role are in it."""
SPEED, TURN, WHEEL_RATE = 0.05, 0.1, 0.4
RANK = {row.name: rank for rank, row in enumerate(TOPICS)}


@cache
def explorer() -> JudgedMachine:
    """The rover of all tests."""
    return JudgedMachine.of_scenario(load_scenario("flat_drive"))


@dataclass
class Entry:
    """One message of the run."""

    topic: str
    stamp: int
    message: Any
    logged: int | None


@dataclass
class CleanRun:
    """Messages in the order of a bag.

    Attributes:
        entries: the messages. lockstep: mode of time that the judge is told.
    """

    lockstep: bool = True
    entries: list[Entry] = field(default_factory=list)

    def __post_init__(self) -> None:
        machine = explorer()
        counters = {role: Counters() for role in ROLES}
        for period in range(1, PERIODS + 1):
            stamp = period * PERIOD
            for row in TOPICS:
                if row.is_event or row.publisher == "all" or period % row.every or not row.logged:
                    continue
                self.add(row.name, stamp, make(row, stamp, machine))
                counters[row.publisher].count_published(row.name)
            if period % 50 == 0:
                for role in ROLES:
                    self._beat(role, stamp, counters[role])

    def add(self, topic: str, stamp: int, message: Any) -> None:
        """One more message, filed at its stamp."""
        set_stamp(message, stamp)
        self.entries.append(Entry(topic, stamp, message, stamp))

    def of(self, topic: str) -> list[Entry]:
        """Messages of a topic."""
        return [entry for entry in self.entries if entry.topic == topic]

    def one(self, topic: str, number: int = 40) -> Any:
        """A message of a topic from the middle of the run, the last one of a slow topic."""
        entries = self.of(topic)
        return entries[min(number, len(entries) - 1)].message

    def drop(self, topic: str, unwanted: Callable[[Entry], bool]) -> None:
        """Take messages out."""
        self.entries = [entry for entry in self.entries if entry.topic != topic or not unwanted(entry)]

    def judge(self, **wishes: Any) -> Report:
        """The verdict."""
        settings = {"lockstep": self.lockstep, "participants": ROLES, "unseen": ("/recorder/tick",)} | wishes
        judge = Judge(explorer(), **settings)
        for entry in sorted(self.entries, key=lambda entry: entry.logged or 0):
            judge.take(entry.topic, entry.message, entry.logged)
        return judge.finish()

    def _beat(self, role: str, stamp: int, counters: Counters) -> None:
        counters.count_published("/diagnostics")
        told = Counters(dict(counters.published))
        for row in outputs_of(role):  # when it sends its heartbeat, the plant has sent the truth of the next period
            if role == "plant" and row.every == 1:
                told.published[row.name] += 1
        self.add("/diagnostics", stamp, ros_message(heartbeat_message(role, RUNNING, stamp, told)))


def kinds(report: Report) -> set[tuple[str, str, str]]:
    """Rule, topic and field (without what is in brackets) of all that was found."""
    return {
        (group.rule, group.topic, group.first[0].finding.field.partition("[")[0].partition(" of ")[0])
        for group in report.groups
    }


def set_stamp(message: Any, stamp: int) -> None:
    """Stamp any message of the contract."""
    time = ros_time(stamp)
    if isinstance(message, Clock):
        message.clock = time
    elif isinstance(message, Header):
        message.stamp = time
    else:
        message.header.stamp = time


def make(row: Topic, stamp: int, machine: JudgedMachine) -> Any:
    """A good message of a row."""
    if row.name == "/power/switches":
        return ros_message(status_message(stamp, "switches", dict.fromkeys(machine.loads, "on")))
    if row.name == "/operator/tick":
        return Header(frame_id="/goal_pose=1")
    return _MAKERS[row.type](row, stamp * 1e-9, machine)


def _joint_state(row: Topic, time: float, machine: JudgedMachine) -> JointState:
    names = list(machine.known(row.joints))
    rates = [WHEEL_RATE if name in machine.drive else 0.0 for name in names]
    message = JointState(name=names)
    message.position = array.array("d", [rate * time for rate in rates])
    message.velocity = array.array("d", rates)
    message.effort = array.array("d", [0.0] * len(names))
    return message


def _odometry(row: Topic, time: float, _machine: JudgedMachine) -> Odometry:
    message = Odometry(child_frame_id="base_link")
    message.header.frame_id = row.frames[0]
    pose, twist = message.pose.pose, message.twist.twist
    angle = TURN * time
    pose.position.x = SPEED / TURN * math.sin(angle)
    pose.position.y = SPEED / TURN * (1.0 - math.cos(angle))
    pose.orientation.z, pose.orientation.w = math.sin(angle / 2.0), math.cos(angle / 2.0)
    twist.linear.x, twist.angular.z = SPEED, TURN
    message.pose.covariance = np.eye(6).ravel()
    return message


def _path(row: Topic, _time: float, _machine: JudgedMachine) -> Path:
    pose = PoseStamped()
    pose.header.frame_id, pose.pose.position.x = row.frames[0], 3.0
    message = Path(poses=[pose])
    message.header.frame_id = row.frames[0]
    return message


def _grid(row: Topic, _time: float, _machine: JudgedMachine) -> OccupancyGrid:
    message = OccupancyGrid(data=array.array("b", [-1, 0, 100, 0, -1, 100]))
    message.header.frame_id = row.frames[0]
    message.info.resolution, message.info.width, message.info.height = 0.1, 3, 2
    return message


def _imu(_row: Topic, time: float, _machine: JudgedMachine) -> Imu:
    message = Imu()
    message.header.frame_id = "imu_link"
    message.orientation.z, message.orientation.w = math.sin(TURN * time / 2.0), math.cos(TURN * time / 2.0)
    message.angular_velocity.z = TURN
    message.linear_acceleration.z = 1.62
    return message


def _battery(row: Topic, _time: float, _machine: JudgedMachine) -> BatteryState:
    message = BatteryState(voltage=28.0, current=-2.0, temperature=15.0, charge=10.0, capacity=16.0, percentage=0.6)
    if row.name == "/bus/state":
        message.charge = message.capacity = message.design_capacity = message.percentage = math.nan
    return message


def _sun(_row: Topic, _time: float, _machine: JudgedMachine) -> Vector3Stamped:
    message = Vector3Stamped()
    message.header.frame_id = "solar_deck_link"
    message.vector.x, message.vector.z = 0.8, 0.6
    return message


def _cloud(row: Topic, time: float, machine: JudgedMachine) -> Any:
    if row.name == "/hazcam/points":
        return ros_message(point_cloud(round(time * 1e9), "base_link", np.full((40, 3), time, dtype=np.float32)))
    points = np.zeros((machine.contacts, len(CONTACT_FIELDS)))
    return ros_message(contact_cloud(round(time * 1e9), points))


def _status(row: Topic, time: float, _machine: JudgedMachine) -> Any:
    values = {"/truth/loads": {"power drive": "5.2"}}.get(
        row.name, {"state": "moving", "goal_stamp": "200000000", "reason": ""}
    )
    return ros_message(status_message(round(time * 1e9), row.publisher, values))


_MAKERS: dict[str, Callable[[Topic, float, JudgedMachine], Any]] = {
    "rosgraph_msgs/Clock": lambda _row, _time, _machine: Clock(),
    "nav_msgs/Odometry": _odometry,
    "nav_msgs/Path": _path,
    "nav_msgs/OccupancyGrid": _grid,
    "sensor_msgs/JointState": _joint_state,
    "sensor_msgs/Imu": _imu,
    "geometry_msgs/WrenchStamped": lambda _row, _time, _machine: WrenchStamped(),
    "sensor_msgs/BatteryState": _battery,
    "sensor_msgs/PointCloud2": _cloud,
    "geometry_msgs/Vector3Stamped": _sun,
    "diagnostic_msgs/DiagnosticArray": _status,
}


def beats_of(run: CleanRun, role: str) -> Iterator[Any]:
    """Heartbeats of a role."""
    for entry in run.of("/diagnostics"):
        if entry.message.status[0].name == role:
            yield entry.message


def value_of(message: Any, key: str) -> Any:
    """The KeyValue of a status message."""
    return next(pair for pair in message.status[0].values if pair.key == key)
