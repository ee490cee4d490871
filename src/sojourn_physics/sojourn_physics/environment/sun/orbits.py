"""Where planets and small bodies are about the Sun: Kepler's orbits with slowly changing elements.

    E - e sin E = M,   M = L - varpi,   r = a [(cos E - e) P + sqrt(1 - e^2) sin E Q]

P points to the perihelion, Q is a right angle ahead of it in the orbit; positions are turned from the ecliptic of J2000
to its equator, the axes of the International Celestial Reference Frame, by the obliquity 23.43928 deg.

Sources: planets and Pluto: Standish, "Keplerian elements for approximate positions of the major planets", JPL, table 1
(1800 to 2050). Small bodies: osculating elements of the JPL Small-Body Database (epoch 2026 June 9; 67P of 2015), with
the mean motion of two bodies. Accuracy, as direction to the Sun: planets to Mars 0.03 deg, Jupiter and Saturn 0.2 deg,
Uranus and Neptune 0.05 deg (Standish, table of errors), Pluto 0.1 deg; small bodies 0.5 deg within ten years of their
epoch and some degrees in fifty; 67P is pushed onto another orbit by each passage of Jupiter.
"""

import math
from typing import NamedTuple

from sojourn_physics.environment.sun.instant import CENTURY

ASTRONOMICAL_UNIT = 149597870700.0
"""[m]"""
Vector = tuple[float, float, float]
_OBLIQUITY = math.radians(23.43928)
_COSINE, _SINE = math.cos(_OBLIQUITY), math.sin(_OBLIQUITY)
_GAUSSIAN_MOTION = 0.9856076686
"""Mean motion at 1 au [deg/d]."""


class Elements(NamedTuple):
    """Elements of an orbit in the ecliptic of J2000, or how fast they change."""

    semi_major_axis: float
    """[au]"""
    eccentricity: float
    inclination: float
    """[deg]"""
    mean_longitude: float
    """[deg]"""
    perihelion: float
    """Longitude of the perihelion [deg]."""
    node: float
    """Longitude of the ascending node [deg]."""


class Orbit(NamedTuple):
    """An orbit about the Sun."""

    at_epoch: Elements
    per_century: Elements
    epoch: float = 0.0
    """TT since J2000 [d]."""


def _small_body(orbit: tuple[float, float, float], node: float, argument: float, perihelion: float) -> Orbit:
    """Of a, e, inclination; longitude of the node, argument of the perihelion [deg], Julian date of its passage."""
    motion = _GAUSSIAN_MOTION / orbit[0] ** 1.5 * CENTURY
    longitude = node + argument
    return Orbit(
        Elements(*orbit, longitude, longitude, node),
        Elements(0.0, 0.0, 0.0, motion, 0.0, 0.0),
        perihelion - 2451545.0,
    )


ORBITS = {
    "mercury": Orbit(
        Elements(0.38709927, 0.20563593, 7.00497902, 252.25032350, 77.45779628, 48.33076593),
        Elements(0.00000037, 0.00001906, -0.00594749, 149472.67411175, 0.16047689, -0.12534081),
    ),
    "venus": Orbit(
        Elements(0.72333566, 0.00677672, 3.39467605, 181.97909950, 131.60246718, 76.67984255),
        Elements(0.00000390, -0.00004107, -0.00078890, 58517.81538729, 0.00268329, -0.27769418),
    ),
    # the common centre of mass of Earth and Moon
    "earth": Orbit(
        Elements(1.00000261, 0.01671123, -0.00001531, 100.46457166, 102.93768193, 0.0),
        Elements(0.00000562, -0.00004392, -0.01294668, 35999.37244981, 0.32327364, 0.0),
    ),
    "mars": Orbit(
        Elements(1.52371034, 0.09339410, 1.84969142, -4.55343205, -23.94362959, 49.55953891),
        Elements(0.00001847, 0.00007882, -0.00813131, 19140.30268499, 0.44441088, -0.29257343),
    ),
    "jupiter": Orbit(
        Elements(5.20288700, 0.04838624, 1.30439695, 34.39644051, 14.72847983, 100.47390909),
        Elements(-0.00011607, -0.00013253, -0.00183714, 3034.74612775, 0.21252668, 0.20469106),
    ),
    "saturn": Orbit(
        Elements(9.53667594, 0.05386179, 2.48599187, 49.95424423, 92.59887831, 113.66242448),
        Elements(-0.00125060, -0.00050991, 0.00193609, 1222.49362201, -0.41897216, -0.28867794),
    ),
    "uranus": Orbit(
        Elements(19.18916464, 0.04725744, 0.77263783, 313.23810451, 170.95427630, 74.01692503),
        Elements(-0.00196176, -0.00004397, -0.00242939, 428.48202785, 0.40805281, 0.04240589),
    ),
    "neptune": Orbit(
        Elements(30.06992276, 0.00859048, 1.77004347, -55.12002969, 44.96476227, 131.78422574),
        Elements(0.00026291, 0.00005105, 0.00035372, 218.45945325, -0.32241464, -0.00508664),
    ),
    "pluto": Orbit(
        Elements(39.48211675, 0.24882730, 17.14001206, 238.92903833, 224.06891629, 110.30393684),
        Elements(-0.00031596, 0.00005170, 0.00004818, 145.20780515, -0.04062942, -0.01183482),
    ),
    "ceres": _small_body((2.7655526, 0.079692295, 10.588028), 80.248627, 73.294215, 2461599.841467),
    "vesta": _small_body((2.36136597, 0.090203744, 7.143926), 103.701293, 151.468648, 2460901.58738),
    "eros": _small_body((1.45824372, 0.222877963, 10.828544), 304.267971, 178.918132, 2461088.813494),
    "itokawa": _small_body((1.32405228, 0.280177641, 1.620941), 69.074497, 162.840902, 2460936.702994),
    "churyumov_gerasimenko": _small_body((3.46224949, 0.640908131, 7.040295), 50.135574, 12.79825, 2457247.588658),
    "patroclus": _small_body((5.20597517, 0.139146792, 22.063591), 44.349688, 308.837728, 2460493.360075),
    "arrokoth": _small_body((44.05257836, 0.035557176, 2.450614), 159.037727, 188.850746, 2475741.403873),
}
"""By the names of the bodies."""


def eccentric_anomaly(mean: float, eccentricity: float) -> float:
    """Solution of Kepler's equation by Newton's method [rad]. mean: anomaly, any angle [rad]; eccentricity: below 1."""
    mean = math.remainder(mean, math.tau)
    anomaly = mean if eccentricity < 0.8 else math.copysign(math.pi, mean)
    for _ in range(30):
        step = (anomaly - eccentricity * math.sin(anomaly) - mean) / (1.0 - eccentricity * math.cos(anomaly))
        anomaly -= step
        if abs(step) < 1e-13:
            break
    return anomaly


def to_equator(x: float, y: float, z: float) -> Vector:
    """From the axes of the ecliptic of J2000 to those of its equator."""
    return x, _COSINE * y - _SINE * z, _SINE * y + _COSINE * z


def heliocentric(orbit: Orbit, days: float) -> Vector:
    """Position from the Sun in the axes of the equator of J2000 [au].

    Args:
        days: TT since J2000 [d].
    """
    centuries = (days - orbit.epoch) / CENTURY
    axis, eccentricity, *angles = (
        start + rate * centuries for start, rate in zip(orbit.at_epoch, orbit.per_century, strict=True)
    )
    inclination, longitude, perihelion, node = (math.radians(angle) for angle in angles)
    anomaly = eccentric_anomaly(longitude - perihelion, eccentricity)
    along = axis * (math.cos(anomaly) - eccentricity)
    across = axis * math.sqrt(1.0 - eccentricity**2) * math.sin(anomaly)
    argument = perihelion - node
    towards_node = along * math.cos(argument) - across * math.sin(argument)
    ahead = along * math.sin(argument) + across * math.cos(argument)
    level = ahead * math.cos(inclination)
    return to_equator(
        towards_node * math.cos(node) - level * math.sin(node),
        towards_node * math.sin(node) + level * math.cos(node),
        ahead * math.sin(inclination),
    )
