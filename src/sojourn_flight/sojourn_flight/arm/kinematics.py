"""Forward and inverse kinematics of the tip in base_link.

The direction of a goal is that of the tool axis (`PoseGoalParams.tool_axis`, fixed in the tip frame). A goal
given as a pose asks for the position of the tip and for the direction that its orientation gives to the
tool axis; the roll about the tool axis is left free, so that a five-joint arm can answer. An arm whose
`goal_orientation` is full is asked for the roll, too: six joints and more reach any, fewer those that they can (a SCARA
any turn about its quill). An identity or an all-zero quaternion stands for "pointing free".

Inverse: damped least squares with limits (see inverse_search.py) from the present position, the named poses, then a
low-discrepancy set of starts, always the same ones. Solutions are sorted by their distance from the present position.
When none is found, a search without joint limits tells a target beyond the limits from one beyond the
reach.

Range: joints of one degree of freedom; closest approach to an unreachable target is that of the best local
minimum.
"""

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from sojourn_flight.arm.chain import ChainArm, tip_kinematics
from sojourn_flight.arm.inverse_search import POINTING, POSE, POSITION, SearchSettings, TipTarget, search, spread
from sojourn_flight.arm.law_params import PoseSearchParams, SearchParams
from sojourn_flight.arm.model import ArmModel
from sojourn_flight.arm.param_groups import PoseGoalParams
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray

SearchStatus = Literal["solved", "unreachable", "limits", "collision"]


@dataclass(frozen=True, slots=True)
class TipPose:
    """Pose of the tip frame and its Jacobian, in base_link."""

    position: FloatArray  # (3,) [m]
    rotation: FloatArray  # (3, 3) tip to base_link
    tool_direction: FloatArray  # (3,) unit
    jacobian: FloatArray  # (6, n) linear then angular velocity per joint rate


@dataclass(frozen=True, slots=True)
class InverseResult:
    """Answer of the inverse kinematics."""

    status: SearchStatus
    solutions: tuple[FloatArray, ...]  # (n,) each, nearest to the start first
    position_error: float  # nearest approach within the joint limits [m]
    pointing_error: float  # at that approach [rad]
    message: str  # empty when solved


def forward_kinematics(model: ChainArm, positions: FloatArray) -> TipPose:
    """Tip pose at joint `positions` (n,) [rad or m]."""
    rotation, position, jacobian = np.empty((3, 3)), np.empty(3), np.empty((6, model.joint_count))
    tip_kinematics(model.chain, positions, rotation, position, jacobian)
    return TipPose(position, rotation, rotation @ model.chain.tool_axis, jacobian)


def direction_from_quaternion(params: PoseGoalParams, quaternion_xyzw: FloatArray) -> FloatArray | None:
    """Tool direction (3,) in base_link that a tip orientation asks for; None (free) for identity or all zero.

    Args:
        quaternion_xyzw: orientation of the tip frame in base_link (4,).

    Raises:
        InvalidValueError: not finite, or a length that is neither 0 nor within 1 % of 1.
    """
    quaternion = np.asarray(quaternion_xyzw, dtype=np.float64)
    if quaternion.shape != (4,) or not np.all(np.isfinite(quaternion)):
        raise InvalidValueError("orientation", quaternion.tolist(), "four finite numbers x, y, z, w")
    if not np.any(quaternion):
        return None
    length = float(np.linalg.norm(quaternion))
    if abs(length - 1.0) > 0.01:
        raise InvalidValueError("orientation", quaternion.tolist(), "a unit quaternion, or all zero for free pointing")
    vector, scalar = quaternion[:3] / length, float(quaternion[3]) / length
    if float(np.max(np.abs(vector))) < 1e-9:
        return None
    axis = np.array(params.tool_axis)
    turned = 2.0 * np.cross(vector, axis)
    return np.asarray(axis + scalar * turned + np.cross(vector, turned), dtype=np.float64)


def inverse_kinematics(
    params: PoseSearchParams,
    model: ArmModel,
    position: FloatArray,
    direction: FloatArray | None,
    start: FloatArray,
    explain: bool = True,
) -> InverseResult:
    """Joint positions that put the tip at `position` and the tool along `direction`.

    Args:
        position: in base_link (3,) [m].
        direction: unit vector in base_link (3,); rotation of the tip frame to base_link (3, 3); None for free pointing.
        start: joint positions (n,) that solutions are to be near to.
        explain: look for the reason if there is no solution; if false: 'unreachable', no message.
    """
    settings = _settings(params)
    target = _target(params, position, direction)
    solutions: list[FloatArray] = []
    nearest, nearest_angle, nearest_cost = math.inf, math.inf, math.inf
    enough = params.inverse_kinematics.starts_when_solved
    for k, guess in enumerate(_starts(params, model, start)):
        if solutions and (k >= enough or len(solutions) >= params.inverse_kinematics.solutions):
            break
        q, distance, angle = search(model.chain, guess, model.lower, model.upper, target, settings)
        cost = distance * distance + (target.weight * angle) ** 2
        if cost < nearest_cost:
            nearest, nearest_angle, nearest_cost = distance, angle, cost
        if distance < settings.position_tolerance and angle < settings.angle_tolerance and _is_new(q, solutions):
            solutions.append(q)
    if solutions:
        solutions.sort(key=lambda q: float(np.max(np.abs(q - start))))
        return InverseResult("solved", tuple(solutions), nearest, nearest_angle, "")
    if not explain:
        return InverseResult("unreachable", (), nearest, nearest_angle, "")
    return _explain(params, model, position, direction, start, nearest, nearest_angle)


def nearby_solution(
    params: PoseSearchParams, model: ArmModel, position: FloatArray, direction: FloatArray | None, start: FloatArray
) -> FloatArray | None:
    """One search from `start` only: joint positions (n,) on the same branch, or None. Arguments as above."""
    settings = _settings(params)
    target = _target(params, position, direction)
    q, distance, angle = search(model.chain, start, model.lower, model.upper, target, settings)
    return q if distance < settings.position_tolerance and angle < settings.angle_tolerance else None


def _explain(
    params: PoseSearchParams,
    model: ArmModel,
    position: FloatArray,
    direction: FloatArray | None,
    start: FloatArray,
    nearest: float,
    angle: float,
) -> InverseResult:
    """Why there is no solution: the limits, or the reach."""
    where = _where(position)
    off = f"nearest approach {nearest * 1e3:.1f} mm"
    if direction is not None:
        off += f" and {math.degrees(angle):.1f} deg"
        alone = inverse_kinematics(params, model, position, None, start, explain=False)
        if alone.status == "solved":
            asked = "pointing" if direction.ndim == 1 else "orientation"
            off += f"; the position alone can be reached, not with this {asked}"
    settings = _settings(params)
    target = _target(params, position, direction)
    wide_lower = np.where(model.chain.revolute > 0.5, -50.0, model.lower)
    wide_upper = np.where(model.chain.revolute > 0.5, 50.0, model.upper)
    best_excess, best_text = math.inf, ""
    for guess in _starts(params, model, start)[: max(8, params.inverse_kinematics.starts_when_solved)]:
        q, distance, turn = search(model.chain, guess, wide_lower, wide_upper, target, settings)
        if distance < settings.position_tolerance and turn < settings.angle_tolerance:
            middle = 0.5 * (model.lower + model.upper)
            wrapped = middle + np.remainder(q - middle + math.pi, 2.0 * math.pi) - math.pi
            q = np.where(model.chain.revolute > 0.5, wrapped, q)
            excess = np.maximum(q - model.upper, model.lower - q)
            if float(np.max(excess)) < best_excess:
                best_excess = float(np.max(excess))
                best_text = ", ".join(
                    f"{model.joint_names[i]} would be {q[i]:.3f} {model.unit(int(i))} (limits {model.lower[i]:.3f} to "
                    f"{model.upper[i]:.3f})"
                    for i in np.flatnonzero(excess > 0.0)
                )
    if best_text:
        message = f"target {where} is outside the joint limits: {best_text}; {off}"
        return InverseResult("limits", (), nearest, angle, message)
    return InverseResult("unreachable", (), nearest, angle, f"target {where} is unreachable: {off}")


def _target(params: SearchParams, position: FloatArray, direction: FloatArray | None) -> TipTarget:
    weight = params.inverse_kinematics.characteristic_length
    wanted = np.eye(3)
    if direction is None:
        return TipTarget(POSITION, position, wanted, weight)
    if direction.ndim == 2:
        return TipTarget(POSE, position, np.ascontiguousarray(direction), weight)
    wanted[:, 2] = direction
    return TipTarget(POINTING, position, wanted, weight)


def _where(position: FloatArray) -> str:
    return f"({position[0]:.3f}, {position[1]:.3f}, {position[2]:.3f}) m in base_link"


def _settings(params: SearchParams) -> SearchSettings:
    s = params.inverse_kinematics
    return SearchSettings(s.position_tolerance, s.pointing_tolerance, s.damping_bias, s.max_step, s.max_iterations)


def _starts(params: PoseSearchParams, model: ArmModel, start: FloatArray) -> list[FloatArray]:
    """The same list of starts for the same start position."""
    count, n = params.inverse_kinematics.starts, model.joint_count
    named = [np.array(values) for values in params.named_poses.values()]
    spread_out = [model.lower + row * (model.upper - model.lower) for row in spread(n, count + 1)[1:]]
    return [start.copy(), *named, *spread_out][:count]


def _is_new(q: FloatArray, found: list[FloatArray]) -> bool:
    return all(float(np.max(np.abs(q - other))) > 0.05 for other in found)
