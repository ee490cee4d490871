"""Bodies that may come before the Sun: the Earth on the Moon, a planet on its moons, the body below in a low orbit.

Where such a body stands is a direction in map and an angular radius. Of a moon that keeps one face to its planet, the
planet stands over latitude 0 and the longitude that `moons` has for it, at the moon's mean distance, as seen from the
site itself. The middle of an eclipse is within 2 minutes on Io, 5 on Europa and Ganymede, 15 on Callisto; how long
it lasts is within 3 %, as planets' flattening is left out.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from sojourn_machine.params import FloatArray
from sojourn_physics.environment.site import SiteFrame
from sojourn_physics.environment.sun import lunar_orbit
from sojourn_physics.environment.sun.ephemeris import body_axes
from sojourn_physics.environment.sun.instant import Instant
from sojourn_physics.environment.sun.moons import MOONS, RADII, Moon
from sojourn_physics.environment.sun.orbits import ASTRONOMICAL_UNIT
from sojourn_physics.environment.sun.orientation import angle_at
from sojourn_physics.environment.sun.shadow import disc_radius


class Cover(NamedTuple):
    """A disc in the sky."""

    direction: FloatArray
    """Unit vector to its centre in map, shape (3,)."""
    radius: float
    """Angular [rad]."""


def cover_below(orbit_radius: float, body_radius: float) -> Cover:
    """The body that an orbit goes about, straight down in map; radii in m."""
    return Cover(np.array((0.0, 0.0, -1.0)), disc_radius(body_radius, orbit_radius))


def covers_over(body: str, frame: SiteFrame) -> Callable[[Instant], Cover] | None:
    """What eclipses the Sun on a body, as a function of the moment; None where nothing does."""
    if body == "moon":
        return lambda at: _cover(frame, ASTRONOMICAL_UNIT * _earth_from_moon(at), RADII["earth"])
    if body in MOONS:
        return lambda at: _cover(frame, _planet_from_moon(MOONS[body], at), RADII[MOONS[body].planet])
    return None


def _earth_from_moon(at: Instant) -> FloatArray:
    x, y, z = lunar_orbit.geocentric(at.terrestrial)
    return np.array(body_axes("moon", (-x, -y, -z), at))


def _planet_from_moon(moon: Moon, at: Instant) -> FloatArray:
    longitude = angle_at(moon.planet_longitude, at.terrestrial)
    return moon.distance * np.array((math.cos(longitude), math.sin(longitude), 0.0))


def _cover(frame: SiteFrame, centre: FloatArray, radius: float) -> Cover:
    towards = frame.rotation.T @ (centre - frame.origin)
    distance = float(np.linalg.norm(towards))
    return Cover(towards / distance, disc_radius(radius, distance))
