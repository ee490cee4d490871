"""Steering kinematics of any machine: from the twist wanted of base_link to steer angles and wheel rates.

Equations. A joint at the pivot P turns wheels (a single one about its own contact, or a whole body of them: articulated
steering) that act at the distance c_x ahead of it, seen in the turned body. The pivot moves with V = v + w z x P.
The wheels do not slide sideways (see `rolling_lines`) if, with the joint at rest,

    |V| sin(q - d) = c_x w,   d = atan2(V_y, V_x)
    q = d + asin(c_x w / |V|)   or   q = d - asin(c_x w / |V|) + pi,   both + 2 k pi

so that all axles meet in the instantaneous centre of rotation (-v_y / w, v_x / w): Ackermann steering, crab (w = 0),
point turn (v = 0) and articulated steering are the same law; a wheel steered about its contact has c_x = 0. The
representative is the one inside the steering limits that is nearest to the present angle; a pivot with no speed keeps
its angle. Where none is inside, the angle is clipped. Each wheel then rolls as its rolling line says, and the sideways
velocity that it cannot follow is reported. Wheels with rollers slide along them freely and follow every twist; fixed
wheels at different places along the body scrub in a turn by nature (see `wheel_table`).

While a joint is still on its way its wheels allow other twists only: `allowed_twist` gives the one that slides least
for the forward speed asked for (for two bodies with an axle each, that of `vehicle.articulated`, the joint's own rate
included, and without any sliding).

Sources: Siegwart, Nourbakhsh, Scaramuzza, Introduction to Autonomous Mobile Robots, 2nd ed. (2011), section 3.2;
Corke and Ridley, IEEE Trans. Robotics and Automation 17 (2001) 215 (articulated steering with its rate); Muir and
Neuman, J. Robotic Systems 4 (1987) 281 (Mecanum).

Assumptions: plane ground, point contact, vertical steering axes, at most one joint between base_link and a wheel. Exact
for any speed (pure kinematics).
"""

import math
from dataclasses import dataclass

import numpy as np

from sojourn_flight.mobility.rolling_lines import rolling_line, sliding_line
from sojourn_flight.mobility.twist import PlanarTwist
from sojourn_flight.mobility.wheel_table import WheelTableColumn
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray

NO_SPEED = 1e-10
"""Speed of a pivot [m/s] below which its direction means nothing and the angle is kept."""
TRUST_IN_WISH = 1e-12
"""Weight of the wanted twist against the sliding lines: it decides only what these leave open [-]."""

_X = int(WheelTableColumn.X)
_Y = int(WheelTableColumn.Y)
_RADIUS = int(WheelTableColumn.RADIUS)
_STEERED = int(WheelTableColumn.STEERED)
_STEER_MIN = int(WheelTableColumn.STEER_MIN)
_STEER_MAX = int(WheelTableColumn.STEER_MAX)
_PIVOT_X = int(WheelTableColumn.PIVOT_X)
_PIVOT_Y = int(WheelTableColumn.PIVOT_Y)
_ARM_X = int(WheelTableColumn.ARM_X)
_ARM_Y = int(WheelTableColumn.ARM_Y)
_ROLLER = int(WheelTableColumn.ROLLER)
_SLIDE_WEIGHT = int(WheelTableColumn.SLIDE_WEIGHT)
_MAX_RATE = int(WheelTableColumn.MAX_RATE)


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
def _reach(direction: float, lead: float, lower: float, upper: float, present: float) -> float:
    """Heading inside the limits and nearest to `present`, or else the least clipped one.

    Headings are direction + lead, and direction - lead + pi for rolling backwards, each + 2 k pi.
    """
    best = direction
    best_miss = math.inf
    best_move = math.inf
    # Forward (even k) first: it wins ties, for a half turn either way from straight ahead.
    for k in (0, 2, -2, 1, -1, 3, -3):
        candidate = direction + (lead if k % 2 == 0 else -lead) + k * math.pi
        clipped = min(max(candidate, lower), upper)
        miss = abs(candidate - clipped)
        if miss < 1e-12:
            miss = 0.0
        move = abs(clipped - present)
        if miss < best_miss - 1e-9 or (miss <= best_miss + 1e-9 and move < best_move - 1e-9):
            best, best_miss, best_move = clipped, miss, move
    return best


@njit(cache=True)
def _steer_angle(row: FloatArray, v_x: float, v_y: float, yaw_rate: float, present: float) -> float:
    """Angle of the joint that turns a wheel [rad] for a twist."""
    along = v_x - yaw_rate * row[_PIVOT_Y]
    across = v_y + yaw_rate * row[_PIVOT_X]
    speed = math.hypot(along, across)
    if speed <= NO_SPEED:
        return present
    lead = math.asin(min(max(row[_ARM_X] * yaw_rate / speed, -1.0), 1.0))
    return float(_reach(math.atan2(across, along), lead, row[_STEER_MIN], row[_STEER_MAX], present))


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
        row = table[i]
        angle = 0.0
        if row[_STEERED] > 0.5:
            angle = _steer_angle(row, v_x, v_y, yaw_rate, present[i])
        angles[i] = angle
        a_x, a_y, a_w, _ = rolling_line(row, angle, 0.0)
        rates[i] = (a_x * v_x + a_y * v_y + a_w * yaw_rate) / row[_RADIUS]
        # where the wheel is, which for a wheel that scrubs by nature is not where it acts
        cosine, sine = math.cos(angle), math.sin(angle)
        arm_x, arm_y = row[_X] - row[_PIVOT_X], row[_Y] - row[_PIVOT_Y]
        along = v_x - yaw_rate * (row[_PIVOT_Y] + (sine * arm_x + cosine * arm_y))
        across = v_y + yaw_rate * (row[_PIVOT_X] + (cosine * arm_x - sine * arm_y))
        residual[i] = across * cosine - along * sine if row[_ROLLER] == 0.0 and row[_SLIDE_WEIGHT] > 0.0 else 0.0


@njit(cache=True)
def rates_kernel(
    table: FloatArray,
    v_x: float,
    v_y: float,
    yaw_rate: float,
    angles: FloatArray,
    steer_rates: FloatArray,
    rates: FloatArray,
) -> None:
    """Fill the rates [rad/s] at which the wheels roll for a twist with the steering as it is and as it moves."""
    for i in range(table.shape[0]):
        a_x, a_y, a_w, known = rolling_line(table[i], angles[i], steer_rates[i])
        rates[i] = (a_x * v_x + a_y * v_y + a_w * yaw_rate + known) / table[i, _RADIUS]


@njit(cache=True)
def allowed_kernel(
    table: FloatArray, v_x: float, v_y: float, yaw_rate: float, angles: FloatArray, steer_rates: FloatArray
) -> tuple[float, float]:
    """v_y and yaw rate with which the wheels slide least; see `allowed_twist`."""
    a00 = a01 = a11 = b0 = b1 = 0.0
    reach = 0.0
    for i in range(table.shape[0]):
        x, y, w, known = sliding_line(table[i], angles[i], steer_rates[i])
        weight = table[i, _SLIDE_WEIGHT]
        right = -known - x * v_x
        a00 += weight * y * y
        a01 += weight * y * w
        a11 += weight * w * w
        b0 += weight * y * right
        b1 += weight * w * right
        reach = max(reach, abs(table[i, _X]), abs(table[i, _Y]))
    a00 += TRUST_IN_WISH
    a11 += TRUST_IN_WISH * reach * reach
    b0 += TRUST_IN_WISH * v_y
    b1 += TRUST_IN_WISH * reach * reach * yaw_rate
    determinant = a00 * a11 - a01 * a01
    return (a11 * b0 - a01 * b1) / determinant, (a00 * b1 - a01 * b0) / determinant


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
        row = table[i]
        if row[_STEERED] > 0.5:  # whatever the angle
            along = v_x - yaw_rate * row[_PIVOT_Y]
            across = v_y + yaw_rate * row[_PIVOT_X]
            rim = math.hypot(along, across) + abs(yaw_rate) * math.hypot(row[_ARM_X], row[_ARM_Y])
        else:
            a_x, a_y, a_w, _ = rolling_line(row, 0.0, 0.0)
            rim = abs(a_x * v_x + a_y * v_y + a_w * yaw_rate)
        rate = rim / row[_RADIUS]
        most = min(max_wheel_rate, row[_MAX_RATE])
        if rate * factor > most:
            factor = most / rate
    return factor


def checked_wheels(table: FloatArray, name: str, array: FloatArray) -> FloatArray:
    """The array as the kernels want it. Raises InvalidValueError if it has not one finite number for each wheel."""
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
    present = checked_wheels(table, "present steer angles", present_angles)
    _check_twist(twist)
    angles, rates, residual = np.empty_like(present), np.empty_like(present), np.empty_like(present)
    wheels_kernel(table, float(twist.v_x), float(twist.v_y), float(twist.yaw_rate), present, angles, rates, residual)
    return WheelSetpoints(angles, rates, residual)


def allowed_twist(
    table: FloatArray, twist: PlanarTwist, steer_angles: FloatArray, steer_rates: FloatArray
) -> PlanarTwist:
    """Twist of the same forward speed with which the wheels slide least, the steering at these angles and rates.

    Args:
        table: wheels, from `SteeringGeometryParams.table()`.
        twist: wanted motion of base_link; where no wheel objects (rollers), it is the answer.
        steer_angles: [rad], shape (wheels,). steer_rates: [rad/s], shape (wheels,).

    Raises:
        InvalidValueError: if a number is not finite, or a shape is wrong.
    """
    angles = checked_wheels(table, "steer angles", steer_angles)
    turning = checked_wheels(table, "steer rates", steer_rates)
    _check_twist(twist)
    v_y, yaw_rate = allowed_kernel(table, float(twist.v_x), float(twist.v_y), float(twist.yaw_rate), angles, turning)
    return PlanarTwist(twist.v_x, v_y, yaw_rate)


def wheel_rates(table: FloatArray, twist: PlanarTwist, steer_angles: FloatArray, steer_rates: FloatArray) -> FloatArray:
    """Rates at which the wheels roll for a twist [rad/s], shape (wheels,), the steering as it is and as it moves.

    Raises:
        InvalidValueError: if a number is not finite, or a shape is wrong.
    """
    angles = checked_wheels(table, "steer angles", steer_angles)
    turning = checked_wheels(table, "steer rates", steer_rates)
    _check_twist(twist)
    rates = np.empty_like(angles)
    rates_kernel(table, float(twist.v_x), float(twist.v_y), float(twist.yaw_rate), angles, turning, rates)
    return rates


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


def _check_twist(twist: PlanarTwist) -> None:
    for name, value in zip(twist._fields, twist, strict=True):
        if not math.isfinite(value):
            raise InvalidValueError(f"twist {name}", value, "a finite number")
