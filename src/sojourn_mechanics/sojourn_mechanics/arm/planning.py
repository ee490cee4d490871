"""From a goal to a checked motion, or to the reason why there is none.

A pose goal: inverse kinematics (first with the preferred direction if the goal leaves pointing free),
solutions in collision dropped, then a way to each solution, nearest first. The last stretch runs along the
tool axis from a point `approach_distance` short of the target, and the same stretch is used to leave it
again (`retreat`), so that a tool on the ground is lifted and not dragged. A joint goal skips the inverse
kinematics.

A way is a chain of straight joint-space moves that stop at each corner: the direct one first, then over
each of `via_poses`. Every candidate is checked for limits and collisions along its whole length before it
is accepted.

The stretch between corner and target is straight in joint space: over 6 cm it leaves the tool axis by a few
mm.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from sojourn_mechanics.arm.collision import Collision, GroundPlane, check_path, check_posture
from sojourn_mechanics.arm.goals import (
    ArmGoal,
    GoalRefusedError,
    JointGoal,
    NamedGoal,
    PoseGoal,
    StopGoal,
    TrajectoryGoal,
    joint_target,
    pose_target,
    trajectory_target,
)
from sojourn_mechanics.arm.inverse_search import POINTING, POSE, POSITION
from sojourn_mechanics.arm.joint_path import JointPath, join
from sojourn_mechanics.arm.kinematics import (
    InverseResult,
    forward_kinematics,
    inverse_kinematics,
    nearby_solution,
)
from sojourn_mechanics.arm.model import ArmModel
from sojourn_mechanics.arm.motion_load import peak, slower
from sojourn_mechanics.arm.params import ArmParams
from sojourn_mechanics.arm.redundancy import Sphere, better_posture, measure_of
from sojourn_mechanics.arm.trajectory import (
    JointReference,
    TrajectoryError,
    at_rest,
    point_to_point,
    stop,
    through_points,
)
from sojourn_mechanics.params import FloatArray

_SLOWER_TRIES = 6
_SECONDARY_STEPS = 60
_SLOWEST_STEP = 0.4
"""The largest step down in speed from one try to the next."""


@dataclass(frozen=True, slots=True)
class Plan:
    """A motion that may be carried out."""

    path: JointPath
    target: FloatArray  # joint positions at the end (n,) [rad or m]
    tip_target: FloatArray  # tip position at the end in base_link (3,) [m]
    retreat: FloatArray | None  # joint positions (n,) by which the target is left again
    retreat_time: float  # from this time on the path [s] the arm leaves by `retreat`
    leave: FloatArray | None  # joint positions (n,) that the path goes through first, to leave a target
    leave_time: float  # when it is there [s]
    note: str  # what the operator should know: retimed, by way of a named pose


def solve_pose(
    params: ArmParams,
    model: ArmModel,
    position: FloatArray,
    direction: FloatArray | None,
    start: FloatArray,
    ground: GroundPlane | None = None,
    explain: bool = True,
) -> InverseResult:
    """Inverse kinematics without the solutions that collide; status 'collision' names the pair if all do.

    Arguments as `inverse_kinematics`, and the ground plane in base_link or None.
    """
    found = inverse_kinematics(params, model, position, direction, start, explain)
    if found.status != "solved":
        return found
    free: list[FloatArray] = []
    first: Collision | None = None
    for solution in (*_with_spare_joints(params, model, direction, found.solutions), *found.solutions):
        collision = check_posture(params, model, solution, ground)
        if collision is None:
            free.append(solution)
        first = first or collision
    if not free and first is not None:
        return replace(found, status="collision", solutions=(), message=f"at the target: {first.text()}")
    return replace(found, solutions=tuple(free))


def _with_spare_joints(
    params: ArmParams, model: ArmModel, direction: FloatArray | None, solutions: tuple[FloatArray, ...]
) -> list[FloatArray]:
    """What the nearest solution becomes by the secondary task, if there is one."""
    if params.secondary_task == "none" or not solutions:
        return []
    spheres = tuple(Sphere(np.array(ball[:3]), ball[3]) for ball in params.obstacles)
    task = POSITION if direction is None else POSE if direction.ndim == 2 else POINTING
    measure = measure_of(model, params.secondary_task, spheres)
    return [better_posture(model, solutions[0], measure, _SECONDARY_STEPS, task)]


def plan_goal(
    params: ArmParams,
    model: ArmModel,
    goal: ArmGoal,
    reference: JointReference,
    present: FloatArray,
    retreat: FloatArray | None = None,
    ground: GroundPlane | None = None,
    gravity: FloatArray | None = None,
) -> Plan:
    """Plan a motion from the present reference to a goal, slower where the drives could not follow it.

    Args:
        reference: where the arm is on its present motion.
        present: target of the present goal (n,), for joints that a goal does not name.
        retreat: joint positions (n,) to go through first, or None.
        ground: plane in base_link that the arm keeps above, or None.
        gravity: in base_link (3,), pointing down [m/s2]; None: torque and power are not looked at.

    Raises:
        GoalRefusedError: with the reason as text.
    """
    plan = _plan(params, model, goal, reference, present, retreat, ground)
    if gravity is None or isinstance(goal, StopGoal):
        return plan
    load = peak(params, model, plan.path, gravity)
    factor = 1.0
    for _ in range(_SLOWER_TRIES):
        if load.share <= 1.0:
            break
        factor *= min(max(0.98 / load.share, _SLOWEST_STEP), 0.9)
        reason = load.text
        plan = _plan(params, slower(model, factor, reference), goal, reference, present, retreat, ground)
        plan = replace(plan, note="; ".join(filter(None, (plan.note, f"slower, or {reason}"))))
        load = peak(params, model, plan.path, gravity)
    if load.share > 1.0:
        raise GoalRefusedError(f"{load.text}, however slowly it moves")
    return plan


def _plan(
    params: ArmParams,
    model: ArmModel,
    goal: ArmGoal,
    reference: JointReference,
    present: FloatArray,
    retreat: FloatArray | None,
    ground: GroundPlane | None,
) -> Plan:
    """A motion within the limits of position, speed, acceleration and jerk, that collides with nothing."""
    if isinstance(goal, PoseGoal):
        return _plan_pose(params, model, goal, reference, retreat, ground)
    if isinstance(goal, TrajectoryGoal):
        return _plan_trajectory(params, model, goal, reference, present, ground)
    if isinstance(goal, JointGoal):
        target = joint_target(model, goal, present)
    elif isinstance(goal, NamedGoal):
        if goal.name not in params.named_poses:
            raise GoalRefusedError(f"unknown pose '{goal.name}': there are {', '.join(sorted(params.named_poses))}")
        target = np.array(params.named_poses[goal.name])
    else:
        path = stop(model, reference)
        end = path.sample(path.duration)[0]
        return Plan(path, end, forward_kinematics(model, end).position, None, 0.0, None, 0.0, "")
    return _first_way(params, model, reference, [(target, None)], retreat, ground)


def _plan_pose(
    params: ArmParams,
    model: ArmModel,
    goal: PoseGoal,
    reference: JointReference,
    retreat: FloatArray | None,
    ground: GroundPlane | None,
) -> Plan:
    position, direction = pose_target(goal)
    asked = solve_pose(params, model, position, direction, reference.position, ground)
    wishes = [(direction, asked)]
    if asked.status in ("unreachable", "limits"):
        raise GoalRefusedError(asked.message)
    if direction is None and params.preferred_direction is not None:
        wish = np.array(params.preferred_direction)
        preferred = solve_pose(params, model, position, wish, reference.position, ground, explain=False)
        wishes.insert(0, (wish, preferred))
    reason = ""
    for wish_direction, found in wishes:
        reason = found.message or reason
        if found.status == "solved":
            ends = [(q, _approach(params, model, position, wish_direction, q)) for q in found.solutions]
            try:
                return _first_way(params, model, reference, ends, retreat, ground)
            except GoalRefusedError as error:
                reason = str(error)
    raise GoalRefusedError(reason)


def _approach(
    params: ArmParams,
    model: ArmModel,
    position: FloatArray,
    direction: FloatArray | None,
    solution: FloatArray,
) -> FloatArray | None:
    """Posture `approach_distance` short of the target on the same branch, or None."""
    if params.approach_distance <= 0.0:
        return None
    along = (
        forward_kinematics(model, solution).tool_direction if direction is None or direction.ndim == 2 else direction
    )
    point = position - params.approach_distance * along
    posture = nearby_solution(params, model, point, along if direction is None else direction, solution)
    if posture is None and direction is None:
        posture = nearby_solution(params, model, point, None, solution)
    if posture is None or float(np.max(np.abs(posture - solution))) > 1.0:
        return None
    return posture


def _plan_trajectory(
    params: ArmParams,
    model: ArmModel,
    goal: TrajectoryGoal,
    reference: JointReference,
    present: FloatArray,
    ground: GroundPlane | None,
) -> Plan:
    points, times, velocities = trajectory_target(model, goal, present)
    try:
        path, stretched = through_points(model, reference, points, times, velocities, params.retime)
    except TrajectoryError as error:
        raise GoalRefusedError(str(error)) from error
    collision = check_path(params, model, path, ground)
    if collision is not None:
        raise GoalRefusedError(collision.text())
    asked = 0.0 if times is None else times[-1]
    note = f"retimed from {asked:.2f} s to {path.duration:.2f} s to keep the joint limits" if stretched else ""
    return Plan(path, points[-1], forward_kinematics(model, points[-1]).position, None, 0.0, None, 0.0, note)


def _ways(
    params: ArmParams, target: FloatArray, approach: FloatArray | None, retreat: FloatArray | None
) -> Iterator[tuple[list[FloatArray], str]]:
    """Corner postures of each way to a target, the target last, and a note for the operator."""
    tail = [target] if approach is None else [approach, target]
    heads: list[list[FloatArray]] = [[]] if retreat is None else [[retreat], []]
    for head in heads:
        yield [*head, *tail], ""
        for name in params.via_poses:
            yield (
                [*head, np.array(params.named_poses[name]), *tail],
                f"by way of '{name}', the direct way collides",
            )


def _first_way(
    params: ArmParams,
    model: ArmModel,
    reference: JointReference,
    ends: list[tuple[FloatArray, FloatArray | None]],
    retreat: FloatArray | None,
    ground: GroundPlane | None,
) -> Plan:
    """The first way to one of `ends` (target, approach) that keeps limits and collides with nothing."""
    reason = ""
    candidates = [(end, way) for end in ends for way in _ways(params, *end, retreat)]
    # Direct ways to every posture come before detours to any.
    candidates.sort(key=lambda candidate: bool(candidate[1][1]))
    for (target, approach), (corners, note) in candidates[: params.planning_attempts]:
        try:
            pieces = _pieces(model, reference, corners)
        except TrajectoryError as error:
            reason = reason or str(error)
            continue
        path = join(pieces)
        collision = check_path(params, model, path, ground)
        if collision is None:
            tip = forward_kinematics(model, target).position
            leaves = retreat is not None and corners[0] is retreat
            return Plan(
                path=path,
                target=target,
                tip_target=tip,
                retreat=approach,
                retreat_time=path.duration - pieces[-1].duration,
                leave=retreat if leaves else None,
                leave_time=pieces[0].duration if leaves else 0.0,
                note=note,
            )
        reason = reason or collision.text()
    raise GoalRefusedError(reason)


def _pieces(model: ArmModel, reference: JointReference, corners: list[FloatArray]) -> list[JointPath]:
    pieces = [point_to_point(model, reference, corners[0])]
    for here, there in pairwise(corners):
        pieces.append(point_to_point(model, at_rest(here), there))
    return pieces
