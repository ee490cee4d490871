"""Numba kernels of a photovoltaic array: current and voltage of a string of cells in unequal light, and its most power.

Equations. A group of cells in series behind one bypass diode, with the diode's voltage v:

    I = I_ph - I_0 (e^(v/a) - 1),    V = v - I R_s

and, where the string drives more through it than its light makes, its bypass diode carries the rest:

    V = -V_b    for    I > I_ph + I_0 (1 - e^(-(V_b - I R_s)/a)), about I_ph.

With temperature and light these go as `photovoltaic_array` has it. The groups of a string carry one current; their
voltages add up. In unequal light the power over the current has a peak between each two currents that the lights of
groups make, where the voltage is concave; each is found by golden section.
"""

from typing import NamedTuple

import numpy as np

from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray

SECTIONS = 36
"""Golden sections: the current is then known to some 10^-8 of what the light makes."""
GOLDEN = 0.6180339887498949
COLDEST, HOTTEST = 80.0, 420.0
"""Temperatures at which the data sheet's slopes are still taken [K]."""


class GroupSheet(NamedTuple):
    """What a data sheet says of one cell, and how many stand behind one bypass diode."""

    current: float
    """I_sc at the reference irradiance and temperature [A]."""
    current_slope: float
    """alpha [A/K]"""
    voltage: float
    """V_oc likewise [V]."""
    voltage_slope: float
    """beta [V/K]"""
    slope: float
    """a at the reference temperature [V]."""
    series: float
    """R_s [ohm]"""
    reference_irradiance: float
    """[W/m2]"""
    reference_temperature: float
    """[K]"""
    number: int
    """Of cells [1]."""
    bypass: float
    """V_b [V]"""


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


@njit(cache=True)
def group_at(sheet: GroupSheet, temperature: float) -> CellGroup:
    """The cells behind one bypass diode at a temperature [K]."""
    warm = min(max(temperature, COLDEST), HOTTEST)
    more = warm - sheet.reference_temperature
    slope = sheet.slope * (warm / sheet.reference_temperature)
    current = sheet.current + sheet.current_slope * more
    voltage = sheet.voltage + sheet.voltage_slope * more
    saturation = current * np.exp(-voltage / slope)
    number = sheet.number
    return CellGroup(max(current, 0.0), saturation, number * slope, number * sheet.series, sheet.bypass)


@njit(cache=True)
def irradiance_on(
    normal: FloatArray, to_sun: FloatArray, up: FloatArray, direct: float, diffuse: float
) -> tuple[float, float]:
    """Of beam and sky on a plane [W/m2].

    Args:
        normal, to_sun, up: unit vectors (3,). direct: of the beam, square to it. diffuse: on level ground [W/m2].
    """
    across = normal[0] * to_sun[0] + normal[1] * to_sun[1] + normal[2] * to_sun[2]
    seen = 0.5 * (1.0 + (normal[0] * up[0] + normal[1] * up[1] + normal[2] * up[2]))
    return direct * max(across, 0.0), diffuse * seen


@njit(cache=True)
def most_power_in_light(
    sheet: GroupSheet,
    temperature: float,
    past: float,
    shadow: FloatArray,
    normal: FloatArray,
    to_sun: FloatArray,
    up: FloatArray,
    direct: float,
    diffuse: float,
) -> float:
    """The most power of a string at a temperature [K] in the light about it [W].

    Args:
        past: part of the light that becomes current [1]. shadow: part of the beam that reaches each group (groups,).
        Others as in `irradiance_on`.
    """
    beam, sky = irradiance_on(normal, to_sun, up, direct, diffuse)
    if beam + sky <= 0.0:
        return 0.0
    light = past * ((beam * shadow + sky) / sheet.reference_irradiance)
    power: float = most_power(group_at(sheet, temperature), light)[0]
    return power
