"""A bench for nodes: they run in this process on a domain of their own, and a peer speaks for everybody else."""

import math
import time
from collections import defaultdict
from collections.abc import Callable
from typing import Any

import numpy as np
import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import Vector3Stamped, WrenchStamped
from nav_msgs.msg import Odometry
from rclpy.context import Context
from rclpy.experimental import EventsExecutor
from sensor_msgs.msg import BatteryState, Imu, JointState, PointCloud2
from std_msgs.msg import Header

from ros_messages import as_ros, ros_message, ros_time, value_of
from sojourn_config.scenario import load_scenario
from sojourn_contract import qos, stamps
from sojourn_contract.clouds import point_cloud
from sojourn_contract.heartbeat import (
    READY,
    Counters,
    heartbeat_message,
    read_heartbeats,
    status_message,
    status_values,
)
from sojourn_contract.messages import battery_state, wrench_stamped
from sojourn_contract.run_table import row_named
from sojourn_contract.topic_types import Topic
from sojourn_contract.topics import TOPICS
from sojourn_contract.types import message_class
from sojourn_machine.tools import TOOL_JOINT

PATIENCE_S = 300.0
"""Wall time after which a test gives up; nothing is measured by it."""
SCENARIO = "flat_drive"
JOINTS = (*load_scenario(SCENARIO).urdf.moving_joints, TOOL_JOINT)
WHEELS = tuple(name for name in JOINTS if name.startswith("wheel_"))
STEERS = tuple(name for name in JOINTS if name.startswith("steer_"))
ARM = tuple(name for name in JOINTS if name.startswith("arm_"))
STOWED = dict(zip(ARM, load_scenario(SCENARIO).arm.named_poses["stow"], strict=True))


def stamp_of(message: Any) -> int:
    """Stamp [ns] of any message of the contract."""
    return value_of(message).stamp


def at(period: int) -> int:
    """Stamp [ns] of a control period."""
    return period * stamps.CONTROL_PERIOD_NS


def row_of(name: str) -> Topic:
    """The row of a topic in whatever run has it."""
    row = row_named(name)
    assert row is not None, name
    return row


class Bench:
    """See the module. `received`: messages by topic, in order of arrival."""

    def __init__(self, domain: int) -> None:
        self.context = Context()
        rclpy.init(args=[], context=self.context, domain_id=domain)
        self.executor = EventsExecutor(context=self.context)
        self.peer = rclpy.create_node("peer", context=self.context, enable_rosout=False, start_parameter_services=False)
        self.executor.add_node(self.peer)
        self.nodes: list[Any] = []
        self.received: dict[str, list[Any]] = defaultdict(list)
        self._stamps: dict[str, list[int]] = defaultdict(list)
        """Of what has been received, as far as it was looked at."""
        self._senders: dict[str, Any] = {}
        self._polled_at = 0.0

    def start(self, node_class: Any, *participants: str, namespace: str | None = None, **parameters: Any) -> Any:
        """Make a node that runs with these participants; lock-step unless told otherwise."""
        values = {"scenario": SCENARIO, "lockstep": True, "participants": list(participants), **parameters}
        node = node_class(context=self.context, overrides=values, namespace=namespace)
        self.executor.add_node(node)
        self.nodes.append(node)
        return node

    def listen(self, *names: str, namespace: str = "", lockstep: bool = True) -> None:
        """Keep what comes on these topics, under their names in the table."""
        for name in names:
            row = row_of(name)
            self.peer.create_subscription(
                message_class(row.type),
                namespace + name,
                self.received[name].append,
                qos.profile(row, lockstep, "recorder"),
            )

    def speak(self, *names: str, lockstep: bool = True) -> None:
        """Get ready to publish on these topics."""
        for name in names:
            row = row_of(name)
            self._senders[name] = self.peer.create_publisher(message_class(row.type), name, qos.profile(row, lockstep))

    def connect(self, node: Any, lockstep: bool = True) -> None:
        """Listen to all that a node publishes and speak on all that it listens to; wait until both have met."""
        self.listen(*node.endpoints.outputs, lockstep=lockstep)
        self.speak(*node.endpoints.readers, lockstep=lockstep)
        self.met()

    def met(self) -> None:
        """Wait until every publisher of the peer has a listener, and it hears somebody on every topic."""
        self.until(
            lambda: (
                all(sender.get_subscription_count() for sender in self._senders.values())
                and all(reader.get_publisher_count() for reader in self.peer.subscriptions)
            ),
            "endpoints have met",
        )

    def send(self, name: str, message: Any) -> None:
        """Publish a message of the ROS library, or a value as one."""
        self._senders[name].publish(as_ros(message))

    def spin(self, seconds: float = 0.0) -> None:
        """Run the executor for a while, and the nodes' wall-clock chores."""
        end = time.monotonic() + seconds
        while True:
            self.executor.spin_once(timeout_sec=0.005)
            now = time.monotonic()
            if now - self._polled_at > 0.02:
                self._polled_at = now
                for node in self.nodes:
                    node.poll()
            if now >= end:
                return

    def until(self, condition: Callable[[], Any], what: str) -> None:
        """Run until something is so. Fails the test, saying what is missing, when patience is over."""
        end = time.monotonic() + PATIENCE_S
        while not condition():
            self.spin()
            if time.monotonic() > end:
                refusals = {node.role: node.counters.last_refusal for node in self.nodes}
                raise AssertionError(f"not so after {PATIENCE_S} s: {what}; last refusals: {refusals}")

    def answer(self, name: str, period: int) -> Any:
        """The message on a topic that is stamped with a period, as soon as it comes."""
        messages, stamps_here = self.received[name], self._stamps[name]

        def has_come() -> bool:
            stamps_here.extend(map(stamp_of, messages[len(stamps_here) :]))
            return at(period) in stamps_here

        self.until(has_come, f"{name} stamped {period} periods")
        assert (times := stamps_here.count(at(period))) == 1, f"{name} came {times} times for one stamp"
        return messages[stamps_here.index(at(period))]

    def status(self, name: str, period: int) -> dict[str, str]:
        """Keys and values of a status topic at a period."""
        return status_values(value_of(self.answer(name, period)))

    def say_ready(self, *roles: str) -> None:
        """Heartbeats of roles that the peer speaks for."""
        for role in roles:
            self.send("/diagnostics", heartbeat_message(role, READY, 0, Counters()))

    def heartbeats(self, role: str) -> list[Any]:
        """Heartbeats of a role so far."""
        beats = [beat for message in self.received["/diagnostics"] for beat in read_heartbeats(value_of(message))]
        return [beat for beat in beats if beat.role == role]

    def close(self) -> None:
        """Take everything down."""
        for node in (*self.nodes, self.peer):
            self.executor.remove_node(node)
            node.destroy_node()
        rclpy.try_shutdown(context=self.context)


def joints(period: int, angles: dict[str, float] | None = None, rates: dict[str, float] | None = None) -> JointState:
    """Measured (or true) joints; zero where nothing is said, and the arm stowed."""
    position = [(STOWED | (angles or {})).get(name, 0.0) for name in JOINTS]
    velocity = [(rates or {}).get(name, 0.0) for name in JOINTS]
    effort = [0.0] * len(JOINTS)
    return JointState(header=_header(period), name=list(JOINTS), position=position, velocity=velocity, effort=effort)


def imu(period: int, yaw: float = 0.0, yaw_rate: float = 0.0) -> Imu:
    """A level machine that turns."""
    message = Imu(header=_header(period, "imu_link"))
    message.orientation.z, message.orientation.w = math.sin(yaw / 2), math.cos(yaw / 2)
    message.angular_velocity.z = yaw_rate
    message.linear_acceleration.z = 1.625
    return message


def wrist(period: int, force: Any = (0.0, 0.0, -3.25)) -> WrenchStamped:
    """Load of the hanging turret on the wrist's sensor, or another force [N]."""
    return ros_message(wrench_stamped(at(period), "arm_turret_link", np.array([*force, 0.0, 0.0, 0.0])))


def sun(period: int, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Vector3Stamped:
    """A reading of the sun sensor; zeros: no Sun."""
    message = Vector3Stamped(header=_header(period))
    message.vector.x, message.vector.y, message.vector.z = x, y, z
    return message


def odometry(period: int) -> Odometry:
    """A machine at rest at the origin of map."""
    message = Odometry(header=_header(period, "map"), child_frame_id="base_link")
    message.pose.pose.orientation.w = 1.0
    return message


def cloud(period: int, points: Any = ()) -> PointCloud2:
    """Points that the hazard camera has found, in base_link [m]."""
    return ros_message(point_cloud(at(period), "base_link", np.asarray(points, dtype=np.float32).reshape(-1, 3)))


def battery(period: int, voltage: float = 29.0, current: float = 2.0) -> BatteryState:
    """Telemetry of the bus; `current` out of the battery."""
    return ros_message(battery_state(at(period), voltage, current, 293.15, math.nan, math.nan, math.nan))


def loads(period: int, **powers: float) -> DiagnosticArray:
    """Power that each load draws [W]."""
    told = {f"power {name}": f"{power:g}" for name, power in powers.items()}
    return ros_message(status_message(at(period), "loads", told))


def tick(period: int, text: str = "") -> Header:
    """A tick of the operator or the recorder."""
    return _header(period, text)


def command(names: tuple[str, ...], period: int, rate: float = 0.0, angle: float = 0.0) -> JointState:
    """A command of these joints, all alike."""
    count = len(names)
    arrays = {"position": [angle] * count, "velocity": [rate] * count, "effort": [0.0] * count}
    return JointState(header=_header(period), name=list(names), **arrays)


def _header(period: int, frame: str = "") -> Header:
    return Header(stamp=ros_time(at(period)), frame_id=frame)


HIGHEST_STAMP_S = 2_000_000_000
"""Near the highest that a stamp can hold [s]: a clock of 2033."""
ALL_TOPICS = tuple(row.name for row in TOPICS)
