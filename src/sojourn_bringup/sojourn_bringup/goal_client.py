"""Sends a goal to a running stack from another terminal and shows its progress to the end: scripts/goal."""

import argparse
import os
import time
from collections.abc import Sequence
from typing import Any

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from rclpy.experimental import EventsExecutor
from rclpy.signals import SignalHandlerOptions

from sojourn_bringup import options
from sojourn_bringup.environment import ros_variables
from sojourn_bringup.errors import BringupError
from sojourn_bringup.goal_messages import goal_message, report_of, stop_messages
from sojourn_bringup.operator_script import FINAL_STATES, REACHED, ArmTo, DriveTo
from sojourn_contract import qos
from sojourn_contract.heartbeat import status_values
from sojourn_contract.process import StopFlag
from sojourn_contract.stamps import from_message, seconds, to_message
from sojourn_contract.topics import topic
from sojourn_contract.types import message_class

ANSWER_S = 5.0
"""Wall time within which a running stack must be found."""
SHOW_S = 1.0
STATUS_TOPICS = {"drive": "/drive/status", "arm": "/arm/status"}
INTERRUPTED = 130


class NoStackError(BringupError):
    """Nobody answers."""


class GoalClient:
    """Talks to a running stack. A context manager.

    Args:
        domain, namespace: where the stack is.
    """

    def __init__(self, domain: int, namespace: str) -> None:
        self.domain, self.namespace = domain, namespace
        self.now = 0
        """Simulation time [ns]; zero until a stamped status has come."""
        self.statuses: dict[str, Any] = {}
        self.stop = StopFlag()
        self._last_stamp = 0

    def __enter__(self) -> "GoalClient":
        os.environ.update(ros_variables(self.domain))
        self.stop.install()
        rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
        self._node = rclpy.create_node(
            "goal", namespace=self.namespace or None, enable_rosout=False, start_parameter_services=False
        )
        self._executor = EventsExecutor()
        self._executor.add_node(self._node)
        self._clock = self._node.create_subscription(
            message_class("rosgraph_msgs/Clock"), "clock", self._on_clock, qos.profile(topic("/clock"), False)
        )
        self._readers = [self._listen(who, name) for who, name in STATUS_TOPICS.items()]
        return self

    def __exit__(self, *_error: object) -> None:
        self._executor.remove_node(self._node)
        self._node.destroy_node()
        rclpy.try_shutdown()

    def send(self, who: str, messages: Sequence[tuple[str, Any]]) -> None:
        """Publish messages once somebody listens to each. Raises NoStackError if nobody does within ANSWER_S."""
        senders = []
        for name, message in messages:
            row = topic(name)
            sender = self._node.create_publisher(
                message_class(row.type), name.lstrip("/"), qos.profile(row, lockstep=True)
            )
            senders.append((name, sender, message))
        end = time.monotonic() + ANSWER_S
        while any(sender.get_subscription_count() == 0 for _, sender, _ in senders) or not self.now:
            if time.monotonic() > end:
                missing = [name for name, sender, _ in senders if sender.get_subscription_count() == 0]
                what = f"nobody listens to {', '.join(missing)}" if missing else "its simulation time does not run"
                raise NoStackError(
                    f"no running stack for {who} on domain {self.domain}"
                    f"{', namespace ' + self.namespace if self.namespace else ''}: {what} (start one with scripts/start.py)"
                )
            self.spin(0.05)
        for _, sender, message in senders:
            self._stamp(message, self.now)
            sender.publish(message)
            self._last_stamp = self.now
        self.spin(0.2)

    def follow(self, who: str, timeout_s: float) -> tuple[str, str]:
        """Show the progress of the goal just sent until it ends. Returns outcome and reason."""
        begin = shown = time.monotonic()
        while not self.stop.is_set and time.monotonic() - begin < timeout_s:
            self.spin(0.05)
            status = self.statuses.get(who)
            if status is None:
                continue
            report = report_of(status)
            if report.goal_stamp == self._last_stamp and report.state in FINAL_STATES:
                return report.state, report.reason
            if time.monotonic() - shown > SHOW_S and report.goal_stamp == self._last_stamp:
                shown = time.monotonic()
                print(f"{seconds(self.now):9.2f} s  {report.state}, {_to_go(who, status_values(status))}", flush=True)
        if self.stop.is_set:
            return "interrupted", "the goal goes on: stop it with scripts/goal stop"
        return "not finished", f"within {timeout_s:g} s of wall time; the goal goes on"

    def spin(self, wall_s: float) -> None:
        """Take what arrives for so long [s]."""
        end = time.monotonic() + wall_s
        while (left := end - time.monotonic()) > 0.0:
            self._executor.spin_once(timeout_sec=left)

    def _listen(self, who: str, name: str) -> Any:
        def keep(message: Any) -> None:
            self.statuses[who] = message

        return self._node.create_subscription(
            DiagnosticArray, name.lstrip("/"), keep, qos.profile(topic(name), lockstep=True)
        )

    def _on_clock(self, message: Any) -> None:
        self.now = from_message(message.clock)

    def _stamp(self, message: Any, stamp: int) -> None:
        time_message = to_message(stamp)
        if hasattr(message, "header"):
            message.header.stamp = time_message
            for pose in getattr(message, "poses", ()):
                pose.header.stamp = time_message
        else:
            message.stamp = time_message


def _to_go(who: str, values: dict[str, str]) -> str:
    if who == "drive":
        return f"{values.get('distance_to_go', '?')} m to go ({values.get('text', '')})"
    return f"{100.0 * float(values.get('progress', 0.0)):.0f} % done, {values.get('time_to_go', '?')} s to go"


def parser() -> argparse.ArgumentParser:
    """Options of scripts/goal."""
    result = options.Parser(prog="goal", description="Send a goal to a running stack and follow it to its end.")
    commands = result.add_subparsers(dest="command", required=True)
    drive = commands.add_parser("drive", help="drive to a place")
    drive.add_argument("x", type=options.number, help="[m]")
    drive.add_argument("y", type=options.number, help="[m]")
    drive.add_argument("yaw", type=options.number, nargs="?", help="heading there [rad]; any if left out")
    drive.add_argument("--frame", default="map", help="map, odom or base_link (default: %(default)s)")
    arm = commands.add_parser("arm", help="place the tip of the arm")
    for axis in ("x", "y", "z"):
        arm.add_argument(axis, type=options.number, help="[m]")
    arm.add_argument("--frame", default="base_link", help="base_link (default)")
    stop = commands.add_parser("stop", help="stop drive and arm")
    for command in (drive, arm, stop):
        options.add_place(command)
        command.add_argument(
            "--timeout", type=options.positive_seconds, default=3600.0, metavar="S", help="longest wait (wall time)"
        )
    return result


def main(arguments: Sequence[str] | None = None) -> int:
    """Send a goal; 0 only if it was reached (a stop: if it was sent)."""
    given = parser().parse_args(arguments)
    with GoalClient(given.domain, given.namespace) as client:
        if given.command == "stop":
            client.send("drive and arm", stop_messages(0))
            print("stop sent")
            return 0
        action = (
            DriveTo(given.x, given.y, given.yaw, given.frame)
            if given.command == "drive"
            else ArmTo(given.x, given.y, given.z, given.frame)
        )
        message = goal_message(action, 0)
        client.send(given.command, [("/goal_pose" if given.command == "drive" else "/arm/goal_pose", message)])
        outcome, reason = client.follow(given.command, given.timeout)
    print(f"{outcome}{': ' + reason if reason else ''}")
    if outcome == "interrupted":
        return INTERRUPTED
    return 0 if outcome == REACHED else 1


if __name__ == "__main__":
    options.run_script(main)
