"""A way round: from the rover back to the way that was asked for, beyond what closes it.

Candidates are the places of that way, a step apart, that lie on the map behind the first closed stretch, up to the next
of its corners that is free: what the operator has named is not cut off. Taken is the one with the least cost of the
way there (`way_round`) plus the length that then remains, of which the closed part counts CLOSED times: one way round
two obstacles is better than two. Corners that lie before the closed stretch are passed first.
"""

import math

import numpy as np
from numpy.typing import NDArray

from sojourn_mechanics.params import FloatArray
from sojourn_mechanics.steering.goal import Point
from sojourn_mechanics.steering.obstacle_map import ObstacleMap
from sojourn_mechanics.steering.room import Room
from sojourn_mechanics.steering.route import Route
from sojourn_mechanics.steering.way_round import Area, cell_costs, cheapest_ways, taut_path
from sojourn_mechanics.vehicle.clothoid import Pose

STEP = 0.2
"""Between two candidates [m]."""
AHEAD = 1.0
"""Where the way itself is open, it is joined at least so far ahead [m]."""
CLOSED = 6.0
"""Weight of a metre that is closed, beyond the place where the way is joined [-]."""
PASSED = 0.3
"""A corner so near ahead counts as passed [m]."""


def plan_detour(
    map_: ObstacleMap, room: Room, route: Route, pose: Pose, straight: float, turning: float, area: Area | None = None
) -> list[Point] | None:
    """Points to drive along, the goal last; None where the map knows no way.

    Args:
        pose: of the rover in odom.
        straight: least distance to obstacles that a straight drive needs [m]. turning: that of a point turn [m].
        area: that the rover may use; None for any.
    """
    corners = route.stations[1:]
    stations = np.unique(np.concatenate([np.arange(route.progress, route.length, STEP), corners]))
    stations = stations[stations >= route.progress]
    places = route.points_at(stations)
    free = np.array([room.holds(x, y) and room.at(x, y) >= straight for x, y in places.tolist()])
    begin, end = _closed_stretch(stations, places, room, straight)
    before = [float(s) for s in corners if route.progress + PASSED < s < begin]
    start = pose if not before else _pose(route, before[-1])
    if not room.holds(start.x, start.y):
        return None
    costs = cell_costs(room, map_.known, start, straight, turning, area)
    ways, previous = cheapest_ways(costs, room.cell, room.cell_of(start.x, start.y))
    found = _joined(stations, places, free, corners, end, room, ways)
    if found is None:
        return None
    path = taut_path(room, costs, ways, previous, room.cell_of(*places[found].tolist()))
    joined: Point = (float(places[found, 0]), float(places[found, 1]))
    first = [(corner.x, corner.y) for corner in (_pose(route, station) for station in before)]
    return [*first, *path[:-1], joined, *route.corners_beyond(float(stations[found]))]


def _pose(route: Route, station: float) -> Pose:
    """A place of the way, heading along it as it comes there."""
    (x, y), (east, north) = route.points_at(np.array([station, station - 0.01]))
    return Pose(float(x), float(y), math.atan2(y - north, x - east))


def _closed_stretch(stations: FloatArray, places: FloatArray, room: Room, straight: float) -> tuple[float, float]:
    """Where the way is first closed: from, to. Where it is open, from nowhere to a little ahead."""
    closed = np.flatnonzero([room.at(x, y) < straight for x, y in places.tolist()])
    if not len(closed):
        return math.inf, min(float(stations[0]) + AHEAD, float(stations[-1]) - 1e-6)
    gaps = np.flatnonzero(np.diff(closed) > 1)
    last = closed[gaps[0]] if len(gaps) else closed[-1]
    return float(stations[closed[0]]), float(stations[last])


def _joined(
    stations: FloatArray,
    places: FloatArray,
    free: NDArray[np.bool_],
    corners: FloatArray,
    end: float,
    room: Room,
    ways: FloatArray,
) -> int | None:
    """Number of the place at which the way is joined again; None where none can be reached."""
    closed = np.array([room.holds(x, y) for x, y in places.tolist()]) & ~free
    steps = np.append(np.diff(stations), 0.0)
    remaining = np.cumsum((steps * np.where(closed, CLOSED, 1.0))[::-1])[::-1]
    best, found = math.inf, None
    for number in np.flatnonzero(free & (stations > end)):
        cost = float(ways[room.cell_of(*places[number].tolist())] + remaining[number])
        if cost < best:
            best, found = cost, int(number)
        if math.isfinite(cost) and np.abs(corners - stations[number]).min() < 1e-9:
            break
    return found
