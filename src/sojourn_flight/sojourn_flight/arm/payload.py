"""Mass and centre of mass of a payload at the tip, from the joint torques at rest in several postures.

A mass m whose centre is at r in the tip's frame adds to the torque of joint i, at rest,

    τ = -J_linᵀ g m - J_angᵀ (R (m r) × g)                              (linear in m and m r; Siciliano et al. 2009,
    sec. 7.3)

so that the torques of k postures, less those of the arm alone, give (m, m r) by least squares. Torques are those that
the joints give to the links, as the joints' telemetry tells them. Postures must differ: with one alone the places of
the mass along gravity cannot be told apart, and those directions are left at zero (pseudo-inverse).

The standard deviation follows from the residuals: σ² = |A x - b|²/(rows - rank), cov x = σ² (AᵀA)⁻¹ (Gauss-Markov).
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from sojourn_flight.arm.dynamics import rigid_effort
from sojourn_flight.arm.kinematics import forward_kinematics
from sojourn_flight.arm.model import ArmModel
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray


class StillPosture(NamedTuple):
    """What is known of the arm at rest in one posture."""

    positions: FloatArray
    """Of the joints, (n,) [rad or m]."""
    efforts: FloatArray
    """Of the joints, mean over some time, (n,) [N m or N]."""
    gravity: FloatArray
    """In base_link, (3,) [m/s2]."""


class Payload(NamedTuple):
    """A mass at the tip."""

    mass: float
    """[kg]"""
    mass_deviation: float
    """Standard deviation of it that the residuals tell [kg]; infinite where they cannot."""
    centre: FloatArray
    """Of mass in the tip's frame (3,) [m]; zero where the mass is none."""
    residual: float
    """Root mean square of what is left of the torques [N m]."""


def regressor(model: ArmModel, posture: StillPosture) -> FloatArray:
    """Matrix (n, 4) from (m, m r) to the joint torques that carry the payload."""
    tip = forward_kinematics(model, posture.positions)
    linear, angular = tip.jacobian[:3], tip.jacobian[3:]
    g = posture.gravity
    cross = np.array([[0.0, g[2], -g[1]], [-g[2], 0.0, g[0]], [g[1], -g[0], 0.0]])  # cross @ v is v × g
    return np.column_stack([-linear.T @ g, -angular.T @ cross @ tip.rotation])


def identify_payload(model: ArmModel, postures: Sequence[StillPosture]) -> Payload:
    """The payload that explains the torques best.

    Raises:
        InvalidValueError: fewer than two postures, or no gravity to weigh with.
    """
    if len(postures) < 2:
        raise InvalidValueError("postures", len(postures), "two or more")
    if min(float(np.linalg.norm(posture.gravity)) for posture in postures) < 1e-3:
        raise InvalidValueError("gravity [m/s2]", [p.gravity.tolist() for p in postures], "0.001 or more")
    still = np.zeros(model.joint_count)
    matrix = np.vstack([regressor(model, posture) for posture in postures])
    rest = np.concatenate([p.efforts - rigid_effort(model, p.positions, still, still, p.gravity) for p in postures])
    found, _, rank, _ = np.linalg.lstsq(matrix, rest, rcond=1e-6)
    left = rest - matrix @ found
    freedom = len(rest) - int(rank)
    variance = float(left @ left) / freedom if freedom > 0 else np.inf
    covariance = np.linalg.pinv(matrix.T @ matrix, rcond=1e-12)
    mass = float(found[0])
    centre = found[1:] / mass if abs(mass) > 1e-3 else np.zeros(3)
    deviation = float(np.sqrt(max(variance * covariance[0, 0], 0.0)))
    return Payload(mass, deviation, centre, float(np.sqrt(np.mean(left * left))))
