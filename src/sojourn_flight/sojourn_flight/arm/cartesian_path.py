"""Paths of the tip in space: straight line, arc, turning at an even rate.

Place: on a line, or on the circle through three points. Turn: from the first orientation to the last about one axis
(spherical linear interpolation; Shoemake, SIGGRAPH 1985), in step with the place. The path parameter s runs from 0 to 1
in even steps of length.

The joints that follow such a path: tip_following.py.
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class TipPath:
    """A path of the tip. `centre` is None on a line."""

    start: FloatArray  # (3,) [m]
    end: FloatArray  # (3,) [m]
    start_rotation: FloatArray  # (3, 3)
    turn: FloatArray  # rotation vector (3,) in the base, start to end [rad]
    centre: FloatArray | None = None  # (3,) [m]
    sweep: FloatArray | None = None  # rotation vector (3,) of the arc [rad]

    @property
    def length(self) -> float:
        """Of the way of the tip's place [m]."""
        if self.centre is None or self.sweep is None:
            return float(np.linalg.norm(self.end - self.start))
        return float(np.linalg.norm(self.sweep) * np.linalg.norm(self.start - self.centre))

    @property
    def breaks(self) -> tuple[float, ...]:
        """Values of s at which its shape changes: none."""
        return ()

    def pose(self, s: float) -> tuple[FloatArray, FloatArray]:
        """Place (3,) [m] and rotation (3, 3) at s from 0 to 1."""
        rotation = Rotation.from_rotvec(s * self.turn).as_matrix() @ self.start_rotation
        if self.centre is None or self.sweep is None:
            return self.start + s * (self.end - self.start), rotation
        return self.centre + Rotation.from_rotvec(s * self.sweep).apply(self.start - self.centre), rotation


def line(start: FloatArray, end: FloatArray, start_rotation: FloatArray, end_rotation: FloatArray) -> TipPath:
    """Straight from one pose to another: places (3,) [m], rotations (3, 3)."""
    _check(start, end, start_rotation, end_rotation)
    return TipPath(start, end, start_rotation, _turn(start_rotation, end_rotation))


def arc(
    start: FloatArray, through: FloatArray, end: FloatArray, start_rotation: FloatArray, end_rotation: FloatArray
) -> TipPath:
    """On the circle from `start` by way of `through` to `end`, (3,) [m] each.

    Raises:
        InvalidValueError: the three points lie on a line.
    """
    _check(start, through, end, start_rotation, end_rotation)
    a, b = through - start, end - start
    normal = np.cross(a, b)
    area = float(normal @ normal)
    if area < (1e-6 * float(a @ a + b @ b)) ** 2 or area == 0.0:
        raise InvalidValueError("arc", [p.tolist() for p in (start, through, end)], "three points that are no line")
    centre = start + (np.cross(normal, a) * float(b @ b) + np.cross(b, normal) * float(a @ a)) / (2.0 * area)
    axis = normal / math.sqrt(area)
    out, last = start - centre, end - centre
    angle = math.atan2(float(np.cross(out, last) @ axis), float(out @ last)) % (2.0 * math.pi)
    return TipPath(start, end, start_rotation, _turn(start_rotation, end_rotation), centre, angle * axis)


def _turn(start: FloatArray, end: FloatArray) -> FloatArray:
    return np.asarray(Rotation.from_matrix(end @ start.T).as_rotvec())


def _check(*values: FloatArray) -> None:
    for value in values:
        if not np.all(np.isfinite(value)):
            raise InvalidValueError("path of the tip", value.tolist(), "finite numbers")
