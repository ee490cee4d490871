"""Laws that make the joints of an arm follow a reference, from no feedback to a model in the loop.

effort = feed-forward + feedback, with the model M, c, g, friction F of whoever designed the law (it may be wrong), the
reference q_r, qd_r, qdd_r, the error e = q_r - q and its rate (Siciliano, Sciavicco, Villani & Oriolo, Robotics, 2009,
chapters 8 and 9):

    open_loop        M(q_r) qdd_r + c + g + F of the reference, no feedback
    pd               Kp e + Kd ed
    pid              the same, and Ki times the integral of e, which stands still while an effort is cut (anti-windup)
    pd_gravity       g(q) + Kp e + Kd ed
    feedforward      open_loop + Kp e + Kd ed
    computed_torque  M(q) (qdd_r + w^2 e + 2 w ed) + c + g + F: linear and decoupled, if the model is right
    impedance        what the reference needs at q, and at the tip a spring and a damper in space: J' (K x_e + D xd_e);
                     a tenth of the joints' own keeps what the tip does not feel (joints to spare, singular postures)

Gains: one bandwidth w for all, at given postures: Kp_i = w^2 m_i, Kd_i = 2 w m_i (damping ratio 1), Ki = Kp w/6, with
m_i = 1/(M^-1)_ii, the inertia that joint i feels while the others are free. The impedance has a sixth of w^2 times the
inertia that the tip feels in each of the six directions: then no frequency is above w, whatever the posture couples.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.spatial.transform import Rotation

from sojourn_flight.arm.dynamics import coriolis_effort, gravity_effort, mass_matrix, rigid_effort
from sojourn_flight.arm.friction import friction_effort
from sojourn_flight.arm.kinematics import forward_kinematics
from sojourn_flight.arm.serial_arm import SerialArm
from sojourn_machine.params import FloatArray

LawName = Literal["open_loop", "pd", "pid", "pd_gravity", "feedforward", "computed_torque", "impedance"]
LAWS: tuple[LawName, ...] = (
    "open_loop", "pd", "pid", "pd_gravity", "feedforward", "computed_torque", "impedance"
)  # fmt: skip
_SPARE = 0.1
"""Share of Kp and Kd by which the impedance keeps what the tip does not feel."""


@dataclass(frozen=True, slots=True, eq=False)
class Gains:
    """Gains of the laws for one arm."""

    bandwidth: float  # w [rad/s]
    proportional: FloatArray  # Kp (n,) [N m/rad or N/m]
    derivative: FloatArray  # Kd (n,)
    integral: FloatArray  # Ki (n,)
    tip_stiffness: FloatArray  # K (6,) [N/m, N m/rad]
    tip_damping: FloatArray  # D (6,)


@dataclass(frozen=True, slots=True, eq=False)
class Reference:
    """Position, velocity, acceleration (n,) each that the joints are to have."""

    position: FloatArray
    velocity: FloatArray
    acceleration: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class MeasuredJoints:
    """Position and velocity (n,) each that the joints have, and the integral of the position's error over time (n,)."""

    position: FloatArray
    velocity: FloatArray
    integral: FloatArray
    """Only pid uses it."""


def gains_for(model: SerialArm, postures: FloatArray, bandwidth: float) -> Gains:
    """Gains of a bandwidth [rad/s] for a posture (n,), or several (k, n): the smallest inertias among them count."""
    joints, tip = [], []
    for posture in np.atleast_2d(postures):
        mobility = np.linalg.inv(mass_matrix(model, posture))
        jacobian = forward_kinematics(model, posture).jacobian
        joints.append(np.diag(mobility))
        tip.append(np.diag(jacobian @ mobility @ jacobian.T))
    at_joints, at_tip = np.max(joints, axis=0), np.max(tip, axis=0)
    felt = np.where(at_tip > 1e-9 * at_tip.max(), 1.0 / np.maximum(6.0 * at_tip, 1e-12), 0.0)
    proportional, derivative = bandwidth**2 / at_joints, 2.0 * bandwidth / at_joints
    integral = proportional * bandwidth / 6.0
    return Gains(bandwidth, proportional, derivative, integral, bandwidth**2 * felt, 2.0 * bandwidth * felt)


def effort_of(
    law: LawName,
    model: SerialArm,
    gains: Gains,
    reference: Reference,
    measured: MeasuredJoints,
    gravity: FloatArray,
) -> FloatArray:
    """Efforts (n,) that a law asks for, before they are cut to what the motors can give."""
    q, qd = measured.position, measured.velocity
    error, rate = reference.position - q, reference.velocity - qd
    if law == "pd":
        return gains.proportional * error + gains.derivative * rate
    if law == "pid":
        return gains.proportional * error + gains.derivative * rate + gains.integral * measured.integral
    if law == "pd_gravity":
        return gravity_effort(model, q, gravity) + gains.proportional * error + gains.derivative * rate
    rubbing = friction_effort(model.friction, reference.velocity)
    if law in ("open_loop", "feedforward"):
        needed = rigid_effort(model, reference.position, reference.velocity, reference.acceleration, gravity) + rubbing
        return needed if law == "open_loop" else needed + gains.proportional * error + gains.derivative * rate
    inertia = mass_matrix(model, q)
    bias = coriolis_effort(model, q, qd) + gravity_effort(model, q, gravity) + rubbing
    if law == "computed_torque":
        wanted = reference.acceleration + gains.bandwidth**2 * error + 2.0 * gains.bandwidth * rate
        return np.asarray(inertia @ wanted + bias)
    tip, goal = forward_kinematics(model, q), forward_kinematics(model, reference.position)
    turn = Rotation.from_matrix(goal.rotation @ tip.rotation.T).as_rotvec()
    twist = goal.jacobian @ reference.velocity - tip.jacobian @ qd
    spring = gains.tip_stiffness * np.concatenate([goal.position - tip.position, turn])
    spare = _SPARE * (gains.proportional * error + gains.derivative * rate)
    return np.asarray(
        tip.jacobian.T @ (spring + gains.tip_damping * twist) + spare + inertia @ reference.acceleration + bias
    )


def feedback_of(law: LawName, model: SerialArm, gains: Gains, q: FloatArray) -> tuple[FloatArray, FloatArray]:
    """How a law's effort answers to small errors of position and velocity at q: two matrices (n, n).

    The integral of pid is slow and left out.
    """
    n = model.joint_count
    if law == "open_loop":
        return np.zeros((n, n)), np.zeros((n, n))
    if law == "computed_torque":
        inertia = mass_matrix(model, q)
        return gains.bandwidth**2 * inertia, 2.0 * gains.bandwidth * inertia
    if law == "impedance":
        jacobian = forward_kinematics(model, q).jacobian
        stiffness = jacobian.T @ (gains.tip_stiffness[:, None] * jacobian) + _SPARE * np.diag(gains.proportional)
        return stiffness, jacobian.T @ (gains.tip_damping[:, None] * jacobian) + _SPARE * np.diag(gains.derivative)
    return np.diag(gains.proportional), np.diag(gains.derivative)
