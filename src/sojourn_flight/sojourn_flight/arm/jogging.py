"""Jogging: the tip moves with a velocity that an operator keeps sending, and stops when the commands stop.

    q' = (J_lin; L J_ang)+ (v; L w)

by damped least squares; L is the characteristic length of the inverse kinematics. Arms of five joints keep to the turns
across the tool's axis, arms of fewer to the place alone, but for turns that they can do. Where a joint would be too
fast, or more power drawn than is granted, all joints are slower in proportion, so that the tip keeps its direction.

The joints follow these rates within their limits of acceleration and jerk (Berscheid & Kroeger, RSS 2021). Before every
period it is asked whether the arm could still stop after it: at no joint's limit, in no collision with the rover,
itself or the ground, and not nearer to a singular posture than where the smallest singular value of the matrix is
`singular_stop` L. If not, it goes slower, or stops as it was found that it can. So it comes to rest before what is in
the way, and can be jogged away from it. The tip is held to no line: what it drifts, the operator sees.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from sojourn_flight.arm.collision import check_posture, check_samples
from sojourn_flight.arm.inverse_search import POINTING, POSE, POSITION
from sojourn_flight.arm.joint_path import JointPath
from sojourn_flight.arm.kinematics import forward_kinematics
from sojourn_flight.arm.law_params import JoggingParams, SearchParams
from sojourn_flight.arm.model import ArmModel
from sojourn_flight.arm.motion_load import share_within
from sojourn_flight.arm.param_groups import PoseGoalParams
from sojourn_flight.arm.refusal import GoalRefusedError
from sojourn_flight.arm.relief import Ground
from sojourn_flight.arm.tip_plan import task_of
from sojourn_flight.arm.trajectory import JointReference, at_rest, stop, towards_rates
from sojourn_machine.params import FloatArray

_DAMPING = 1.0e-3
"""Of the least squares [m]: singular values below are hardly used."""
_SLOWER = 0.6
"""Share of the speed that is tried next, where the arm could not stop in time."""
_FASTER = 0.04
"""Most by which the share of the speed rises in a period."""
_LEAST = 0.01
"""A smaller share of the speed is none."""
_LEFT_UNDONE = 0.05
"""Share of a command that an arm of few joints may leave undone."""
_STILL = 1.0e-9


@dataclass(frozen=True, slots=True)
class JogCommand:
    """Wanted velocity of the tip, in base_link or, `of_tool`, in the tip's frame."""

    linear: tuple[float, float, float]  # [m/s]
    angular: tuple[float, float, float]  # [rad/s]
    of_tool: bool = False
    age: float = 0.0  # when it takes effect [s]


@dataclass(frozen=True, slots=True)
class Jogging:
    """A jog under way: a plain value."""

    command: JogCommand
    age: float  # of the command [s]
    near: bool = False  # it began nearer to something than the clearance
    share: float = 1.0  # of the wanted speed, for what is in the way
    held: str = ""  # what that is
    moving: bool = True
    reason: str = ""


@dataclass(frozen=True, slots=True)
class Surroundings:
    """What a jog must heed beside the arm itself."""

    ground: Ground | None
    gravity: FloatArray  # in base_link (3,) [m/s2]
    hindrance: str = ""  # why the arm may not move, in words
    limited_power: bool = False  # the parameters hold a power or an effort that is less than the arm's own


def begin_jog(
    params: JoggingParams, model: ArmModel, command: JogCommand, posture: FloatArray, ground: Ground | None
) -> Jogging:
    """The jog that a command asks for, with the arm at joint positions (n,).

    Raises:
        GoalRefusedError: not finite, faster than is allowed, or a turn that this arm cannot be asked for.
    """
    limits = params.jog
    for name, vector, most, unit in (
        ("linear", command.linear, limits.speed, "m/s"),
        ("angular", command.angular, limits.turning, "rad/s"),
    ):
        size = float(np.linalg.norm(vector))
        if not size <= most * (1.0 + 1e-9):
            raise GoalRefusedError(f"{name} velocity of {size:.3f} {unit}: allowed is at most {most:g} {unit}")
    turn, task = np.array(command.angular), _task(params, model, command)
    if np.any(turn) and task == POSITION:
        raise GoalRefusedError("angular velocity: this arm can be told the place of its tip alone: allowed is zero")
    if np.any(turn) and task == POSE and model.moving_count < 6 and not _can_turn(params, model, command, posture):
        raise GoalRefusedError(f"angular velocity: {model.moving_count} joints cannot turn the tool like that")
    if task == POINTING:
        tip = forward_kinematics(model, posture)
        tool = np.array(params.tool_axis) if command.of_tool else tip.tool_direction
        about = abs(float(tool @ turn))
        if about > 0.5 * float(np.linalg.norm(turn)) > 0.0:
            raise GoalRefusedError(
                f"angular velocity of {about:.3f} rad/s about the tool's axis: five joints turn the tool's direction "
                "alone: allowed is a turn across that axis"
            )
    near = check_posture(params, model, posture, ground) is not None
    return Jogging(command, command.age, near)


def jog_on(
    params: JoggingParams, model: ArmModel, jogging: Jogging, here: JointReference, around: Surroundings, dt: float
) -> tuple[Jogging, JointReference]:
    """The jog, and the joints' reference, a period of `dt` [s] later."""
    command, reason, share, held = jogging.command, "", 1.0, ""
    rates, there = np.zeros(model.joint_count), here
    if around.hindrance:
        reason = around.hindrance
    elif jogging.age > params.jog.timeout:
        reason = f"stopped: /arm/cmd_vel is older than {params.jog.timeout:.2f} s"
    elif np.any(command.linear) or np.any(command.angular):
        rates, reason = _wanted_rates(params, model, command, here.position, around)
        there, share, held = _as_is_safe(params, model, jogging, here, rates, around.ground, dt)
        reason = f"held before {held}" if held else reason
    if not np.any(rates):
        there = _after(stop(model, here), np.zeros(model.joint_count), dt)
    still = float(np.max(np.abs(there.velocity))) < _STILL and float(np.max(np.abs(there.acceleration))) < _STILL
    if still:
        there = at_rest(there.position)
    moving = bool(np.any(rates)) or not still
    return replace(jogging, age=jogging.age + dt, share=share, held=held, moving=moving, reason=reason), there


def _wanted_rates(
    params: JoggingParams, model: ArmModel, command: JogCommand, positions: FloatArray, around: Surroundings
) -> tuple[FloatArray, str]:
    """Joint rates (n,) [rad/s or m/s] for a command, and why the tip is slower than it asks for."""
    matrix, wanted = _task_matrix(params, model, command, positions), _wanted(params, model, command, positions)
    left, values, right = np.linalg.svd(matrix, full_matrices=False)
    rates = right.T @ (values / (values**2 + _DAMPING**2) * (left.T @ wanted[: matrix.shape[0]]))
    shares = model.max_velocity / np.maximum(np.abs(rates), 1e-12)
    worst = int(np.argmin(shares))
    reason = f"slowed: {model.joint_names[worst]} at its fastest" if shares[worst] < 1.0 else ""
    rates = min(float(shares[worst]), 1.0) * rates
    if around.limited_power:
        granted, text = share_within(params, model, positions, rates, np.zeros(model.joint_count), around.gravity)
        rates, reason = granted * rates, f"slowed: {text}" if granted < 1.0 else reason
    return rates, reason


def _task(params: PoseGoalParams, model: ArmModel, command: JogCommand) -> int:
    return task_of(params, model, bool(np.any(command.angular)))


def _wanted(params: SearchParams, model: ArmModel, command: JogCommand, positions: FloatArray) -> FloatArray:
    """(v; L w) of a command in base_link (6,) [m/s]."""
    turn = forward_kinematics(model, positions).rotation if command.of_tool else np.eye(3)
    length = params.inverse_kinematics.characteristic_length
    return np.concatenate([turn @ np.array(command.linear), length * (turn @ np.array(command.angular))])


def _task_matrix(params: JoggingParams, model: ArmModel, command: JogCommand, positions: FloatArray) -> FloatArray:
    """(J_lin; L J_ang), (6, n), or its first rows for a place alone (3, n) [m]."""
    tip, task = forward_kinematics(model, positions), _task(params, model, command)
    if task == POSITION:
        return tip.jacobian[:3]
    turning = tip.jacobian[3:]
    if task == POINTING:
        turning = turning - np.outer(tip.tool_direction, tip.tool_direction @ turning)
    return np.vstack([tip.jacobian[:3], params.inverse_kinematics.characteristic_length * turning])


def _can_turn(params: JoggingParams, model: ArmModel, command: JogCommand, positions: FloatArray) -> bool:
    """Whether few joints can do all that a command asks for."""
    matrix, wanted = _task_matrix(params, model, command, positions), _wanted(params, model, command, positions)
    done = matrix @ np.linalg.lstsq(matrix, wanted, rcond=1e-9)[0]
    return float(np.linalg.norm(done - wanted)) <= _LEFT_UNDONE * float(np.linalg.norm(wanted))


def _least_singular_value(params: JoggingParams, model: ArmModel, command: JogCommand, positions: FloatArray) -> float:
    """Of the matrix [m], leaving out those that are always zero."""
    task = _task(params, model, command)
    rank = min(3 if task == POSITION else 5 if task == POINTING else 6, model.moving_count)
    return float(np.linalg.svd(_task_matrix(params, model, command, positions), compute_uv=False)[rank - 1])


def _as_is_safe(
    params: JoggingParams,
    model: ArmModel,
    jogging: Jogging,
    here: JointReference,
    rates: FloatArray,
    ground: Ground | None,
    dt: float,
) -> tuple[JointReference, float, str]:
    """The reference a period later, the share of the rates that it goes for, and before what it is held."""
    share, why = min(jogging.share + _FASTER, 1.0), ""
    while share >= _LEAST:
        there = _after(towards_rates(model, here, share * rates), share * rates, dt)
        brake = stop(model, there)
        postures = np.vstack([here.position, brake.samples(_instants(brake, params.collision_step, dt))])
        found = _hindrance(params, model, jogging, brake, postures, ground)
        if not found:
            return there, share, why or (jogging.held if share < 1.0 else "")
        why, share = why or found, share * _SLOWER
    return _after(stop(model, here), np.zeros(model.joint_count), dt), _LEAST, why


def _hindrance(
    params: JoggingParams,
    model: ArmModel,
    jogging: Jogging,
    brake: JointPath,
    postures: FloatArray,
    ground: Ground | None,
) -> str:
    """What is met before the arm has come to rest, in words; empty where nothing is. Postures (m, n): now, and then
    along the brake.
    """
    low, high = brake.extremes()[:2]
    out = (low < np.minimum(model.lower, postures[0])) | (high > np.maximum(model.upper, postures[0]))
    if out.any():
        return f"the limit of {model.joint_names[int(np.argmax(out))]}"
    end = _least_singular_value(params, model, jogging.command, brake.sample(brake.duration)[0])
    least = params.jog.singular_stop * params.inverse_kinematics.characteristic_length
    if end < least and end < _least_singular_value(params, model, jogging.command, postures[0]):
        return "a singular posture"
    collision = check_samples(params, model, postures if jogging.near else postures[1:], ground, jogging.near)
    return "" if collision is None else f"a collision of {collision.first} and {collision.second}"


def _instants(brake: JointPath, step: float, dt: float) -> FloatArray:
    """Times on a way to rest [s], its ends included, no joint more than `step` between two. Those of the periods of
    `dt` are among them, as where the arm stands then must be clear by itself.
    """
    fastest = float(np.max(brake.extremes()[2]))
    spacing = dt / max(1, math.ceil(fastest * dt / step))
    return np.append(np.arange(0.0, brake.duration, spacing), brake.duration)


def _after(path: JointPath, rates: FloatArray, dt: float) -> JointReference:
    """The reference `dt` [s] on; beyond the path it goes on with `rates` (n,)."""
    position, velocity, acceleration = path.sample(min(dt, path.duration))
    if dt <= path.duration:
        return JointReference(position, velocity, acceleration)
    return JointReference(position + (dt - path.duration) * rates, rates, np.zeros(len(rates)))
