"""Which points of a camera's cloud are on the machine itself: its arm before the camera, its wheels below.

A point within MARGIN of one of the machine's shapes is none of the ground. The shapes are where the measured joints
have them; a joint that is not measured stands at zero.
"""

import numpy as np
from numpy.typing import NDArray

from sojourn_machine.params import FloatArray
from sojourn_machine.shapes import BALL, BOX, HALF_X, HALF_Y, HALF_Z, KIND, MachineShapes, Shapes

MARGIN = 0.05
"""Three deviations of a stereo camera at 1 m, and the way of an arm's link in the age of a cloud [m]: an estimate."""


class OwnBody:
    """Of a machine, by its URDF."""

    def __init__(self, urdf_xml: str) -> None:
        self._shapes = MachineShapes(urdf_xml, "base_link")

    def left_out(self, points: FloatArray, names: tuple[str, ...], angles: FloatArray) -> FloatArray:
        """The points, (n, 3) in base_link [m], that are not on the machine.

        Args:
            names, angles: of joints, see `MachineShapes.at`.
        """
        _, _, shapes = self._shapes.at(names, angles)
        return np.asarray(points[~on_shapes(shapes, points, MARGIN)])


def on_shapes(shapes: Shapes, points: FloatArray, margin: float) -> NDArray[np.bool_]:
    """Which points, (n, 3), are within a margin of a shape [m], (n,); of its edges somewhat more."""
    on = np.zeros(len(points), dtype=bool)
    for size, turn, place in zip(shapes.sizes, shapes.turns, shapes.places, strict=True):
        x, y, z = np.abs((points - place) @ turn.T).T
        if size[KIND] == BOX:
            on |= (x <= size[HALF_X] + margin) & (y <= size[HALF_Y] + margin) & (z <= size[HALF_Z] + margin)
        elif size[KIND] == BALL:
            on |= x * x + y * y + z * z <= (size[HALF_X] + margin) ** 2
        else:
            on |= (np.hypot(x, y) <= size[HALF_X] + margin) & (z <= size[HALF_Z] + margin)
    return on
