"""True motion of an inertial sensor from the truth of the base: differences of attitude and velocity over a period, and
the lever arm.
"""

from dataclasses import dataclass
from math import atan2, sqrt
from typing import TypeAlias

import numpy as np

from sojourn_contract.values import Odometry
from sojourn_machine.mounting import IMU_LINK, mounting
from sojourn_machine.params import FloatArray
from sojourn_machine.rotations import quaternion_of
from sojourn_physics.environment.gravity.field import GravityField

Vector: TypeAlias = tuple[float, float, float]
"""Three numbers: of so few numpy would take most of the time to be called."""


@dataclass(frozen=True, slots=True)
class InertialMotion:
    """Of the sensor, in its own frame, each (3,): angular velocity [rad/s], acceleration less gravity
    [m/s^2].
    """

    angular_velocity: FloatArray
    specific_force: FloatArray


@dataclass(frozen=True, slots=True)
class MotionBefore:
    """Of the period before: what is remembered."""

    velocity: FloatArray
    """Of the sensor in map, (3,) [m/s]."""
    orientation: FloatArray
    """Of the base in map, quaternion x y z w."""


class ImuMotion:
    """What an ideal IMU on a link of the machine feels.

    Velocity of the link  v = R (v_base + ω × r);  specific force = R_imuᵀ (Δv/Δt - g);  angular velocity = rotation
    vector of R_beforeᵀ R over Δt. Both are means over the period, as an IMU gives them that integrates (Titterton and
    Weston 2004, sec. 11.2): a machine that shakes within a period would else seem to turn.

    Args:
        urdf_xml: the machine. gravity: in map. link: of the sensor.
    """

    def __init__(self, urdf_xml: str, gravity: GravityField, link: str = IMU_LINK) -> None:
        self._rotation_imu_to_base, lever = mounting(urdf_xml, link)
        self._into_imu = self._rotation_imu_to_base.T.tolist()
        self._lever: Vector = tuple(lever.tolist())
        self._gravity = gravity

    def orientation_imu_in_map(self, orientation_base_in_map: FloatArray) -> FloatArray:
        """Quaternion x y z w of the IMU from that of the base."""
        rotation = rotation_matrix(orientation_base_in_map) @ self._rotation_imu_to_base
        return quaternion_of(rotation)

    def felt(self, before: MotionBefore | None, odometry: Odometry, dt: float) -> tuple[MotionBefore, InertialMotion]:
        """Motion at the end of a period of `dt` [s], from the base's true odometry; `before` None in the first."""
        orientation = odometry.orientation
        rotation = rotation_matrix(orientation)
        (vx, vy, vz), (wx, wy, wz), (x, y, z) = odometry.linear.tolist(), odometry.angular.tolist(), self._lever
        velocity = rotation @ np.array((vx + (wy * z - wz * y), vy + (wz * x - wx * z), vz + (wx * y - wy * x)))
        if before is None:
            ax, ay, az, mean = 0.0, 0.0, 0.0, (wx, wy, wz)
        else:
            ax, ay, az = ((velocity - before.velocity) / dt).tolist()
            rx, ry, rz = rotation_vector(before.orientation, orientation)
            mean = (rx / dt, ry / dt, rz / dt)
        gx, gy, gz = self._gravity.acceleration(odometry.position, rotation @ odometry.linear).tolist()
        specific = _turned(rotation.T.tolist(), (ax - gx, ay - gy, az - gz))
        motion = InertialMotion(np.array(_turned(self._into_imu, mean)), np.array(_turned(self._into_imu, specific)))
        return MotionBefore(velocity, orientation), motion


def _turned(rotation: list[list[float]], vector: Vector) -> Vector:
    x, y, z = vector
    (a, b, c), (d, e, f), (g, h, i) = rotation
    return a * x + b * y + c * z, d * x + e * y + f * z, g * x + h * y + i * z


def rotation_vector(before: FloatArray, now: FloatArray) -> Vector:
    """Of the turn between two unit quaternions x y z w, in the body, the shorter way [rad]."""
    a, b, c, d = before.tolist()
    e, f, g, h = now.tolist()
    x, y, z = d * e - a * h - b * g + c * f, d * f + a * g - b * h - c * e, d * g - a * f + b * e - c * h
    w = d * h + a * e + b * f + c * g
    sine = sqrt(x * x + y * y + z * z)
    angle_over_sine = 2.0 * atan2(sine, abs(w)) / sine if sine > 1e-12 else 2.0
    scale = angle_over_sine if w >= 0.0 else -angle_over_sine
    return scale * x, scale * y, scale * z


def rotation_matrix(orientation: FloatArray) -> FloatArray:
    """Of a unit quaternion x y z w: shape (3, 3)."""
    x, y, z, w = orientation.tolist()
    return np.array(
        (
            (1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)),
            (2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)),
            (2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)),
        )
    )
