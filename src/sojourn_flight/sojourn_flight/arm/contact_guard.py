"""Contacts that nobody asked for: felt in every motion, by the wrist's sensor and by the torques of all joints.

Torques: a contact anywhere on the arm is in the residual of the generalised momentum p = M(q) q' (De Luca & Mattone
2003, IEEE CDC; Haddadin, De Luca & Albu-Schaeffer 2017, IEEE Trans. Robotics 33(6):1292, section IV-E),

    r = K [p - p(0) - integral (tau + C' q' - g + r) dt],        r' = K (tau_ext - r)

tau: measured torques that the joints give to the links, so that no friction of the motors is in it. Where torques are
measured behind a gear that gives, M is without the rotors. What the model does not know (payload, bearings) is allowed
for by a share of each joint's largest effort.

A motion is given up where, beyond what was felt when it began, the wrist feels `force`, or a joint the torque of that
force at the tip. What was felt at the beginning is forgotten as it fades: an arm that leaves the ground may press at
first. Then the arm gives way, each joint after the torque that is felt at it (admittance: q'_i = tau_i/(n D |J_i|^2)
moves the tip with at most f/D), until it presses no more. It starts where it is, not where it should be: what the
servos had run ahead is taken back at once.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import pinocchio

from sojourn_flight.arm.contact_params import ContactParams
from sojourn_flight.arm.footing import FootingLoads
from sojourn_flight.arm.kinematics import TipPose
from sojourn_flight.arm.model import ArmModel
from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray
from sojourn_machine.vectors import length

_LEAST_LEVER = 0.05
"""Of the tip about a joint, in shares of the arm's reach: nearer to the axis counts as this."""


@dataclass(frozen=True, slots=True)
class Felt:
    """What the arm feels from outside."""

    force: FloatArray | None = None
    """On the tool, in base_link (3,) [N]; None without a wrist's sensor."""
    torque: FloatArray | None = None
    """At the joints (n,) [N m or N], of all contacts; None where torques are not told."""


class JointReading(NamedTuple):
    """Of the joints as measured, (n,) each."""

    positions: FloatArray
    velocities: FloatArray
    efforts: FloatArray


@dataclass(frozen=True, slots=True)
class MomentumObserver:
    """State of the observer; `integral` is None before the first reading."""

    integral: FloatArray | None = None
    residual: FloatArray | None = None


@dataclass(frozen=True, slots=True)
class Before:
    """Sizes of what was felt when a motion began, or less: |force| [N], |torque| (n,)."""

    force: float
    torque: FloatArray


def observe(
    model: ArmModel,
    observer: MomentumObserver,
    rotors: bool,
    joints: JointReading,
    gravity: FloatArray,
    rate: float,
    dt: float,
) -> MomentumObserver:
    """The observer after a reading.

    Args:
        rotors: the measured efforts move the rotors, too.
        gravity: in base_link (3,) [m/s2]. rate: K [1/s].
    """
    positions, velocities, efforts = joints
    rigid, data = model.pinocchio_model, model.data
    mass = np.empty((len(positions), len(positions)))
    _mass_from_upper(pinocchio.crba(rigid, data, positions), model.rotor_inertia, rotors, mass)
    momentum = mass @ velocities
    integral = momentum if observer.integral is None else observer.integral
    residual = rate * (momentum - integral)
    rigid.gravity.linear = gravity
    weight = np.array(pinocchio.computeGeneralizedGravity(rigid, data, positions))
    coriolis = pinocchio.computeCoriolisMatrix(rigid, data, positions, velocities)
    change = efforts + coriolis.T @ velocities - weight + residual
    return MomentumObserver(integral + dt * change, residual)


@njit(cache=True)
def _mass_from_upper(upper: FloatArray, rotors: FloatArray, with_rotors: bool, mass: FloatArray) -> None:
    """The mass matrix (n, n) of its upper triangle, with or without the inertia of the rotors (n,), into `mass`."""
    for i in range(mass.shape[0]):
        for j in range(i, mass.shape[0]):
            mass[i, j] = mass[j, i] = upper[i, j]
        if not with_rotors:
            mass[i, i] -= rotors[i]


def before(felt: Felt, count: int) -> Before:
    """What is felt now, for a motion of `count` joints that begins."""
    force = 0.0 if felt.force is None else length(felt.force)
    return Before(force, np.zeros(count) if felt.torque is None else np.abs(felt.torque))


def faded(known: Before, felt: Felt) -> Before:
    """The less of what was felt before and of what is felt now."""
    now = before(felt, known.torque.shape[0])
    return Before(min(known.force, now.force), np.minimum(known.torque, now.torque))


def touched(params: ContactParams, model: ArmModel, tip: TipPose, known: Before, felt: Felt) -> str:
    """What is felt and may not be, in words; empty where nothing is."""
    if felt.force is not None:
        force = length(felt.force)
        if force > known.force + params.force:
            return f"the tool pressed with {force:.0f} N (at most {params.force:g} N is allowed)"
    if felt.torque is not None:
        beyond = np.abs(felt.torque) - known.torque - params.force * levers(model, tip) - _unknown(params, model)
        beyond[list(model.held)] = -np.inf  # what a joint that does not move holds is no contact
        worst = int(np.argmax(beyond))
        if beyond[worst] > 0.0:
            unit = model.effort_unit(worst)
            return f"{abs(felt.torque[worst]):.1f} {unit} from outside were felt at {model.joint_names[worst]}"
    return ""


def yielding_rates(params: ContactParams, model: ArmModel, tip: TipPose, felt: Felt) -> FloatArray:
    """Rates (n,) [rad/s or m/s] with which the joints give way to what is felt; zero where it is little."""
    count = model.joint_count
    torque = np.zeros(count)
    if felt.torque is not None:
        torque = _beyond(felt.torque, _unknown(params, model))
        torque[list(model.held)] = 0.0
    if felt.force is not None:
        size = length(felt.force)
        share = max(1.0 - params.released_force / size, 0.0) if size > 0.0 else 0.0
        at_tip = tip.jacobian[:3].T @ (share * felt.force)
        torque = np.where(np.abs(at_tip) >= np.abs(torque), at_tip, torque)
    rates = torque / (count * params.damping * levers(model, tip) ** 2)
    fastest = length(tip.jacobian[:3] @ rates)
    share = min(1.0, params.max_speed / max(fastest, 1e-12))
    share = min(share, float(np.min(model.max_velocity / np.maximum(np.abs(rates), 1e-12))))
    return np.asarray(share * rates)


def levers(model: ArmModel, tip: TipPose) -> FloatArray:
    """Way of the tip per way of each joint (n,) [m/rad or 1], at least a little."""
    least = np.where(model.chain.revolute > 0.5, _LEAST_LEVER * model.reach, 1.0)
    return np.asarray(np.maximum(np.linalg.norm(tip.jacobian[:3], axis=0), least))


def lifted(params: ContactParams, loads: FootingLoads, force: FloatArray) -> str:
    """Which wheel a force (3,) [N] on the tool all but lifts, in words; empty where none is."""
    wheel, share = loads.least_share(force)
    if share >= params.least_wheel_load:
        return ""
    return (
        f"the tool pressed with {length(force):.0f} N, which leaves wheel {loads.names[wheel]} "
        f"{100.0 * max(share, 0.0):.0f} % of its load (at least {100.0 * params.least_wheel_load:g} %)"
    )


def _unknown(params: ContactParams, model: ArmModel) -> FloatArray:
    return np.asarray(params.unknown_share * model.max_effort)


def _beyond(values: FloatArray, limits: FloatArray) -> FloatArray:
    """What of the values is beyond limits, both ways."""
    return np.asarray(values - np.clip(values, -limits, limits))
