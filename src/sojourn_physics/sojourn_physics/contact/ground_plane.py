"""The plane, and the soil, that stand for the ground under one wheel.

The rim is sampled in the wheel's plane; each sample under the terrain (or within a small margin of it) has a
weight that grows with the square of its depth. The contact plane goes through the weighted mean of the
terrain's points. Its slope along the wheel is that of the line through these points (weighted least squares,
with a little of their mean gradient where a light touch has few samples); across the wheel it is that from
edge to edge. On a plane, tilted or not, the contact plane is exact; over a rock or a step it turns continuously
towards what the rim presses on, also where the gradient of the ground jumps.

No plane lies deeper in the rim than the ground does: one that would, through a crest that a single sample touches or
from side to side of a groove, is turned towards the tangent of the rim there, the normal of a round body on an edge,
and lowered by what is still too much.

Where the samples lie on different soils, their parameters are blended by the same weights (the pressure modulus
geometrically, since it differs by orders of magnitude between sand and rock), so that a wheel is lifted onto a
rock and not shot off it.
"""

import math

import numpy as np

from sojourn_machine.kernels import small_kernel
from sojourn_machine.params import FloatArray
from sojourn_physics.contact.contact_law import WheelColumn
from sojourn_physics.contact.tables import Ground
from sojourn_physics.contact.wheel_on_soil import pressure_modulus
from sojourn_physics.soil.params import FORM_BEKKER, SoilColumn
from sojourn_physics.terrain.height_field import sample_ground, sample_soil

RIM_SAMPLES = 13
RIM_SAMPLE_RANGE = 1.35
"""Rim angles sampled for the contact plane [rad], to both sides of straight down."""
SAMPLE_MARGIN = 0.03
"""Margin over the ground within which a sample still counts, as a fraction of the radius."""

BETWEEN_SAMPLES = 1.0 - math.cos(RIM_SAMPLE_RANGE / (RIM_SAMPLES - 1))
"""How much deeper than its deepest sample the rim may be in a plane, over the radius: half way to the next one."""

FEW_SAMPLES = 0.02
"""Spread of the samples along the ground at which their own gradient counts by half, as a fraction of the radius."""

_ANGLES = np.linspace(-RIM_SAMPLE_RANGE, RIM_SAMPLE_RANGE, RIM_SAMPLES)
RIM_SIN: FloatArray = np.ascontiguousarray(np.sin(_ANGLES))
RIM_COS: FloatArray = np.ascontiguousarray(np.cos(_ANGLES))


@small_kernel
def blend_soils(soils: FloatArray, shares: FloatArray, width: float, blended: FloatArray) -> int:
    """Parameters of the ground under a wheel that touches several soils.

    Args:
        soils: kernel rows, (soils, columns). shares: weight of each soil, (soils,), not all zero.
        width: of the wheel [m]. blended: (columns,), written.

    Returns:
        index of the soil with the largest share.
    """
    total = 0.0
    first = 0
    for i in range(shares.shape[0]):
        total += shares[i]
        if shares[i] > shares[first]:
            first = i
    if shares[first] == total:
        for k in range(blended.shape[0]):
            blended[k] = soils[first, k]
        return first
    blended[:] = 0.0
    log_modulus = 0.0
    exit_ratio = 0.0
    for i in range(shares.shape[0]):
        share = shares[i] / total
        if share > 0.0:
            log_modulus += share * math.log(max(pressure_modulus(soils[i], width), 1.0))
            # "exit angle zero" is marked by a negative ratio, for which zero stands as well
            exit_ratio += share * max(soils[i, SoilColumn.EXIT_LAMBDA], 0.0)
            for k in range(blended.shape[0]):
                blended[k] += share * soils[i, k]
    blended[SoilColumn.FORM] = FORM_BEKKER
    blended[SoilColumn.K_C] = 0.0
    blended[SoilColumn.K_PHI] = math.exp(log_modulus)
    blended[SoilColumn.EXIT_LAMBDA] = exit_ratio
    return first


@small_kernel
def _turned(slope: float, ahead: float, above: float, least: float) -> tuple[float, float]:
    """A line through a point of the rim's plane, turned towards the tangent of the rim there.

    Args:
        slope: of the line. ahead, above: how far the point is ahead of the wheel's centre and the centre above it [m].
        least: distance from the centre that it is to have [m], more than it has.

    Returns:
        slope, and what is wanting of that distance where the point itself is closer [m].
    """
    reach = math.sqrt(ahead * ahead + above * above)
    cosine = min(least / reach, 1.0)
    sine = math.copysign(math.sqrt(1.0 - cosine * cosine), slope * above - ahead)
    return (ahead * cosine + above * sine) / (above * cosine - ahead * sine), max(least - reach, 0.0)


@small_kernel
def contact_plane(
    ground: Ground, centre: FloatArray, forward: FloatArray, up: FloatArray, wheel: FloatArray, shares: FloatArray
) -> tuple[bool, float, float, float, float, float, bool]:
    """Plane that stands for the ground under one wheel.

    Args:
        centre: of the wheel in map, shape (3,) [m]. forward, up: unit vectors in its plane, shape (3,).
        wheel: row of `WheelColumn`. shares: (soils,), written: weight of each soil in the contact.

    Returns:
        whether there is ground within reach, a point of the plane x, y, z [m], its gradients dz/dx, dz/dy,
        and whether all of it is on the map.
    """
    heights, grid = ground.heights, ground.grid
    radius, width = float(wheel[WheelColumn.RADIUS]), float(wheel[WheelColumn.WIDTH])
    total = 0.0
    x_mean = 0.0
    y_mean = 0.0
    z_mean = 0.0
    x_slope = 0.0
    y_slope = 0.0
    # sums of the fit: place along (s) and across (t) from the centre, and height over it
    s_mean = t_mean = 0.0
    ss = sz = st = base = 0.0
    on_map = True
    margin = SAMPLE_MARGIN * radius
    deepest = 0.0
    shares[:] = 0.0
    for i in range(RIM_SAMPLES):
        ahead = radius * RIM_SIN[i]
        below = radius * RIM_COS[i]
        x = centre[0] + ahead * forward[0] - below * up[0]
        y = centre[1] + ahead * forward[1] - below * up[1]
        z = centre[2] + ahead * forward[2] - below * up[2]
        height, dh_dx, dh_dy, inside = sample_ground(heights, grid, x, y)
        depth = height - z + margin
        if depth > 0.0:
            if total == 0.0:
                base = height  # level ground then has a slope of zero, not of a rounding error
            weight = depth * depth
            deepest = max(deepest, depth)
            total += weight
            shares[sample_soil(ground.soil_index, grid[0], grid[1], grid[2], x, y)] += weight
            x_mean += weight * x
            y_mean += weight * y
            z_mean += weight * height
            x_slope += weight * dh_dx
            y_slope += weight * dh_dy
            across = -below * (up[1] * forward[0] - up[0] * forward[1])
            s_mean += weight * ahead
            t_mean += weight * across
            ss += weight * ahead * ahead
            sz += weight * ahead * (height - base)
            st += weight * ahead * across
            on_map = on_map and inside
    if total <= 0.0:
        return False, 0.0, 0.0, 0.0, 0.0, 0.0, True
    x_mean, y_mean, z_mean = x_mean / total, y_mean / total, z_mean / total
    s_mean, t_mean = s_mean / total, t_mean / total
    # to the left, horizontally: from edge to edge of the wheel
    half = 0.5 * width
    left, _, _, _ = sample_ground(heights, grid, x_mean - half * forward[1], y_mean + half * forward[0])
    right, _, _, _ = sample_ground(heights, grid, x_mean + half * forward[1], y_mean - half * forward[0])
    lateral = (left - right) / width
    gradient = (x_slope * forward[0] + y_slope * forward[1]) / total
    spread = ss / total - s_mean * s_mean
    rise = sz / total - s_mean * (z_mean - base) - lateral * (st / total - s_mean * t_mean)
    little = (FEW_SAMPLES * radius) ** 2
    along = (rise + little * gradient) / (spread + little)
    # no deeper in the rim than the ground is
    level = centre[2] - z_mean + lateral * t_mean
    axle_up = up[0] * forward[1] - up[1] * forward[0]
    square = 1.0 + lateral * lateral
    norm = 1.0 / math.sqrt(square + along * along)
    camber = (axle_up - lateral * up[2]) * norm
    rim = radius * (math.sqrt(max(1.0 - camber * camber, 0.0)) - BETWEEN_SAMPLES)
    least = rim - (deepest - margin) * norm
    if level > 0.0 and least > 0.0 and (level + along * s_mean) * norm < least:
        scale = math.sqrt(square)
        slope, wanting = _turned(along / scale, s_mean, level / scale, least)
        along = slope * scale
        z_mean -= wanting * math.sqrt(square + along * along)
    x_slope = along * forward[0] - lateral * forward[1]
    y_slope = along * forward[1] + lateral * forward[0]
    return True, x_mean, y_mean, z_mean, x_slope, y_slope, on_map
