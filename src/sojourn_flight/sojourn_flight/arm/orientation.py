"""Orientation as matrix, quaternion, rotation vector, roll-pitch-yaw and Euler angles, with their singularities.

The arithmetic is scipy's Rotation. Roll, pitch, yaw are turns about the fixed axes x, y, z in this order, as in URDF
and REP 103: R = Rz(yaw) Ry(pitch) Rx(roll). Euler angles are turns about the moving axes; the sequence ZYZ is that of
a roll-bend-roll wrist.

Every set of three numbers has orientations where it fails (Stuelpnagel, SIAM Review 6(4), 1964): roll-pitch-yaw where
the pitch is a right angle, Euler angles where the middle one is 0 or half a turn (only the sum or the difference of the
other two is then known), the rotation vector at half a turn (both senses of its axis are right). The quaternion has
none, but q and -q are the same orientation; here w >= 0.
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray

NEAR = 1.0e-6
"""An angle that is so near to a singular one counts as singular [rad]."""


@dataclass(frozen=True, slots=True, eq=False)
class Orientation:
    """One orientation in every form."""

    quaternion_xyzw: FloatArray  # (4,) unit, w >= 0
    rotation_vector: FloatArray  # (3,) [rad]
    roll_pitch_yaw: FloatArray  # (3,) about fixed x, y, z [rad]
    euler_zyz: FloatArray  # (3,) about moving z, y, z [rad]
    singularities: tuple[str, ...]  # the forms that are not unique here, in words


def orientation_of(rotation: FloatArray) -> Orientation:
    """Every form of a rotation matrix (3, 3).

    Raises:
        InvalidValueError: not a rotation within 1e-6.
    """
    matrix = np.asarray(rotation, dtype=np.float64)
    if matrix.shape != (3, 3) or not np.all(np.isfinite(matrix)):
        raise InvalidValueError("rotation", matrix.tolist(), "a 3 x 3 matrix of finite numbers")
    if np.max(np.abs(matrix @ matrix.T - np.eye(3))) > 1e-6 or np.linalg.det(matrix) < 0.0:
        raise InvalidValueError("rotation", matrix.tolist(), "a rotation matrix: orthogonal, determinant +1")
    turn = Rotation.from_matrix(matrix)
    vector = turn.as_rotvec()
    rpy = turn.as_euler("xyz", suppress_warnings=True)
    zyz = _euler_zyz(matrix)
    found = []
    if abs(np.linalg.norm(vector) - math.pi) < NEAR:
        found.append("rotation vector: half a turn, both senses of the axis are right")
    if abs(abs(rpy[1]) - 0.5 * math.pi) < NEAR:
        found.append("roll-pitch-yaw: pitch is a right angle, roll and yaw turn about one axis")
    if abs(math.sin(zyz[1])) < NEAR:
        found.append("Euler ZYZ: the middle angle is 0 or half a turn, the outer two turn about one axis")
    return Orientation(turn.as_quat(canonical=True), vector, rpy, zyz, tuple(found))


def from_quaternion(quaternion_xyzw: FloatArray) -> FloatArray:
    """Rotation matrix (3, 3) of a quaternion (4,), whose length may be off by 1 %."""
    values = _finite("quaternion", quaternion_xyzw, 4)
    if abs(np.linalg.norm(values) - 1.0) > 0.01:
        raise InvalidValueError("quaternion", values.tolist(), "a unit quaternion x, y, z, w")
    return np.asarray(Rotation.from_quat(values).as_matrix())


def from_rotation_vector(vector: FloatArray) -> FloatArray:
    """Rotation matrix (3, 3) of a rotation vector (3,) [rad]."""
    return np.asarray(Rotation.from_rotvec(_finite("rotation vector", vector, 3)).as_matrix())


def from_roll_pitch_yaw(angles: FloatArray) -> FloatArray:
    """Rotation matrix (3, 3) of roll, pitch, yaw (3,) [rad]."""
    return np.asarray(Rotation.from_euler("xyz", _finite("roll, pitch, yaw", angles, 3)).as_matrix())


def _euler_zyz(matrix: FloatArray) -> FloatArray:
    """Angles about moving z, y, z [rad], the second in 0..pi. The third follows from the sum or the difference of the
    outer two, which are well determined where one of them alone is not.
    """
    second = math.atan2(math.hypot(matrix[0, 2], matrix[1, 2]), matrix[2, 2])
    first = math.atan2(matrix[1, 2], matrix[0, 2])
    if matrix[2, 2] >= 0.0:
        third = math.atan2(matrix[1, 0] - matrix[0, 1], matrix[0, 0] + matrix[1, 1]) - first
    else:
        third = first - math.atan2(-(matrix[1, 0] + matrix[0, 1]), matrix[1, 1] - matrix[0, 0])
    return np.array([first, second, math.remainder(third, 2.0 * math.pi)])


def from_euler_zyz(angles: FloatArray) -> FloatArray:
    """Rotation matrix (3, 3) of Euler angles about moving z, y, z (3,) [rad]."""
    return np.asarray(Rotation.from_euler("ZYZ", _finite("Euler angles", angles, 3)).as_matrix())


def _finite(name: str, values: FloatArray, count: int) -> FloatArray:
    array = np.asarray(values, dtype=np.float64)
    if array.shape != (count,) or not np.all(np.isfinite(array)):
        raise InvalidValueError(name, array.tolist(), f"{count} finite numbers")
    return array
