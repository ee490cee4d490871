"""Way round obstacles: shortest path over the cells of the map, drawn taut.

A cell costs for each metre

    w = 1 + NARROW clip((R - D) / (R - r), 0, 1) + NEAR clip((R + SOFT - D) / SOFT, 0, 1) + UNSEEN [unknown]
          + TURN a / pi [nearer to the rover than TURN_WAY]

with D the distance to the nearest obstacle, r the least that a straight drive needs, R that of a point turn, and a the
angle by which the cell lies off the rover's heading: a turn takes time, and a rover that has begun to go round one side
does not change it for little. Below r a cell is closed, and where it lies outside the area that the rover may use.
Neighbours (eight) are joined at the mean of their costs, and Dijkstra's algorithm (1959; that of scipy) finds the
cheapest ways from the rover to all cells. Unknown ground counts as passable (Koenig & Likhachev 2005, IEEE Trans.
Robotics 21(3):354, "freespace assumption"): the way is planned again when it turns out not to be.

The path is drawn taut: from each of its cells straight on to the farthest that costs no more than the cells between.
Lengths [m], places in odom.
"""

import math
from functools import lru_cache
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from sojourn_mechanics.params import FloatArray
from sojourn_mechanics.steering.goal import Point
from sojourn_mechanics.steering.room import Room
from sojourn_mechanics.vehicle.clothoid import Pose

NARROW, NEAR, UNSEEN = 6.0, 1.0, 0.5
"""Extra cost of a metre: where there is no room to turn, near an obstacle, over ground not seen [-]."""
SOFT = 0.5
"""Beyond the circle of a point turn an obstacle counts as near for so long [m]."""
TURN, TURN_WAY = 3.0, 1.0
"""Extra cost of a metre behind the rover, and how far about it [-], [m]: half a turn takes as long as three metres."""
Area: TypeAlias = tuple[float, float, float, float]
"""x_min, x_max, y_min, y_max in odom [m]."""
ESCAPE = 0.8
"""Round the rover a cell may be as narrow as its own place is [m]."""
TAUT = 1.02
"""A straight line may cost so much more than the cells that it replaces [-]."""


def cell_costs(
    room: Room,
    known: NDArray[np.bool_],
    start: Pose,
    straight: float,
    turning: float,
    area: Area | None = None,
) -> FloatArray:
    """Cost of a metre in each cell, infinite where it is closed: see the module; `straight` is r, `turning` is R."""
    distances = room.distances
    narrow = np.clip((turning - distances) / (turning - straight), 0.0, 1.0)
    near = np.clip((turning + SOFT - distances) / SOFT, 0.0, 1.0)
    costs = 1.0 + NARROW * narrow + NEAR * near + UNSEEN * ~known
    middles = room.cell * (np.arange(len(distances)) + 0.5)
    east, north = room.x0 + middles[np.newaxis, :], room.y0 + middles[:, np.newaxis]
    away = np.hypot(east - start.x, north - start.y)
    off = np.angle(np.exp(1j * (np.arctan2(north - start.y, east - start.x) - start.heading)))
    costs += np.where(away < TURN_WAY, TURN * np.abs(off) / np.pi, 0.0)
    least = np.where(away < ESCAPE, min(straight, room.at(start.x, start.y) - 0.1), straight)
    open_ = distances >= least
    if area is not None:
        west, far_east, south, far_north = area
        open_ &= (east >= west + turning) & (east <= far_east - turning)
        open_ &= (north >= south + turning) & (north <= far_north - turning)
    found: FloatArray = np.where(open_, costs, np.inf)
    return found


@lru_cache(maxsize=4)
def _neighbours(size: int) -> tuple[NDArray[np.int64], NDArray[np.int64], FloatArray]:
    """Pairs of neighbouring cells, each pair once, and their distances in cells."""
    numbers = np.arange(size * size).reshape(size, size)
    pairs = [
        (numbers[:, :-1], numbers[:, 1:], 1.0),
        (numbers[:-1], numbers[1:], 1.0),
        (numbers[:-1, :-1], numbers[1:, 1:], math.sqrt(2.0)),
        (numbers[1:, :-1], numbers[:-1, 1:], math.sqrt(2.0)),
    ]
    first = np.concatenate([one.ravel() for one, _, _ in pairs])
    second = np.concatenate([other.ravel() for _, other, _ in pairs])
    lengths = np.concatenate([np.full(one.size, length) for one, _, length in pairs])
    return first, second, lengths


def cheapest_ways(costs: FloatArray, cell: float, start: tuple[int, int]) -> tuple[FloatArray, NDArray[np.int32]]:
    """Cost of the cheapest way from a cell to each, shape (cells, cells), and the cell before each on it, flat.

    Args:
        start: row and column, on the map. cell: side [m].
    """
    from scipy.sparse import csr_matrix  # here: a drive without a camera need not wait for it to load
    from scipy.sparse.csgraph import dijkstra

    size = len(costs)
    first, second, lengths = _neighbours(size)
    flat = costs.ravel()
    weights = 0.5 * (flat[first] + flat[second]) * lengths * cell
    open_ = np.isfinite(weights)
    graph = csr_matrix((weights[open_], (first[open_], second[open_])), shape=(size * size, size * size))
    source = start[0] * size + start[1]
    ways, before = dijkstra(graph, directed=False, indices=source, return_predecessors=True)
    return ways.reshape(size, size), before


def taut_path(
    room: Room, costs: FloatArray, ways: FloatArray, before: NDArray[np.int32], end: tuple[int, int]
) -> list[Point]:
    """The cheapest way to a cell that can be reached as few points, without the first (the rover's own)."""
    size = len(costs)
    numbers = [end[0] * size + end[1]]
    while before[numbers[-1]] >= 0:
        numbers.append(int(before[numbers[-1]]))
    cells = [divmod(number, size) for number in reversed(numbers)]
    points: list[Point] = []
    here = 0
    while here < len(cells) - 1:
        there = here + 1
        for far in range(len(cells) - 1, here + 1, -1):
            along = ways[cells[far]] - ways[cells[here]]
            if _straight_cost(costs, cells[here], cells[far], room.cell) <= TAUT * along:
                there = far
                break
        here = there
        row, column = cells[here]
        points.append((room.x0 + (column + 0.5) * room.cell, room.y0 + (row + 0.5) * room.cell))
    return points


def _straight_cost(costs: FloatArray, start: tuple[int, int], end: tuple[int, int], cell: float) -> float:
    """Cost of a straight line between two cells, looked at every half cell."""
    length = math.hypot(end[0] - start[0], end[1] - start[1])
    parts = np.linspace(0.0, 1.0, max(2, math.ceil(2.0 * length) + 1))
    rows = np.round(start[0] + parts * (end[0] - start[0])).astype(np.int64)
    columns = np.round(start[1] + parts * (end[1] - start[1])).astype(np.int64)
    return float(costs[rows, columns].mean()) * length * cell
