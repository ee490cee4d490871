"""Rotation of roll, pitch and yaw: about the fixed axes x, y, z in this order, pitch positive nose down (REP 103)."""

import math

import numpy as np

from sojourn_machine.params import FloatArray


def rotation_of(roll: float, pitch: float, yaw: float = 0.0) -> FloatArray:
    """Rz(yaw) Ry(pitch) Rx(roll): from base_link to odom, or to level axes along its heading with yaw = 0."""
    cr, sr, cp, sp = math.cos(roll), math.sin(roll), math.cos(pitch), math.sin(pitch)
    cy, sy = math.cos(yaw), math.sin(yaw)
    return np.array(
        (
            (cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr),
            (sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr),
            (-sp, cp * sr, cp * cr),
        )
    )


def turned_in_plane(x: float, y: float, angle: float) -> tuple[float, float]:
    """A vector in the plane turned by an angle [rad]."""
    cosine, sine = math.cos(angle), math.sin(angle)
    return cosine * x - sine * y, sine * x + cosine * y
