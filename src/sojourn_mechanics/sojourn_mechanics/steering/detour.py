"""A way round: from the rover back to the way that was asked for, beyond what closes it.

Candidates are the places of that way, a step apart, that lie on the map behind the first closed stretch. Taken is the
one with the least cost of the way there (`way_round`) plus the length that then remains.
"""

import math

import numpy as np

from sojourn_mechanics.steering.goal import Point
from sojourn_mechanics.steering.obstacle_map import ObstacleMap
from sojourn_mechanics.steering.room import Room
from sojourn_mechanics.steering.route import Route
from sojourn_mechanics.steering.way_round import cell_costs, cheapest_ways, taut_path

STEP = 0.2
"""Between two candidates [m]."""
AHEAD = 1.0
"""Where the way itself is open, it is joined at least so far ahead [m]."""


def plan_detour(
    map_: ObstacleMap, room: Room, route: Route, position: Point, straight: float, turning: float
) -> list[Point] | None:
    """Points to drive along, the goal last; None where the map knows no way.

    Args:
        straight: least distance to obstacles that a straight drive needs [m]. turning: that of a point turn [m].
    """
    start = room.cell_of(*position)
    if not room.holds(*position):
        return None
    stations = np.append(np.arange(route.progress, route.length, STEP), route.length)
    places = route.points_at(stations)
    distances = np.array([room.at(float(x), float(y)) for x, y in places])
    closed = np.flatnonzero(distances < straight)
    first = AHEAD
    if len(closed):
        gaps = np.flatnonzero(np.diff(closed) > 1)
        last = closed[gaps[0]] if len(gaps) else closed[-1]
        first = float(stations[last]) - route.progress
    costs = cell_costs(room, map_.known, position, straight, turning)
    ways, before = cheapest_ways(costs, room.cell, start)
    best, found = math.inf, -1
    for number, station in enumerate(stations):
        is_goal = number == len(stations) - 1
        if (station - route.progress <= first and not is_goal) or not room.holds(*places[number]):
            continue
        if distances[number] < straight:
            continue
        cost = ways[room.cell_of(*places[number])] + route.length - station
        if cost < best:
            best, found = cost, number
    if found < 0:
        return None
    path = taut_path(room, costs, ways, before, room.cell_of(*places[found]))
    joined: Point = (float(places[found, 0]), float(places[found, 1]))
    return [*path[:-1], joined, *route.corners_beyond(float(stations[found]))]
