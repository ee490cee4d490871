"""Goals as they come over topics: into odom, refused with the reason, and what became of them for the
status.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.goal_topics import REFUSAL_TOLD_NS
from sojourn_contract.messages import yaw_of
from sojourn_contract.values import Message, Path, PoseStamped
from sojourn_flight.odometry.attitude import turned_in_plane
from sojourn_flight.odometry.odometry import OdometryState
from sojourn_flight.planning.goal import Goal, GoalOutcome
from sojourn_flight.supervision.drive_types import DriveState

FRAMES = ("map", "odom", "base_link")
"""map and odom coincide at the start of a run, and the drive knows no better afterwards."""


@dataclass(frozen=True, slots=True)
class GoalStatus:
    """What became of the last goal, or velocity command."""

    state: str = "idle"
    reason: str = ""
    stamp: int = 0
    number: int = 0
    """Of the goal: goals are numbered as they come. Their stamps do not tell them apart: those that are stamped zero
    share it."""
    goes_on: "GoalStatus | None" = None
    """The goal that was under way when this one came, until this one has taken its place; if it is refused, the drive
    goes on with it."""
    until: int = 0
    """So long a refusal is told before what goes on [ns]."""

    @property
    def under_way(self) -> "GoalStatus | None":
        """What the drive is on its way to, as long as it has not taken a newer goal."""
        if self.goes_on is not None:
            return self.goes_on.under_way
        return self if self.state == "moving" else None

    def begun(self, message: Message) -> "GoalStatus":
        """A new goal has come."""
        return GoalStatus("moving", "", message.stamp, self.number + 1, self.under_way)

    def refused(self, message: Message, reason: str, waits: bool = False) -> "GoalStatus":
        """A goal or a velocity command has come and was refused. waits: whether the drive has yet to see the goal
        before it, which is still to come.
        """
        goes_on = self if waits and self.state == "moving" else self.goes_on if waits else self.under_way
        return GoalStatus("refused", reason, message.stamp, self.number + 1, goes_on)

    def pre_empted(self, stamp: int, unseen: str) -> "GoalStatus":
        """A velocity command stamped `stamp` [ns] has come: a goal on its way ends with the outcome that the drive
        gives it. A goal that the drive has not seen yet never starts, for the reason `unseen`; empty without one.
        """
        if unseen:
            goal = self if self.state == "moving" else self.goes_on or self
            return replace(goal, state="stopped", reason=unseen)
        return self.under_way or GoalStatus(stamp=stamp, number=self.number)

    def given_up(self, reason: str) -> "GoalStatus":
        """The goal on its way has failed, as its measurements stay away."""
        if self.state == "moving":
            return replace(self, state="failed", reason=reason)
        return self if self.goes_on is None else replace(self, goes_on=self.goes_on.given_up(reason))

    def noted(self, outcomes: Sequence[GoalOutcome], waits: bool = False) -> "GoalStatus":
        """With how it ended, if it has. waits: whether the drive has not seen it yet."""
        last = self
        for outcome in outcomes:
            last = last._after(outcome)
        return last if waits else last._seen()

    def told(self, now: int) -> "GoalStatus":
        """What is to be told at a time [ns]: a refusal, and after it the goal that goes on."""
        if self.goes_on is None or self.state != "refused":
            return self
        if not self.until:
            return replace(self, until=now + REFUSAL_TOLD_NS)
        is_now = self.until - REFUSAL_TOLD_NS <= now < self.until  # the clock may have been set
        return self if is_now else self.goes_on

    def _seen(self) -> "GoalStatus":
        """After the drive has seen the newest goal: what that has taken the place of does not go on."""
        if self.goes_on is None:
            return self
        goes_on = self.goes_on._seen() if self.state == "refused" else None
        return self if goes_on is self.goes_on else replace(self, goes_on=goes_on)

    def _after(self, outcome: GoalOutcome) -> "GoalStatus":
        if outcome.goal.number == self.number and self.state == "moving":
            return replace(self, state=outcome.kind, reason=outcome.reason)
        return self if self.goes_on is None else replace(self, goes_on=self.goes_on._after(outcome))

    def status(self, state: DriveState) -> dict[str, str]:
        """First fields of /drive/status."""
        distance = state.follower.distance_to_go if state.follower is not None else 0.0
        return {
            "state": "refused" if state.twist_refused else self.state,
            "goal_stamp": str(self.stamp),
            "distance_to_go": f"{distance:.3f}",
            "reason": self.reason or (state.text if is_held(state) or state.waits else ""),
        }


@dataclass(frozen=True, slots=True)
class QuestionStatus:
    """The last question, and what kept it from the drive if anything did."""

    stamp: int = 0
    refused: str = ""

    def status(self, answer: Mapping[str, str | float]) -> dict[str, str | float]:
        """Fields of /drive/status; none before the first question. answer: the drive's, if it has been asked."""
        if self.refused:
            return {"asked_stamp": str(self.stamp), "asked_state": "refused", "asked_reason": self.refused}
        return {"asked_stamp": str(self.stamp), **answer} if answer else {}


def goal_of(topic: str, message: Message, here: OdometryState, number: int) -> Goal:
    """Goal of a PoseStamped or a Path, in odom. A z other than 0 is the height of its point, for the forecast.

    Raises:
        RefusedMessageError: a frame that is not known, a path without points.
    """
    poses = message.poses if isinstance(message, Path) else [message]
    frame = message.frame
    points = [_point(topic, frame, pose, here) for pose in poses]
    if not points:
        raise RefusedMessageError(topic, "poses", "empty", "at least one pose")
    yaw = yaw_of(poses[-1].orientation)
    if yaw is not None and frame == "base_link":
        yaw += here.yaw
    base = here.z if frame == "base_link" else 0.0
    z = [float(pose.position[2]) for pose in poses]
    heights = tuple(base + height if height != 0.0 else None for height in z)
    goal = Goal.along(points, yaw, number) if isinstance(message, Path) else Goal.at(*points[0], yaw, number)
    return replace(goal, heights=heights)


def _point(topic: str, frame: str, pose: PoseStamped, here: OdometryState) -> tuple[float, float]:
    if frame not in FRAMES:
        raise RefusedMessageError(topic, "header.frame_id", repr(frame), "one of " + ", ".join(FRAMES))
    x, y = pose.position[:2].tolist()
    if frame == "base_link":
        ahead, left = turned_in_plane(x, y, here.yaw)
        x, y = here.x + ahead, here.y + left
    return float(x), float(y)


def is_held(state: DriveState) -> bool:
    """Whether a velocity command is not carried out, because of an obstacle or because the wheels do not allow it."""
    blocked = state.avoidance is not None and state.avoidance.blocked
    return state.mode == "cmd_vel" and (blocked or state.twist_refused)
