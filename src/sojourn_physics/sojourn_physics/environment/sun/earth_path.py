"""Where the Earth stands over a site, and how long its light takes.

    e = R^T (d s - o),    light time = |e| / c

s and d are direction and distance of the Earth from the centre of the body (`ephemeris.earth_from`), o is the site's
place from there and R the rotation from map to the body (`environment.site`). It is evaluated every 10 s and taken as
a straight line in between. Left out are the size of the Earth, 21 ms at most, and refraction.
"""

import math
from functools import lru_cache

import numpy as np

from sojourn_machine.params import FloatArray
from sojourn_physics.environment.site import SiteFrame
from sojourn_physics.environment.sun.ephemeris import earth_from
from sojourn_physics.environment.sun.instant import Instant
from sojourn_physics.environment.sun.orbits import ASTRONOMICAL_UNIT

SPEED_OF_LIGHT = 299792458.0
"""[m/s]"""
KNOT = 10.0
"""The ephemeris is evaluated at whole multiples of this [s]."""


class EarthPath:
    """The Earth over a site, `time` [s] after the start of the run.

    Args:
        body: name of one that has an ephemeris. frame: of the site on it. start: moment at which the run starts.

    Raises:
        InvalidValueError: a body without ephemeris, or the Earth.
    """

    def __init__(self, body: str, frame: SiteFrame, start: Instant) -> None:
        self._body, self._frame, self._start = body, frame, start
        self._knot = lru_cache(maxsize=8)(self._at_knot)
        self._knot(0)

    def place(self, time: float) -> FloatArray:
        """Of the Earth's centre in map, shape (3,) [m]."""
        before = math.floor(time / KNOT)
        share = time / KNOT - before
        between: FloatArray = (1.0 - share) * self._knot(before) + share * self._knot(before + 1)
        return between

    def light_time(self, time: float) -> float:
        """To the Earth or from there [s]."""
        return float(np.linalg.norm(self.place(time))) / SPEED_OF_LIGHT

    def _at_knot(self, index: int) -> FloatArray:
        seen = earth_from(self._body, self._start.after(KNOT * index))
        from_centre = np.array(seen.direction) * (seen.distance * ASTRONOMICAL_UNIT)
        place: FloatArray = self._frame.rotation.T @ (from_centre - self._frame.origin)
        return place
