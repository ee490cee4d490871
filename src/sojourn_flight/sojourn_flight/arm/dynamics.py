"""Rigid dynamics of a serial arm on a body that may stand tilted, move and turn.

    tau = M(q) qdd + c(q, qd) + g(q) + F(qd) - J' f
M with the rotors' inertia J_m G^2 on its diagonal; c: Coriolis and centrifugal; g: what holds against gravity; F:
friction (friction.py); f: force and moment on the tip from outside. Recursive Newton-Euler, composite rigid body and
articulated body algorithms (Featherstone, Rigid Body Dynamics Algorithms, 2008, chapters 5 to 7) of Pinocchio.

Base motion: an arm on an accelerated base feels as if gravity were  g - a_base  (Luh, Walker & Paul 1980). Turning of
the base enters too: here the base's velocity and acceleration are given to a copy of the arm on a free joint, whose own
effort is left out. Statics: tau = J' f, and back, the f of least norm with that tau.

Everything is in the frame of the base. Rotors turn about the joint axes only (see serial_arm.py).
"""

from dataclasses import dataclass

import numpy as np
import pinocchio

from sojourn_flight.arm.friction import friction_effort
from sojourn_flight.arm.manipulability import tip_jacobian
from sojourn_flight.arm.model import ArmModel
from sojourn_flight.arm.serial_arm import SerialArm
from sojourn_machine.params import FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class BaseMotion:
    """Motion of the base, seen in its own frame; all zero at rest."""

    angular_velocity: FloatArray  # (3,) [rad/s]
    linear_acceleration: FloatArray  # (3,) of its origin, without gravity [m/s2]
    angular_acceleration: FloatArray  # (3,) [rad/s2]


def mass_matrix(arm: SerialArm, positions: FloatArray) -> FloatArray:
    """M (n, n), rotors included [kg m2, kg m, kg]."""
    upper = np.triu(pinocchio.crba(arm.pinocchio_model, arm.data, positions))
    return np.asarray(upper + np.triu(upper, 1).T)


def coriolis_effort(arm: SerialArm, positions: FloatArray, velocities: FloatArray) -> FloatArray:
    """c(q, qd) (n,) [N m or N]."""
    return rigid_effort(arm, positions, velocities, np.zeros(arm.joint_count), np.zeros(3))


def gravity_effort(arm: SerialArm | ArmModel, positions: FloatArray, gravity: FloatArray) -> FloatArray:
    """g(q) (n,): what holds the arm at rest [N m or N], under `gravity` (3,) in the base, pointing down [m/s2]."""
    arm.pinocchio_model.gravity.linear = gravity
    return np.array(pinocchio.computeGeneralizedGravity(arm.pinocchio_model, arm.data, positions))


def rigid_effort(
    arm: SerialArm | ArmModel,
    positions: FloatArray,
    velocities: FloatArray,
    accelerations: FloatArray,
    gravity: FloatArray,
) -> FloatArray:
    """M qdd + c + g (n,) [N m or N]: inverse dynamics without friction."""
    arm.pinocchio_model.gravity.linear = gravity
    return np.array(pinocchio.rnea(arm.pinocchio_model, arm.data, positions, velocities, accelerations))


def inverse_dynamics(
    arm: SerialArm,
    positions: FloatArray,
    velocities: FloatArray,
    accelerations: FloatArray,
    gravity: FloatArray,
    tip_wrench: FloatArray | None = None,
    base: BaseMotion | None = None,
) -> FloatArray:
    """Efforts (n,) that the drives must give for a motion, friction included [N m or N].

    Args:
        gravity: in the base (3,) [m/s2], pointing down.
        tip_wrench: force [N] and moment [N m] on the tip from outside, in the base's directions (6,).
        base: motion of the base; at rest if left out.
    """
    if base is None:
        effort = rigid_effort(arm, positions, velocities, accelerations, gravity)
    else:
        effort = _effort_on_moving_base(arm, positions, velocities, accelerations, gravity, base)
    effort += friction_effort(arm.friction, velocities)
    if tip_wrench is not None:
        effort -= effort_of_wrench(arm, positions, tip_wrench)
    return effort


def effort_of_wrench(arm: SerialArm, positions: FloatArray, wrench: FloatArray) -> FloatArray:
    """J' f (n,): joint efforts that a force and moment (6,) on the tip amount to [N m or N]."""
    return np.asarray(tip_jacobian(arm, positions).T @ wrench)


def _effort_on_moving_base(
    arm: SerialArm,
    positions: FloatArray,
    velocities: FloatArray,
    accelerations: FloatArray,
    gravity: FloatArray,
    base: BaseMotion,
) -> FloatArray:
    free = pinocchio.Model()
    free.addJoint(0, pinocchio.JointModelFreeFlyer(), pinocchio.SE3.Identity(), "base")
    for i in range(1, arm.pinocchio_model.njoints):
        joint = arm.pinocchio_model.joints[i]
        index = free.addJoint(i, joint, arm.pinocchio_model.jointPlacements[i], arm.pinocchio_model.names[i])
        free.appendBodyToJoint(index, arm.pinocchio_model.inertias[i], pinocchio.SE3.Identity())
    free.gravity.linear = gravity
    q = np.concatenate([pinocchio.neutral(free)[:7], positions])
    # at this instant the base is where the world is: its origin at rest, turning about it
    v = np.concatenate([np.zeros(3), base.angular_velocity, velocities])
    a = np.concatenate([base.linear_acceleration, base.angular_acceleration, accelerations])
    effort = np.array(pinocchio.rnea(free, free.createData(), q, v, a))[6:]
    return effort + arm.motor_inertia * accelerations
