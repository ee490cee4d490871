"""Twist of the gears between the arm's motors and its joints, from the load that the model expects.

Encoder and servo on the motor know nothing of what the gear gives. Where a joint carries the torque T its motor is
ahead by

    x(T) = T/k + h clip(T/b, -1, 1)

k: stiffness of the gear; h: half its play; b: friction of the joint's own bearing, below which the torque does not say
on which flank the teeth rest. T is the rigid-body torque of the model, from the gravity that the IMU sees (a
compensation that placing an instrument to millimetres needs: Tunstel et al. 2005, IEEE SMC, of the MER arm).

What stays: h where T is near zero, b/k, what the model's masses are wrong by, loads from outside. Range: small twists.
"""

import numpy as np

from sojourn_flight.arm.dynamics import gravity_effort, rigid_effort
from sojourn_flight.arm.model import ArmModel
from sojourn_flight.arm.params import ArmParams
from sojourn_flight.arm.trajectory import JointReference
from sojourn_machine.params import FloatArray

_LEAST_FRICTION = 1e-3
"""[N m]: a bearing without friction would let the play jump."""


def gear_twist(params: ArmParams, efforts: FloatArray) -> FloatArray:
    """x (n,) [rad]: motor over the gear less joint, under joint torques `efforts` (n,) [N m]."""
    bearing = np.maximum(np.array(params.bearing_friction), _LEAST_FRICTION)
    half = 0.5 * np.array(params.gear_backlash)
    flank = np.minimum(np.maximum(efforts / bearing, -1.0), 1.0)
    return np.asarray(np.array(params.gear_compliance) * efforts + half * flank)


def joint_positions(params: ArmParams, model: ArmModel, measured: FloatArray, gravity: FloatArray) -> FloatArray:
    """Where the joints are (n,) [rad or m], from the encoders (n,) and gravity in base_link (3,) [m/s2]."""
    if not params.gear_compliance:
        return measured
    return measured - gear_twist(params, gravity_effort(model, measured, gravity))


def motor_positions(params: ArmParams, model: ArmModel, reference: JointReference, gravity: FloatArray) -> FloatArray:
    """Where the motors have to be (n,) for the joints to be at a reference."""
    if not params.gear_compliance:
        return reference.position
    effort = rigid_effort(model, reference.position, reference.velocity, reference.acceleration, gravity)
    return reference.position + gear_twist(params, effort)
