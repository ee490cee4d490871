"""An arm on a spacecraft that floats free: how the base gives way under the arm, and what the arm is then worth.

    H_b v_b + H_bm q' = 0                    total momentum, linear and angular, is zero and stays so
    v_b = -H_b^-1 H_bm q'                    reaction of the base (`sojourn_flight.arm.floating_base`)
    J* = J_m - J_b H_b^-1 H_bm               generalised Jacobian: velocity of the tip against the stars = J* q'

(Umetani & Yoshida 1989, IEEE Trans. Robotics and Automation 5:303.) H_b is the inertia of the machine with its joints
locked, H_bm couples joints to base: both are blocks of the mass matrix on a free base. J* depends on masses and
inertias: it loses rank in postures where the Jacobian of the same arm on the ground does not (dynamic singularities:
Papadopoulos & Dubowsky 1993, ASME J. Dynamic Systems, Measurement and Control 115:44). The base turns by the path that
was taken, not by the posture alone, and with it the places in space where that happens.

Range: no force from outside, thrusters and reaction wheels at rest, total momentum zero, rigid links.
"""

from typing import NamedTuple

import numpy as np
import pinocchio as pin

from sojourn_flight.arm.floating_base import BASE_RATES, base_reaction
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray


class FreeFlyingArm(NamedTuple):
    """An arm on a free base in one posture; twists are linear, then angular [m/s, rad/s]."""

    reaction: FloatArray
    """Twist of the base in its own axes for each joint's rate, (6, n)."""
    generalised_jacobian: FloatArray
    """Twist of the tip against the stars, in axes of the world, for each joint's rate, (6, n)."""
    fixed_jacobian: FloatArray
    """The same if the base stood fast, (6, n)."""


def free_flying_arm(model: pin.Model, configuration: FloatArray, tip: str) -> FreeFlyingArm:
    """Find the reaction of the base and the generalised Jacobian.

    Args:
        model: with a free-flying base as its first joint.
        configuration: of base and joints, (nq,).
        tip: frame whose velocity is asked for.

    Raises:
        InvalidValueError: a model whose base is not free, a frame that it does not have.
    """
    if model.njoints < 2 or model.joints[1].nv != BASE_RATES:
        raise InvalidValueError("model", model.name, "one on a free-flying base")
    if not model.existFrame(tip):
        raise InvalidValueError("frame", tip, "one of " + ", ".join(frame.name for frame in model.frames))
    data = model.createData()
    reaction = base_reaction(model, data, configuration)
    jacobian = pin.computeFrameJacobian(
        model, data, configuration, model.getFrameId(tip), pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
    )
    base, joints = slice(0, BASE_RATES), slice(BASE_RATES, None)
    return FreeFlyingArm(reaction, jacobian[:, joints] + jacobian[:, base] @ reaction, jacobian[:, joints])


def manipulability(jacobian: FloatArray) -> float:
    """Product of the singular values of the rows and columns that are given: 0 where rank is lost (Yoshikawa 1985)."""
    return float(np.prod(np.linalg.svd(jacobian, compute_uv=False)))


def momentum(model: pin.Model, configuration: FloatArray, velocity: FloatArray) -> FloatArray:
    """Of all links, in axes of the world, (6,): linear [kg m/s], angular about their centre of mass [kg m^2/s]."""
    found = pin.computeCentroidalMomentum(model, model.createData(), configuration, velocity)
    return np.concatenate([found.linear, found.angular])
