"""A route over a map of the whole site, for goals beyond the camera's sight.

The map is one from orbit: coarse, with an error of its own. A cell is closed where

    |g| > tan(climb limit),  where the rover has found an obstacle,

within the distance that the drive keeps from such cells, and where a keep-out zone is as near. Round the rover only
what is closed by itself counts: it may stand nearer than it would plan. Over the rest the cheapest way is that of
`detour_search`: a metre costs 1 and more for its slope up, down or across, with steps to eight neighbours; Dijkstra's
algorithm (1959), that of scipy. The path is drawn taut to the corners that a drive is sent along. Between them the
drive sees for itself: what is smaller than a cell is left to it.

Two levels, a global map that is planned over again when the local one disagrees: Carsten, Rankin, Ferguson & Stentz
(2009), J. Field Robotics 26(4):337. Gradients are central differences over two cells. Lengths [m], places in map.
"""

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sojourn_flight.hazards.obstacle_params import TiltLimits
from sojourn_flight.hazards.zone_params import KeepOutZone
from sojourn_flight.planning.detour_search import (
    Pairs,
    cheapest_over,
    drawn_taut,
    neighbours,
    nodes_to,
    slope_costs,
)
from sojourn_flight.planning.goal import Point
from sojourn_machine.errors import MachineError
from sojourn_machine.params import FloatArray

PROBE = 0.25
"""A straight line is looked at every so many cells [-]."""


class NoRouteError(MachineError):
    """There is no route to a place.

    Args:
        place: x, y [m]. reason: why.
    """

    def __init__(self, place: Point, reason: str) -> None:
        super().__init__(f"no route to ({place[0]:.2f}, {place[1]:.2f}) m: {reason}")
        self.place, self.reason = place, reason


@dataclass(frozen=True, eq=False)
class SiteMap:
    """Ground as it is known from afar.

    Args:
        x0, y0: middle of the first cell [m]. cell: side of one [m]. heights: at their middles, shape (rows, columns),
            row along y, each side 2 at least [m]. limits: slopes that the machine drives. keep: distance that it keeps
            from what is closed [m]. zones: into which it must not go.
        found: cells that turned out to be closed, shape (rows, columns); None for none.
    """

    x0: float
    y0: float
    cell: float
    heights: FloatArray
    limits: TiltLimits
    keep: float
    zones: tuple[KeepOutZone, ...] = ()
    found: NDArray[np.bool_] | None = None

    @cached_property
    def slopes(self) -> FloatArray:
        """Gradient along x and y, shape (2, rows, columns) [-]."""
        along_y, along_x = np.gradient(self.heights, self.cell)
        return np.stack([along_x, along_y])

    @cached_property
    def blocked(self) -> NDArray[np.bool_]:
        """Cells that are closed by themselves, shape (rows, columns)."""
        blocked = np.asarray(np.hypot(*self.slopes) > self.limits.climb)
        if self.found is not None:
            blocked |= self.found
        return blocked

    @cached_property
    def closed(self) -> NDArray[np.bool_]:
        """Cells in which the rover's middle is not to be, shape (rows, columns)."""
        from scipy.ndimage import distance_transform_edt  # here: a drive need not wait for it to load

        away = distance_transform_edt(~self.blocked, self.cell) if self.blocked.any() else np.inf
        closed = np.broadcast_to(away <= self.keep, self.heights.shape)
        for zone in self.zones:
            closed = closed | (zone.distances(self._middles.reshape(-1, 2)) <= self.keep).reshape(closed.shape)
        return np.asarray(closed)

    def with_found(self, places: FloatArray) -> "SiteMap":
        """The same with the cells closed in which obstacles have been found. places: shape (n, 2) [m]."""
        found = np.zeros(self.heights.shape, dtype=np.bool_) if self.found is None else self.found.copy()
        rows, columns = self._cells(places).T
        on_map = (rows >= 0) & (rows < found.shape[0]) & (columns >= 0) & (columns < found.shape[1])
        found[rows[on_map], columns[on_map]] = True
        return replace(self, found=found)

    def route(self, start: Point, goal: Point) -> list[Point]:
        """Corners from one place to another, the goal last. Raises NoRouteError."""
        first, last = self._node(start, goal), self._node(goal, goal)
        costs = np.where(self.closed, np.inf, 1.0).ravel()
        if not math.isfinite(costs[last]):
            raise NoRouteError(goal, f"it is closed there: {self._why(last)}")
        near = np.hypot(*(self._middles - start).reshape(-1, 2).T) <= self.keep + self.cell
        costs[near & ~self.blocked.ravel()] = 1.0
        costs[first] = 1.0  # wherever the rover is, it has come there
        slopes = self.slopes.reshape(2, -1)
        pairs = neighbours(*self.heights.shape)
        ways, before = cheapest_over(
            Pairs(pairs.first, pairs.second, pairs.way * self.cell), costs, slopes, self.limits, first
        )
        if not math.isfinite(ways[last]):
            raise NoRouteError(goal, "what is closed on the map of the site lies round it, or round the rover")
        nodes = nodes_to(before, last)
        places = self._middles.reshape(-1, 2)[nodes]
        places[0], places[-1] = start, goal

        def straight(one: FloatArray, other: FloatArray) -> float:
            way = other - one
            length = float(np.hypot(*way))
            parts = np.linspace(0.0, 1.0, max(2, math.ceil(length / (PROBE * self.cell)) + 1))
            rows, columns = self._cells(one + parts[:, np.newaxis] * way).T
            cells = rows * self.heights.shape[1] + columns
            ahead = way / max(length, 1e-9)
            here = slopes[:, cells]
            along, across = here[0] * ahead[0] + here[1] * ahead[1], here[1] * ahead[0] - here[0] * ahead[1]
            return float((costs[cells] + slope_costs(along, across, self.limits)).mean()) * length

        return drawn_taut(places, ways[nodes], straight)

    @cached_property
    def _middles(self) -> FloatArray:
        """Shape (rows, columns, 2) [m]."""
        rows, columns = np.indices(self.heights.shape)
        return np.stack([self.x0 + self.cell * columns, self.y0 + self.cell * rows], axis=-1)

    def _cells(self, places: FloatArray) -> NDArray[np.int64]:
        """Row and column of places, shape (n, 2); may be off the map."""
        return np.rint((places - (self.x0, self.y0)) / self.cell).astype(np.int64)[:, ::-1]

    def _node(self, place: Point, goal: Point) -> int:
        row, column = self._cells(np.array([place]))[0].tolist()
        rows, columns = self.heights.shape
        if not (0 <= row < rows and 0 <= column < columns):
            edges = (value + side * self.cell for value, side in (
                (self.x0, -0.5), (self.x0, columns - 0.5), (self.y0, -0.5), (self.y0, rows - 0.5),
            ))  # fmt: skip
            allowed = "x from {:g} to {:g} m and y from {:g} to {:g} m".format(*edges)
            raise NoRouteError(
                goal, f"({place[0]:.2f}, {place[1]:.2f}) m is off the map of the site: allowed is {allowed}"
            )
        return int(row * columns + column)

    def _why(self, node: int) -> str:
        """What closes a cell."""
        place = self._middles.reshape(-1, 2)[[node]]
        for zone in self.zones:
            if zone.distances(place)[0] <= self.keep:
                return f"keep-out zone {zone.name}"
        limit = math.degrees(math.atan(self.limits.climb))
        found = "" if self.found is None else ", or the rover has found an obstacle there"
        return f"within {self.keep:.1f} m the ground is steeper than {limit:.0f} degrees{found}"
