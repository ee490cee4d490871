"""From a goal to a checked motion, or to the reason why there is none.

A pose goal: inverse kinematics (first with the preferred direction if the goal leaves pointing free),
solutions in collision dropped, then a way to each solution, nearest first (ways.py). The last stretch runs along the
tool axis from a point `approach_distance` short of the target, and the same stretch is used to leave it
again (`retreat`), so that a tool on the ground is lifted and not dragged. A joint goal skips the inverse
kinematics.

A path of the tip: tip_plan.py.

The stretch between corner and target is straight in joint space: over 6 cm it leaves the tool axis by a few
mm.
"""

from dataclasses import replace

import numpy as np

from sojourn_flight.arm.collision import (
    Collision,
    check_path,
    check_posture,
)
from sojourn_flight.arm.goals import (
    ArmGoal,
    JointGoal,
    NamedGoal,
    PathGoal,
    PoseGoal,
    StopGoal,
    TrajectoryGoal,
    check_position_limits,
    joint_target,
    pose_target,
    trajectory_target,
)
from sojourn_flight.arm.inverse_search import POINTING, POSE, POSITION
from sojourn_flight.arm.kinematics import (
    InverseResult,
    forward_kinematics,
    inverse_kinematics,
    nearby_solution,
)
from sojourn_flight.arm.law_params import PlanningParams
from sojourn_flight.arm.model import ArmModel
from sojourn_flight.arm.motion_load import peak, slower
from sojourn_flight.arm.param_groups import ClearanceParams, PoseGoalParams
from sojourn_flight.arm.redundancy import Sphere, better_posture, measure_of
from sojourn_flight.arm.refusal import GoalRefusedError
from sojourn_flight.arm.relief import Ground, GroundRelief, depth_below
from sojourn_flight.arm.sampling_planner import Detours, posture_of
from sojourn_flight.arm.tip_plan import checked_path, timed_path
from sojourn_flight.arm.trajectory import (
    TrajectoryError,
    stop,
    through_points,
)
from sojourn_flight.arm.ways import Departure, Plan, any_way
from sojourn_machine.params import FloatArray

_SLOWER_TRIES = 6
_SECONDARY_STEPS = 60
_SLOWEST_STEP = 0.4
"""The largest step down in speed from one try to the next."""


def solve_pose(
    params: PlanningParams,
    model: ArmModel,
    position: FloatArray,
    direction: FloatArray | None,
    start: FloatArray,
    ground: Ground | None = None,
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
    params: PoseGoalParams, model: ArmModel, direction: FloatArray | None, solutions: tuple[FloatArray, ...]
) -> list[FloatArray]:
    """What the nearest solution becomes by the secondary task, if there is one."""
    if params.secondary_task == "none" or not solutions:
        return []
    spheres = tuple(Sphere(np.array(ball[:3]), ball[3]) for ball in params.obstacles)
    task = POSITION if direction is None else POSE if direction.ndim == 2 else POINTING
    measure = measure_of(model, params.secondary_task, spheres)
    return [better_posture(model, solutions[0], measure, _SECONDARY_STEPS, task)]


def plan_goal(
    params: PlanningParams,
    model: ArmModel,
    goal: ArmGoal,
    departure: Departure,
    ground: Ground | None = None,
    gravity: FloatArray | None = None,
) -> Plan:
    """Plan a motion from where the arm is to a goal, slower where the drives could not follow it.

    Args:
        ground: plane in base_link that the arm keeps above, or None.
        gravity: in base_link (3,), pointing down [m/s2]; None: torque and power are not looked at.

    Raises:
        GoalRefusedError: with the reason as text.
    """
    if isinstance(goal, PathGoal):
        for point in goal.points:
            if ground is not None and not point.on_arc:
                _refuse_buried(params, pose_target(point.pose)[0], ground)
        path = checked_path(params, model, goal, departure.reference, ground)

        def plan_for(arm: ArmModel) -> Plan:
            return timed_path(params, arm, path)
    else:
        detours = Detours(params, model, ground)

        def plan_for(arm: ArmModel) -> Plan:
            return _plan(params, arm, goal, departure, detours)

    plan = plan_for(model)
    if gravity is None or isinstance(goal, StopGoal):
        return plan
    load = peak(params, model, plan.path, gravity)
    factor = 1.0
    for _ in range(_SLOWER_TRIES):
        if load.share <= 1.0:
            break
        factor *= min(max(0.98 / load.share, _SLOWEST_STEP), 0.9)
        reason = load.text
        plan = plan_for(slower(model, factor, departure.reference))
        plan = replace(plan, note="; ".join(filter(None, (plan.note, f"slower, or {reason}"))))
        load = peak(params, model, plan.path, gravity)
    if load.share > 1.0:
        raise GoalRefusedError(f"{load.text}, however slowly it moves")
    return plan


def _plan(
    params: PlanningParams,
    model: ArmModel,
    goal: ArmGoal,
    departure: Departure,
    detours: Detours,
) -> Plan:
    """A motion within the limits of position, speed, acceleration and jerk, that collides with nothing."""
    if isinstance(goal, PoseGoal):
        return _plan_pose(params, model, goal, departure, detours)
    if isinstance(goal, TrajectoryGoal):
        return _plan_trajectory(params, model, goal, departure, detours.ground)
    if isinstance(goal, JointGoal):
        target = joint_target(model, goal, departure.present)
    elif isinstance(goal, NamedGoal):
        if goal.name not in params.named_poses:
            raise GoalRefusedError(f"unknown pose '{goal.name}': there are {', '.join(sorted(params.named_poses))}")
        named = np.array(params.named_poses[goal.name])
        check_position_limits(model, named, list(range(model.joint_count)), f"pose '{goal.name}'")
        target = posture_of(params, model, goal.name)
    else:
        path = stop(model, departure.reference)
        end = path.sample(path.duration)[0]
        return Plan(path, end, forward_kinematics(model, end).position, None, 0.0, None, 0.0, "")
    return any_way(params, model, departure, [[(target, None)]], detours)


def _plan_pose(
    params: PlanningParams,
    model: ArmModel,
    goal: PoseGoal,
    departure: Departure,
    detours: Detours,
) -> Plan:
    position, direction = pose_target(goal)
    here, ground = departure.reference.position, detours.ground
    if ground is not None:
        _refuse_buried(params, position, ground)
    asked = solve_pose(params, model, position, direction, here, ground)
    wishes = [(direction, asked)]
    if asked.status in ("unreachable", "limits"):
        raise GoalRefusedError(asked.message)
    if direction is None and params.preferred_direction is not None:
        wish = np.array(params.preferred_direction)
        preferred = solve_pose(params, model, position, wish, here, ground, explain=False)
        wishes.insert(0, (wish, preferred))
    choices = [
        [(q, _approach(params, model, position, wish_direction, q)) for q in found.solutions]
        for wish_direction, found in wishes
        if found.status == "solved"
    ]
    if not choices:
        raise GoalRefusedError(next(found.message for _, found in reversed(wishes) if found.message))
    return any_way(params, model, departure, choices, detours)


def _refuse_buried(params: ClearanceParams, position: FloatArray, ground: Ground) -> None:
    """Refuse a place below the ground, by more than a tool may go there."""
    depth, seen = depth_below(ground, position), False
    if isinstance(ground, GroundRelief):
        seen = ground.height(float(position[0]), float(position[1]))[1]
    allowed = params.seen_ground_depth if seen else params.ground_contact_depth
    allowed = allowed if params.ground_contact_links else 0.0
    if depth > allowed:
        known = "ground that the camera has seen" if seen else "plane on which the machine stands"
        raise GoalRefusedError(
            f"the goal is {depth * 1e3:.0f} mm below the {known}: at most {allowed * 1e3:.0f} mm is allowed"
        )


def _approach(
    params: PlanningParams,
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
    params: PlanningParams,
    model: ArmModel,
    goal: TrajectoryGoal,
    departure: Departure,
    ground: Ground | None,
) -> Plan:
    points, times, velocities = trajectory_target(model, goal, departure.present)
    try:
        path, stretched = through_points(model, departure.reference, points, times, velocities, params.retime)
    except TrajectoryError as error:
        raise GoalRefusedError(str(error)) from error
    collision = check_path(params, model, path, ground)
    if collision is not None:
        raise GoalRefusedError(collision.text())
    asked = 0.0 if times is None else times[-1]
    note = f"retimed from {asked:.2f} s to {path.duration:.2f} s to keep the joint limits" if stretched else ""
    return Plan(path, points[-1], forward_kinematics(model, points[-1]).position, None, 0.0, None, 0.0, note)
