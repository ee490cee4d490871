"""Goals as messages, as any operator sends them, and statuses as reports."""

from collections.abc import Sequence
from math import cos, sin

import numpy as np

from sojourn_contract.heartbeat import is_count, status_message, status_values
from sojourn_contract.values import DiagnosticArray, Header, JointState, Message, Path, PoseStamped, TwistStamped
from sojourn_operator.actions import Action, ArmAlong, ArmJog, ArmJoints, ArmTask, ArmTo, DriveAlong, DriveTo
from sojourn_operator.script import GoalReport

ANY = (0.0, 0.0, 0.0, 0.0)
"""An orientation of zero length."""


def goal_message(action: Action, stamp: int) -> Message:
    """Message that asks for an action, stamped `stamp` [ns]. Raises TypeError for one that is no goal (a wait), or
    whose place is still to be looked up."""
    match action:
        case DriveTo():
            return _pose(action.frame, stamp, (action.x, action.y, action.z), _heading(action.yaw))
        case DriveAlong():
            last = len(action.points) - 1
            poses = [
                _pose(action.frame, stamp, (x, y, 0.0), _heading(action.yaw if place == last else None))
                for place, (x, y) in enumerate(action.points)
            ]
            return Path(stamp, action.frame, tuple(poses))
        case ArmTo():
            return _pose(action.frame, stamp, (action.x, action.y, action.z), action.orientation)
        case ArmJoints():
            names = tuple(name for name, _ in action.positions)
            return JointState(stamp, names, np.array([angle for _, angle in action.positions]), frame=action.name)
        case ArmAlong():
            poses = [
                _pose("arc" if point.on_arc else action.frame, stamp, (point.x, point.y, point.z), point.orientation)
                for point in action.points
            ]
            return Path(stamp, action.frame, tuple(poses))
        case ArmJog():
            return TwistStamped(stamp, action.frame, np.array(action.linear), np.array(action.angular))
        case ArmTask():
            return status_message(stamp, action.name, dict(action.values))
    raise TypeError(f"{action!r} is no goal")


def stop_messages(stamp: int) -> list[tuple[str, Message]]:
    """Messages that stop everything: a velocity of zero for the drive, a stop for the arm, as (topic, message)."""
    twist = TwistStamped(stamp, "base_link", np.zeros(3), np.zeros(3))
    return [("/cmd_vel", twist), ("/arm/stop", Header(stamp))]


def stamped(message: Message, stamp: int) -> Message:
    """The message with a stamp [ns], its poses, if it has any, too."""
    message = message._replace(stamp=stamp)
    if isinstance(message, Path):
        message = message._replace(poses=tuple(pose._replace(stamp=stamp) for pose in message.poses))
    return message


def report_of(status: DiagnosticArray) -> GoalReport:
    """What a status message says of its goal."""
    values = status_values(status)
    stamp = values.get("goal_stamp", "0")
    return GoalReport(values.get("state", ""), int(stamp) if is_count(stamp) else 0, values.get("reason", ""))


def _pose(frame: str, stamp: int, position: Sequence[float], orientation: Sequence[float]) -> PoseStamped:
    return PoseStamped(stamp, frame, np.array(position, dtype=float), np.array(orientation, dtype=float))


def _heading(yaw: float | None) -> tuple[float, float, float, float]:
    """Quaternion x y z w; any where none is wanted."""
    return ANY if yaw is None else (0.0, 0.0, sin(yaw / 2.0), cos(yaw / 2.0))
