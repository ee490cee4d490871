"""The chassis on the ground of the map: how it is tilted at a pose, along its heading and across it.

Under each wheel the height of the ground is the mean of the cells within FOOTING, each brought to the wheel's place by
its own slope, so that a cell that is missing tilts nothing. The chassis lies in the plane of least squares through
these heights: what a rocker-bogie comes to with its averaging (front and rear of both sides count, a stone under one
wheel by a part), and a machine on four wheels but for what its suspension gives. With wheels at (a_i, b_i)
in base_link, the heights z_i with variances v_i, and their means taken off,

    climb = sum A_i z_i,  lean = sum B_i z_i,  (A, B) rows of the pseudo-inverse;   variance of climb = sum A_i^2 v_i.

Each tilt is judged by its own limit: up the slope by what the soil carries, down it by what brakes, across it by the
drift downhill. What noise explains does not count. The ratio told is that of the worst to its limit, of tangents.

Sources: Otsu et al. (2020), J. Field Robotics 37(5):768 (ACE: the chassis settled on the heights under its wheels, for
the poses of a path); Goldberg, Maimone & Matthies (2002), IEEE Aerospace Conf. 5:2025 (tilt over a patch of the rover's
size); Helmick, Angelova & Matthies (2009), J. Field Robotics 26(4):391 (slopes judged by the direction driven).

Assumptions: wheels carry the chassis evenly; small tilts (tangents add); where fewer than LEAST_WHEELS stand on known
ground nothing is said, and there is no tilt.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sojourn_flight.hazards.obstacle_map import COUNT, MEAN, SIGMAS, mean_variance
from sojourn_flight.hazards.obstacle_params import TiltLimits
from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray

FOOTING = 0.25
"""Cells so near to a wheel's place are its ground [m]."""
LEAST_WHEELS = 4


class SettlingGround(NamedTuple):
    """What of a judged map settling looks at."""

    layers: FloatArray
    """Of the map."""
    kinds: NDArray[np.int64]
    """0 for cells that a wheel may stand on, shape (cells, cells)."""
    slopes: FloatArray
    """Gradient of the ground in odom, shape (2, cells, cells) [-]."""
    x0: float
    y0: float
    cell: float
    """[m]"""


@njit(cache=True)
def footing(ground: SettlingGround, x: float, y: float) -> tuple[bool, float, float]:
    """Whether the ground under a wheel at a place in odom is known, its height [m], the variance of that [m^2]."""
    size, wide = ground.kinds.shape[0], math.ceil(FOOTING / ground.cell)
    row, column = math.floor((y - ground.y0) / ground.cell), math.floor((x - ground.x0) / ground.cell)
    n = total = variance = 0.0
    for i in range(max(row - wide, 0), min(row + wide + 1, size)):
        for j in range(max(column - wide, 0), min(column + wide + 1, size)):
            if ground.layers[COUNT, i, j] == 0.0 or ground.kinds[i, j] != 0:
                continue
            east, north = x - ground.x0 - (j + 0.5) * ground.cell, y - ground.y0 - (i + 0.5) * ground.cell
            if east * east + north * north > FOOTING * FOOTING:
                continue
            n += 1.0
            total += ground.layers[MEAN, i, j] + ground.slopes[0, i, j] * east + ground.slopes[1, i, j] * north
            variance += mean_variance(ground.layers, i, j)
    if n == 0.0:
        return False, 0.0, 0.0
    return True, total / n, variance / (n * n)


@njit(cache=True)
def settled(ground: SettlingGround, wheels: FloatArray, x: float, y: float, yaw: float) -> FloatArray:
    """Climb along the heading and lean, up to the left [-], and their variances; NaN where too little is known.

    Args:
        wheels: places in base_link, shape (wheels, 2) [m]. x, y, yaw: pose in odom.
    """
    found = np.full(4, np.nan)
    cosine, sine = math.cos(yaw), math.sin(yaw)
    n = sa = sb = sz = saa = sab = sbb = saz = sbz = 0.0
    heights, variances = np.empty(wheels.shape[0]), np.full(wheels.shape[0], -1.0)
    for i in range(wheels.shape[0]):
        a, b = wheels[i, 0], wheels[i, 1]
        known, z, variance = footing(ground, x + cosine * a - sine * b, y + sine * a + cosine * b)
        if known:
            heights[i], variances[i] = z, variance
            n += 1.0
            sa += a
            sb += b
            sz += z
            saa += a * a
            sab += a * b
            sbb += b * b
            saz += a * z
            sbz += b * z
    if n < LEAST_WHEELS:
        return found
    a_mean, b_mean = sa / n, sb / n
    saa, sab, sbb = saa - sa * a_mean, sab - sa * b_mean, sbb - sb * b_mean
    determinant = saa * sbb - sab * sab
    if determinant < 0.05 * (saa + sbb) ** 2:  # wheels in a row
        return found
    found[:] = 0.0
    for i in range(wheels.shape[0]):
        if variances[i] < 0.0:
            continue
        a, b = wheels[i, 0] - a_mean, wheels[i, 1] - b_mean
        ahead, left = (sbb * a - sab * b) / determinant, (saa * b - sab * a) / determinant
        found[0] += ahead * heights[i]
        found[1] += left * heights[i]
        found[2] += ahead * ahead * variances[i]
        found[3] += left * left * variances[i]
    return found


@njit(cache=True)
def tilt_ratio(climb: float, lean: float, climb_noise: float, lean_noise: float, limits: TiltLimits) -> float:
    """The worst tilt over its limit, without what noise explains [-]; `climb` is negative downhill."""
    along, across = max(abs(climb) - climb_noise, 0.0), max(abs(lean) - lean_noise, 0.0)
    return max(along / (limits.climb if climb > 0.0 else limits.descent), across / limits.side)


@njit(cache=True)
def tilts_along(ground: SettlingGround, wheels: FloatArray, limits: TiltLimits, poses: FloatArray) -> FloatArray:
    """The tilt ratio at poses x, y, yaw in odom, shape (n, 3): shape (n,); 0 where too little is known."""
    ratios = np.zeros(poses.shape[0])
    for i in range(poses.shape[0]):
        tilt = settled(ground, wheels, poses[i, 0], poses[i, 1], poses[i, 2])
        if not math.isnan(tilt[0]):
            noise = SIGMAS * math.sqrt(tilt[2]), SIGMAS * math.sqrt(tilt[3])
            ratios[i] = tilt_ratio(tilt[0], tilt[1], noise[0], noise[1], limits)
    return ratios
