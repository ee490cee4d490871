"""Limits and damping of the shear that contacts remember; shared by wheels and pads.

Near rest the rate of shear leads the displacement, by SHEAR_LEAD/(1 + (V/LEAD_SPEED)²), which damps the swing
of a parked machine on its soil (soil loses most of the energy of such a swing; the numbers are estimates) and
is gone at driving speed.
"""

from numba import njit

SHEAR_LEAD = 0.1
"""Time by which the rate of shear leads the shear displacement at rest [s]."""
LEAD_SPEED = 0.01
"""Speed at which the lead has halved [m/s]."""
MAX_DAMPING_GAIN = 3.0
"""Largest factor by which damping raises a normal force."""


@njit(cache=True)
def clip(value: float, low: float, high: float) -> float:
    """The value, held to low..high."""
    return min(max(value, low), high)


@njit(cache=True)
def shear_lead(speed: float) -> float:
    """Time by which the rate of shear leads the shear displacement [s] at a speed over the ground [m/s]."""
    ratio = speed / LEAD_SPEED
    return SHEAR_LEAD / (1.0 + ratio * ratio)
