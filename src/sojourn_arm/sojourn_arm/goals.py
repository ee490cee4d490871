"""Goals as they come over topics: into the arm's own, refused with the reason, and what became of them for
the status.
"""

from typing import Any

from sojourn_arm.rover import Rover
from sojourn_arm.tasks import task_fields, task_of
from sojourn_contract import stamps
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.messages import quaternion, xyz
from sojourn_mechanics.arm.controller import ArmOutput
from sojourn_mechanics.arm.goals import (
    ArmGoal,
    GoalRefusedError,
    JointGoal,
    NamedGoal,
    StopGoal,
    TrajectoryGoal,
    pose_goal,
)
from sojourn_mechanics.arm.params import ArmParams
from sojourn_mechanics.arm.tasks.requests import TaskRequest
from sojourn_mechanics.arm.tasks.task_control import TaskReport

_STATES = {
    "holding": "failed",
    "idle": "idle",
    "moving": "moving",
    "paused": "reached",
    "refused": "refused",
    "reached": "reached",
    "stopped": "stopped",
}


class GoalDesk:
    """Takes goals in and keeps the state of the last one."""

    def __init__(self, params: ArmParams, rover: Rover) -> None:
        self._params = params
        self._rover = rover
        self._state = "idle"
        self._reason = ""
        self._stamp = 0
        self._refused_before = 0
        self._report: TaskReport | None = None

    def goal(self, topic: str, message: Any) -> ArmGoal | TaskRequest:
        """The arm's goal or task of a message. Raises RefusedMessageError for a frame or numbers that it cannot
        have.
        """
        header = message if topic == "/arm/stop" else message.header
        self._stamp = stamps.from_message(header.stamp)
        self._state, self._reason = "moving", ""
        try:
            return self._convert(topic, message)
        except (GoalRefusedError, RefusedMessageError) as refusal:
            self._state, self._reason = "refused", str(refusal)
            raise RefusedMessageError(topic, "goal", "refused", str(refusal)) from refusal

    def note(self, output: ArmOutput, report: TaskReport | None, new_goal: bool) -> None:
        """Keep what has become of the last goal; `new_goal`: it was given to the arm in this period."""
        self._report = report
        refused = output.goals_refused > self._refused_before
        self._refused_before = output.goals_refused
        if refused:
            self._state, self._reason = "refused", output.reason
        elif new_goal or self._state == "moving":
            self._state, self._reason = _STATES[output.status], output.reason
            if report is not None:
                self._state, self._reason = report.doing.state, report.doing.reason

    def status(self, output: ArmOutput | None) -> dict[str, str]:
        """Fields of /arm/status; without those that are measured where nothing has been measured yet."""
        known = {"state": self._state, "goal_stamp": str(self._stamp), "reason": self._reason}
        if output is None:
            return known
        x, y, z = output.tip_in_base
        return (
            known
            | {
                "progress": f"{output.progress:.3f}",
                "time_to_go": f"{output.time_to_go:.2f}",
                "error_m": f"{output.goal_error:.6f}",
                "joint_error_rad": f"{output.joint_error:.6f}",
                "tip_in_base_m": f"{x:.5f} {y:.5f} {z:.5f}",
                "goals_accepted": str(output.goals_accepted),
                "goals_refused": str(output.goals_refused),
            }
            | task_fields(self._report)
        )

    def _convert(self, topic: str, message: Any) -> ArmGoal | TaskRequest:
        if topic == "/arm/stop":
            return StopGoal()
        if topic == "/arm/task":
            return task_of(message)
        if topic == "/arm/goal_pose":
            pose = message.pose
            goal = pose_goal(self._params, xyz(pose.position).tolist(), quaternion(pose.orientation).tolist())
            return self._rover.in_base(goal, message.header.frame_id)
        if topic == "/arm/joint_goal":
            if not message.name:
                return NamedGoal(message.header.frame_id)
            return JointGoal(tuple(message.name), tuple(message.position))
        points = message.points
        return TrajectoryGoal(
            names=tuple(message.joint_names),
            times=tuple(point.time_from_start.sec + 1e-9 * point.time_from_start.nanosec for point in points),
            positions=tuple(tuple(point.positions) for point in points),
            velocities=tuple(tuple(point.velocities) for point in points)
            if points and all(point.velocities for point in points)
            else None,
        )
