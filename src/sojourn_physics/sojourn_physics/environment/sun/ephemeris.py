"""Where Sun and Earth stand in the sky of a body, as seen from its centre: direction in the body's own axes, distance.

    s = (r_0 - r)(t - |r_0 - r|/c) / |r_0 - r|, turned into the body's axes at t

r is the body's position from the Sun and r_0 that of what is seen, nothing for the Sun; taking both one light time
earlier gives light time and the aberration by the body's motion (20" at the Earth) together. The point under it has the
latitude asin s_z (planetocentric) and east longitude atan2(s_y, s_x).

Sources: `orbits`, `lunar_orbit`, `orientation`; aberration: Meeus (1998), ch. 25 and 33. Accuracy of the Sun: 0.01 deg
for Earth, Moon, Mercury and Venus, 0.03 deg for Mars, 0.08 deg for Phobos (the most found against DE421, 1973 to 2052);
0.2 deg for Jupiter, Saturn and their moons (which are taken to be where their planet is: another 0.15 deg for Callisto
and Iapetus), 0.1 deg farther out; see `orbits` for small bodies. Of the Earth: 0.04 deg from the Moon, 0.1 deg and 4e-4
au from Mars. Range: 1958 to 2100, in the last half century of it a few times less accurate.
"""

import math
from typing import NamedTuple

from sojourn_machine.errors import InvalidValueError
from sojourn_physics.environment.sun import lunar_orbit
from sojourn_physics.environment.sun.instant import DAY, Instant
from sojourn_physics.environment.sun.moons import MOON, MOONS
from sojourn_physics.environment.sun.orbits import ASTRONOMICAL_UNIT, ORBITS, Vector, heliocentric
from sojourn_physics.environment.sun.orientation import BodyAxes, into_body
from sojourn_physics.environment.sun.orientations import EARTH, PLANETS, SMALL_BODIES

_SPEED_OF_LIGHT = 299792458.0
_LIGHT_DAYS = ASTRONOMICAL_UNIT / _SPEED_OF_LIGHT / DAY
"""Light's time for 1 au [d]."""
_EARTH_OVER_MOON = 81.30056
"""Ratio of masses (JPL DE405)."""
_ORIENTATIONS = {**PLANETS, **SMALL_BODIES, **{name: moon.orientation for name, moon in MOONS.items()}, "moon": MOON}
BODIES = ("earth", *_ORIENTATIONS)
"""Names of the bodies that have an ephemeris."""


class FromCentre(NamedTuple):
    """Sun or Earth from the centre of a body."""

    direction: Vector
    """Unit vector to it in the axes of the body: x through latitude and longitude 0, z through the pole."""
    distance: float
    """[au]"""

    @property
    def latitude(self) -> float:
        """Planetocentric latitude of the point under it, its declination in the body's sky [rad]."""
        return math.asin(max(-1.0, min(1.0, self.direction[2])))

    @property
    def longitude(self) -> float:
        """East longitude of the point under it, -pi to pi [rad]."""
        return math.atan2(self.direction[1], self.direction[0])


def sun_from(body: str, at: Instant) -> FromCentre:
    """The Sun as seen from the centre of a body.

    Raises:
        InvalidValueError: the body has no ephemeris.
    """
    if body not in BODIES:
        raise InvalidValueError("body", body, f"one with an ephemeris: {', '.join(sorted(BODIES))}")
    days = at.terrestrial
    rough_distance = math.hypot(*heliocentric(ORBITS[_centre(body)], days))
    x, y, z = _position(body, days - rough_distance * _LIGHT_DAYS)
    return _seen(body, (-x, -y, -z), at)


def earth_from(body: str, at: Instant) -> FromCentre:
    """The centre of the Earth as seen from that of a body.

    Raises:
        InvalidValueError: the body has no ephemeris, or is the Earth.
    """
    others = [name for name in sorted(BODIES) if name != "earth"]
    if body not in others:
        raise InvalidValueError("body", body, f"one with an ephemeris, not the Earth: {', '.join(others)}")
    days = at.terrestrial
    rough_distance = math.hypot(*_towards_earth(body, days))
    return _seen(body, _towards_earth(body, days - rough_distance * _LIGHT_DAYS), at)


def _seen(body: str, towards: Vector, at: Instant) -> FromCentre:
    """What is at a place from the centre of a body, in the axes of the equator of J2000 [au]."""
    x, y, z = towards
    distance = math.hypot(x, y, z)
    return FromCentre(body_axes(body, (x / distance, y / distance, z / distance), at), distance)


def _towards_earth(body: str, days: float) -> Vector:
    """From the centre of a body, in the axes of the equator of J2000 [au]."""
    (x, y, z), (a, b, c) = _position("earth", days), _position(body, days)
    return x - a, y - b, z - c


def body_axes(body: str, vector: Vector, at: Instant) -> Vector:
    """A vector in the axes of the equator of J2000 turned into those of a body with an ephemeris."""
    if body == "earth":
        return into_body(vector, EARTH, at.universal)
    orientation: BodyAxes = _ORIENTATIONS[body]
    return into_body(vector, orientation, at.terrestrial)


def _centre(body: str) -> str:
    """Whose orbit about the Sun a body shares."""
    if body == "moon":
        return "earth"
    return MOONS[body].planet if body in MOONS else body


def _position(body: str, days: float) -> Vector:
    """From the Sun, in the axes of the equator of J2000 [au]."""
    centre = _centre(body)
    x, y, z = heliocentric(ORBITS[centre], days)
    if centre != "earth":
        return x, y, z
    share = (_EARTH_OVER_MOON if body == "moon" else -1.0) / (1.0 + _EARTH_OVER_MOON)
    a, b, c = lunar_orbit.geocentric(days)
    return x + share * a, y + share * b, z + share * c
