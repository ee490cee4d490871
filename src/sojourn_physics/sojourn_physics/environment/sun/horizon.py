"""How high the ground stands before the sky, seen from a place on it.

    e(A) = max over d of atan((h(x + d sin A, y + d cos A) - z) / d)

Heights are taken at distances that grow by 1.5 % from one to the next, out to the edge of the map, so what it costs
grows with the logarithm of the map's size; ground narrower than 1.5 % of its distance, 0.9 deg, may be missed. Behind
the map a table of a far horizon may stand, as from an elevation model of the region; without one the horizon there is
flat. The map itself is flat: the body's curvature hides 0.3 m of what is 1 km away on the Moon.
"""

import math
from collections.abc import Sequence

import numpy as np
from pydantic import Field

from sojourn_machine.params import FloatArray, Params
from sojourn_physics.terrain.height_field import HeightField

_GROWTH = 1.015
_NEAREST = 0.25
"""Least distance of ground that is looked at [m]."""


class HorizonPoint(Params):
    """One point of a far horizon."""

    azimuth_deg: float = Field(ge=0.0, lt=360.0, description="from north, east is 90 [deg]")
    elevation_deg: float = Field(ge=-90.0, lt=90.0, description="of the horizon, over the level [deg]")


def far_horizon(points: Sequence[HorizonPoint], azimuth: float) -> float:
    """Elevation between the points of a table in any order, linear and all the way round; 0 without one [rad].

    Args:
        azimuth: from north towards east [rad].
    """
    if not points:
        return 0.0
    rows = sorted((point.azimuth_deg, point.elevation_deg) for point in points)
    azimuths, elevations = zip(*rows, strict=True)
    return math.radians(float(np.interp(math.degrees(azimuth), azimuths, elevations, period=360.0)))


def ground_horizon(terrain: HeightField, place: tuple[float, float, float], azimuths: FloatArray) -> FloatArray:
    """Elevation of the highest ground in each direction; -pi/2 where the map ends before any is looked at.

    Args:
        place: where the eye is in map [m]. azimuths: from north towards east, shape (n,) [rad].

    Returns:
        shape (n,) [rad].
    """
    x_min, x_max, y_min, y_max = terrain.bounds
    farthest = math.hypot(x_max - x_min, y_max - y_min)
    nearest = max(_NEAREST, terrain.resolution)
    count = max(1, math.ceil(math.log(farthest / nearest) / math.log(_GROWTH)))
    distances = nearest * _GROWTH ** np.arange(count + 1)
    x = place[0] + np.multiply.outer(np.sin(azimuths), distances)
    y = place[1] + np.multiply.outer(np.cos(azimuths), distances)
    inside = (x >= x_min) & (x <= x_max) & (y >= y_min) & (y <= y_max)
    slopes = np.where(inside, (_heights(terrain, x, y) - place[2]) / distances, -np.inf)
    elevations: FloatArray = np.arctan(slopes.max(axis=-1))
    return elevations


def _heights(terrain: HeightField, x: FloatArray, y: FloatArray) -> FloatArray:
    """Bilinear between the nodes; of the nearest point of the edge off the map."""
    rows, columns = terrain.heights.shape
    column = np.clip((x - terrain.origin_x) / terrain.resolution, 0.0, columns - 1.0)
    row = np.clip((y - terrain.origin_y) / terrain.resolution, 0.0, rows - 1.0)
    j = np.minimum(column.astype(np.int64), columns - 2)
    i = np.minimum(row.astype(np.int64), rows - 2)
    u, v = column - j, row - i
    heights = terrain.heights
    low = heights[i, j] * (1.0 - u) + heights[i, j + 1] * u
    high = heights[i + 1, j] * (1.0 - u) + heights[i + 1, j + 1] * u
    found: FloatArray = low * (1.0 - v) + high * v
    return found
