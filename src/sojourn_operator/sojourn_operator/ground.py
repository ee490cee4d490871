"""Where the ground is, seen from the rover."""

import numpy as np
import pinocchio as pin

from sojourn_machine.params import FloatArray
from sojourn_operator.actions import ArmGround
from sojourn_physics.terrain.height_field import HeightField

PASSES = 50
CLOSE_M = 1e-9


def ground_point(
    terrain: HeightField, position: FloatArray, orientation: FloatArray, target: ArmGround
) -> tuple[float, float, float]:
    """Point in base_link that lies over (or under) x, y of base_link at the wanted height above the ground.

    Args:
        position: of base_link in map, (3,) [m]. orientation: quaternion x y z w of base_link in map, (4,).
        target: x, y in base_link and height along the vertical [m].

    Raises:
        OutsideTerrainError: there is no ground there.
    """
    x, y, z, w = (float(value) for value in orientation)
    rotation = pin.Quaternion(w, x, y, z).toRotationMatrix()
    depth = 0.0
    for _ in range(PASSES):  # along the base's z axis down to the ground: the slope makes it a fixed-point problem
        point = position + rotation @ np.array([target.x, target.y, depth])
        gap = terrain.height(float(point[0]), float(point[1])) + target.height - point[2]
        depth += gap / rotation[2, 2]
        if abs(gap) < CLOSE_M:
            break
    return target.x, target.y, float(depth)
