"""From a path of the tip, as an operator gives it, to a checked motion along it, or to the reason why there is none.

The path begins where the tip is: a moving arm comes to rest first. Its legs are straight lines to each point in turn,
or an arc by way of a point that is on one. The tool turns evenly along a leg, from its direction at the beginning to
that of the point, and keeps it where the point asks for none. Arms of four joints and fewer keep to the places alone,
unless a point asks for an orientation and `goal_orientation` is full.
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from sojourn_flight.arm.cartesian_path import TipPath, arc, line
from sojourn_flight.arm.collision import check_path, check_samples, refined
from sojourn_flight.arm.goals import PathGoal, PoseGoal, pose_target
from sojourn_flight.arm.inverse_search import POINTING, POSE, POSITION
from sojourn_flight.arm.joint_path import JointPath, join
from sojourn_flight.arm.kinematics import TipPose, forward_kinematics
from sojourn_flight.arm.law_params import TipPlanParams
from sojourn_flight.arm.model import ArmModel
from sojourn_flight.arm.param_groups import PoseGoalParams
from sojourn_flight.arm.refusal import GoalRefusedError
from sojourn_flight.arm.relief import Ground
from sojourn_flight.arm.tip_following import CartesianPathError, FollowedPath, joints_along
from sojourn_flight.arm.tip_route import routes_along
from sojourn_flight.arm.tip_timing import TipTimingError, jerk_limited
from sojourn_flight.arm.trajectory import JointReference, stop
from sojourn_flight.arm.ways import Plan
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray

_NO_WAY = 1.0e-6
"""A leg that is shorter is none [m], [rad]."""


@dataclass(frozen=True, slots=True, eq=False)
class CheckedPath:
    """Joints along a path that collides with nothing, before it is timed."""

    brake: JointPath
    """To rest, before the path begins."""
    runs: tuple[tuple[FollowedPath, float], ...]
    """From stop to stop, each with the length of the tip's way [m]."""


def checked_path(
    params: TipPlanParams, model: ArmModel, goal: PathGoal, reference: JointReference, ground: Ground | None
) -> CheckedPath:
    """The joints that take the tip along a path, from where the arm is.

    Raises:
        GoalRefusedError: no points, or such as make no path; a place that cannot be reached on this way; a collision.
    """
    brake = stop(model, reference)
    posture = brake.sample(brake.duration)[0]
    collision = check_path(params, model, brake, ground)
    tip = forward_kinematics(model, posture)
    runs = []
    try:
        legs = _legs(params, goal, tip)
        turning = any(float(np.linalg.norm(leg.turn)) > _NO_WAY for leg in legs)
        task = task_of(params, model, turning)
        if turning and task == POSITION:
            raise GoalRefusedError("this arm can be told the place of its tip alone: allowed is no orientation")
        for route in routes_along(legs, params.tip_path.corner):
            followed = joints_along(model, route, posture, task, params.tip_path.tolerance)
            fine = followed.joints.at(np.linspace(0.0, followed.joints.end, 8 * len(followed.joints.spline.x)))[0]
            samples = refined(np.clip(fine, model.lower, model.upper), params.collision_step)
            collision = collision or check_samples(params, model, samples, ground, allow_start=True)
            if collision is not None:
                raise GoalRefusedError(collision.text())
            runs.append((followed, route.length))
            posture = fine[-1]
    except CartesianPathError as error:
        raise GoalRefusedError(str(error)) from error
    return CheckedPath(brake, tuple(runs))


def timed_path(params: TipPlanParams, model: ArmModel, path: CheckedPath) -> Plan:
    """The motion along a path within the limits of the joints and of the tip's speed.

    Raises:
        GoalRefusedError: it would take too long.
    """
    try:
        parts = [jerk_limited(model, followed, params.tip_path.speed / length) for followed, length in path.runs]
    except TipTimingError as error:
        raise GoalRefusedError(str(error)) from error
    whole = join([path.brake, *parts] if path.brake.duration > 0.0 else parts)
    end = whole.sample(whole.duration)[0]
    note = f"stops at {len(parts) - 1} of its corners" if len(parts) > 1 else ""
    return Plan(whole, end, forward_kinematics(model, end).position, None, 0.0, None, 0.0, note)


def task_of(params: PoseGoalParams, model: ArmModel, turning: bool) -> int:
    """What a motion of the tip asks of this arm: POSE, POINTING or POSITION; `turning`: a turn is asked for."""
    if model.moving_count > 5 or (turning and params.goal_orientation == "full"):
        return POSE
    return POINTING if model.moving_count == 5 else POSITION


def _legs(params: PoseGoalParams, goal: PathGoal, tip: TipPose) -> list[TipPath]:
    """Lines and arcs from the tip through all points."""
    if not goal.points:
        raise GoalRefusedError("path without points: at least one is needed")
    legs: list[TipPath] = []
    here, rotation, by_way_of = tip.position, tip.rotation, None
    for k, point in enumerate(goal.points):
        place, turned = pose_target(point.pose)[0], _turned(params, point.pose, rotation)
        if point.on_arc:
            if by_way_of is not None:
                raise GoalRefusedError(f"points {k - 1} and {k} are both on an arc: allowed is one before its end")
            by_way_of = place
            continue
        try:
            if by_way_of is None:
                leg = line(here, place, rotation, turned)
            else:
                leg = arc(here, by_way_of, place, rotation, turned)
        except InvalidValueError as error:
            raise GoalRefusedError(f"point {k}: {error}") from error
        if leg.length > _NO_WAY or math.sqrt(float(leg.turn @ leg.turn)) > _NO_WAY:
            legs.append(leg)
            here, rotation = place, turned
        by_way_of = None
    if by_way_of is not None:
        raise GoalRefusedError("the last point is on an arc: its end is to follow")
    if not legs:
        raise GoalRefusedError("the path has no length: the tip is there")
    return legs


def _turned(params: PoseGoalParams, pose: PoseGoal, before: FloatArray) -> FloatArray:
    """Rotation of the tip frame (3, 3) at a point of the path."""
    wanted = pose_target(pose)[1]
    if wanted is None:
        return before
    if wanted.ndim == 2:
        return wanted
    present = before @ np.array(params.tool_axis)
    axis, along = np.cross(present, wanted), float(present @ wanted)
    length = float(np.linalg.norm(axis))
    if length < 1e-9:  # the same, or the opposite: about any axis across it
        if along > 0.0:
            return before
        axis = np.cross(present, np.eye(3)[int(np.argmin(np.abs(present)))])
    angle = math.atan2(length, along)
    turn = Rotation.from_rotvec(angle * axis / np.linalg.norm(axis))
    return np.asarray(turn.as_matrix() @ before)
