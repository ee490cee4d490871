"""What a rolling contact remembers, so that rest is a fixed point and everything is continuous through zero
speed.

The relaxation of a rolling contact (Pacejka 2012, Tire and Vehicle Dynamics, ch. 7), here with the contact
length L as relaxation length:

    du_x/dt = (r ω - v_x) - V u_x/L,   du_y/dt = -v_y - V u_y/L,   V = max(|r ω|, |v|)
    s = u_x/L,   s_y = u_y/L
    dD/dt = (w - |w| D)/L,   w = (v_x + r ω)/2

In steady rolling s is the usual slip ratio; at rest u is the shear displacement itself, and stays. D is the
sense of travel, -1..1. The stress follows the effective displacement e of `hysteresis`, which is u until the shear
turns.

Near rest the rate of shear leads the displacement, by SHEAR_LEAD/(1 + (V/LEAD_SPEED)²): a small viscous share (an
estimate), for swings too small for the sliders, gone at driving speed.
"""

import math

from sojourn_machine.kernels import small_kernel
from sojourn_machine.params import FloatArray
from sojourn_physics.contact.contact_law import MotionColumn, StateColumn
from sojourn_physics.contact.hysteresis import effective_shear

SHEAR_LEAD = 0.02
"""Time by which the rate of shear leads the shear displacement at rest [s]."""
LEAD_SPEED = 0.005
"""Speed at which the lead has halved [m/s]."""
MAX_DAMPING_GAIN = 3.0
"""Largest factor by which damping raises a normal force."""


@small_kernel
def clip(value: float, low: float, high: float) -> float:
    """The value, held to low..high."""
    return min(max(value, low), high)


@small_kernel
def shear_lead(speed: float) -> float:
    """Time by which the rate of shear leads the shear displacement [s] at a speed over the ground [m/s]."""
    ratio = speed / LEAD_SPEED
    return SHEAR_LEAD / (1.0 + ratio * ratio)


@small_kernel
def advance_rolling(motion: FloatArray, length: float, dt: float, state: FloatArray) -> tuple[float, float]:
    """Advance the memory of a rolling contact's shear over dt [s], implicitly: at any speed and step it stays bounded.

    Args:
        motion: row of `MotionColumn`. length: of the contact [m], more than 0. state: row of `StateColumn`, written.

    Returns:
        the displacements along and to the side that the stress follows, e and its lead [m].
    """
    v_along, v_side, rim_speed = (
        motion[MotionColumn.V_ALONG],
        motion[MotionColumn.V_SIDE],
        motion[MotionColumn.RIM_SPEED],
    )
    transport = max(abs(rim_speed), math.sqrt(v_along * v_along + v_side * v_side))
    kept = 1.0 / (1.0 + dt * transport / length)
    slip_speed = rim_speed - v_along
    u_x = (state[StateColumn.SHEAR_ALONG] + dt * slip_speed) * kept
    u_y = (state[StateColumn.SHEAR_SIDE] - dt * v_side) * kept
    state[StateColumn.SHEAR_ALONG] = u_x
    state[StateColumn.SHEAR_SIDE] = u_y
    displacement = math.sqrt(u_x * u_x + u_y * u_y)
    e_x, e_y, _ = effective_shear(dt * slip_speed, -dt * v_side, 0.0, kept, displacement, state)
    travel = 0.5 * (v_along + rim_speed)
    state[StateColumn.TRAVEL] = clip(
        (state[StateColumn.TRAVEL] + dt * travel / length) / (1.0 + dt * abs(travel) / length), -1.0, 1.0
    )
    lead = shear_lead(transport)
    return e_x + lead * slip_speed, e_y - lead * v_side
