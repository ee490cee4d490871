"""Steering kinematics of any number of wheels, steered or fixed, about an instantaneous centre of rotation.

Equations. A body that moves over a plane with twist (v_x, v_y, w) in base_link carries a wheel at (x, y) with

    u_x = v_x - w y,   u_y = v_y + w x.

The wheel rolls without sliding if its heading d and its rate q satisfy

    u_x cos d + u_y sin d = r q        (it rolls)
   -u_x sin d + u_y cos d = 0          (it does not slide sideways)

so d = atan2(u_y, u_x) + k pi and q = (-1)^k |u| / r. All axles then meet in the instantaneous centre of
rotation (-v_y / w, v_x / w): Ackermann steering, crab (w = 0) and point turn (v = 0) are the same law. The
representative k is the one inside the steering limits that is nearest to the present angle; a wheel with no
speed keeps its angle. Where no representative is inside, the angle is clipped, the rate is the part of the
velocity along the heading, and the sideways velocity that is left is reported.

The inverse takes the same two lines of all wheels as a linear least-squares problem in (v_x, v_y, w); the
lines "does not slide sideways" carry a weight, since on loose soil and on skid-steered machines they hold
less well.

Sources: Siegwart, Nourbakhsh, Scaramuzza, Introduction to Autonomous Mobile Robots, 2nd ed. (2011), section
3.2 (rolling and sliding constraints); Muir and Neuman, J. Robotic Systems 4 (1987) 281 (least squares over
all wheels).

Assumptions: plane ground, point contact, steering axis through the contact. On uneven ground the wheels
disagree by the differences of their slopes; the least-squares residual shows it. Exact for any speed (pure
kinematics).
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numba import njit

from sojourn_mechanics.errors import InvalidValueError
from sojourn_mechanics.params import FloatArray

NO_SPEED = 1e-10
"""Wheel speed [m/s] below which its direction means nothing and the angle is kept."""


class PlanarTwist(NamedTuple):
    """Motion of base_link in its own x-y plane: v_x, v_y [m/s], yaw_rate [rad/s]."""

    v_x: float
    v_y: float
    yaw_rate: float


class TwistEstimate(NamedTuple):
    """Twist that fits the wheels best, and the root mean square of what does not fit [m/s]."""

    v_x: float
    v_y: float
    yaw_rate: float
    residual: float


@dataclass(frozen=True, slots=True)
class WheelSetpoints:
    """What each wheel has to do for a twist. Arrays have shape (wheels,)."""

    steer_angles: FloatArray
    """[rad], 0 for fixed wheels."""
    wheel_rates: FloatArray
    """[rad/s], positive forward along the heading."""
    residual: FloatArray
    """Velocity across the wheel's heading that the wheel cannot follow [m/s]; 0 where the angle fits."""


@njit(cache=True)
def _reach(angle: float, lower: float, upper: float, present: float) -> float:
    """Heading angle + k pi inside the limits and nearest to `present`, or else the least clipped one."""
    best = angle
    best_miss = math.inf
    best_move = math.inf
    # Forward (even k) first: it wins ties, for a half turn either way from straight ahead.
    for k in (0, 2, -2, 1, -1, 3, -3):
        candidate = angle + k * math.pi
        clipped = min(max(candidate, lower), upper)
        miss = abs(candidate - clipped)
        if miss < 1e-12:
            miss = 0.0
        move = abs(clipped - present)
        if miss < best_miss - 1e-9 or (miss <= best_miss + 1e-9 and move < best_move - 1e-9):
            best, best_miss, best_move = clipped, miss, move
    return best


@njit(cache=True)
def wheels_kernel(
    table: FloatArray,
    v_x: float,
    v_y: float,
    yaw_rate: float,
    present: FloatArray,
    angles: FloatArray,
    rates: FloatArray,
    residual: FloatArray,
) -> None:
    """Fill angles [rad], rates [rad/s] and residual [m/s] for a twist; see `wheels_from_twist`."""
    for i in range(table.shape[0]):
        along = v_x - yaw_rate * table[i, 1]
        across = v_y + yaw_rate * table[i, 0]
        angle = 0.0
        if table[i, 3] > 0.5:
            angle = present[i]
            if math.hypot(along, across) > NO_SPEED:
                angle = _reach(math.atan2(across, along), table[i, 4], table[i, 5], present[i])
        cosine, sine = math.cos(angle), math.sin(angle)
        angles[i] = angle
        rates[i] = (along * cosine + across * sine) / table[i, 2]
        residual[i] = across * cosine - along * sine


@njit(cache=True)
def twist_kernel(
    table: FloatArray, rates: FloatArray, angles: FloatArray, lateral_weight: float
) -> tuple[float, float, float, float]:
    """Weighted least squares of all rolling and sliding lines, by Cholesky of the 3 x 3 normal equations."""
    a00 = a01 = a02 = a11 = a12 = a22 = b0 = b1 = b2 = 0.0
    for i in range(table.shape[0]):
        cosine, sine = math.cos(angles[i]), math.sin(angles[i])
        speed = table[i, 2] * rates[i]
        roll_arm = table[i, 0] * sine - table[i, 1] * cosine
        slide_arm = table[i, 0] * cosine + table[i, 1] * sine
        weight = lateral_weight
        a00 += cosine * cosine + weight * sine * sine
        a01 += (1.0 - weight) * cosine * sine
        a11 += sine * sine + weight * cosine * cosine
        a02 += cosine * roll_arm - weight * sine * slide_arm
        a12 += sine * roll_arm + weight * cosine * slide_arm
        a22 += roll_arm * roll_arm + weight * slide_arm * slide_arm
        b0 += cosine * speed
        b1 += sine * speed
        b2 += roll_arm * speed
    l00 = math.sqrt(a00)
    l10, l20 = a01 / l00, a02 / l00
    l11 = math.sqrt(a11 - l10 * l10)
    l21 = (a12 - l20 * l10) / l11
    l22 = math.sqrt(a22 - l20 * l20 - l21 * l21)
    z0 = b0 / l00
    z1 = (b1 - l10 * z0) / l11
    z2 = (b2 - l20 * z0 - l21 * z1) / l22
    yaw_rate = z2 / l22
    v_y = (z1 - l21 * yaw_rate) / l11
    v_x = (z0 - l10 * v_y - l20 * yaw_rate) / l00
    return v_x, v_y, yaw_rate, _misfit(table, rates, angles, v_x, v_y, yaw_rate)


@njit(cache=True)
def velocity_kernel(
    table: FloatArray, rates: FloatArray, angles: FloatArray, yaw_rate: float, lateral_weight: float
) -> tuple[float, float, float]:
    """v_x, v_y and residual [m/s] that fit the wheels best when the yaw rate is known, from a gyro."""
    a00 = a01 = a11 = b0 = b1 = 0.0
    for i in range(table.shape[0]):
        cosine, sine = math.cos(angles[i]), math.sin(angles[i])
        roll = table[i, 2] * rates[i] - yaw_rate * (table[i, 0] * sine - table[i, 1] * cosine)
        slide = -yaw_rate * (table[i, 0] * cosine + table[i, 1] * sine)
        weight = lateral_weight
        a00 += cosine * cosine + weight * sine * sine
        a01 += (1.0 - weight) * cosine * sine
        a11 += sine * sine + weight * cosine * cosine
        b0 += cosine * roll - weight * sine * slide
        b1 += sine * roll + weight * cosine * slide
    determinant = a00 * a11 - a01 * a01
    v_x = (a11 * b0 - a01 * b1) / determinant
    v_y = (a00 * b1 - a01 * b0) / determinant
    return v_x, v_y, _misfit(table, rates, angles, v_x, v_y, yaw_rate)


@njit(cache=True)
def _misfit(table: FloatArray, rates: FloatArray, angles: FloatArray, v_x: float, v_y: float, yaw_rate: float) -> float:
    """Root mean square over the wheels of the velocity between a wheel's contact and its rolling [m/s]."""
    total = 0.0
    for i in range(table.shape[0]):
        cosine, sine = math.cos(angles[i]), math.sin(angles[i])
        along = v_x - yaw_rate * table[i, 1] - table[i, 2] * rates[i] * cosine
        across = v_y + yaw_rate * table[i, 0] - table[i, 2] * rates[i] * sine
        total += along * along + across * across
    return math.sqrt(total / table.shape[0])


@njit(cache=True)
def limit_kernel(
    table: FloatArray,
    v_x: float,
    v_y: float,
    yaw_rate: float,
    max_speed: float,
    max_yaw_rate: float,
    max_wheel_rate: float,
) -> float:
    """Largest factor up to 1 by which a twist has to be multiplied to be inside all limits."""
    factor = 1.0
    speed = math.hypot(v_x, v_y)
    if speed > max_speed:
        factor = max_speed / speed
    if abs(yaw_rate) * factor > max_yaw_rate:
        factor = max_yaw_rate / abs(yaw_rate)
    for i in range(table.shape[0]):
        along = v_x - yaw_rate * table[i, 1]
        across = v_y + yaw_rate * table[i, 0] if table[i, 3] > 0.5 else 0.0
        rate = math.hypot(along, across) / table[i, 2]
        if rate * factor > max_wheel_rate:
            factor = max_wheel_rate / rate
    return factor


def _checked(table: FloatArray, name: str, array: FloatArray) -> FloatArray:
    """The array as the kernels want it, or an error if it has not one finite number for each wheel."""
    fit = np.ascontiguousarray(array, dtype=np.float64)
    if fit.shape != (table.shape[0],):
        raise InvalidValueError(f"shape of {name}", fit.shape, f"({table.shape[0]},), one for each wheel")
    if not np.isfinite(fit).all():
        raise InvalidValueError(name, fit.tolist(), "finite numbers")
    return fit


def wheels_from_twist(table: FloatArray, twist: PlanarTwist, present_angles: FloatArray) -> WheelSetpoints:
    """Steer angles and wheel rates for a twist.

    Args:
        table: wheels, from `SteeringGeometryParams.table()`.
        twist: wanted motion of base_link.
        present_angles: where the steering is now [rad], shape (wheels,).

    Raises:
        InvalidValueError: if the twist or an angle is not finite, or the shape is wrong.
    """
    present = _checked(table, "present steer angles", present_angles)
    for name, value in zip(twist._fields, twist, strict=True):
        if not math.isfinite(value):
            raise InvalidValueError(f"twist {name}", value, "a finite number")
    angles, rates, residual = np.empty_like(present), np.empty_like(present), np.empty_like(present)
    wheels_kernel(table, float(twist.v_x), float(twist.v_y), float(twist.yaw_rate), present, angles, rates, residual)
    return WheelSetpoints(angles, rates, residual)


def twist_from_wheels(
    table: FloatArray, wheel_rates: FloatArray, steer_angles: FloatArray, lateral_weight: float = 1.0
) -> TwistEstimate:
    """Twist that fits wheel rates [rad/s] and steer angles [rad], both of shape (wheels,), best.

    Args:
        table: wheels, from `SteeringGeometryParams.table()`.
        wheel_rates: measured or commanded rates.
        steer_angles: measured or commanded angles, 0 for fixed wheels.
        lateral_weight: weight of the sliding lines against the rolling lines, above 0 up to 1.

    Raises:
        InvalidValueError: if a number is not finite, the weight out of range or a shape wrong.
    """
    rates = _checked(table, "wheel rates", wheel_rates)
    angles = _checked(table, "steer angles", steer_angles)
    if not 0.0 < lateral_weight <= 1.0:
        raise InvalidValueError("lateral_weight", lateral_weight, "above 0 and at most 1")
    return TwistEstimate(*twist_kernel(table, rates, angles, float(lateral_weight)))


def limited_twist(
    table: FloatArray, twist: PlanarTwist, max_speed: float, max_yaw_rate: float, max_wheel_rate: float
) -> tuple[PlanarTwist, float]:
    """The twist inside the limits with the same centre of rotation, and the factor (0 to 1) that did it."""
    factor = limit_kernel(
        table,
        float(twist.v_x),
        float(twist.v_y),
        float(twist.yaw_rate),
        float(max_speed),
        float(max_yaw_rate),
        float(max_wheel_rate),
    )
    return PlanarTwist(twist.v_x * factor, twist.v_y * factor, twist.yaw_rate * factor), factor
