"""Differential between the two rockers, a bar with two links: how exactly it averages.

Angles of the rockers against the chassis, positive about y. A bevel gear holds q_R = -q_L. A bar on a vertical axis in
the middle of the chassis, of half length w, is joined by links of length L to points at height e above the rockers'
axis and at the same distance w from the middle. With its end at height z_b, yawed by B:

    left   (X + e sin q_L + w sin B)^2 + (w - w cos B)^2 + (e cos q_L - z_b)^2 = L^2
    right  the same with q_R and -B,      X = sqrt(L^2 - (e - z_b)^2)

For small angles both give q_R = -q_L; what is left is the chassis' pitch error (q_L + q_R)/2.
(Lindemann and Voorhees 2005; Harrington and Voorhees 2004, Proc. 37th Aerospace Mechanisms Symp.)
Assumptions: rigid links, spherical joints at their ends. Range: until the links reach a dead centre.
"""

import math

from scipy.optimize import brentq

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.machine import DifferentialBarParams

MOST_YAW = 1.2
"""Of the bar [rad]."""


def bar_right_angle(bar: DifferentialBarParams, left: float) -> float:
    """Angle of the right rocker [rad] for one of the left [rad].

    Raises:
        InvalidValueError: an angle that the bar does not reach.
    """
    ahead = math.sqrt(bar.link**2 - (bar.arm - bar.bar_height) ** 2)

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


def chassis_error(bar: DifferentialBarParams, left: float) -> float:
    """Pitch of the chassis away from the mean of the rockers [rad] for an angle of the left one [rad]."""
    return 0.5 * (left + bar_right_angle(bar, left))
