"""Differential between the two rockers: bevel gear, or a bar with two links; how exactly it averages.

Angles of the rockers against the chassis, positive about y. A gear holds q_R = -q_L. A bar on a vertical axis in the
middle of the chassis, of half length w, is joined by links of length L to points at height e above the rockers' axis
and at the same distance w from the middle. With its end at height z_b, yawed by B:

    left   (X + e sin q_L + w sin B)^2 + (w - w cos B)^2 + (e cos q_L - z_b)^2 = L^2
    right  the same with q_R and -B,      X = sqrt(L^2 - (e - z_b)^2)

For small angles both give q_R = -q_L; what is left is the chassis' pitch error (q_L + q_R)/2.
(Lindemann and Voorhees 2005; Harrington and Voorhees 2004, Proc. 37th Aerospace Mechanisms Symp.)
Assumptions: rigid links, spherical joints at their ends. Range: until the links reach a dead centre.
"""

import math
from typing import NamedTuple

from scipy.optimize import brentq

from sojourn_mechanics.errors import InvalidValueError

MOST_YAW = 1.2
"""Of the bar [rad]."""


class DifferentialBar(NamedTuple):
    """Half length of the bar w, height e of the rockers' points over their axis, height z_b of the bar's ends, links
    L [m].
    """

    half_length: float
    arm: float
    bar_height: float
    link: float


def gear_right_angle(left: float, ratio: float = 1.0) -> float:
    """Angle of the right rocker [rad] behind a gear: q_L + ratio q_R = 0."""
    if ratio == 0.0:
        raise InvalidValueError("ratio", ratio, "a number that is not 0")
    return -left / ratio


def bar_right_angle(bar: DifferentialBar, left: float) -> float:
    """Angle of the right rocker [rad] for one of the left [rad].

    Raises:
        InvalidValueError: a link that does not span the distance, or an angle that the bar does not reach.
    """
    offset = bar.link**2 - (bar.arm - bar.bar_height) ** 2
    if min(bar.half_length, bar.arm, bar.link) <= 0.0 or offset <= 0.0:
        raise InvalidValueError("bar", tuple(bar), "lengths of more than 0 and a link longer than |arm - bar_height|")
    ahead = math.sqrt(offset)

    def closure(rocker: float, yaw: float) -> float:
        along = ahead + bar.arm * math.sin(rocker) + bar.half_length * math.sin(yaw)
        across = bar.half_length * (1.0 - math.cos(yaw))
        up = bar.arm * math.cos(rocker) - bar.bar_height
        return along**2 + across**2 + up**2 - bar.link**2

    try:
        yaw = brentq(lambda angle: closure(left, angle), -MOST_YAW, MOST_YAW, xtol=1e-14)
        return float(brentq(lambda angle: closure(angle, -yaw), -MOST_YAW, MOST_YAW, xtol=1e-14))
    except ValueError as error:
        raise InvalidValueError("left", left, "an angle that the bar reaches") from error


def chassis_error(bar: DifferentialBar, left: float) -> float:
    """Pitch of the chassis away from the mean of the rockers [rad] for an angle of the left one [rad]."""
    return 0.5 * (left + bar_right_angle(bar, left))
