"""Goals as they come over topics: into odom, refused with the reason, and what became of them for the
status.
"""

from dataclasses import replace
from typing import Any

import numpy as np

from sojourn_contract import stamps
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.messages import yaw_of
from sojourn_mechanics.steering.drive_types import DriveState
from sojourn_mechanics.steering.goal import Goal, GoalOutcome
from sojourn_mechanics.steering.odometry import OdometryState
from sojourn_mechanics.terrain.params import TerrainParams

FRAMES = ("map", "odom", "base_link")
"""map and odom coincide at the start of a run, and the drive knows no better afterwards."""


class GoalDesk:
    """Takes goals in and keeps the state of the last one.

    Args:
        terrain: the ground of the scenario; goals off it are refused.
    """

    def __init__(self, terrain: TerrainParams) -> None:
        self._x = (terrain.center_x - terrain.size_x / 2, terrain.center_x + terrain.size_x / 2)
        self._y = (terrain.center_y - terrain.size_y / 2, terrain.center_y + terrain.size_y / 2)
        self._state = "idle"
        self._reason = ""
        self._stamp = 0
        self._count = 0

    def goal(self, topic: str, message: Any, here: OdometryState) -> Goal:
        """Goal of a PoseStamped or a Path, in odom. A z other than 0 is the height of its point, for the forecast.

        Raises:
            RefusedMessageError: a frame that is not known, a path without points, a point off the terrain.
                The status shows it.
        """
        stamp = stamps.from_message(message.header.stamp)
        poses = message.poses if topic == "/waypoints" else [message]
        self._state, self._reason, self._stamp = "moving", "", stamp
        self._count += 1
        try:
            points = [self._point(topic, message.header.frame_id, pose.pose, here) for pose in poses]
            if not points:
                raise RefusedMessageError(topic, "poses", "empty", "at least one pose")
        except RefusedMessageError as refusal:
            self._state, self._reason = "refused", str(refusal)
            raise
        yaw = yaw_of(poses[-1].pose.orientation)
        if yaw is not None and message.header.frame_id == "base_link":
            yaw += here.yaw
        base = here.z if message.header.frame_id == "base_link" else 0.0
        z = [pose.pose.position.z for pose in poses]
        heights = tuple(base + height if height != 0.0 else None for height in z)
        goal = (
            Goal.along(points, yaw, self._name()) if topic == "/waypoints" else Goal.at(*points[0], yaw, self._name())
        )
        return replace(goal, heights=heights)

    def refused(self, topic: str, message: Any, reason: str) -> RefusedMessageError:
        """Note that a goal or a velocity command was refused; the refusal."""
        self._state, self._reason, self._stamp = "refused", reason, stamps.from_message(message.header.stamp)
        self._count += 1
        return RefusedMessageError(topic, "header", "a goal now", f"none while {reason}")

    def pre_empted(self, stamp: int, unseen: bool) -> None:
        """A velocity command has come: a goal on its way ends with the outcome that the drive gives it.

        A goal that the drive has not seen yet (`unseen`) never starts.
        """
        if unseen:
            self._state, self._reason = "stopped", "pre-empted by /cmd_vel"
        elif self._state != "moving":
            self._state, self._reason, self._stamp = "idle", "", stamp

    def note(self, outcomes: tuple[GoalOutcome, ...]) -> None:
        """Keep how the last goal ended."""
        for outcome in outcomes:
            if outcome.goal.name == self._name():
                self._state, self._reason = outcome.kind, outcome.reason

    def status(self, state: DriveState) -> dict[str, str]:
        """First fields of /drive/status."""
        distance = state.follower.distance_to_go if state.follower is not None else 0.0
        return {
            "state": self._state,
            "goal_stamp": str(self._stamp),
            "distance_to_go": f"{distance:.3f}",
            "reason": self._reason or (state.text if is_held(state) else ""),
        }

    def _name(self) -> str:
        """Name of the last goal. Its stamp is none: all goals that are stamped zero would share it."""
        return str(self._count)

    def _point(self, topic: str, frame: str, pose: Any, here: OdometryState) -> tuple[float, float]:
        if frame not in FRAMES:
            raise RefusedMessageError(topic, "header.frame_id", repr(frame), "one of " + ", ".join(FRAMES))
        x, y = pose.position.x, pose.position.y
        if frame == "base_link":
            cosine, sine = np.cos(here.yaw), np.sin(here.yaw)
            x, y = here.x + cosine * x - sine * y, here.y + sine * x + cosine * y
        for axis, value, (low, high) in (("x", x, self._x), ("y", y, self._y)):
            if not low <= value <= high:
                raise RefusedMessageError(
                    topic,
                    f"pose.position.{axis}",
                    f"{value:.2f} m in map",
                    f"on the terrain, {low:.2f} to {high:.2f} m",
                )
        return float(x), float(y)


def is_held(state: DriveState) -> bool:
    """Whether a velocity command is not carried out because of an obstacle."""
    return state.mode == "cmd_vel" and state.avoidance is not None and state.avoidance.blocked
