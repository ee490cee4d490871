"""Kernels of the odometry: arc, covariance. Equations and sources are in `odometry`."""

import math
from typing import NamedTuple

import numpy as np

from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray

START_POSITION_VARIANCE = 1e-6
"""Variance of the start position [m^2]: zero by definition, but a covariance must be positive definite."""
START_YAW_VARIANCE = 1.6e-7
"""Variance of the start heading [rad^2]: a machine is put down within 1 mrad of what is asked for, mostly 0.4 mrad."""
CLONED_YAW_VARIANCE = 1e-10
"""Of the heading of a clone against the original [rad^2], for the same reason."""
STANDING_RATE_VARIANCE = 1e-8
"""Variance of a velocity that is zero because the rover stands [m^2/s^2 or rad^2/s^2]."""


class AddedVariances(NamedTuple):
    """Q: what a period adds to the variances of the states."""

    slip: float
    """[-]"""
    side: float
    """[-]"""
    move: float
    """Of x and of y [m^2]."""
    yaw: float
    """[rad^2]"""
    bias: float
    """[rad^2/s^2]"""


class Ways(NamedTuple):
    """Of a period, in odom: x, y [m]."""

    moved: tuple[float, float]
    """D: the displacement."""
    told: tuple[float, float]
    """T: what it would be without the correction of slip."""
    side: tuple[float, float]
    """S: as far as D, to the left of it."""


@njit(cache=True)
def body_arc(v_x: float, v_y: float, turn: float, dt: float) -> tuple[float, float]:
    """Displacement in the body plane at the start of a period [m] while the body turns by `turn` [rad]."""
    if abs(turn) < 1e-4:
        sine = 1.0 - turn * turn / 6.0
        versine = 0.5 * turn - turn**3 / 24.0
    else:
        sine = math.sin(turn) / turn
        versine = (1.0 - math.cos(turn)) / turn
    return dt * (sine * v_x - versine * v_y), dt * (versine * v_x + sine * v_y)


@njit(cache=True)
def propagate(
    covariance: FloatArray,
    ways: Ways,
    bias_gain: float,
    slip_kept: float,
    added: AddedVariances,
) -> FloatArray:
    """F P F^T + Q for one period. States beyond the six of the odometry are constants.

    Args:
        bias_gain: g [s]. slip_kept: what is left of the old slip [-].
    """
    move_x, move_y = ways.moved
    told_x, told_y = ways.told
    side_x, side_y = ways.side
    result = covariance.copy()
    # F differs from the identity in its first five rows only: F P row by row, and the same once more for the columns.
    # The bias turns the heading while the rover moves: half of the period's turn counts for its displacement.
    for _ in range(2):
        for j in range(covariance.shape[0]):
            turned = result[2, j] - 0.5 * bias_gain * result[5, j]
            result[0, j] += -move_y * turned - told_x * result[3, j] + side_x * result[4, j]
            result[1, j] += move_x * turned - told_y * result[3, j] + side_y * result[4, j]
            result[2, j] -= bias_gain * result[5, j]
            result[3, j] *= slip_kept
            result[4, j] *= slip_kept
        result = result.T.copy()
    for i in range(covariance.shape[0]):
        for j in range(i):
            result[i, j] = result[j, i]
    result[0, 0] += added.move
    result[1, 1] += added.move
    result[2, 2] += added.yaw
    result[3, 3] += added.slip
    result[4, 4] += added.side
    result[5, 5] += added.bias
    return result


@njit(cache=True)
def rescaled(covariance: FloatArray, place: int, ratio: float) -> FloatArray:
    """The covariance with the standard deviation of one state multiplied, correlations as they are."""
    result = covariance.copy()
    result[place] *= ratio
    result[:, place] *= ratio
    return result


@njit(cache=True)
def cloned(covariance: FloatArray, variance: float) -> FloatArray:
    """The covariance with its last three states made anew as copies of x, y, yaw, and more `variance` of x and y."""
    size = covariance.shape[0]
    result = covariance.copy()
    for i in range(3):
        result[size - 3 + i] = result[i]
    for i in range(3):
        result[:, size - 3 + i] = result[:, i]
    result[size - 3, size - 3] += variance
    result[size - 2, size - 2] += variance
    result[size - 1, size - 1] += CLONED_YAW_VARIANCE
    return result


@njit(cache=True)
def widened(covariance: FloatArray, way_x: float, way_y: float, sigma: float) -> FloatArray:
    """The covariance with an unknown slip and side slip of standard deviation `sigma` over the way [m] so far."""
    result = covariance.copy()
    for place, x, y in ((3, -way_x, -way_y), (4, -way_y, way_x)):
        part = np.zeros(covariance.shape[0])
        part[0], part[1], part[place] = sigma * x, sigma * y, sigma
        result += np.outer(part, part)
    return result


@njit(cache=True)
def update_bias(covariance: FloatArray, noise_variance: float) -> tuple[float, FloatArray]:
    """Gain and covariance after the standing gyro has measured its bias; other states are left alone."""
    gain = covariance[5, 5] / (covariance[5, 5] + noise_variance)
    result = covariance.copy()
    for i in range(covariance.shape[0]):
        result[i, 5] *= 1.0 - gain
        result[5, i] = result[i, 5]
    result[5, 5] = (1.0 - gain) ** 2 * covariance[5, 5] + gain * gain * noise_variance
    return gain, result


@njit(cache=True)
def update_all(
    covariance: FloatArray, row: FloatArray, noise_variance: float, innovation: float
) -> tuple[FloatArray, FloatArray]:
    """Change of the states and covariance (Joseph's form) after a measurement of row . states; shapes (n,), (n, n)."""
    size = covariance.shape[0]
    carried = covariance @ row
    gain = carried / (row @ carried + noise_variance)
    result = np.empty((size, size))
    middle = row @ carried
    for i in range(size):
        for j in range(size):
            result[i, j] = (
                covariance[i, j]
                - gain[i] * carried[j]
                - carried[i] * gain[j]
                + gain[i] * gain[j] * (middle + noise_variance)
            )
    return gain * innovation, result


@njit(cache=True)
def covariances_of(
    covariance: FloatArray,
    tilt_sigma: float,
    height: float,
    white: float,
    lasting: float,
    side: float,
    gyro: float,
) -> tuple[FloatArray, FloatArray]:
    """The covariances of pose and twist of a message, (6, 6) each.

    Args:
        covariance: of the states. tilt_sigma: [rad]. height: variance of z [m^2].
        white, lasting, side: variances of the velocities, new in each period, of the slip, aside [m^2/s^2].
        gyro: variance [rad^2/s^2].
    """
    pose, twist = np.zeros((6, 6)), np.zeros((6, 6))
    pose[0, 0], pose[0, 1], pose[1, 1] = covariance[0, 0], covariance[0, 1], covariance[1, 1]
    pose[0, 5], pose[1, 5], pose[5, 5] = covariance[0, 2], covariance[1, 2], covariance[2, 2]
    pose[1, 0], pose[5, 0], pose[5, 1] = pose[0, 1], pose[0, 5], pose[1, 5]
    pose[2, 2] = height
    pose[3, 3] = pose[4, 4] = tilt_sigma**2
    twist[0, 0] = STANDING_RATE_VARIANCE + white + lasting
    twist[1, 1] = STANDING_RATE_VARIANCE + white + side
    twist[2, 2] = STANDING_RATE_VARIANCE + side
    twist[3, 3] = twist[4, 4] = twist[5, 5] = STANDING_RATE_VARIANCE + gyro
    return pose, twist
