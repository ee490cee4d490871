"""How well an arm moves and pushes in a posture: singular values of its Jacobian.

Manipulability (Yoshikawa, IJRR 4(2), 1985):  w = sqrt(det(J J')) for n >= 6, and the product of the n singular values
for fewer joints. Its unit mixes metres and radians; so the conditioning here is of the Jacobian whose velocities are
divided by a length of the arm (Angeles, Fundamentals of Robotic Mechanical Systems, 2014, section 5.8).

Force: tau = J' F (principle of virtual work). The largest force in a direction d that keeps every joint within its
torque limits, gravity included:  F_max = min over joints of (+-tau_max - tau_gravity) / (J_v' d).
"""

import numpy as np

from sojourn_flight.arm.chain import ChainArm, tip_kinematics
from sojourn_flight.arm.inverse_search import spread
from sojourn_flight.arm.serial_arm import SerialArm
from sojourn_machine.params import FloatArray

SINGULAR = 1.0e-3
"""Smallest singular value of the scaled Jacobian below which a posture counts as singular [-]."""


def tip_jacobian(arm: SerialArm, positions: FloatArray) -> FloatArray:
    """Geometric Jacobian (6, n) of the tip in the base: linear rows, then angular ones."""
    rotation, position, jacobian = np.empty((3, 3)), np.empty(3), np.empty((6, arm.joint_count))
    tip_kinematics(arm.chain, positions, rotation, position, jacobian)
    return jacobian


def manipulability(jacobian: FloatArray) -> float:
    """Product of the singular values of a Jacobian (m, n); Yoshikawa's measure."""
    return float(np.prod(np.linalg.svd(jacobian, compute_uv=False)))


def partial_manipulability(arm: SerialArm, jacobian: FloatArray, rows: slice) -> float:
    """Yoshikawa's measure of some rows of a Jacobian (6, n), of the translation or the rotation alone.

    What the arm cannot do in any posture is left out: of a planar arm it is that of its plane (l1 l2 |sin q2| for two
    joints), of an arm that only slides it is 0 for the rotation.
    """
    rank = 0
    for posture in spread(arm.joint_count, 8) * (arm.upper - arm.lower) + arm.lower:
        there = np.linalg.svd(scaled_jacobian(arm, tip_jacobian(arm, posture))[rows], compute_uv=False)
        rank = max(rank, int(np.count_nonzero(there > SINGULAR**2)))
    values = np.linalg.svd(jacobian[rows], compute_uv=False)
    return float(np.prod(values[:rank])) if rank else 0.0


def scaled_jacobian(arm: ChainArm, jacobian: FloatArray) -> FloatArray:
    """Jacobian (6, n) with lengths counted in reaches of the arm."""
    scaled = jacobian.copy()
    scaled[:3] /= arm.reach
    scaled[:, arm.chain.revolute < 0.5] *= arm.reach
    return scaled


def smallest_singular_value(arm: SerialArm, jacobian: FloatArray) -> float:
    """Of the scaled Jacobian: 0 in a singular posture [-]."""
    return float(np.linalg.svd(scaled_jacobian(arm, jacobian), compute_uv=False)[-1])


def condition_number(arm: SerialArm, jacobian: FloatArray) -> float:
    """Largest over smallest singular value of the scaled Jacobian; infinite in a singular posture [-]."""
    values = np.linalg.svd(scaled_jacobian(arm, jacobian), compute_uv=False)
    return float(values[0] / values[-1]) if values[-1] > 1e-12 * values[0] else float("inf")


def largest_force(arm: SerialArm, jacobian: FloatArray, gravity_effort: FloatArray, direction: FloatArray) -> float:
    """Largest force at the tip along a unit `direction` (3,) that the joints can give at rest [N].

    Args:
        gravity_effort: what holds the arm alone (n,) [N m or N].

    Returns:
        0 where the arm cannot even hold itself; infinite where the structure takes the force.
    """
    needed = jacobian[:3].T @ direction
    spare = np.where(needed > 0.0, arm.max_effort - gravity_effort, arm.max_effort + gravity_effort)
    if np.any(np.abs(gravity_effort) > arm.max_effort):
        return 0.0
    loaded = np.abs(needed) > 1e-9
    return float(np.min(spare[loaded] / np.abs(needed[loaded]))) if np.any(loaded) else float("inf")
