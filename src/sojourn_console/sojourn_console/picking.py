"""Where a ray from the eye meets the ground."""

import numpy as np

from sojourn_machine.params import FloatArray
from sojourn_physics.terrain.ground_samples import heights_of
from sojourn_physics.terrain.height_field import HeightField

FARTHEST = 400.0
"""Length of a ray [m]."""
STEP = 0.05
"""Between two looks along it [m]: a boulder is not passed through."""


def met_by(ground: HeightField, origin: FloatArray, direction: FloatArray) -> FloatArray | None:
    """The first place on the ground that a ray meets from above, (3,) [m]; None where it meets none.

    The ground is looked at every STEP; between the two looks where the ray passes through it, it is taken for plane.

    Args:
        origin: of the ray in map, (3,) [m]. direction: of any length, (3,).
    """
    unit = direction / np.linalg.norm(direction)
    along = np.arange(0.0, FARTHEST, STEP)
    points = origin + along[:, None] * unit
    x_min, x_max, y_min, y_max = ground.bounds
    inside = (points[:, 0] >= x_min) & (points[:, 0] <= x_max) & (points[:, 1] >= y_min) & (points[:, 1] <= y_max)
    above = points[:, 2] - heights_of(ground, points[:, 0], points[:, 1])
    through = np.flatnonzero((above[:-1] > 0.0) & (above[1:] <= 0.0) & inside[:-1] & inside[1:])
    if not through.size:
        return None
    first = int(through[0])
    part = above[first] / (above[first] - above[first + 1])
    x, y, _ = points[first] + part * (points[first + 1] - points[first])
    return np.array([x, y, float(heights_of(ground, np.array([x]), np.array([y]))[0])])
