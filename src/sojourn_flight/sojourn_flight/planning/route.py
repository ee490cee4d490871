"""The way that was asked for, as a line in odom, and how far the rover is along it."""

import math
from dataclasses import dataclass, replace

import numpy as np

from sojourn_flight.planning.goal import Goal, Point
from sojourn_machine.params import FloatArray

WINDOW = 3.0
"""Progress is looked for so far ahead of the last [m], so that a way that crosses itself is not cut short."""


@dataclass(frozen=True, slots=True)
class Route:
    """A goal and the line to it from where it was accepted, in odom."""

    goal: Goal
    line: tuple[Point, ...]
    """Corners, the first where the goal was accepted."""
    driven: float
    """Odometer there [m]."""
    progress: float = 0.0
    """Length of the line that lies behind [m]."""

    @property
    def stations(self) -> FloatArray:
        """Length of the line up to each corner [m]."""
        steps = [math.dist(one, other) for one, other in zip(self.line[:-1], self.line[1:], strict=True)]
        return np.concatenate([[0.0], np.cumsum(steps)])

    @property
    def length(self) -> float:
        """[m]"""
        return float(self.stations[-1])

    def points_at(self, stations: FloatArray) -> FloatArray:
        """Places at these lengths of the line, shape (n, 2) [m]."""
        corners = np.array(self.line)
        return np.stack([np.interp(stations, self.stations, corners[:, axis]) for axis in range(2)], axis=1)

    def corners_beyond(self, station: float) -> list[Point]:
        """Corners of the line that come after a length of it."""
        return [point for point, there in zip(self.line, self.stations, strict=True) if there > station + 1e-6]


def route_of(goal: Goal, position: Point, driven: float) -> Route:
    """The way to a goal from a place in odom."""
    return Route(goal, (position, *goal.points), driven)


def advanced(route: Route, position: Point, step: float) -> Route:
    """The route with its progress moved on to the place of the line that is nearest."""
    stations = np.arange(route.progress, min(route.progress + WINDOW, route.length) + 0.5 * step, step)
    away = np.hypot(*(route.points_at(stations) - position).T)
    return replace(route, progress=float(min(stations[int(np.argmin(away))], route.length)))
