"""A path as the rover follows it: legs of continuous curvature, with a turn on the spot between one and the next.

A leg is held as samples of its clothoids, arcs and straights, at most SPACING apart; in between, everything is
linear (the chord of an arc of curvature k is off by no more than k SPACING^2 / 8: 0.2 mm at 0.7 1/m)."""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sojourn_flight.odometry.odometry import wrap_angle
from sojourn_flight.planning.clothoid import Piece, Pose, sample_path
from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray

SPACING = 0.05
"""Distance of the samples [m]."""
BEHIND, AHEAD = 0.2, 1.0
"""How far from the last place on the path the next is looked for [m]; paths may cross themselves."""
SHORTEST_SQUARE = 1e-24
"""A step between two samples whose square is less is one on the spot [m^2]."""
NO_TURN = 0.02
"""Angle below which nothing has to be turned [rad]."""


class NearestPoint(NamedTuple):
    """A place on a leg, the nearest to the rover."""

    distance: float
    """From the begin of the leg [m]."""
    heading: float
    """Of the path [rad], not wrapped."""
    curvature: float
    """[1/m]"""
    lateral: float
    """Of the rover, to the left of the path [m]."""


@dataclass(frozen=True, eq=False)
class Leg:
    """Part of a path that is driven without a stop."""

    start: Pose
    pieces: tuple[Piece, ...]
    samples: FloatArray
    """Distance, x, y [m], heading [rad], curvature [1/m]; shape (n, 5), n at least 2."""

    @classmethod
    def of(cls, start: Pose, pieces: tuple[Piece, ...]) -> "Leg":
        """A leg of these pieces; there must be one longer than nothing."""
        return cls(start, pieces, sample_path(start, pieces, SPACING))

    @property
    def length(self) -> float:
        """[m]"""
        return float(self.samples[-1, 0])

    @property
    def end(self) -> Pose:
        """Pose at its end."""
        return Pose(*(float(value) for value in self.samples[-1, 1:4]))

    def nearest(self, x: float, y: float, near: float) -> NearestPoint:
        """The place on the leg nearest to (x, y) [m] among those about `near` [m] from its begin."""
        return NearestPoint(*_nearest(self.samples, float(x), float(y), float(near)))


@njit(cache=True)
def _nearest(samples: FloatArray, x: float, y: float, near: float) -> tuple[float, float, float, float]:
    """The fields of a NearestPoint."""
    count = samples.shape[0]
    first = max(int(np.searchsorted(samples[:, 0], near - BEHIND)) - 1, 0)
    last = min(int(np.searchsorted(samples[:, 0], near + AHEAD)) + 1, count - 1)
    place, part, least = first, 0.0, np.inf
    for i in range(first, last):
        step_x, step_y = samples[i + 1, 1] - samples[i, 1], samples[i + 1, 2] - samples[i, 2]
        off_x, off_y = x - samples[i, 1], y - samples[i, 2]
        fraction = (off_x * step_x + off_y * step_y) / max(step_x * step_x + step_y * step_y, SHORTEST_SQUARE)
        fraction = min(max(fraction, 0.0), 1.0)
        miss_x, miss_y = off_x - fraction * step_x, off_y - fraction * step_y
        square = miss_x * miss_x + miss_y * miss_y
        if square < least:
            place, part, least = i, fraction, square
    row = samples[place] + part * (samples[place + 1] - samples[place])
    lateral = math.cos(row[3]) * (y - row[2]) - math.sin(row[3]) * (x - row[1])
    return row[0], row[3], row[4], lateral


def thinned(distances: FloatArray, step: float) -> NDArray[np.int64]:
    """Numbers of samples about `step` from one another [m], with the first and the last.

    Args:
        distances: of all samples along a path, shape (n,), n at least 1 [m].
    """
    wanted = np.arange(distances[0], distances[-1] + step, step)
    return np.unique(np.searchsorted(distances, wanted).clip(max=len(distances) - 1))


@dataclass(frozen=True, eq=False)
class PlannedPath:
    """The way to a goal. No legs: it is there already."""

    legs: tuple[Leg, ...]
    marks: tuple[float, ...]
    """Distance along the path at which each waypoint is passed [m]."""

    @property
    def length(self) -> float:
        """[m]"""
        return sum(leg.length for leg in self.legs)

    def turns(self, yaw: float, yaw_at_end: float | None) -> tuple[float, ...]:
        """Angles of all turns on the spot, from a heading at the start to one at the end [rad]."""
        headings = [yaw]
        for leg in self.legs:
            headings += [leg.start.heading, leg.end.heading]
        headings.append(headings[-1] if yaw_at_end is None else yaw_at_end)
        pairs = zip(headings[::2], headings[1::2], strict=True)
        angles = (abs(wrap_angle(after - before)) for before, after in pairs)
        return tuple(angle for angle in angles if angle > NO_TURN)
