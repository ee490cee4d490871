"""The light on the ground, painted into its picture: relief and cast shadows as fine as the ground is known, on
triangles that are few and that the browser need not light.

The Sun's light goes with the cosine of its angle to the ground (Lambert), the sky's is the same everywhere.
"""

import math

import numpy as np

from sojourn_machine.params import FloatArray
from sojourn_physics.imaging.ground import seen_ground
from sojourn_physics.imaging.scenery import sun_of
from sojourn_physics.imaging.shadows import shadows, sunlit_ground
from sojourn_physics.terrain.ground_samples import between_nodes
from sojourn_physics.terrain.height_field import HeightField

SUN = 3.0
"""Of the browser's light from the Sun; a surface sends back a part of 1/pi of it."""
SKY = 0.7
"""Of the browser's light from everywhere."""
SKY_COLOR = (225, 230, 255)


class GroundLight:
    """On one ground as it was at the start; before the first Sun it is night.

    Args:
        ground: that is lit.
    """

    def __init__(self, ground: HeightField) -> None:
        self._field, self._ground = ground, seen_ground(ground)
        self._slopes: FloatArray = np.array(np.gradient(ground.heights, ground.resolution), dtype=np.float64)
        self._sun = np.array([0.0, 0.0, -1.0])
        self._cast = shadows(self._ground, sun_of(self._sun, 0.0))

    def shine(self, direction: FloatArray, disc: float) -> None:
        """Have the Sun elsewhere.

        Args:
            direction: unit vector towards it in map, (3,). disc: its angular radius [rad].
        """
        self._sun = direction.copy()
        self._cast = shadows(self._ground, sun_of(direction, disc))

    def on(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """What a white surface sends back, of each colour (linear): (rows, columns, 3).

        Args:
            x: of the columns in map, (columns,) [m]. y: of the rows, (rows,) [m].
        """
        seen = np.empty((len(y), len(x)), dtype=np.float32)
        sunlit_ground(self._ground, self._cast, x, y, seen)
        places = np.meshgrid(x, y)
        rise_y, rise_x = (between_nodes(self._field, rise, *places) for rise in self._slopes)
        towards = (self._sun[2] - rise_x * self._sun[0] - rise_y * self._sun[1]) / np.sqrt(1.0 + rise_x**2 + rise_y**2)
        direct = SUN * seen * np.maximum(towards, 0.0) if self._sun[2] > 0.0 else np.zeros_like(towards)
        lit: FloatArray = (direct[:, :, None] + SKY * np.array(SKY_COLOR) / 255.0) / math.pi
        return lit
