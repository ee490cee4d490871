"""Numba kernels of the IMU: its triads and its attitude. Equations and sources in `inertial_errors` and `imu`;
quaternions x y z w, body in world.
"""

import numpy as np

from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray
from sojourn_physics.sensors.inertial_errors import (
    BIAS,
    BIAS_PER_KELVIN,
    CORRELATION_TIMES,
    FLICKER,
    FLICKER_SHARES,
    G_ROW,
    MATRIX_ROW,
    PROCESSES,
    QUANTUM,
    RANDOM_WALK,
    RANGE,
    RATE_WALK,
    REMAINDER,
    SCALE_PER_KELVIN,
    WALK,
)


@njit(cache=True)
def read_triads(
    axes: FloatArray, memory: FloatArray, truth: FloatArray, warmer: float, dt: float, noise: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """What gyros and accelerometers read, shape (6,), and remember.

    Args:
        axes, memory: as `inertial_errors.drawn` gives them. truth: rate [rad/s] and specific force [m/s^2], shape (6,).
        warmer: temperature over that of the calibration [K].
        noise: standard normal, shape (6,) or, with drift, (6 + 6 WALK,).
    """
    reading, after = np.empty(6), np.zeros_like(memory)
    root, drifts = np.sqrt(dt), memory.shape[1] > PROCESSES
    if drifts:
        wander(axes, memory, after, dt, noise)
    for i in range(6):
        axis, first = axes[i], 3 * (i // 3)
        value = axis[BIAS] + axis[RANDOM_WALK] / root * noise[i]
        for j in range(3):
            value += axis[MATRIX_ROW + j] * truth[first + j]
        for j in range(3):
            value += axis[G_ROW + j] * truth[3 + j]
        value += warmer * (axis[BIAS_PER_KELVIN] + axis[SCALE_PER_KELVIN] * truth[i])
        if drifts:
            for p in range(PROCESSES, WALK + 1):
                value += after[i, p]
        value = min(max(value, -axis[RANGE]), axis[RANGE])
        if axis[QUANTUM] > 0.0:
            increment = memory[i, REMAINDER] + value * dt
            counted = np.floor(increment / axis[QUANTUM] + 0.5) * axis[QUANTUM]
            after[i, REMAINDER] = increment - counted
            value = counted / dt
        reading[i] = value
    return reading, after


@njit(cache=True)
def wander(axes: FloatArray, memory: FloatArray, after: FloatArray, dt: float, noise: FloatArray) -> None:
    """Flicker and rate random walk of the axes, `dt` [s] later, into `after`; shapes as in `read_triads`."""
    place = 6
    for p in range(len(CORRELATION_TIMES)):
        ratio = dt / CORRELATION_TIMES[p]
        keep, spread = np.exp(-ratio), FLICKER_SHARES[p] * np.sqrt(-np.expm1(-2.0 * ratio))
        for i in range(6):
            after[i, PROCESSES + p] = keep * memory[i, PROCESSES + p] + spread * axes[i, FLICKER] * noise[place]
            place += 1
    root = np.sqrt(dt)
    for i in range(6):
        after[i, WALK] = memory[i, WALK] + root * axes[i, RATE_WALK] * noise[place]
        place += 1


@njit(cache=True)
def levelling_force(
    axes: FloatArray, memory: FloatArray, truth: FloatArray, warmer: float, averaged: float, noise: FloatArray
) -> FloatArray:
    """Mean of the specific force that accelerometers at rest read in the time `averaged` [s] before, (3,) [m/s^2].

    Of a Gauss-Markov process that is now x the mean, fading over the time A, is r x with r = T/(T + A), and its
    variance s^2 r (1 - r). The other arguments are those of `read_triads`.
    """
    mean, root = np.empty(3), np.sqrt(averaged)
    for i in range(3):
        axis, past = axes[3 + i], memory[3 + i]
        sigma, drift = axis[RANDOM_WALK] / root, warmer * axis[BIAS_PER_KELVIN]
        if memory.shape[1] > PROCESSES:
            variance = sigma**2
            for p in range(len(CORRELATION_TIMES)):
                part = CORRELATION_TIMES[p] / (CORRELATION_TIMES[p] + averaged)
                drift += part * past[PROCESSES + p]
                variance += (FLICKER_SHARES[p] * axis[FLICKER]) ** 2 * part * (1.0 - part)
            sigma = np.sqrt(variance)
        value = axis[BIAS] + sigma * noise[3 + i]
        for j in range(3):
            value += axis[MATRIX_ROW + j] * truth[3 + j]
        mean[i] = value + drift
    return mean


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
