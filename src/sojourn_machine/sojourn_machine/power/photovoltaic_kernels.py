"""Numba kernels of a photovoltaic array: current and voltage of a string of cells in unequal light, and its most power.

Equations. A group of cells in series behind one bypass diode, with the diode's voltage v:

    I = I_ph - I_0 (e^(v/a) - 1),    V = v - I R_s

and, where the string drives more through it than its light makes, its bypass diode carries the rest:

    V = -V_b    for    I > I_ph + I_0 (1 - e^(-(V_b - I R_s)/a)), about I_ph.

The groups of a string carry one current; their voltages add up. In unequal light the power over the current has a peak
between each two currents that the lights of groups make, where the voltage is concave; each is found by golden
section.
"""

from typing import NamedTuple

import numpy as np

from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray

SECTIONS = 36
"""Golden sections: the current is then known to some 10^-8 of what the light makes."""
GOLDEN = 0.6180339887498949


class CellGroup(NamedTuple):
    """The cells behind one bypass diode at a temperature."""

    light_current: float
    """I_ph at the reference irradiance [A]."""
    saturation: float
    """I_0 [A]"""
    slope: float
    """a, of all cells of the group together [V]."""
    series: float
    """R_s likewise [ohm]."""
    bypass: float
    """V_b [V]"""


@njit(cache=True)
def group_voltage(group: CellGroup, light: float, current: float) -> float:
    """Voltage [V] at a current [A]; light: irradiance over the reference one [1]."""
    left = group.light_current * light - current
    if left <= -group.saturation:  # more than the dark diode lets through backwards
        return -group.bypass
    voltage: float = group.slope * np.log1p(left / group.saturation) - current * group.series
    return max(voltage, -group.bypass)


@njit(cache=True)
def string_voltage(group: CellGroup, light: FloatArray, current: float) -> float:
    """Of all groups of a string, of lights (groups,)."""
    total = 0.0
    for each in light:
        total += group_voltage(group, each, current)
    return total


@njit(cache=True)
def _peak(group: CellGroup, light: FloatArray, low: float, high: float) -> tuple[float, float]:
    """The most power of a string between two currents [A] with one peak: power [W] and current [A]."""
    left, right = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
    at_left = left * string_voltage(group, light, left)
    at_right = right * string_voltage(group, light, right)
    for _ in range(SECTIONS):
        if at_left >= at_right:
            high, right, at_right = right, left, at_left
            left = high - GOLDEN * (high - low)
            at_left = left * string_voltage(group, light, left)
        else:
            low, left, at_left = left, right, at_right
            right = low + GOLDEN * (high - low)
            at_right = right * string_voltage(group, light, right)
    current = 0.5 * (low + high)
    return current * string_voltage(group, light, current), current


@njit(cache=True)
def most_power(group: CellGroup, light: FloatArray) -> tuple[float, float]:
    """The most power of a string [W] and the current at which it gives it [A]."""
    best, place, low = 0.0, 0.0, 0.0
    for each in np.sort(light):
        high = group.light_current * each
        if high > low:
            power, current = _peak(group, light, low, high)
            if power > best:
                best, place = power, current
            low = high
    return best, place
