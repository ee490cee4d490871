"""A detour: from the rover back to the way that was asked for, beyond what closes it.

Candidates are the places of that way, a step apart, that lie on the maps behind the first closed stretch, up to the
next of its corners that is free: what the operator has named is not cut off. Taken is the one with the least cost of
the way there (`detour_search`) plus the length that then remains, of which the closed part counts CLOSED times: one way
round two obstacles is better than two. Corners that lie before the closed stretch are passed first. A rover that has
left a way which is open joins it AHEAD or beyond; the way to where it joins, or to the first corner, is planned, too.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sojourn_flight.hazards.clearance import ClearanceMap
from sojourn_flight.hazards.wide_map import WideMap
from sojourn_flight.planning.clothoid import Pose
from sojourn_flight.planning.detour_search import (
    Graph,
    Slopes,
    cell_costs,
    cheapest_ways,
    graph_of,
    line_costs,
    on_maps,
    static_costs,
    straight_cost,
    taut_path,
)
from sojourn_flight.planning.goal import Point
from sojourn_flight.planning.route import Route
from sojourn_machine.params import FloatArray

STEP = 0.2
"""Between two candidates [m]."""
AHEAD = 1.0
"""Where the way itself is open, it is joined at least so far ahead [m]."""
CLOSED = 6.0
"""Weight of a metre that is closed, beyond the place where the way is joined [-]."""
PASSED = 0.3
"""A corner so near ahead counts as passed [m]."""
FARTHEST = 100.0
"""The way is looked at so far ahead [m]."""


class Maps(NamedTuple):
    """What is known of the ground."""

    known: NDArray[np.bool_]
    """Cells of the map that have been seen, shape (cells, cells)."""
    slopes: Slopes
    wide: WideMap


def plan_detour(
    maps: Maps, clearance: ClearanceMap, route: Route, pose: Pose, straight: float, turning: float
) -> list[Point] | None:
    """Points to drive along, the goal last; None where the maps know no way.

    Args:
        pose: of the rover in odom.
        straight: least distance to obstacles that a straight drive needs [m]. turning: that of a point turn [m].
    """
    corners = route.stations[1:]
    last = min(route.length, route.progress + FARTHEST)
    stations = np.unique(np.concatenate([np.arange(route.progress, last, STEP), corners]))
    stations = stations[stations >= route.progress]
    places = route.points_at(stations)
    ahead = route.points_at(stations + 0.01) - route.points_at(stations - 0.01)
    lasting = graph_of(clearance, static_costs(clearance, straight, turning), maps.wide, maps.slopes)
    closed = ~np.isfinite(line_costs(lasting, places, ahead)) & on_maps(lasting, places)
    begin, end = _closed_stretch(stations, closed)
    before = [float(s) for s in corners if route.progress + PASSED < s < begin]
    points: list[Point] = []
    start = pose
    if before:
        first, start = _pose(route, before[0]), _pose(route, before[-1])
        ways = _ways_from(maps, clearance, pose, straight, turning)
        there = None if ways is None else ways.straight_or_round((pose.x, pose.y), (first.x, first.y))
        if there is None:
            return None
        points = there + [(corner.x, corner.y) for corner in (_pose(route, station) for station in before[1:])]
    ways = _ways_from(maps, clearance, start, straight, turning)
    if ways is None:
        return None
    costs = np.array([ways.cost(place) for place in places.tolist()])
    found = _joined(stations, closed, corners, end, costs)
    if found is None:
        return None
    x, y = places[found].tolist()
    onwards = ways.to((x, y)) or []
    return [*points, *onwards, *route.corners_beyond(float(stations[found]))]


class _Ways(NamedTuple):
    """The cheapest ways from a place to all others."""

    graph: Graph
    costs: FloatArray
    """Shape (nodes,)."""
    before: NDArray[np.int32]

    def cost(self, place: Sequence[float]) -> float:
        """That of the way to a place, infinite where there is none."""
        node = self.graph.node_of(place[0], place[1])
        return math.inf if node is None else float(self.costs[node])

    def to(self, place: Point) -> list[Point] | None:
        """Points of the way to a place, itself the last; None where there is none."""
        node = self.graph.node_of(*place)
        if node is None or not math.isfinite(self.costs[node]):
            return None
        return [*taut_path(self.graph, self.costs, self.before, node)[:-1], place]

    def straight_or_round(self, start: Point, place: Point) -> list[Point] | None:
        """The same as `to`, but straight from its start where nothing closes that."""
        straight = straight_cost(self.graph, np.array(start), np.array(place))
        return [place] if math.isfinite(straight) else self.to(place)


def _ways_from(maps: Maps, clearance: ClearanceMap, start: Pose, straight: float, turning: float) -> _Ways | None:
    """None for a start that is on neither map."""
    graph = graph_of(clearance, cell_costs(clearance, maps.known, start, straight, turning), maps.wide, maps.slopes)
    node = graph.node_of(start.x, start.y)
    return None if node is None else _Ways(graph, *cheapest_ways(graph, node))


def _pose(route: Route, station: float) -> Pose:
    """A place of the way, heading along it as it comes there."""
    (x, y), (east, north) = route.points_at(np.array([station, station - 0.01]))
    return Pose(float(x), float(y), math.atan2(y - north, x - east))


def _closed_stretch(stations: FloatArray, closed: NDArray[np.bool_]) -> tuple[float, float]:
    """Where the way is first closed: from, to. Where it is open, both are a little ahead."""
    where = np.flatnonzero(closed)
    if not len(where):
        near = min(float(stations[0]) + AHEAD, float(stations[-1]) - 1e-6)
        return near, near
    gaps = np.flatnonzero(np.diff(where) > 1)
    last = where[gaps[0]] if len(gaps) else where[-1]
    return float(stations[where[0]]), float(stations[last])


def _joined(
    stations: FloatArray, closed: NDArray[np.bool_], corners: FloatArray, end: float, ways: FloatArray
) -> int | None:
    """Number of the place at which the way is joined again; None where none can be reached.

    Args:
        ways: cost of the way to each place, shape (stations,).
    """
    steps = np.append(np.diff(stations), 0.0)
    remaining = np.cumsum((steps * np.where(closed, CLOSED, 1.0))[::-1])[::-1]
    best, found = math.inf, None
    for number in np.flatnonzero(~closed & (stations > end)):
        cost = float(ways[number] + remaining[number])
        if cost < best:
            best, found = cost, int(number)
        if math.isfinite(cost) and np.abs(corners - stations[number]).min() < 1e-9:
            break
    return found
