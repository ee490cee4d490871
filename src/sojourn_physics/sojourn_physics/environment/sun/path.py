"""Where the Sun stands over a site, and how it moves there while the body turns.

In map (x east, y north, z up) a Sun of azimuth A, from north towards east, and elevation e is in the direction

    u_0 = [sin A cos e, cos A cos e, sin e].

**By its place at the start.** The body turns eastward about its positive pole, which a site of latitude f sees at
p = [0, cos f, sin f]. So the Sun turns westward about p, once in a solar day T (Rodrigues' formula, a = -2 pi t / T):

    u(t) = u_0 cos a + (p x u_0) sin a + p (p . u_0) (1 - cos a).

Source: Meeus (1998), Astronomical Algorithms, ch. 13 (hour angle and horizontal coordinates), with the declination
held, which is asin(u . p) and changes by less than 0.4 deg in a solar day of the Earth or of Mars. The body is at its
mean distance from the Sun.

**By the date.** Direction and distance from `ephemeris`, turned into the frame of the site. It is evaluated every 10 s
and taken as a straight line in between, which is off by a2/8 where the Sun moves by a: 6e-8 rad on Mars, 1.4e-6 on
Eros.

Assumptions: no refraction. What hides the Sun is not looked at here.
"""

import math
from functools import lru_cache
from typing import Protocol, Self

import numpy as np
from pydantic import AwareDatetime, Field, model_validator

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray, Params
from sojourn_physics.environment.site import SiteFrame
from sojourn_physics.environment.sun.ephemeris import sun_from
from sojourn_physics.environment.sun.horizon import HorizonPoint
from sojourn_physics.environment.sun.instant import Instant, instant

KNOT = 10.0
"""The ephemeris is evaluated at whole multiples of this [s]."""


class SunParams(Params):
    """The Sun over the site: where it stands at the start of a run, or the date of the start. Angles in degrees."""

    azimuth_deg: float = Field(default=90.0, ge=-360.0, le=360.0, description="from north, east is 90 [deg]")
    elevation_deg: float = Field(default=30.0, ge=-90.0, le=90.0, description="over the horizon [deg]")
    latitude_deg: float = Field(default=0.0, ge=-90.0, le=90.0, description="of the site, north positive [deg]")
    time: AwareDatetime | None = Field(
        default=None, description="date of the start with its zone, as 2028-03-01T12:00:00Z: the ephemeris has the Sun"
    )
    optical_depth: float = Field(default=0.5, ge=0.0, le=30.0, description="of the dust over Mars; 5 to 11 in a storm")
    albedo: float = Field(default=0.25, ge=0.0, le=1.0, description="of the ground, whose light dust sends back")
    horizon: tuple[HorizonPoint, ...] = Field(default=(), description="far horizon behind the map; none: flat")
    ground_hides: bool | None = Field(default=None, description="whether ground hides the Sun; none: with a time")

    @model_validator(mode="after")
    def _one_way(self) -> Self:
        placed = [name for name in ("azimuth_deg", "elevation_deg", "latitude_deg") if self.says(name)]
        if self.time is not None and placed:
            allowed = "alone: the date says where the Sun stands. Leave out " + ", ".join(placed)
            raise InvalidValueError("time", self.time.isoformat(), allowed)
        if self.time is not None:
            instant(self.time.timestamp())
        return self

    def says(self, name: str) -> bool:
        """Whether a field has another value than that of a file without it: a recorded set has all of them."""
        return bool(getattr(self, name) != type(self).model_fields[name].default)

    @property
    def ground_counts(self) -> bool:
        """Whether ground and far horizon hide the Sun."""
        return self.time is not None if self.ground_hides is None else self.ground_hides


class SunPath(Protocol):
    """The Sun's way over a site, `time` [s] after the start of the run."""

    def direction(self, time: float) -> FloatArray:
        """Unit vector to the Sun in map, shape (3,)."""
        ...

    def distance(self, time: float) -> float:
        """From the Sun [au]."""
        ...


def sun_direction(sun: SunParams, solar_day: float, time: float) -> FloatArray:
    """Unit vector to a Sun in map that is given by its place at the start, shape (3,).

    Args:
        solar_day: noon to noon [s]. time: since the start of the run [s].
    """
    azimuth, elevation = math.radians(sun.azimuth_deg), math.radians(sun.elevation_deg)
    level = math.cos(elevation)
    x, y, z = math.sin(azimuth) * level, math.cos(azimuth) * level, math.sin(elevation)
    north, up = math.cos(math.radians(sun.latitude_deg)), math.sin(math.radians(sun.latitude_deg))
    angle = -2.0 * math.pi * time / solar_day
    cosine, sine = math.cos(angle), math.sin(angle)
    along = (north * y + up * z) * (1.0 - cosine)
    return np.array(
        (
            x * cosine + (north * z - up * y) * sine,
            y * cosine + up * x * sine + north * along,
            z * cosine - north * x * sine + up * along,
        )
    )


class PathFromStart:
    """By the Sun's place at the start.

    Args:
        sun: that place. solar_day: noon to noon [s]. distance: from the Sun [au].
    """

    def __init__(self, sun: SunParams, solar_day: float, distance: float) -> None:
        self._sun, self._solar_day, self._distance = sun, solar_day, distance

    def direction(self, time: float) -> FloatArray:
        """Unit vector to the Sun in map, shape (3,)."""
        return sun_direction(self._sun, self._solar_day, time)

    def distance(self, time: float) -> float:
        """From the Sun [au]."""
        return self._distance


class PathByDate:
    """By the ephemeris.

    Args:
        body: name of one that has an ephemeris. frame: of the site on it. start: moment at which the run starts.

    Raises:
        InvalidValueError: a body without ephemeris.
    """

    def __init__(self, body: str, frame: SiteFrame, start: Instant) -> None:
        self._body, self._to_map, self._start = body, frame.rotation.T.copy(), start
        self._knot = lru_cache(maxsize=8)(self._at_knot)
        self._knot(0)

    def direction(self, time: float) -> FloatArray:
        """Unit vector to the Sun in map, shape (3,)."""
        before = math.floor(time / KNOT)
        share = time / KNOT - before
        between = (1.0 - share) * self._knot(before)[0] + share * self._knot(before + 1)[0]
        unit: FloatArray = between / math.sqrt(float(between @ between))
        return unit

    def distance(self, time: float) -> float:
        """From the Sun [au]."""
        return self._knot(math.floor(time / KNOT))[1]

    def moment(self, time: float) -> Instant:
        """The moment `time` [s] after the start."""
        return self._start.after(time)

    def _at_knot(self, index: int) -> tuple[FloatArray, float]:
        seen = sun_from(self._body, self._start.after(KNOT * index))
        return self._to_map @ np.array(seen.direction), seen.distance
