"""A path as the rover follows it: legs of continuous curvature, with a turn on the spot between one and the next.

A leg is held as samples of its clothoids, arcs and straights, at most SPACING apart; in between, everything is
linear (the chord of an arc of curvature k is off by no more than k SPACING^2 / 8: 0.2 mm at 0.7 1/m)."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from sojourn_mechanics.params import FloatArray
from sojourn_mechanics.steering.odometry import wrap_angle
from sojourn_mechanics.vehicle.clothoid import Piece, Pose, sample_path

SPACING = 0.05
"""Distance of the samples [m]."""
BEHIND, AHEAD = 0.2, 1.0
"""How far from the last place on the path the next is looked for [m]; paths may cross themselves."""
NO_TURN = 0.02
"""Angle below which nothing has to be turned [rad]."""


class PathPoint(NamedTuple):
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

    def nearest(self, x: float, y: float, near: float) -> PathPoint:
        """The place on the leg nearest to (x, y) [m] among those about `near` [m] from its begin."""
        s = self.samples[:, 0]
        first = max(int(np.searchsorted(s, near - BEHIND)) - 1, 0)
        last = min(int(np.searchsorted(s, near + AHEAD)) + 1, len(s) - 1)
        part = self.samples[first : last + 1]
        step = part[1:, 1:3] - part[:-1, 1:3]
        offset = np.array((x, y)) - part[:-1, 1:3]
        square = np.maximum((step * step).sum(axis=1), 1e-24)
        fraction = np.clip((offset * step).sum(axis=1) / square, 0.0, 1.0)
        miss = offset - fraction[:, None] * step
        place = int(np.argmin((miss * miss).sum(axis=1)))
        row = part[place] + fraction[place] * (part[place + 1] - part[place])
        cosine, sine = np.cos(row[3]), np.sin(row[3])
        lateral = cosine * (y - row[2]) - sine * (x - row[1])
        return PathPoint(float(row[0]), float(row[3]), float(row[4]), float(lateral))


@dataclass(frozen=True, eq=False)
class Path:
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
