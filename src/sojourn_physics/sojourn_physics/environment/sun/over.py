"""The Sun over a site as all who ask see it: plant, Sun sensor and arrays.

    direct = S_1 / r^2 * (what the air lets through of the beam) * (part of the disc that is seen)

The part of the disc that is seen is the product of what stands over the horizon and what an eclipsing body leaves of
it.

An eclipsing body is looked up every 10 s. The horizon, of the ground of the map or the far one behind it, whichever is
the higher, is looked up for the middle of the half-metre square in which the rover is, 0.5 m over its ground, and at
whole multiples of 10 s. So it is a function of place and time and nothing remembers it, and it costs nothing in all the
periods in between. Left out are the shadows of the machine itself, and ruts.
"""

import math
from collections.abc import Callable
from functools import lru_cache

import numpy as np

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray
from sojourn_machine.sunlight import Sunlight
from sojourn_physics.environment.body import SOLAR_FLUX_AT_1_AU, BodyParams
from sojourn_physics.environment.site import SiteFrame, SiteParams, site_frame
from sojourn_physics.environment.sun.eclipses import Cover, cover_below, covers_over
from sojourn_physics.environment.sun.horizon import far_horizon, ground_horizon
from sojourn_physics.environment.sun.instant import instant
from sojourn_physics.environment.sun.moons import RADII
from sojourn_physics.environment.sun.orbits import ASTRONOMICAL_UNIT
from sojourn_physics.environment.sun.path import KNOT, PathByDate, PathFromStart, SunParams, SunPath
from sojourn_physics.environment.sun.shadow import SOLAR_RADIUS, disc_radius, seen_over_edge, seen_past_disc
from sojourn_physics.environment.sun.skies import sky_over
from sojourn_physics.terrain.height_field import HeightField

SQUARE = 0.5
"""Side of the squares that a horizon is looked up for [m]."""
EYE = 0.5
"""Height over the ground from which the horizon is seen [m]."""
_LOW_ORBITS = {"low_earth_orbit": "earth"}
"""Orbits that have a file of their own, and what they go about."""


class SunOver:
    """The Sun over a site of a body.

    Args:
        sun: where it stands at the start, or the date. body, site: where; a site is needed with a date.
        terrain: makes the ground, if it may hide the Sun: it is not asked where it does not; None: no ground.

    Raises:
        InvalidValueError: a date without a site, or on a body without ephemeris.
    """

    def __init__(
        self,
        sun: SunParams,
        body: BodyParams,
        site: SiteParams | None = None,
        terrain: Callable[[], HeightField] | None = None,
    ) -> None:
        self._sun, self._body = sun, body
        self._ground = terrain() if terrain is not None and sun.ground_counts else None
        self._sky = sky_over(body.name, sun.optical_depth, sun.albedo)
        self.path: SunPath = sun_path(sun, body, site)
        frame = None if site is None else site_frame(site, body.semi_axes)
        self._covers = None if frame is None else covers_over(body.name, frame)
        self._cover = lru_cache(maxsize=8)(self._cover_at)
        about = _LOW_ORBITS.get(body.name) if body.free_fall else None
        self._below = None if about is None else cover_below(body.radius, RADII[about])
        self._horizon = lru_cache(maxsize=8)(self._horizon_of)
        self._held = lru_cache(maxsize=8)(self._held_at)

    def direction(self, time: float) -> FloatArray:
        """Unit vector to the Sun in map, shape (3,), `time` [s] after the start of the run."""
        return self.path.direction(time)

    def disc(self, time: float) -> float:
        """Angular radius of the Sun [rad], `time` [s] after the start of the run."""
        return _disc(self.path.distance(time))

    def light(self, time: float, x: float, y: float) -> Sunlight:
        """What falls on a machine that stands at (x, y) in map [m], `time` [s] after the start of the run."""
        direction, distance = self.path.direction(time), self.path.distance(time)
        elevation = math.asin(min(max(float(direction[2]), -1.0), 1.0))
        disc = _disc(distance)
        uncovered = self._past_covers(direction, disc, time)
        over_horizon = 1.0
        if not self._body.free_fall:
            squares = math.floor(x / SQUARE), math.floor(y / SQUARE), math.floor(time / KNOT)
            over_horizon = seen_over_edge(elevation - self._horizon(*squares), disc)
        beam, diffuse = self._sky(SOLAR_FLUX_AT_1_AU / distance**2, math.sin(elevation))
        visible = over_horizon * uncovered
        return Sunlight(direction, beam * visible, diffuse * uncovered, elevation, visible)

    def held_light(self, time: float, x: float, y: float) -> Sunlight:
        """As `light`, of the middle of the second in which a time lies, made once in it. The Sun moves by 7e-5 rad
        meanwhile on Mars, and the edge of a planet's shadow takes eight seconds to pass over what circles the Earth.
        """
        return self._held(math.floor(time), math.floor(x / SQUARE), math.floor(y / SQUARE))

    def horizon(self, x: float, y: float, azimuths: FloatArray) -> FloatArray:
        """Elevation of the horizon from the square of (x, y) [m] in directions from north towards east.

        Args:
            azimuths: shape (n,) [rad].

        Returns:
            shape (n,) [rad].
        """
        if not self._sun.ground_counts:
            return np.zeros(len(azimuths))
        far = np.array([far_horizon(self._sun.horizon, float(azimuth)) for azimuth in azimuths])
        if self._ground is None:
            return far
        x_min, x_max, y_min, y_max = self._ground.bounds
        x = min(max((math.floor(x / SQUARE) + 0.5) * SQUARE, x_min), x_max)
        y = min(max((math.floor(y / SQUARE) + 0.5) * SQUARE, y_min), y_max)
        place = (x, y, self._ground.height(x, y) + EYE)
        higher: FloatArray = np.maximum(far, ground_horizon(self._ground, place, azimuths))
        return higher

    def _held_at(self, second: int, column: int, row: int) -> Sunlight:
        return self.light(second + 0.5, (column + 0.5) * SQUARE, (row + 0.5) * SQUARE)

    def _horizon_of(self, column: int, row: int, knot: int) -> float:
        east, north, _ = self.path.direction(knot * KNOT)
        azimuth = np.array((math.atan2(east, north),))
        return float(self.horizon((column + 0.5) * SQUARE, (row + 0.5) * SQUARE, azimuth)[0])

    def _cover_at(self, knot: int) -> Cover | None:
        if self._covers is None or not isinstance(self.path, PathByDate):
            return None
        return self._covers(self.path.moment(knot * KNOT))

    def _past_covers(self, direction: FloatArray, disc: float, time: float) -> float:
        cover = self._below or self._cover(math.floor(time / KNOT))
        if cover is None:
            return 1.0
        # by the chord, which is exact for small angles too
        apart = 2.0 * math.asin(min(0.5 * float(np.linalg.norm(direction - cover.direction)), 1.0))
        return seen_past_disc(apart, disc, cover.radius)


def _disc(distance: float) -> float:
    """Angular radius of the Sun [rad] from so far away [au]."""
    return disc_radius(SOLAR_RADIUS, distance * ASTRONOMICAL_UNIT)


def sun_path(sun: SunParams, body: BodyParams, site: SiteParams | None) -> SunPath:
    """The Sun's way over a site. Raises InvalidValueError as `SunOver` does."""
    if sun.time is None:
        if site is not None and sun.says("latitude_deg"):
            raise InvalidValueError("sun.latitude_deg", sun.latitude_deg, "none: the site has its latitude")
        if site is not None:
            sun = sun.model_copy(update={"latitude_deg": site.latitude_deg})
        return PathFromStart(sun, body.solar_day, body.semi_major_axis_au)
    if site is None:
        raise InvalidValueError("sun.time", sun.time.isoformat(), "with a site: its latitude and longitude on the body")
    frame: SiteFrame = site_frame(site, body.semi_axes)
    return PathByDate(body.name, frame, instant(sun.time.timestamp()))
