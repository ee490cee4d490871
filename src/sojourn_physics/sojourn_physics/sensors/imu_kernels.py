"""Numba kernels of the IMU's attitude. Equations and sources in `imu`; quaternions x y z w, body in world."""

import numpy as np

from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray


@njit(cache=True)
def measure(matrix: FloatArray, truth: FloatArray, bias: FloatArray, sigma: float, noise: FloatArray) -> FloatArray:
    """matrix truth + bias + sigma noise, for a triad: shapes (3, 3) and (3,)."""
    reading = np.empty(3)
    for i in range(3):
        reading[i] = bias[i] + sigma * noise[i]
        for j in range(3):
            reading[i] += matrix[i, j] * truth[j]
    return reading


@njit(cache=True)
def attitude_from_specific_force(force: FloatArray, heading: float) -> FloatArray:
    """Attitude whose "up" is along `force` (shape (3,), any length) and whose x axis has the heading [rad].

    A force too small to tell a direction gives a level attitude.
    """
    if force[0] ** 2 + force[1] ** 2 + force[2] ** 2 > 1e-20:
        roll = np.arctan2(force[1], force[2])
        pitch = np.arctan2(-force[0], np.sqrt(force[1] ** 2 + force[2] ** 2))
    else:
        roll, pitch = 0.0, 0.0
    cr, sr = np.cos(0.5 * roll), np.sin(0.5 * roll)
    cp, sp = np.cos(0.5 * pitch), np.sin(0.5 * pitch)
    cy, sy = np.cos(0.5 * heading), np.sin(0.5 * heading)
    return np.array(
        (
            sr * cp * cy - cr * sp * sy,
            cr * sp * cy + sr * cp * sy,
            cr * cp * sy - sr * sp * cy,
            cr * cp * cy + sr * sp * sy,
        )
    )


@njit(cache=True)
def attitude_step(
    orientation: FloatArray,
    rate: FloatArray,
    force: FloatArray,
    dt: float,
    gain: float,
    gate: float,
    gravity: float,
) -> FloatArray:
    """Attitude, shape (4,), after `rate` [rad/s] for `dt` [s], levelled by `force` [m/s^2], shapes (3,)."""
    turned = turn(orientation, rate[0] * dt, rate[1] * dt, rate[2] * dt)
    length = np.sqrt(force[0] ** 2 + force[1] ** 2 + force[2] ** 2)
    if abs(length - gravity) < gate * gravity:
        # The world's vertical in the body at the end of the period: by the gyros, by the accelerometers.
        x, y, z, w = turned[0], turned[1], turned[2], turned[3]
        ux, uy, uz = 2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)
        fx, fy, fz = force[0] / length, force[1] / length, force[2] / length
        k = gain * dt
        turned = turn(turned, k * (fy * uz - fz * uy), k * (fz * ux - fx * uz), k * (fx * uy - fy * ux))
    unit: FloatArray = turned / np.sqrt((turned**2).sum())
    return unit


@njit(cache=True)
def turn(orientation: FloatArray, about_x: float, about_y: float, about_z: float) -> FloatArray:
    """Attitude, shape (4,), turned by a rotation vector in the body frame [rad]."""
    x, y, z, w = orientation[0], orientation[1], orientation[2], orientation[3]
    half = 0.5 * np.sqrt(about_x * about_x + about_y * about_y + about_z * about_z)
    # sin(a)/a near 0 by its series, so that rest divides by nothing.
    scale = 0.5 * (np.sin(half) / half if half > 1e-8 else 1.0 - half * half / 6.0)
    px, py, pz, pw = about_x * scale, about_y * scale, about_z * scale, np.cos(half)
    return np.array(
        (
            w * px + x * pw + y * pz - z * py,
            w * py - x * pz + y * pw + z * px,
            w * pz + x * py - y * px + z * pw,
            w * pw - x * px - y * py - z * pz,
        )
    )
