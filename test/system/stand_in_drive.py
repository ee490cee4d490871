"""A drive as another team might write it: it knows the contract, and nothing of Sojourn's code.

Straight ahead only: it turns all wheels alike until they have rolled as far as the goal is away. In lock-step it acts
at each stamp at which all of its inputs are in: measurements of that stamp, switches at each fifth, and the operator's
tick of five periods before, with all goals that the tick announces.
"""

import array
import math
import sys
from typing import Any

import rclpy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from geometry_msgs.msg import PoseStamped, TwistStamped
from nav_msgs.msg import Odometry, Path
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from rclpy.time import Time
from sensor_msgs.msg import Imu, JointState
from std_msgs.msg import Header

PERIOD = 20_000_000
WHEEL_RADIUS = 0.125
SPEED = 0.05
INPUTS = {"joint_states": (JointState, 1, 0), "imu/data": (Imu, 1, 0), "power/switches": (DiagnosticArray, 5, 0),
          "operator/tick": (Header, 5, 5)}  # fmt: skip
"""Type, periods between two, and periods that the message lags."""
OUTPUTS = {"odom": (Odometry, 1), "drive/status": (DiagnosticArray, 2), "wheel_command": (JointState, 2),
           "diagnostics": (DiagnosticArray, 2)}  # fmt: skip
"""Type, and how many listen: recorder, plant, operator."""


def stamp_of(message: Any) -> int:
    header = message if isinstance(message, Header) else message.header
    return Time.from_msg(header.stamp).nanoseconds


def status(name: str, stamp: int, **values: object) -> DiagnosticArray:
    pairs = [
        KeyValue(key=key.replace("__", " ").replace("_of_", "/"), value=str(value)) for key, value in values.items()
    ]
    message = DiagnosticArray(status=[DiagnosticStatus(name=name, message="stand-in", values=pairs)])
    message.header.stamp = Time(nanoseconds=stamp).to_msg()
    return message


class StandInDrive(Node):
    def __init__(self) -> None:
        super().__init__("drive")
        self.inbox: dict[str, dict[int, Any]] = {name: {} for name in INPUTS}
        self.goals: list[PoseStamped] = []
        self.goals_received = 0
        self.period = 1
        self.published: dict[str, int] = {}
        self.goal_stamp, self.to_go, self.state = 0, 0.0, "idle"
        self.rolled: float | None = None
        self.distance = 0.0
        self.senders = {name: self.create_publisher(kind, name, 10) for name, (kind, _) in OUTPUTS.items()}
        self.readers = [
            self.create_subscription(kind, name, lambda message, name=name: self.receive(name, message), 10)
            for name, (kind, _, _) in INPUTS.items()
        ]
        self.goal_reader = self.create_subscription(PoseStamped, "goal_pose", self.receive_goal, 10)
        # what it takes as well and does not act on
        self.deaf = [
            self.create_subscription(kind, name, lambda message: None, 10)
            for name, kind in (("cmd_vel", TwistStamped), ("waypoints", Path))
        ]
        self.readiness = self.create_timer(0.1, self.say_ready)

    def say_ready(self) -> None:
        heard = all(self.senders[name].get_subscription_count() >= count for name, (_, count) in OUTPUTS.items())
        if heard and all(reader.get_publisher_count() for reader in self.readers) and self.period == 1:
            self.senders["diagnostics"].publish(status("drive", 0, state="ready"))

    def receive(self, name: str, message: Any) -> None:
        self.inbox[name][stamp_of(message)] = message
        self.advance()

    def receive_goal(self, goal: PoseStamped) -> None:
        self.goals_received += 1
        self.goals.append(goal)
        self.advance()

    def due(self) -> dict[str, int]:
        """Stamp of each message that this period needs."""
        return {
            name: (self.period - lag) * PERIOD
            for name, (_, every, lag) in INPUTS.items()
            if self.period % every == 0 and self.period > lag
        }

    def advance(self) -> None:
        while all(stamp in self.inbox[name] for name, stamp in self.due().items()):
            due = self.due()
            if "operator/tick" in due:
                tick = self.inbox["operator/tick"][due["operator/tick"]]
                announced = [int(text[11:]) for text in tick.frame_id.split(";") if text.startswith("/goal_pose=")]
                if announced and announced[0] > self.goals_received:
                    return
            inputs = {name: self.inbox[name].pop(stamp) for name, stamp in due.items()}
            self.act(self.period * PERIOD, inputs["joint_states"])
            self.period += 1

    def act(self, stamp: int, joints: JointState) -> None:
        wheels = [place for place, name in enumerate(joints.name) if name.startswith("wheel_")]
        rolled = WHEEL_RADIUS * sum(joints.position[place] for place in wheels) / len(wheels)
        step = 0.0 if self.rolled is None else rolled - self.rolled
        self.rolled, self.distance = rolled, self.distance + step
        self.speed = step * 1e9 / PERIOD
        for goal in [goal for goal in self.goals if stamp_of(goal) <= stamp]:
            self.goals.remove(goal)
            self.goal_stamp, self.state = stamp_of(goal), "moving"
            self.to_go = math.hypot(goal.pose.position.x, goal.pose.position.y)
        if self.state == "moving":
            self.to_go -= step
            self.state = "moving" if self.to_go > 0.0 else "reached"
        self.answer(stamp, [joints.name[place] for place in wheels])

    def answer(self, stamp: int, wheels: list[str]) -> None:
        odometry = Odometry(child_frame_id="base_link")
        odometry.header.frame_id = "odom"
        odometry.header.stamp = Time(nanoseconds=stamp).to_msg()
        odometry.pose.pose.position.x = self.distance
        odometry.twist.twist.linear.x = self.speed
        self.publish("odom", odometry)
        if self.period % 50 == 0:
            goal, to_go = self.goal_stamp, f"{self.to_go:.3f}"
            told = status("drive", stamp, state=self.state, goal_stamp=goal, distance_to_go=to_go, reason="")
            self.publish("drive/status", told)
        rate = SPEED / WHEEL_RADIUS if self.state == "moving" else 0.0
        command = JointState(name=wheels, velocity=array.array("d", [rate] * len(wheels)))
        command.header.stamp = Time(nanoseconds=stamp).to_msg()
        self.publish("wheel_command", command)
        if self.period % 50 == 0:
            self.beat("running", stamp)

    def beat(self, state: str, stamp: int) -> None:
        self.published["diagnostics"] = self.published.get("diagnostics", 0) + 1
        counts = {"published__/" + name.replace("/", "_of_"): count for name, count in self.published.items()}
        self.senders["diagnostics"].publish(status("drive", stamp, state=state, **counts))

    def publish(self, name: str, message: Any) -> None:
        self.published[name] = self.published.get(name, 0) + 1
        self.senders[name].publish(message)


def main() -> None:
    rclpy.init(args=sys.argv, signal_handler_options=SignalHandlerOptions.NO)
    node = StandInDrive()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        if rclpy.ok():
            node.beat("ended", (node.period - 1) * PERIOD)
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
