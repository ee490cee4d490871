"""A way round: from the rover back to the way that was asked for, beyond what closes it.

Candidates are the places of that way, a step apart, that lie on the maps behind the first closed stretch, up to the
next of its corners that is free: what the operator has named is not cut off. Taken is the one with the least cost of
the way there (`way_round`) plus the length that then remains, of which the closed part counts CLOSED times: one way
round two obstacles is better than two. Corners that lie before the closed stretch are passed first.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sojourn_flight.hazards.clearance import Room
from sojourn_flight.hazards.wide_map import WideMap
from sojourn_flight.planning.clothoid import Pose
from sojourn_flight.planning.goal import Point
from sojourn_flight.planning.route import Route
from sojourn_flight.planning.way_round import (
    Slopes,
    cell_costs,
    cheapest_ways,
    graph_of,
    line_costs,
    on_maps,
    static_costs,
    taut_path,
)
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
    maps: Maps, room: Room, route: Route, pose: Pose, straight: float, turning: float
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
    lasting = graph_of(room, static_costs(room, straight, turning), maps.wide, maps.slopes)
    closed = ~np.isfinite(line_costs(lasting, places, ahead)) & on_maps(lasting, places)
    begin, end = _closed_stretch(stations, closed)
    before = [float(s) for s in corners if route.progress + PASSED < s < begin]
    start = pose if not before else _pose(route, before[-1])
    costs = cell_costs(room, maps.known, start, straight, turning)
    graph = graph_of(room, costs, maps.wide, maps.slopes)
    node = graph.node_of(start.x, start.y)
    if node is None:
        return None
    ways, previous = cheapest_ways(graph, node)
    nodes = [graph.node_of(x, y) for x, y in places.tolist()]
    there = np.array([math.inf if at is None else float(ways[at]) for at in nodes])
    found = _joined(stations, closed, corners, end, there)
    at = None if found is None else nodes[found]
    if found is None or at is None:
        return None
    path = taut_path(graph, ways, previous, at)
    joined: Point = (float(places[found, 0]), float(places[found, 1]))
    first = [(corner.x, corner.y) for corner in (_pose(route, station) for station in before)]
    return [*first, *path[:-1], joined, *route.corners_beyond(float(stations[found]))]


def _pose(route: Route, station: float) -> Pose:
    """A place of the way, heading along it as it comes there."""
    (x, y), (east, north) = route.points_at(np.array([station, station - 0.01]))
    return Pose(float(x), float(y), math.atan2(y - north, x - east))


def _closed_stretch(stations: FloatArray, closed: NDArray[np.bool_]) -> tuple[float, float]:
    """Where the way is first closed: from, to. Where it is open, from nowhere to a little ahead."""
    where = np.flatnonzero(closed)
    if not len(where):
        return math.inf, min(float(stations[0]) + AHEAD, float(stations[-1]) - 1e-6)
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
