"""Believed slip of a machine from the torques of its wheels: what slip makes them turn that hard on this soil.

A wheel of radius r under the load N that slips by s needs, in this drive's belief, the torque

    T = r N c(s),    c(s) = limit (1 - exp(-(s + offset) / softness))

(Janosi and Hanamoto 1961; Wong 2008, sec. 2.5: shear stress mobilised along the contact), one curve for fresh ground,
whose compaction takes torque as well (`offset`), and one for the rut of a wheel ahead. Wheels on one body, without
sliding sideways, have one slip; it follows from the sum of their torques, which hardly depends on how the load is
spread: sum T_i = sum r_i N_i c_i(s), monotonous in s. A torque beyond all traction gives 1.

Not seen: firm ground, where torque needs no slip; a soil stronger or weaker than believed (`speed_filter` finds that).
"""

import math

from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray, IntArray

LOWEST_SLIP, HIGHEST_SLIP = -0.6, 1.0
STEPS = 30
"""Halvings of the interval: far finer than the torque's noise."""
NEXT = 0.05
"""A wheel must be this far ahead of another to leave a rut for it [m]."""


@njit(cache=True)
def in_rut(table: FloatArray, wheel: int, ahead_x: float, ahead_y: float, width: float, way: float) -> bool:
    """Whether another wheel has gone where this one is, all moving towards the unit vector (ahead_x, ahead_y).

    Args:
        width: tracks nearer to each other than this are one [m]. way: since the machine began to go there [m].
    """
    for other in range(table.shape[0]):
        x, y = table[other, 0] - table[wheel, 0], table[other, 1] - table[wheel, 1]
        if NEXT < x * ahead_x + y * ahead_y < way and abs(y * ahead_x - x * ahead_y) < width:
            return True
    return False


@njit(cache=True)
def coefficient(curve: FloatArray, slip: float) -> float:
    """c(s) for (limit, softness, offset)."""
    return float(-curve[0] * math.expm1(-(slip + curve[2]) / curve[1]))


@njit(cache=True)
def slope(curve: FloatArray, slip: float) -> float:
    """dc/ds."""
    return float(curve[0] / curve[1] * math.exp(-(slip + curve[2]) / curve[1]))


@njit(cache=True)
def believed_slip(
    torques: FloatArray, levers: FloatArray, kinds: IntArray, counts: FloatArray, curves: FloatArray
) -> tuple[float, float]:
    """Slip, and its change with the sum of the torques [1/(N m)].

    Args:
        torques: in the sense of travel, (wheels,) [N m]. levers: r N of each [N m]. kinds: row in `curves` of each.
        counts: 1 for a wheel that counts, 0 for one that does not. curves: rows of limit, softness, offset.
    """
    total = 0.0
    for i in range(torques.shape[0]):
        total += counts[i] * torques[i]
    low, high = LOWEST_SLIP, HIGHEST_SLIP
    for _ in range(STEPS):
        middle = 0.5 * (low + high)
        needed = 0.0
        for i in range(torques.shape[0]):
            needed += counts[i] * levers[i] * coefficient(curves[kinds[i]], middle)
        if needed < total:
            low = middle
        else:
            high = middle
    slip = 0.5 * (low + high)
    gradient = 0.0
    for i in range(torques.shape[0]):
        gradient += counts[i] * levers[i] * slope(curves[kinds[i]], slip)
    return slip, 1.0 / max(gradient, 1e-9)
