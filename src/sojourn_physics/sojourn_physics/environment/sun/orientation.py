"""How a body is turned in space: its pole and its prime meridian as functions of time.

    alpha = alpha_0 + alpha_1 d + sum A sin theta_i,  delta likewise with cosines
    W = W_0 + W_1 d + W_2 d^2 + sum A sin theta_i

alpha and delta are right ascension and declination of the pole about which east is counted (the IAU's north pole of
planets and their moons, the pole of right-handed rotation of small bodies); W goes eastward from the ascending node of
the body's equator on that of J2000 to its prime meridian; theta_i = theta_0 + theta_1 d; d days of TT since J2000. W_2
is that of moons which tides bring nearer to their planet or farther from it.

Source: Archinal et al. (2018), "Report of the IAU Working Group on Cartographic Coordinates and Rotational Elements:
2015", Celest. Mech. Dyn. Astr. 130:22.
"""

import math
from typing import NamedTuple

from sojourn_physics.environment.sun.orbits import Vector

Harmonics = tuple[tuple[float, tuple[float, float]], ...]
"""Amplitude [deg]; angle at J2000 [deg] and its rate [deg/d]."""


class Angle(NamedTuple):
    """An angle that grows evenly, but for small oscillations."""

    at_epoch: float
    """[deg]"""
    per_day: float = 0.0
    """[deg/d]"""
    harmonics: Harmonics = ()
    per_day_squared: float = 0.0
    """[deg/d2]"""


class BodyAxes(NamedTuple):
    """How one body is turned."""

    right_ascension: Angle
    declination: Angle
    """Its harmonics are cosines."""
    meridian: Angle


def angle_at(angle: Angle, days: float, quarter: float = 0.0) -> float:
    """Value [rad]; harmonics are sines of their angles advanced by `quarter` [deg]."""
    total = angle.at_epoch + (angle.per_day + angle.per_day_squared * days) * days
    for amplitude, (start, rate) in angle.harmonics:
        total += amplitude * math.sin(math.radians(start + rate * days + quarter))
    return math.radians(total)


def into_body(vector: Vector, orientation: BodyAxes, days: float) -> Vector:
    """The same vector in the axes of the body: x through latitude and longitude 0, z through the pole.

    Args:
        vector: in the axes of the equator of J2000. days: since J2000 [d].
    """
    right_ascension = angle_at(orientation.right_ascension, days)
    declination = angle_at(orientation.declination, days, 90.0)
    meridian = angle_at(orientation.meridian, days)
    x, y, z = vector
    towards_node = -math.sin(right_ascension) * x + math.cos(right_ascension) * y
    outward = math.cos(right_ascension) * x + math.sin(right_ascension) * y
    ahead = math.cos(declination) * z - math.sin(declination) * outward
    cosine, sine = math.cos(meridian), math.sin(meridian)
    return (
        towards_node * cosine + ahead * sine,
        ahead * cosine - towards_node * sine,
        math.cos(declination) * outward + math.sin(declination) * z,
    )
