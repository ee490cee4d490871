"""Where the ground is, seen from the rover."""

import numpy as np
import pinocchio as pin

from sojourn_machine.params import FloatArray
from sojourn_physics.terrain.height_field import HeightField

PASSES = 50
CLOSE_M = 1e-9


def ground_point(
    terrain: HeightField, position: FloatArray, orientation: FloatArray, target: tuple[float, float, float]
) -> tuple[float, float, float]:
    """Point in base_link that lies over (or under) x, y of base_link at the wanted height above the ground.

    Args:
        position: of base_link in map, (3,) [m]. orientation: quaternion x y z w of base_link in map, (4,).
        target: x, y in base_link and height over the ground along the vertical [m].

    Raises:
        OutsideTerrainError: there is no ground there.
    """
    rotation = pin.Quaternion(*(float(orientation[place]) for place in (3, 0, 1, 2))).toRotationMatrix()
    x, y, height = target
    depth = 0.0
    for _ in range(PASSES):  # along the base's z axis down to the ground: the slope makes it a fixed-point problem
        point = position + rotation @ np.array([x, y, depth])
        gap = terrain.height(float(point[0]), float(point[1])) + height - point[2]
        depth += gap / rotation[2, 2]
        if abs(gap) < CLOSE_M:
            break
    return x, y, float(depth)
