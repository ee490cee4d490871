"""Where the Moon is about the Earth.

Longitude, latitude and distance as sums of sines and cosines of the Moon's mean elongation D, the mean anomalies of Sun
M and Moon M', and the argument of latitude F:

    lambda = L' + sum A sin(d D + m M + m' M' + f F), beta likewise, r = 385000.56 km + sum R cos(...)

and terms with M multiplied by E = 1 - 0.002516 T once for each M (the Earth's orbit grows rounder). Longitudes are of
the equinox of date; they are taken back to that of J2000 by the general precession, 1.396971 deg T + 0.000309 deg T^2.

Source: Meeus (1998), Astronomical Algorithms, ch. 47, the terms from 0.004 deg on. Accuracy: 0.035 deg and 80 km
(the most found against DE421, 1973 to 2052); what the ecliptic itself turns is left out (0.013 deg in a century).
"""

import math

from sojourn_physics.environment.sun.instant import CENTURY
from sojourn_physics.environment.sun.orbits import ASTRONOMICAL_UNIT, Vector, to_equator

_LONGITUDE = (
    (0, 0, 1, 0, 6288774, -20905355),
    (2, 0, -1, 0, 1274027, -3699111),
    (2, 0, 0, 0, 658314, -2955968),
    (0, 0, 2, 0, 213618, -569925),
    (0, 1, 0, 0, -185116, 48888),
    (0, 0, 0, 2, -114332, -3149),
    (2, 0, -2, 0, 58793, 246158),
    (2, -1, -1, 0, 57066, -152138),
    (2, 0, 1, 0, 53322, -170733),
    (2, -1, 0, 0, 45758, -204586),
    (0, 1, -1, 0, -40923, -129620),
    (1, 0, 0, 0, -34720, 108743),
    (0, 1, 1, 0, -30383, 104755),
    (2, 0, 0, -2, 15327, 10321),
    (0, 0, 1, 2, -12528, 0),
    (0, 0, 1, -2, 10980, 79661),
    (4, 0, -1, 0, 10675, -34782),
    (0, 0, 3, 0, 10034, -23210),
    (4, 0, -2, 0, 8548, -21636),
    (2, 1, -1, 0, -7888, 24208),
    (2, 1, 0, 0, -6766, 30824),
    (1, 0, -1, 0, -5163, -8379),
    (1, 1, 0, 0, 4987, -16675),
    (2, -1, 1, 0, 4036, -12831),
)
"""Multiples of D, M, M', F; sine in longitude [1e-6 deg]; cosine in distance [m]."""
_LATITUDE = (
    (0, 0, 0, 1, 5128122),
    (0, 0, 1, 1, 280602),
    (0, 0, 1, -1, 277693),
    (2, 0, 0, -1, 173237),
    (2, 0, -1, 1, 55413),
    (2, 0, -1, -1, 46271),
    (2, 0, 0, 1, 32573),
    (0, 0, 2, 1, 17198),
    (2, 0, 1, -1, 9266),
    (0, 0, 2, -1, 8822),
    (2, -1, 0, -1, 8216),
    (2, 0, -2, -1, 4324),
    (2, 0, 1, 1, 4200),
)


def ecliptic_of_date(days: float) -> Vector:
    """Longitude and latitude in the mean ecliptic of date [deg], and distance from the centre of the Earth [m].

    Args:
        days: TT since J2000 [d].
    """
    t = days / CENTURY
    mean_longitude = 218.3164477 + 481267.88123421 * t - 0.0015786 * t * t
    d = math.radians(297.8501921 + 445267.1114034 * t - 0.0018819 * t * t)
    m = math.radians(357.5291092 + 35999.0502909 * t - 0.0001536 * t * t)
    anomaly = math.radians(134.9633964 + 477198.8675055 * t + 0.0087414 * t * t)
    f = math.radians(93.2720950 + 483202.0175233 * t - 0.0036539 * t * t)
    weights = (1.0, 1.0 - 0.002516 * t)
    longitude = latitude = distance = 0.0
    # written out: a plan of a lunar day asks for the Moon a hundred thousand times
    for of_d, of_m, of_anomaly, of_f, sine, cosine in _LONGITUDE:
        angle = of_d * d + of_m * m + of_anomaly * anomaly + of_f * f
        weight = weights[abs(of_m)]
        longitude += weight * sine * math.sin(angle)
        distance += weight * cosine * math.cos(angle)
    for of_d, of_m, of_anomaly, of_f, sine in _LATITUDE:
        angle = of_d * d + of_m * m + of_anomaly * anomaly + of_f * f
        latitude += weights[abs(of_m)] * sine * math.sin(angle)
    return (mean_longitude + 1e-6 * longitude) % 360.0, 1e-6 * latitude, 385000560.0 + distance


def geocentric(days: float) -> Vector:
    """Position from the centre of the Earth in the axes of the equator of J2000 [au]. days: TT since J2000 [d]."""
    t = days / CENTURY
    longitude, latitude, distance = ecliptic_of_date(days)
    longitude = math.radians(longitude - 1.396971 * t - 0.000309 * t * t)
    latitude = math.radians(latitude)
    distance /= ASTRONOMICAL_UNIT
    level = distance * math.cos(latitude)
    return to_equator(level * math.cos(longitude), level * math.sin(longitude), distance * math.sin(latitude))
