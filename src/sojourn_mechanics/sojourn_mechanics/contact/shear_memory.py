"""What a rolling contact remembers, so that rest is a fixed point and everything is continuous through zero
speed.

The relaxation of a rolling contact (Pacejka 2012, Tire and Vehicle Dynamics, ch. 7), here with the contact
length L as relaxation length:

    du_x/dt = (r ω - v_x) - V u_x/L,   du_y/dt = -v_y - V u_y/L,   V = max(|r ω|, |v|)
    s = u_x/L,   s_y = u_y/L
    dD/dt = (w - |w| D)/L,   w = (v_x + r ω)/2

In steady rolling s is the usual slip ratio; at rest u is the shear displacement itself, and stays. D is the
sense of travel, -1..1.

Near rest the rate of shear leads the displacement, by SHEAR_LEAD/(1 + (V/LEAD_SPEED)²), which damps the swing
of a parked machine on its soil (soil loses most of the energy of such a swing; the numbers are estimates) and
is gone at driving speed.

Not modelled: the loop that stress and displacement of soil run through when the shear turns. Sand sheared to and fro by
some per cent has a damping ratio of 0.2 to 0.25, and of 0.02 at small strains (Seed & Idriss 1970, EERC 70-10; Hardin &
Drnevich 1972, J. Soil Mech. Found. Div. 98(SM7):667). The other way round here: the explorer, stopped at once from
0.1 m/s on lunar_nominal, swings at 1.15 Hz with a ratio of 0.05, and of 0.35 once it is slower than LEAD_SPEED, so that
4 s pass where 1.5 would.
"""

import math

from numba import njit

from sojourn_mechanics.contact.contact_law import MotionColumn, StateColumn
from sojourn_mechanics.params import FloatArray

SHEAR_LEAD = 0.1
"""Time by which the rate of shear leads the shear displacement at rest [s]."""
LEAD_SPEED = 0.01
"""Speed at which the lead has halved [m/s]."""
MAX_DAMPING_GAIN = 3.0
"""Largest factor by which damping raises a normal force."""

_U_X = int(StateColumn.SHEAR_ALONG)
_U_Y = int(StateColumn.SHEAR_SIDE)
_TRAVEL = int(StateColumn.TRAVEL)
_V_ALONG = int(MotionColumn.V_ALONG)
_V_SIDE = int(MotionColumn.V_SIDE)
_RIM_SPEED = int(MotionColumn.RIM_SPEED)


@njit(cache=True)
def clip(value: float, low: float, high: float) -> float:
    """The value, held to low..high."""
    return min(max(value, low), high)


@njit(cache=True)
def shear_lead(speed: float) -> float:
    """Time by which the rate of shear leads the shear displacement [s] at a speed over the ground [m/s]."""
    ratio = speed / LEAD_SPEED
    return SHEAR_LEAD / (1.0 + ratio * ratio)


@njit(cache=True)
def advance_rolling(motion: FloatArray, length: float, dt: float, state: FloatArray) -> float:
    """Advance the first three columns of a rolling contact's state over dt [s], implicitly: at any speed and step
    they stay bounded.

    Args:
        motion: row of `MotionColumn`. length: of the contact [m], more than 0.

    Returns:
        V, the speed at which the contact is renewed [m/s].
    """
    v_along, v_side, rim_speed = motion[_V_ALONG], motion[_V_SIDE], motion[_RIM_SPEED]
    transport = max(abs(rim_speed), math.sqrt(v_along * v_along + v_side * v_side))
    relaxed = 1.0 + dt * transport / length
    state[_U_X] = (state[_U_X] + dt * (rim_speed - v_along)) / relaxed
    state[_U_Y] = (state[_U_Y] - dt * v_side) / relaxed
    travel = 0.5 * (v_along + rim_speed)
    state[_TRAVEL] = clip((state[_TRAVEL] + dt * travel / length) / (1.0 + dt * abs(travel) / length), -1.0, 1.0)
    return float(transport)
