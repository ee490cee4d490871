"""What an operator may ask of the arm, as plain values, and the checks that need no planning.

Conversions from ROS messages are one line each: /arm/joint_goal (JointState: name, position) is a
JointGoal; /arm/goal_pose (PoseStamped in base_link) is `pose_goal(params, xyz, quaternion)`;
/arm/joint_trajectory is a TrajectoryGoal with time_from_start in seconds; /arm/path is a PathGoal; /arm/stop is a
StopGoal; /arm/task may carry the name of a NamedGoal.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from sojourn_flight.arm.kinematics import direction_from_quaternion
from sojourn_flight.arm.model import ArmModel
from sojourn_flight.arm.orientation import from_quaternion
from sojourn_flight.arm.param_groups import PoseGoalParams
from sojourn_flight.arm.refusal import GoalRefusedError
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray

HELD_WITHIN = 0.02
"""Of a joint that does not move: so near to where it is any goal has it there [rad or m]."""


@dataclass(frozen=True, slots=True)
class JointGoal:
    """Joint positions by name [rad or m]. Joints that are not named stay where the present goal has them."""

    names: tuple[str, ...]
    positions: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class NamedGoal:
    """One of the named poses of the parameters, such as 'stow' or 'unfold'."""

    name: str


@dataclass(frozen=True, slots=True)
class PoseGoal:
    """Tip position in base_link [m] and, if wanted, the direction of the tool axis in base_link or, instead, the whole
    orientation of the tip frame, a quaternion x y z w.
    """

    position: tuple[float, float, float]
    direction: tuple[float, float, float] | None = None
    orientation: tuple[float, float, float, float] | None = None


@dataclass(frozen=True, slots=True)
class TrajectoryGoal:
    """Points to go through: times after the start [s] (all zero or empty: as fast as may be)."""

    names: tuple[str, ...]
    times: tuple[float, ...]
    positions: tuple[tuple[float, ...], ...]
    velocities: tuple[tuple[float, ...], ...] | None = None


@dataclass(frozen=True, slots=True)
class PathPoint:
    """A point of a path of the tip. A pose that asks for no direction of the tool keeps it as it is."""

    pose: PoseGoal
    on_arc: bool = False
    """The tip goes by it on an arc, from the point before to the one after. Its direction is not asked for."""


@dataclass(frozen=True, slots=True)
class PathGoal:
    """Straight lines and arcs of the tip, from where it is through all points, at rest at the last one."""

    points: tuple[PathPoint, ...]


@dataclass(frozen=True, slots=True)
class StopGoal:
    """Stop as fast as acceleration and jerk allow, and hold."""


@dataclass(frozen=True, slots=True)
class PauseGoal:
    """Come to rest on the path of the present motion, to go on later."""


@dataclass(frozen=True, slots=True)
class ResumeGoal:
    """Go on with a motion that was paused."""


ArmGoal: TypeAlias = JointGoal | NamedGoal | PoseGoal | TrajectoryGoal | PathGoal | StopGoal | PauseGoal | ResumeGoal


def pose_goal(params: PoseGoalParams, position: Sequence[float], quaternion_xyzw: Sequence[float]) -> PoseGoal:
    """Goal from a pose of the tip frame in base_link; identity or all-zero orientation: pointing free. What the
    orientation asks for otherwise is `params.goal_orientation`.

    Raises:
        GoalRefusedError: numbers not finite, or an orientation that is not a unit quaternion.
    """
    point = _finite("goal position", position, 3)
    try:
        direction = direction_from_quaternion(params, np.array(quaternion_xyzw, dtype=np.float64))
    except InvalidValueError as error:
        raise GoalRefusedError(f"goal {error}") from error
    place = (float(point[0]), float(point[1]), float(point[2]))
    if direction is None:
        return PoseGoal(place)
    if params.goal_orientation == "full":
        x, y, z, w = (float(value) for value in quaternion_xyzw)
        return PoseGoal(place, orientation=(x, y, z, w))
    return PoseGoal(place, (float(direction[0]), float(direction[1]), float(direction[2])))


def joint_target(model: ArmModel, goal: JointGoal, present: FloatArray) -> FloatArray:
    """Target of every joint (n,): the named ones from the goal, the others from `present` (n,).

    Raises:
        GoalRefusedError: names unknown or twice, lengths that differ, numbers not finite, out of limits.
    """
    columns = _columns(model, goal.names)
    values = _finite("positions", goal.positions, len(goal.names))
    target = present.copy()
    check_position_limits(model, values, columns, "goal")
    target[columns] = np.clip(values, model.lower[columns], model.upper[columns])
    return target


def pose_target(goal: PoseGoal) -> tuple[FloatArray, FloatArray | None]:
    """Tip position (3,), and unit direction (3,), rotation of the tip frame (3, 3) or None.

    Raises:
        GoalRefusedError: numbers not finite, or a direction or a quaternion of no length.
    """
    point = _finite("goal position", goal.position, 3)
    if goal.orientation is not None:
        quaternion = _finite("goal orientation", goal.orientation, 4)
        if float(np.linalg.norm(quaternion)) < 1e-6:
            raise GoalRefusedError(
                f"goal orientation = {quaternion.tolist()}: allowed is a quaternion that has a length"
            )
        return point, from_quaternion(quaternion / np.linalg.norm(quaternion))
    if goal.direction is None:
        return point, None
    direction = _finite("goal direction", goal.direction, 3)
    length = float(np.linalg.norm(direction))
    if length < 1e-6:
        raise GoalRefusedError(f"goal direction = {direction.tolist()}: allowed is a vector that has a length")
    return point, direction / length


def trajectory_target(
    model: ArmModel, goal: TrajectoryGoal, present: FloatArray
) -> tuple[FloatArray, FloatArray | None, FloatArray | None]:
    """Points (m, n), times (m,) or None, velocities (m, n) or None of a trajectory goal.

    A first point at time 0 must be where the arm's reference is; it is left out.

    Raises:
        GoalRefusedError: as joint_target; times that do not rise; no points.
    """
    columns = _columns(model, goal.names)
    if not goal.positions:
        raise GoalRefusedError("trajectory without points: at least one is needed")
    rows = [_finite(f"positions of point {k}", row, len(columns)) for k, row in enumerate(goal.positions)]
    points = np.tile(present, (len(rows), 1))
    for k, row in enumerate(rows):
        check_position_limits(model, row, columns, f"point {k}")
        points[k, columns] = np.clip(row, model.lower[columns], model.upper[columns])
    velocities = None
    if goal.velocities is not None:
        if len(goal.velocities) != len(rows):
            raise GoalRefusedError(f"trajectory has {len(goal.velocities)} velocities for {len(rows)} points")
        velocities = np.zeros_like(points)
        for k, speeds in enumerate(goal.velocities):
            velocities[k, columns] = _finite(f"velocities of point {k}", speeds, len(columns))
    if not goal.times or not np.any(np.array(goal.times)):
        return points, None, velocities
    times = _finite("times", goal.times, len(rows))
    if times[0] < 0.0 or np.any(np.diff(times) <= 0.0):
        raise GoalRefusedError(f"times = {times.tolist()} s: allowed are rising times, none below zero")
    if times[0] == 0.0:
        gap = np.abs(points[0] - present)
        if float(np.max(gap)) > 0.01:
            joint = int(np.argmax(gap))
            raise GoalRefusedError(
                f"point 0 at time 0 has {model.joint_names[joint]} at {points[0, joint]:.4f}, "
                f"the arm is at {present[joint]:.4f}: give it time to get there"
            )
        if len(rows) == 1:
            return points, None, velocities
        return points[1:], times[1:], None if velocities is None else velocities[1:]
    return points, times, velocities


def check_position_limits(model: ArmModel, values: FloatArray, columns: list[int], what: str) -> None:
    """Refuse joint positions out of the URDF's limits (a rounding excess of 1e-6 is let pass), or elsewhere than where
    a joint is that does not move.
    """
    for value, column in zip(values, columns, strict=True):
        if column in model.held:
            here = model.lower[column]
            if not abs(value - here) <= HELD_WITHIN:
                raise GoalRefusedError(
                    f"{what}: {model.joint_names[column]} = {value:.4f} {model.unit(column)}, but it is at {here:.4f}"
                )
            continue
        if not model.lower[column] - 1e-6 <= value <= model.upper[column] + 1e-6:
            raise GoalRefusedError(
                f"{what}: {model.joint_names[column]} = {value:.4f} is out of its limits "
                f"{model.lower[column]:.4f} to {model.upper[column]:.4f} {model.unit(column)}"
            )


def _columns(model: ArmModel, names: Sequence[str]) -> list[int]:
    unknown = [name for name in names if name not in model.joint_names]
    if unknown:
        raise GoalRefusedError(f"unknown joint {', '.join(unknown)}: this arm has {', '.join(model.joint_names)}")
    if not names or len(set(names)) != len(names):
        raise GoalRefusedError(f"joint names {list(names)}: allowed are one or more, each once")
    return [model.joint_names.index(name) for name in names]


def _finite(what: str, values: Sequence[float], count: int) -> FloatArray:
    array = np.array(values, dtype=np.float64)
    if array.shape != (count,):
        raise GoalRefusedError(f"{what}: {array.size} values, needed are {count}")
    if not np.all(np.isfinite(array)):
        raise GoalRefusedError(f"{what} = {array.tolist()}: allowed are finite numbers")
    return array
