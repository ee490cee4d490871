"""Joint references that move the tip with a velocity that is decided anew at every period, the tool's direction held.

    q' = W (J_lin; E J_ang)⁺ ((p + v dt - p(q))/dt; error of the direction/dt)

Closed-loop inverse kinematics (Siciliano et al. 2009, section 3.7) with damped least squares: the reference of the tip
p integrates the wanted velocity, and what the joints are behind it is taken up in the next period. E keeps the two
turns across the tool's axis. The speed of the tip changes by no more than `tip_acceleration`, that of a joint by no
more than its own limit: where one would have to do more, all of them do less. Jerk is not limited here, or a contact
could not be answered; a pause, and less power, change the wanted velocity within it (guided_pace.py).
"""

from dataclasses import dataclass, replace

import numpy as np

from sojourn_flight.arm.kinematics import TipPose, forward_kinematics
from sojourn_flight.arm.model import ArmModel
from sojourn_flight.arm.trajectory import JointReference, at_rest
from sojourn_machine.errors import MachineError
from sojourn_machine.params import FloatArray

DAMPING = 1e-5
"""Of the least squares [m2]."""
POINTING_LENGTH = 0.1
"""Weight of one radian of pointing against position [m]."""
LEFT_BEHIND = 0.01
"""Distance of the tip from its reference at which the arm cannot follow [m]."""


class CannotFollowError(MachineError):
    """The arm cannot follow the motion of the tip; the message says why."""


@dataclass(frozen=True, slots=True)
class TipMotion:
    """Reference of the tip and of the joints."""

    joints: JointReference
    place: FloatArray  # of the tip in base_link (3,) [m]
    velocity: FloatArray  # (3,) [m/s]
    direction: FloatArray  # of the tool, held (3,)
    origin: FloatArray | None  # joint positions (n,) at which the motion began: it is left again by way of them


def begin(model: ArmModel, reference: JointReference) -> TipMotion:
    """From where the reference is, at its speed."""
    tip = forward_kinematics(model, reference.position)
    velocity = np.asarray(tip.jacobian[:3] @ reference.velocity)
    return TipMotion(reference, tip.position, velocity, tip.tool_direction, reference.position)


def begin_at(model: ArmModel, positions: FloatArray) -> TipMotion:
    """From rest at joint positions (n,)."""
    return begin(model, at_rest(positions))


def turn_joints(model: ArmModel, motion: TipMotion, rates: FloatArray, dt: float) -> TipMotion:
    """One period of `dt` [s] with joint rates (n,), which stop at the limits of their positions."""
    before = motion.joints
    position = np.clip(before.position + rates * dt, model.lower, model.upper)
    moved = (position - before.position) / dt
    tip = forward_kinematics(model, position)
    joints = JointReference(position, moved, np.zeros(model.joint_count))
    velocity = np.asarray(tip.jacobian[:3] @ moved)
    return replace(motion, joints=joints, place=tip.position, velocity=velocity, direction=tip.tool_direction)


def rates_of(model: ArmModel, motion: TipMotion, velocity: FloatArray) -> FloatArray:
    """Joint rates (n,) with which the tip has a velocity (3,) [m/s], and the tool keeps its direction."""
    return _joint_rates(forward_kinematics(model, motion.joints.position), velocity, np.zeros(3))


def _joint_rates(tip: TipPose, velocity: FloatArray, turning: FloatArray) -> FloatArray:
    """Joint rates (n,) for a velocity of the tip (3,) [m/s] and a turn of the tool's direction (3,) [rad/s]."""
    across = np.eye(3) - np.outer(tip.tool_direction, tip.tool_direction)
    matrix = np.vstack([tip.jacobian[:3], POINTING_LENGTH * across @ tip.jacobian[3:]])
    wanted = np.concatenate([velocity, POINTING_LENGTH * turning])
    damped = matrix.T @ matrix + DAMPING * np.eye(matrix.shape[1])
    return np.asarray(np.linalg.solve(damped, matrix.T @ wanted), dtype=np.float64)


def move(model: ArmModel, motion: TipMotion, wanted: FloatArray, acceleration: float, dt: float) -> TipMotion:
    """One period of `dt` [s] with the wanted velocity (3,) [m/s], `acceleration` [m/s2] at most.

    Raises:
        CannotFollowError: a joint at its limit, or a posture near which the tip cannot move that way.
    """
    change = wanted - motion.velocity
    size = float(np.linalg.norm(change))
    if size > acceleration * dt:
        change *= acceleration * dt / size
    velocity = motion.velocity + change
    place = motion.place + velocity * dt
    here = motion.joints
    tip = forward_kinematics(model, here.position)
    turn = np.cross(tip.tool_direction, motion.direction)
    rates = _joint_rates(tip, (place - tip.position) / dt, turn / dt)
    change = rates - here.velocity
    share = float(np.min(model.max_acceleration * dt / np.maximum(np.abs(change), 1e-12)))
    fastest = float(np.max(np.abs(here.velocity + min(share, 1.0) * change) / model.max_velocity))
    if share < 1.0 or fastest > 1.0:  # the tip does what the joints can: nothing is made up for later
        rates = np.asarray((here.velocity + min(share, 1.0) * change) / max(fastest, 1.0), dtype=np.float64)
        velocity = np.asarray(tip.jacobian[:3] @ rates)
        place = tip.position + velocity * dt
    position = here.position + rates * dt
    beyond = np.flatnonzero((position < model.lower) | (position > model.upper))
    if beyond.size:
        raise CannotFollowError(f"{model.joint_names[beyond[0]]} has come to its limit")
    if float(np.linalg.norm(place - tip.position)) > LEFT_BEHIND:
        raise CannotFollowError("the arm cannot follow the tip here: it is stretched out or near a singular posture")
    joints = JointReference(position, rates, (rates - here.velocity) / dt)
    return replace(motion, joints=joints, place=place, velocity=velocity)
