"""Goals as they come over topics: into the arm's own, refused with the reason, and what became of them for
the status.
"""

from dataclasses import dataclass
from typing import Any

from sojourn_arm.rover import BASE_FRAME, Rover, in_base
from sojourn_arm.tasks import Request, progress_fields, task_fields, task_of
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.goal_topics import REFUSAL_TOLD_NS
from sojourn_contract.stamps import NANOSECONDS
from sojourn_contract.values import JointTrajectory, Message, Path, PoseStamped, TwistStamped
from sojourn_flight.arm.goal_events import GoalEvent
from sojourn_flight.arm.goals import (
    JointGoal,
    NamedGoal,
    PathGoal,
    PathPoint,
    PoseGoal,
    StopGoal,
    TrajectoryGoal,
    pose_goal,
)
from sojourn_flight.arm.jogging import JogCommand
from sojourn_flight.arm.params import ArmParams
from sojourn_flight.arm.refusal import GoalRefusedError
from sojourn_flight.arm.state import ArmOutput
from sojourn_flight.arm.tasks.task_control import TaskReport
from sojourn_machine.evolution import replace

ON_ARC = "arc"
"""header.frame_id of a pose of a path that the tip goes by on an arc."""


@dataclass(frozen=True, slots=True)
class LastGoal:
    """What became of the last goal."""

    state: str = "idle"
    reason: str = ""
    stamp: int = 0
    """Of its message [ns]."""
    abandoned: bool = False
    """It has failed without the arm's doing: what the arm says of it is no news."""
    report: TaskReport | None = None
    """Of the last period; None where the last goal was no task."""
    goals_accepted: int = 0
    """By the arm, so far."""
    goals_refused: int = 0
    """By the arm, so far."""
    goes_on: "LastGoal | None" = None
    """The goal that was under way when this one came, until this one has been accepted; if it is refused, the arm goes
    on with it."""
    until: int = 0
    """So long a refusal is told before what goes on [ns]."""

    @property
    def under_way(self) -> "LastGoal | None":
        """What the arm is on its way to, as long as it has not accepted a newer goal."""
        if self.goes_on is not None and self.state in ("moving", "refused"):
            return self.goes_on.under_way
        return self if self.state == "moving" else None

    def begun(self, message: Message) -> "LastGoal":
        """A new goal has come."""
        return self._next(message, "moving", self.under_way)

    def refused_at_once(self, message: Message, reason: str, waits: bool) -> "LastGoal":
        """One has come that cannot be, and is not given to the arm. waits: whether the arm has yet to see the goal
        before it.
        """
        goes_on = self if waits and self.state == "moving" else self.goes_on if waits else self.under_way
        return replace(self._next(message, "refused", goes_on), reason=reason)

    def refused(self, reason: str) -> "LastGoal":
        """The arm will not have it."""
        return replace(self, state="refused", reason=reason)

    def _next(self, message: Message, state: str, goes_on: "LastGoal | None") -> "LastGoal":
        return replace(self, state=state, reason="", stamp=message.stamp, abandoned=False, goes_on=goes_on, until=0)

    def given_up(self, reason: str) -> "LastGoal":
        """The goal on its way has failed, as its measurements stay away."""
        if self.state == "moving":
            return replace(self, state="failed", reason=reason, abandoned=True)
        return self if self.goes_on is None else replace(self, goes_on=self.goes_on.given_up(reason))

    def noted(self, output: ArmOutput, report: TaskReport | None) -> "LastGoal":
        """With what has become of it in this period."""
        last = self if report is self.report else replace(self, report=report)
        for event in output.events:
            last = last._after(event)
        if last.state != "moving":
            return last
        reason = output.reason if report is None else report.doing.reason
        return last if reason == last.reason else replace(last, reason=reason)

    def _after(self, event: GoalEvent) -> "LastGoal":
        """After what has happened to it, which is told once: to the newest goal its answer, before any end."""
        last = replace(
            self,
            goals_accepted=self.goals_accepted + (event.outcome == "accepted"),
            goals_refused=self.goals_refused + (event.outcome == "refused"),
        )
        if last.state == "refused" and last.goes_on is not None:  # the arm knows nothing of the one that was refused
            return replace(last, goes_on=last.goes_on._after(event))
        if event.outcome == "accepted":
            return replace(last, goes_on=None, state=last.state if last.abandoned else "moving")
        if event.outcome == "refused":
            return last if last.abandoned else last.refused(event.reason)
        ended = "reached" if event.outcome == "paused" else event.outcome
        return replace(last, state=ended, reason=event.reason) if last.state == "moving" else last

    def told(self, now: int) -> "LastGoal":
        """What is to be told at a time [ns]: a refusal, and after it the goal that goes on."""
        if self.goes_on is None or self.state != "refused":
            return self
        if not self.until:
            return replace(self, until=now + REFUSAL_TOLD_NS)
        if self.until - REFUSAL_TOLD_NS <= now < self.until:  # else it is over, or the clock was set
            return self
        counts = {"goals_accepted": self.goals_accepted, "goals_refused": self.goals_refused}
        return replace(self.goes_on, report=self.report, **counts)

    def status(self, output: ArmOutput | None) -> dict[str, str]:
        """Fields of /arm/status; without those that are measured where nothing has been measured yet."""
        known = {"state": self.state, "goal_stamp": str(self.stamp), "reason": self.reason}
        if output is None:
            return known
        x, y, z = output.tip_in_base
        return (
            known
            | progress_fields(output, self.report)
            | {
                "error_m": f"{output.goal_error:.6f}",
                "joint_error_rad": f"{output.joint_error:.6f}",
                "tip_in_base_m": f"{x:.5f} {y:.5f} {z:.5f}",
                "goals_accepted": str(self.goals_accepted),
                "goals_refused": str(self.goals_refused),
            }
            | task_fields(self.report)
            | ({"failed_joints": output.failed_joints} if output.failed_joints else {})
        )


class GoalReader:
    """Makes the arm's own goals of messages. floats: the base gives way under the arm."""

    def __init__(self, params: ArmParams, floats: bool = False) -> None:
        self._params, self._floats = params, floats

    def request(self, topic: str, message: Any, now: int, rover: Rover) -> Request:
        """What a message asks for at the time `now` [ns], of a rover that stands where it does.

        Raises:
            GoalRefusedError, RefusedMessageError: a frame or numbers that it cannot have.
        """
        if topic == "/arm/stop":
            return StopGoal()
        if topic == "/arm/task":
            return task_of(message)
        if topic == "/arm/goal_pose":
            return in_base(self._pose(message), rover.base_in(message.frame, topic))
        if topic == "/arm/cmd_vel":
            return self._jog(topic, message, now, rover)
        if topic == "/arm/path":
            if self._floats:
                why = "the base floats free and gives way under the arm, so that the hand would leave the line"
                raise GoalRefusedError(f"{why}: allowed are poses, joint goals, trajectories and jogging")
            return self._path(topic, message, rover)
        if topic == "/arm/joint_goal":
            if not message.names:
                return NamedGoal(message.frame)
            return JointGoal(message.names, tuple(message.position.tolist()))
        return self._trajectory(message)

    def _pose(self, pose: PoseStamped) -> PoseGoal:
        return pose_goal(self._params, pose.position.tolist(), pose.orientation.tolist())

    def _jog(self, topic: str, message: TwistStamped, now: int, rover: Rover) -> JogCommand:
        frame = message.frame or BASE_FRAME
        linear, angular = message.linear, message.angular
        of_tool = frame == self._params.tip_link
        if not of_tool:
            turn = rover.base_in(frame, topic, self._params.tip_link).rotation.T
            linear, angular = turn @ linear, turn @ angular
        age = max(now - message.stamp, 0) * 1e-9 if message.stamp else 0.0
        return JogCommand(tuple(linear), tuple(angular), of_tool, age)

    def _path(self, topic: str, message: Path, rover: Rover) -> PathGoal:
        """A path; raises RefusedMessageError where the poses have frames of their own."""
        frame = message.frame
        here = rover.base_in(frame, topic)
        points = []
        for k, pose in enumerate(message.poses):
            own = pose.frame
            if own not in ("", frame, ON_ARC):
                allowed = f"empty, {frame} as of the whole path, or {ON_ARC}"
                raise RefusedMessageError(topic, f"poses[{k}].header.frame_id", repr(own), allowed)
            points.append(PathPoint(in_base(self._pose(pose), here), own == ON_ARC))
        return PathGoal(tuple(points))

    def _trajectory(self, message: JointTrajectory) -> TrajectoryGoal:
        points = message.points
        return TrajectoryGoal(
            names=message.names,
            times=tuple(_seconds(point.time_from_start) for point in points),
            positions=tuple(tuple(point.positions.tolist()) for point in points),
            velocities=tuple(tuple(point.velocities.tolist()) for point in points)
            if points and all(len(point.velocities) for point in points)
            else None,
        )


def _seconds(duration: int) -> float:
    """Of nanoseconds, as a Duration of whole seconds and nanoseconds adds up."""
    return duration // NANOSECONDS + 1e-9 * (duration % NANOSECONDS)
