"""Twist of the body from its wheels: weighted least squares of the lines of all wheels (see `rolling_lines`).

The lines "does not slide sideways" carry a weight, since on loose soil they hold less well than "it rolls". Each
wheel's own weights are in the table; a failed wheel's are zero there.

Source: Muir and Neuman, J. Robotic Systems 4 (1987) 281 (least squares over all wheels). On uneven ground the wheels
disagree by the differences of their slopes; the residual shows it.
"""

import math
from typing import NamedTuple

import numpy as np

from sojourn_flight.mobility.kinematics import checked_wheels
from sojourn_flight.mobility.rolling_lines import rolling_line, sliding_line
from sojourn_flight.mobility.wheel_table import WheelTableColumn
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray

NO_PIVOT = 1e-12
"""Part of a diagonal element below which its unknown cannot be told from the others [-]."""

_RADIUS = int(WheelTableColumn.RADIUS)
_ROLL_WEIGHT = int(WheelTableColumn.ROLL_WEIGHT)
_SLIDE_WEIGHT = int(WheelTableColumn.SLIDE_WEIGHT)


class TwistEstimate(NamedTuple):
    """Twist that fits the wheels best, and the root mean square of what does not fit [m/s]."""

    v_x: float
    v_y: float
    yaw_rate: float
    residual: float


@njit(cache=True)
def twist_kernel(
    table: FloatArray, rates: FloatArray, angles: FloatArray, steer_rates: FloatArray, lateral_weight: float
) -> tuple[float, float, float, float]:
    """v_x, v_y, yaw rate and residual, by Cholesky of the 3 x 3 normal equations.

    What the wheels cannot tell (all that know it have failed) is taken as zero.
    """
    a00 = a01 = a02 = a11 = a12 = a22 = b0 = b1 = b2 = 0.0
    for i in range(table.shape[0]):
        weight = table[i, _ROLL_WEIGHT]
        x, y, w, known = rolling_line(table[i], angles[i], steer_rates[i])
        right = table[i, _RADIUS] * rates[i] - known
        for line in range(2):
            if line == 1:
                weight = lateral_weight * table[i, _SLIDE_WEIGHT]
                x, y, w, known = sliding_line(table[i], angles[i], steer_rates[i])
                right = -known
            a00 += weight * x * x
            a01 += weight * x * y
            a11 += weight * y * y
            a02 += weight * x * w
            a12 += weight * y * w
            a22 += weight * w * w
            b0 += weight * x * right
            b1 += weight * y * right
            b2 += weight * w * right
    l00 = math.sqrt(a00)
    over_0 = 1.0 / l00 if l00 > 0.0 else 0.0
    l10, l20, z0 = a01 * over_0, a02 * over_0, b0 * over_0
    pivot = a11 - l10 * l10
    over_1 = 1.0 / math.sqrt(pivot) if pivot > NO_PIVOT * a11 else 0.0
    l21, z1 = (a12 - l20 * l10) * over_1, (b1 - l10 * z0) * over_1
    pivot = a22 - l20 * l20 - l21 * l21
    over_2 = 1.0 / math.sqrt(pivot) if pivot > NO_PIVOT * a22 else 0.0
    yaw_rate = (b2 - l20 * z0 - l21 * z1) * over_2 * over_2
    v_y = (z1 - l21 * yaw_rate) * over_1
    v_x = (z0 - l10 * v_y - l20 * yaw_rate) * over_0
    return v_x, v_y, yaw_rate, _misfit(table, rates, angles, steer_rates, v_x, v_y, yaw_rate)


@njit(cache=True)
def velocity_kernel(
    table: FloatArray,
    rates: FloatArray,
    angles: FloatArray,
    steer_rates: FloatArray,
    yaw_rate: float,
    lateral_weight: float,
) -> tuple[float, float, float]:
    """v_x, v_y and residual [m/s] that fit the wheels best when the yaw rate is known, from a gyro."""
    a00 = a01 = a11 = b0 = b1 = 0.0
    for i in range(table.shape[0]):
        weight = table[i, _ROLL_WEIGHT]
        x, y, w, known = rolling_line(table[i], angles[i], steer_rates[i])
        right = table[i, _RADIUS] * rates[i] - known - yaw_rate * w
        for line in range(2):
            if line == 1:
                weight = lateral_weight * table[i, _SLIDE_WEIGHT]
                x, y, w, known = sliding_line(table[i], angles[i], steer_rates[i])
                right = -known - yaw_rate * w
            a00 += weight * x * x
            a01 += weight * x * y
            a11 += weight * y * y
            b0 += weight * x * right
            b1 += weight * y * right
    determinant = a00 * a11 - a01 * a01
    if determinant <= NO_PIVOT * a00 * a11:
        v_x = b0 / a00 if a00 > 0.0 else 0.0
        return v_x, 0.0, _misfit(table, rates, angles, steer_rates, v_x, 0.0, yaw_rate)
    v_x = (a11 * b0 - a01 * b1) / determinant
    v_y = (a00 * b1 - a01 * b0) / determinant
    return v_x, v_y, _misfit(table, rates, angles, steer_rates, v_x, v_y, yaw_rate)


@njit(cache=True)
def _misfit(
    table: FloatArray,
    rates: FloatArray,
    angles: FloatArray,
    steer_rates: FloatArray,
    v_x: float,
    v_y: float,
    yaw_rate: float,
) -> float:
    """Root mean square over the wheels of the velocity between a wheel's contact and its rolling [m/s]."""
    total = 0.0
    for i in range(table.shape[0]):
        x, y, w, known = rolling_line(table[i], angles[i], steer_rates[i])
        miss = x * v_x + y * v_y + w * yaw_rate + known - table[i, _RADIUS] * rates[i]
        total += table[i, _ROLL_WEIGHT] * miss * miss
        x, y, w, known = sliding_line(table[i], angles[i], steer_rates[i])
        miss = x * v_x + y * v_y + w * yaw_rate + known
        total += table[i, _SLIDE_WEIGHT] * miss * miss
    return math.sqrt(total / table.shape[0])


def twist_from_wheels(
    table: FloatArray,
    wheel_rates: FloatArray,
    steer_angles: FloatArray,
    lateral_weight: float = 1.0,
    steer_rates: FloatArray | None = None,
) -> TwistEstimate:
    """Twist that fits wheel rates [rad/s] and steer angles [rad], both of shape (wheels,), best.

    Args:
        table: wheels, from `SteeringGeometryParams.table()`.
        wheel_rates: measured or commanded rates.
        steer_angles: measured or commanded angles, 0 for fixed wheels.
        lateral_weight: weight of the sliding lines against the rolling lines, above 0 up to 1.
        steer_rates: rates of the steering [rad/s], none for zero. They matter where a joint does not turn a wheel
            about its own contact.

    Raises:
        InvalidValueError: if a number is not finite, the weight out of range or a shape wrong.
    """
    rates = checked_wheels(table, "wheel rates", wheel_rates)
    angles = checked_wheels(table, "steer angles", steer_angles)
    turning = checked_wheels(table, "steer rates", np.zeros(len(table)) if steer_rates is None else steer_rates)
    if not 0.0 < lateral_weight <= 1.0:
        raise InvalidValueError("lateral_weight", lateral_weight, "above 0 and at most 1")
    return TwistEstimate(*twist_kernel(table, rates, angles, turning, float(lateral_weight)))
