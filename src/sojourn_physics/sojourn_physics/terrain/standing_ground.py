"""How a machine stands on a ground that does not give way: on the plane of least squares under its supports."""

import math

import numpy as np

from sojourn_machine.params import FloatArray
from sojourn_physics.terrain.ground_samples import heights_of
from sojourn_physics.terrain.height_field import HeightField


class StandingGround:
    """Under a machine.

    Args:
        field: the ground. supports: places in base_link, shape (n, 2) [m]. ride_height: of base_link over it [m].
    """

    def __init__(self, field: HeightField, supports: FloatArray, ride_height: float) -> None:
        self.field, self._supports, self._ride_height = field, supports, ride_height
        self._solve = np.linalg.pinv(np.column_stack([np.ones(len(supports)), supports]))

    def pose(self, x: float, y: float, yaw: float) -> tuple[FloatArray, float, float]:
        """Place of base_link (3,) [m], roll and pitch (nose down positive) [rad]: on the plane under its supports."""
        cosine, sine = math.cos(yaw), math.sin(yaw)
        ahead, left = self._supports.T
        heights = heights_of(self.field, x + cosine * ahead - sine * left, y + sine * ahead + cosine * left)
        height, rise, lean = (self._solve @ heights).tolist()
        return np.array([x, y, height + self._ride_height]), math.atan(lean), -math.atan(rise)
