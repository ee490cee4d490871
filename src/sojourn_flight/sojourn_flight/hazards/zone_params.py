"""Keep-out zones as a file has them: polygons in map into which no part of the machine may go.

A place is in a polygon if a ray from it crosses the edge an odd number of times (Shimrat 1962, Communications of the
ACM 5(8):434). Lengths [m].
"""

from collections.abc import Sequence
from typing import Self

import numpy as np
from pydantic import Field, model_validator

from sojourn_machine.params import FloatArray, Params

LEAST_AREA = 1e-4
"""[m2]"""
FARTHEST = 1e5
"""[m]"""


class KeepOutZone(Params):
    """A polygon."""

    name: str = Field(min_length=1, max_length=60, description="by which it is told")
    points: tuple[tuple[float, float], ...] = Field(
        min_length=3, max_length=200, description="corners x, y in map, in order [m]"
    )

    @model_validator(mode="after")
    def _encloses(self) -> Self:
        corners = np.array(self.points)
        if not np.isfinite(corners).all() or np.abs(corners).max() > FARTHEST:
            raise ValueError(f"zone {self.name!r}: allowed are corners within {FARTHEST:g} m")
        x, y = (corners - corners[0]).T
        area = 0.5 * abs(float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))))
        if area < LEAST_AREA:
            raise ValueError(f"zone {self.name!r} encloses {area:.2g} m2: allowed is a polygon with an area")
        return self

    def distances(self, places: FloatArray) -> FloatArray:
        """From places, shape (n, 2), to the zone, shape (n,) [m]; zero inside."""
        first = np.array(self.points)
        second = np.roll(first, -1, axis=0)
        least, odd = np.full(len(places), np.inf), np.zeros(len(places), dtype=np.bool_)
        x, y = places.T
        for (x0, y0), (x1, y1) in zip(first.tolist(), second.tolist(), strict=True):
            along = ((x - x0) * (x1 - x0) + (y - y0) * (y1 - y0)) / max((x1 - x0) ** 2 + (y1 - y0) ** 2, 1e-12)
            part = np.clip(along, 0.0, 1.0)
            least = np.minimum(least, np.hypot(x - x0 - part * (x1 - x0), y - y0 - part * (y1 - y0)))
            if y0 != y1:
                odd ^= ((y0 > y) != (y1 > y)) & (x < x0 + (x1 - x0) * (y - y0) / (y1 - y0))
        return np.asarray(np.where(odd, 0.0, least))


def first_in(zones: Sequence[KeepOutZone], places: FloatArray, margin: float = 0.0) -> tuple[int, KeepOutZone] | None:
    """The first of places, shape (n, 2), that is nearer than that to a zone [m], and the zone; None for none."""
    found: tuple[int, KeepOutZone] | None = None
    for zone in zones:
        near = np.flatnonzero(zone.distances(places) <= margin)
        if len(near) and (found is None or near[0] < found[0]):
            found = int(near[0]), zone
    return found
