"""Control of force and of motion at the tip, through the position references of the joints' servos.

The servos of the joints hold positions, so the outer loop is an admittance: it reads the force at the wrist and moves
the reference of the tip.

- Along a direction of contact d, with the force f that the tool presses with, (F - f)/D is the speed of the reference:
  a damper D between the wanted force F and the measured one. Against a contact of stiffness k (arm and ground in
  series) the force then closes in with the rate k/D; a sampled loop with a delay T is stable for k T/D < π/2.
- Across d the reference follows the wanted motion: hybrid control of position and force (Raibert & Craig 1981, ASME J.
  Dyn. Syst. Meas. Control 103:126), with the selection matrix  S = I - d dᵀ  for motion and  d dᵀ  for force.
- Where the place matters as well as the force, the reference gives way as a mass on a spring and a damper would,
  M a + D v + K (x - x0) = f  (Hogan 1985, ASME J. Dyn. Syst. Meas. Control 107:1), semi-implicit in the step.

Forces are those of the ground on the tool, in base_link [N]. A lost contact makes f = 0: the tip then seeks the ground
with at most `max_speed`.
"""

import numpy as np
from pydantic import Field

from sojourn_machine.params import FloatArray, Params


class ForceControlParams(Params):
    """Admittance of the tip, and the limits of every motion that is guided by force."""

    damping: float = Field(
        default=6000.0, gt=0.0, le=1e6, description="force error per speed of the reference along the contact [N s/m]"
    )
    deadband: float = Field(default=0.5, ge=0.0, le=100.0, description="force error that is left alone [N]")
    max_speed: float = Field(default=0.01, gt=0.0, le=1.0, description="of the reference along the contact [m/s]")
    max_force: float = Field(
        default=80.0, gt=0.0, le=1e5, description="contact force at which a guided motion is given up [N]"
    )
    tip_acceleration: float = Field(default=0.15, gt=0.0, le=100.0, description="of the reference of the tip [m/s2]")


def pressing(direction: FloatArray, force: FloatArray) -> float:
    """Force with which the tool presses along a unit direction [N], from that of the ground on it (3,)."""
    return -float(direction @ force)


def force_speed(params: ForceControlParams, wanted: float, present: float) -> float:
    """Speed of the reference along the contact, into the ground positive [m/s], for forces [N]."""
    error = wanted - present
    beyond = error - np.clip(error, -params.deadband, params.deadband)
    return float(np.clip(beyond / params.damping, -params.max_speed, params.max_speed))


def hybrid_velocity(
    params: ForceControlParams, direction: FloatArray, wanted: float, force: FloatArray, along: FloatArray
) -> FloatArray:
    """Velocity of the tip's reference (3,) [m/s]: force along the unit `direction`, the motion `along` across it."""
    across = along - (direction @ along) * direction
    return np.asarray(across + force_speed(params, wanted, pressing(direction, force)) * direction)


def impedance_velocity(
    mass: float, damping: float, stiffness: float, offset: float, speed: float, force: float, dt: float
) -> float:
    """Speed after a step of `dt` of a reference that gives way like a mass on spring and damper [m/s].

    Args:
        mass [kg], damping [N s/m], stiffness [N/m]: of the wanted behaviour, mass above 0, the others at least 0.
        offset: from the place of rest [m]. speed: of the reference [m/s]. force: of the surroundings on it [N].
    """
    return (mass * speed + dt * (force - stiffness * offset)) / (mass + dt * damping + dt * dt * stiffness)
