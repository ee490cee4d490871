"""Rotation matrices as quaternions."""

import numpy as np
import pinocchio as pin

from sojourn_machine.params import FloatArray

_HERE: FloatArray = np.zeros(3)


def quaternion_of(rotation: FloatArray) -> FloatArray:
    """Quaternion x y z w of a rotation matrix (3, 3), shape (4,).

    By way of a placement: `pinocchio.Quaternion(rotation)` has the same numbers, but each that is made of a matrix
    leaves 80 bytes behind (4.1.0), in a node that makes one each period some 350 MB a day.
    """
    quaternion: FloatArray = pin.SE3ToXYZQUAT(pin.SE3(rotation, _HERE))[3:]
    return quaternion
