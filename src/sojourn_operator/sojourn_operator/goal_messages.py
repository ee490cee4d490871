"""Goals as messages, as any operator sends them, and statuses as reports."""

from collections.abc import Sequence
from math import cos, sin

import numpy as np
from numpy.typing import ArrayLike

from sojourn_contract.heartbeat import is_count, status_values
from sojourn_contract.values import (
    DiagnosticArray,
    Header,
    Message,
    Path,
    PoseStamped,
    PoseWithCovarianceStamped,
    TwistStamped,
)
from sojourn_operator.steps.step import GoalReport

QUESTION = "/drive/question"
ANY = (0.0, 0.0, 0.0, 0.0)
"""An orientation of zero length."""


def drive_goal(
    stamp: int, place: tuple[float, float], yaw: float | None, frame: str = "map", height: float = 0.0
) -> PoseStamped:
    """Goal of the drive.

    Args:
        stamp: of it [ns]. place: x, y [m]. yaw: wanted heading there [rad], None for any.
        height: of the ground there in the frame [m], 0 if it is not known.
    """
    return pose_message(stamp, frame, (*place, height), _heading(yaw))


def route_goal(stamp: int, points: Sequence[tuple[float, float]], yaw: float | None, frame: str = "map") -> Path:
    """Goal of the drive along points x, y [m]; `yaw` [rad] is the wanted heading at the last, None for any."""
    headings = [None] * (len(points) - 1) + [yaw]
    poses = (drive_goal(stamp, point, heading, frame) for point, heading in zip(points, headings, strict=True))
    return Path(stamp, frame, tuple(poses))


def question_message(goal: PoseStamped | Path) -> Path:
    """Message that asks what it would take to drive so."""
    return goal if isinstance(goal, Path) else Path(goal.stamp, goal.frame, (goal,))


def pose_message(stamp: int, frame: str, position: ArrayLike, orientation: ArrayLike) -> PoseStamped:
    """A pose. position: (3,) [m]. orientation: quaternion x y z w."""
    return PoseStamped(stamp, frame, np.array(position, dtype=float), np.array(orientation, dtype=float))


def place_message(stamp: int, place: tuple[float, float], yaw: float, within: float) -> PoseWithCovarianceStamped:
    """An operator's word where the rover is.

    Args:
        stamp: of it [ns]. place: x, y on the map [m]. yaw: heading [rad]. within: standard deviation of x and y, and,
            for one metre, of the heading [m], [rad].
    """
    covariance = np.diag((within**2, within**2, 0.0, 0.0, 0.0, within**2))
    orientation = np.array(_heading(yaw))
    return PoseWithCovarianceStamped(stamp, "map", np.array((*place, 0.0)), orientation, covariance.ravel())


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
    return _report(status, "state", "goal_stamp", "reason")


def request_report_of(status: DiagnosticArray) -> GoalReport:
    """What a status of the power manager says of the last request: state, stamp, reason."""
    return _report(status, "request_state", "request_stamp", "request_reason")


def place_report_of(status: DiagnosticArray) -> GoalReport:
    """What a status of the drive says of the last word where it is: state, stamp, reason."""
    return _report(status, "placed_state", "placed_stamp", "placed_reason")


def _report(status: DiagnosticArray, state: str, stamp: str, reason: str) -> GoalReport:
    """Of the fields that are named."""
    values = status_values(status)
    told = values.get(stamp, "0")
    return GoalReport(values.get(state, ""), int(told) if is_count(told) else 0, values.get(reason, ""))


def _heading(yaw: float | None) -> tuple[float, float, float, float]:
    """Quaternion x y z w; any where none is wanted."""
    return ANY if yaw is None else (0.0, 0.0, sin(yaw / 2.0), cos(yaw / 2.0))
