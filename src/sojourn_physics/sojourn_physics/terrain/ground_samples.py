"""Values of the ground between its nodes, bilinear; beyond its edge those of the edge."""

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates

from sojourn_machine.params import FloatArray
from sojourn_physics.terrain.height_field import HeightField


def heights_of(ground: HeightField, x: FloatArray, y: FloatArray) -> FloatArray:
    """Heights of a ground at points of any shape [m]."""
    return between_nodes(ground, ground.heights, x, y)


def between_nodes(ground: HeightField, values: NDArray[np.floating], x: FloatArray, y: FloatArray) -> FloatArray:
    """At points of any shape [m] of what is known at the nodes of a ground, (rows, columns)."""
    places = np.stack([(y - ground.origin_y) / ground.resolution, (x - ground.origin_x) / ground.resolution])
    found: FloatArray = map_coordinates(values, places, order=1, mode="nearest", output=np.float64)
    return found
