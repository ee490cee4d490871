"""control_msgs/FollowJointTrajectory: /arm/joint_trajectory with /arm/status."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.stamps import NANOSECONDS, seconds
from sojourn_contract.topics import topic
from sojourn_contract.types import message_class
from sojourn_contract.values import JointState, JointTrajectory
from sojourn_machine.params import FloatArray
from sojourn_operator.actions.conversion import value_of
from sojourn_operator.actions.kind import LastHeard, action_type
from sojourn_operator.actions.tolerances import Tolerance, breach
from sojourn_operator.actions.watch import ABORTED, BREACH, CANCELED, SUCCEEDED, Ending

GOAL = topic("/arm/joint_trajectory")
COMMAND, MEASURED = "/arm_command", "/joint_states"
NOT_HERE = ("component_path_tolerance", "component_goal_tolerance")


class FollowJointTrajectory:
    """Moves the arm through joint positions."""

    name = "FollowJointTrajectory"
    package = "control_msgs"
    role = "arm"
    topic = GOAL.name
    hears: tuple[str, ...] = (COMMAND, MEASURED)

    def begin(self, request: Any) -> "ArmPursuit":
        """See ActionKind."""
        several = getattr(request, "multi_dof_trajectory", None)
        if several is not None and several.points:
            raise RefusedMessageError(self.name, "multi_dof_trajectory", f"{len(several.points)} points", "none")
        for field in NOT_HERE:
            if len(getattr(request, field, ())):
                raise RefusedMessageError(self.name, field, f"{len(getattr(request, field))} of them", "none")
        goal = value_of(GOAL, request.trajectory)
        if not isinstance(goal, JointTrajectory) or not goal.points:
            raise RefusedMessageError(self.name, "trajectory.points", "none", "at least one")
        for field in ("path_tolerance", "goal_tolerance"):
            for one in getattr(request, field):
                if one.name not in goal.names:
                    raise RefusedMessageError(self.name, f"{field}.name", one.name, "one of " + ", ".join(goal.names))
        return ArmPursuit(action_type(self), goal, request)


class ArmPursuit:
    """See Pursuit."""

    def __init__(self, action: Any, goal: JointTrajectory, request: Any) -> None:
        self._action, self.goal = action, goal._replace(stamp=0)
        self._path, self._end = _tolerances(request.path_tolerance), _tolerances(request.goal_tolerance)
        late = request.goal_time_tolerance.sec * NANOSECONDS + request.goal_time_tolerance.nanosec
        self._longest = goal.points[-1].time_from_start + late if late > 0 else 0
        """[ns] after its begin; 0: it takes what it takes."""
        self._is_path_left = False

    def feedback(self, heard: LastHeard) -> Any:
        """See Pursuit."""
        said = self._action.Feedback()
        wanted, measured = heard.messages.get(COMMAND), heard.messages.get(MEASURED)
        if not (isinstance(wanted, JointState) and isinstance(measured, JointState)):
            return said
        said.header.stamp.sec, said.header.stamp.nanosec = divmod(measured.stamp, NANOSECONDS)
        names = [name for name in self.goal.names if name in wanted.names and name in measured.names]
        said.joint_names = names
        (desired, desired_rate), (actual, actual_rate) = (_of(message, names) for message in (wanted, measured))
        said.desired = _point(desired, desired_rate)
        said.actual = _point(actual, actual_rate)
        said.error = _point(desired - actual, desired_rate - actual_rate)
        return said

    def breach(self, heard: LastHeard) -> str:
        """See Pursuit: the tolerance of the path, and the time that it may take."""
        wanted = heard.messages.get(COMMAND)
        if isinstance(wanted, JointState):
            position, rate = _of(wanted, wanted.names)
            places = dict(zip(wanted.names, zip(position.tolist(), rate.tolist(), strict=True), strict=True))
            found = breach(self._path, places, _measured(heard))
            if found:
                self._is_path_left = True
                return found
        if self._longest and heard.now > heard.begun + self._longest:
            return f"not there after {seconds(self._longest):g} s, the last point's time and its tolerance"
        return ""

    def final(self, ending: Ending, heard: LastHeard) -> Ending:
        """See Pursuit: the tolerance of the goal."""
        if ending.word != SUCCEEDED:
            return ending
        last = self.goal.points[-1].positions.tolist()
        found = breach(
            self._end, {name: (at, 0.0) for name, at in zip(self.goal.names, last, strict=True)}, _measured(heard)
        )
        return Ending(ABORTED, BREACH, found) if found else ending

    def result(self, ending: Ending) -> Any:
        """See Pursuit. What keeps the arm from its path is PATH_TOLERANCE_VIOLATED, whatever it was: no other number of
        the action is nearer, and `error_string` says it.
        """
        result = self._action.Result()
        result.error_string = ending.reason
        if ending.word in (SUCCEEDED, CANCELED):
            return result
        if ending.cause == "refused":
            result.error_code = result.INVALID_GOAL
        elif ending.cause == BREACH and not self._is_path_left:
            result.error_code = result.GOAL_TOLERANCE_VIOLATED
        else:
            result.error_code = result.PATH_TOLERANCE_VIOLATED
        return result


def _measured(heard: LastHeard) -> JointState | None:
    found = heard.messages.get(MEASURED)
    return found if isinstance(found, JointState) else None


def _tolerances(messages: Sequence[Any]) -> tuple[Tolerance, ...]:
    return tuple(Tolerance(one.name, one.position, one.velocity) for one in messages)


def _of(message: JointState, names: Sequence[str]) -> tuple[FloatArray, FloatArray]:
    """Positions and rates of these joints, each (n,); rates of zero where none are told."""
    places = [message.names.index(name) for name in names]
    rates = message.velocity if len(message.velocity) else np.zeros(len(message.names))
    return message.position[places], rates[places]


def _point(positions: FloatArray, velocities: FloatArray) -> Any:
    """A trajectory_msgs/JointTrajectoryPoint."""
    point = message_class("trajectory_msgs/JointTrajectoryPoint")()
    point.positions, point.velocities = positions.tolist(), velocities.tolist()
    return point
