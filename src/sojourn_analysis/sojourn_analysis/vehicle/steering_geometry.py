"""Kinematic (low-speed) steering: where wheels should point, and what is lost where they do not.

The vehicle turns about a centre C = (x_C, y_C) in its own frame (x forward, y left); a left turn has y_C > 0. A wheel
at (x, y) rolls without side slip where it points at right angles to the line to the centre:

    tan d = (x - x_C) / (y_C - y)                       (ideal steering of any number of axles; Ackermann 1818 for one)
    cot d_o - cot d_i = t / l                            (front axle alone steers, x_C on the rear axle)

With angles d_i that are built otherwise, the vehicle finds a centre of its own. For small side slip angles
e_i = d_ideal,i - d_i, wheels alike, it is the one with the least sum of squares of e_i (least energy lost); what is
left of e_i is the steering error. Trapezoid linkage: arms of length a, inclined by g to the inside, with a rod between
their ends:

    rod^2 = (t - a sin(g + d_L) - a sin(g - d_R))^2 + a^2 (cos(g + d_L) - cos(g - d_R))^2,   rod = t - 2 a sin g

(Genta and Morello 2009, vol. 1, sec. 4.2, vol. 2, sec. 25.2; Jazar 2008, Vehicle Dynamics, ch. 7.)
Assumptions: plane ground, no side slip, no compliance, steering axes through the contacts.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq, least_squares

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray

FARTHEST = 1e6
"""A turning centre beyond it counts as straight driving [m]."""


class Turn(NamedTuple):
    """A turn about a centre (x, y) [m] with the steer angle of each wheel [rad], shape (wheels,)."""

    x: float
    y: float
    angles: FloatArray


class SteeringError(NamedTuple):
    """Centre that fits the built angles best [m], side slip angles that are left, shape (wheels,) [rad], and their
    rms.
    """

    x: float
    y: float
    slip_angles: FloatArray
    rms: float


def ideal_angles(places: FloatArray, x: float, y: float) -> FloatArray:
    """Steer angles [rad], shape (wheels,), of wheels at `places` (wheels, 2) [m] for a turn about (x, y).

    Raises:
        InvalidValueError: the centre is on a wheel.
    """
    places = np.asarray(places, dtype=np.float64)
    along, across = places[:, 0] - x, y - places[:, 1]
    if np.any(np.hypot(along, across) < 1e-9):
        raise InvalidValueError("centre", (x, y), "a place without a wheel")
    angles = np.arctan2(along, across)
    # the axis of a wheel has two ends: take the angle within a quarter turn
    return np.asarray(np.arctan(np.tan(angles)))


def turn_of_outer_wheel(places: FloatArray, outer: int, angle: float, x: float) -> Turn:
    """The turn in which one wheel has a given angle and the centre is at a given x: all other wheels follow.

    Args:
        places: (wheels, 2) [m]. outer: index of the wheel. angle: its steer angle, not 0 [rad].
        x: of the turning centre: that of the fixed axle, or of the middle where both ends steer [m].

    Raises:
        InvalidValueError: an angle of 0, or a wheel at the x of the centre.
    """
    if angle == 0.0 or not abs(angle) < 0.5 * math.pi:
        raise InvalidValueError("angle", angle, "an angle between -pi/2 and pi/2 that is not 0")
    along = float(places[outer, 0]) - x
    if along == 0.0:
        raise InvalidValueError("outer", outer, "a wheel that is not beside the centre of the turn")
    y = float(places[outer, 1]) + along / math.tan(angle)
    return Turn(x, y, ideal_angles(places, x, y))


def path_radii(places: FloatArray, turn: Turn) -> FloatArray:
    """Radius of each wheel's path [m], shape (wheels,)."""
    return np.asarray(np.hypot(places[:, 0] - turn.x, places[:, 1] - turn.y))


def off_tracking(wheelbase: float, radius: float) -> float:
    """How much the path of a fixed rear axle is inside of the front one's: R_1 - sqrt(R_1^2 - l^2) [m]."""
    if not radius > wheelbase > 0.0:
        raise InvalidValueError("radius", radius, f"more than the wheelbase {wheelbase:g} m")
    return radius - math.sqrt(radius * radius - wheelbase * wheelbase)


def steering_error(places: FloatArray, angles: Sequence[float] | FloatArray) -> SteeringError:
    """The centre about which a vehicle with these steer angles turns, and the side slip that its wheels then have.

    Args:
        places: (wheels, 2) [m]. angles: (wheels,) [rad].
    """
    places = np.asarray(places, dtype=np.float64)
    built = np.asarray(angles, dtype=np.float64)
    if built.shape != (len(places),):
        raise InvalidValueError("angles.shape", built.shape, f"({len(places)},)")

    def misses(motion: FloatArray) -> FloatArray:
        """Side slip for the curvature and the course angle at the origin: velocity (cos b, sin b), rate k."""
        curvature, course = motion
        along = math.cos(course) - curvature * places[:, 1]
        across = math.sin(course) + curvature * places[:, 0]
        slip = np.arctan2(across, along) - built
        return np.asarray((slip + 0.5 * math.pi) % math.pi - 0.5 * math.pi)

    rows = np.column_stack([-places[:, 1] * np.sin(built) - places[:, 0] * np.cos(built), -np.cos(built)])
    start = np.linalg.lstsq(rows, -np.sin(built), rcond=None)[0]
    found = least_squares(misses, start, xtol=1e-15, ftol=1e-15, gtol=1e-15).x
    slips = misses(found)
    curvature = float(found[0]) if abs(found[0]) > 1.0 / FARTHEST else math.copysign(1.0 / FARTHEST, found[0])
    x, y = -math.sin(found[1]) / curvature, math.cos(found[1]) / curvature
    return SteeringError(x, y, slips, float(np.sqrt(np.mean(slips**2))))


def trapezoid_right_angle(track: float, arm: float, inclination: float, left: float) -> float:
    """Angle of the right wheel [rad] that a trapezoid linkage gives for the angle of the left one [rad].

    Args:
        track: between the steering axes [m]. arm: length of the arms, behind the axle [m].
        inclination: of the arms to the inside, straight ahead [rad].

    Raises:
        InvalidValueError: the linkage does not reach that angle.
    """
    rod = track - 2.0 * arm * math.sin(inclination)

    def gap(right: float) -> float:
        across = track - arm * math.sin(inclination + left) - arm * math.sin(inclination - right)
        along = arm * (math.cos(inclination + left) - math.cos(inclination - right))
        return math.hypot(across, along) - rod

    low, high = left - 0.6, left + 0.6
    grid = np.linspace(low, high, 121)
    values = [gap(float(right)) for right in grid]
    crossings = [i for i in range(120) if values[i] * values[i + 1] <= 0.0]
    if not crossings:
        raise InvalidValueError("left", left, "an angle that the linkage reaches")
    nearest = min(crossings, key=lambda i: abs(0.5 * (grid[i] + grid[i + 1]) - left))
    return float(brentq(gap, grid[nearest], grid[nearest + 1], xtol=1e-14))
