"""A detour round obstacles: the cheapest path over the cells of the map and of the wide map beyond it, drawn taut.

A cell costs for each metre

    w = 1 + NARROW clip((R - D) / (R - r), 0, 1) + NEAR clip((R + SOFT - D) / SOFT, 0, 1) + UNSEEN [unknown]
          + TURN a / pi [nearer to the rover than TURN_WAY]

with D the distance to the nearest obstacle, r the least that a straight drive needs, R that of a point turn, and a the
angle by which the cell lies off the rover's heading: a turn takes time, and a rover that has begun to go round one side
does not change it for little. Below r a cell is closed. A step from one cell to a neighbour (eight) costs the mean of
the two, and for the slope g of the ground in its direction, with p = g . d along it and q across it,

    CLIMB max(p, 0) / climb + SIDE |q| / side      per metre;  closed where p, -p or |q| is beyond its limit,

so that up, down and across a slope are three things, as its drive is. What noise explains of a slope is taken off.

The map and the wide one are one graph: the cells of the map, those of the wide map whose middles lie outside of it, and
a link from each cell at the map's edge to the wide cell beyond. Dijkstra's algorithm (1959; that of scipy) finds the
cheapest ways from the rover to all cells. Unknown ground counts as passable (Koenig & Likhachev 2005, IEEE Trans.
Robotics 21(3):354, "freespace assumption"): the way is planned again when it turns out not to be. That the far part of
the cost comes from a wide map, and not from the straight distance, is what leads round long obstacles (Carsten, Rankin,
Ferguson & Stentz 2009, J. Field Robotics 26(4):337; Stentz 1995, Int. Joint Conf. Artificial Intelligence, 1652).
Costs by direction on slopes: Helmick, Angelova & Matthies (2009), J. Field Robotics 26(4):391.

The path is drawn taut: from each of its places straight on to the farthest that costs no more than the cells between.
Lengths [m], places in odom.
"""

import math
from collections.abc import Callable
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sojourn_flight.hazards.clearance import ClearanceMap
from sojourn_flight.hazards.obstacle_params import TiltLimits
from sojourn_flight.hazards.wide_map import COST, SLOPE_X, SLOPE_Y, WideMap
from sojourn_flight.planning.clothoid import Pose
from sojourn_flight.planning.goal import Point
from sojourn_machine.params import FloatArray

NARROW, NEAR, UNSEEN = 6.0, 1.0, 0.5
"""Extra cost of a metre: where there is no room to turn, near an obstacle, over ground not seen [-]."""
CLIMB, SIDE = 0.6, 0.4
"""Extra cost of a metre on the steepest slope that is driven, up it and across it [-]: up 8 degrees a metre takes half
as much energy again as on the level (`energy_per_metre` of the explorer); across it the drift has to be made good."""
SOFT = 0.5
"""Beyond the circle of a point turn an obstacle counts as near for so long [m]."""
TURN, TURN_WAY = 3.0, 1.0
"""Extra cost of a metre behind the rover, and how far about it [-], [m]: half a turn takes as long as three metres."""
ESCAPE = 0.8
"""Round the rover a cell may be as narrow as its own place is [m]."""
TAUT = 1.02
"""A straight line may cost so much more than the cells that it replaces [-]."""
PROBE = 0.5
"""A straight line is looked at every so many cells of the map [-]."""


def static_costs(clearance: ClearanceMap, straight: float, turning: float) -> FloatArray:
    """Cost of a metre that obstacles make in each cell, infinite where closed; `straight` is r, `turning` is R."""
    distances = clearance.distances
    narrow = np.clip((turning - distances) / (turning - straight), 0.0, 1.0)
    near = np.clip((turning + SOFT - distances) / SOFT, 0.0, 1.0)
    return np.asarray(np.where(distances >= straight, 1.0 + NARROW * narrow + NEAR * near, np.inf))


def cell_costs(
    clearance: ClearanceMap, known: NDArray[np.bool_], start: Pose, straight: float, turning: float
) -> FloatArray:
    """Cost of a metre in each cell of the map, from where the rover is; shape (cells, cells)."""
    nearer = min(straight, clearance.at(start.x, start.y) - 0.1)
    costs = static_costs(clearance, straight, turning)
    middles = clearance.cell * (np.arange(len(costs)) + 0.5)
    east, north = clearance.x0 + middles[np.newaxis, :] - start.x, clearance.y0 + middles[:, np.newaxis] - start.y
    away = np.hypot(east, north)
    if nearer < straight:
        costs = np.where(away < ESCAPE, static_costs(clearance, nearer, turning), costs)
    off = np.angle(np.exp(1j * (np.arctan2(north, east) - start.heading)))
    return np.asarray(costs + UNSEEN * ~known + np.where(away < TURN_WAY, TURN * np.abs(off) / np.pi, 0.0))


class Slopes(NamedTuple):
    """How the slope of the ground counts."""

    map: FloatArray
    """Gradient on the cells of the map, from `sure_slopes`, shape (2, cells, cells) [-]."""
    limits: TiltLimits


def sure_slopes(slopes: FloatArray) -> FloatArray:
    """Gradients less what noise explains of them, shape (2, cells, cells), from those of a judged map."""
    steepness = np.hypot(slopes[0], slopes[1])
    sure = np.divide(
        np.maximum(steepness - slopes[2], 0.0), steepness, out=np.zeros_like(steepness), where=steepness > 0
    )
    return np.asarray(slopes[:2] * sure)


class Graph(NamedTuple):
    """The cells of both maps: those of the map row by row, then those of the wide map."""

    clearance: ClearanceMap
    wide: WideMap
    costs: FloatArray
    """Of a metre, shape (nodes,); infinite where closed, and on wide cells that the map covers."""
    slopes: FloatArray
    """Shape (2, nodes) [-]."""
    limits: TiltLimits

    def node_of(self, x: float, y: float) -> int | None:
        """The cell that holds a place; None off both maps."""
        if self.clearance.holds(x, y):
            row, column = self.clearance.cell_of(x, y)
            return row * len(self.clearance.distances) + column
        wide = self.wide
        size = int(wide.layers.shape[1])
        row, column = math.floor((y - wide.y0) / wide.cell), math.floor((x - wide.x0) / wide.cell)
        if not (0 <= row < size and 0 <= column < size):
            return None
        return int(self.clearance.distances.size) + row * size + column

    def places(self) -> FloatArray:
        """Middles of the cells, shape (nodes, 2) [m]."""
        return np.concatenate([
            _middles(len(self.clearance.distances), self.clearance.x0, self.clearance.y0, self.clearance.cell),
            _middles(self.wide.layers.shape[1], self.wide.x0, self.wide.y0, self.wide.cell),
        ])  # fmt: skip


def _middles(size: int, x0: float, y0: float, cell: float) -> FloatArray:
    rows, columns = np.divmod(np.arange(size * size), size)
    return np.stack([x0 + (columns + 0.5) * cell, y0 + (rows + 0.5) * cell], axis=1)


def graph_of(clearance: ClearanceMap, costs: FloatArray, wide: WideMap, slopes: Slopes) -> Graph:
    """The graph; `costs` are those of the map's cells, from `cell_costs`."""
    far = _middles(wide.layers.shape[1], wide.x0, wide.y0, wide.cell)
    side = len(clearance.distances) * clearance.cell
    covered = (np.abs(far - (clearance.x0 + 0.5 * side, clearance.y0 + 0.5 * side)) < 0.5 * side).all(axis=1)
    far_costs = np.where(covered, np.inf, (wide.layers[COST] + UNSEEN * ~wide.known).ravel())
    return Graph(
        clearance,
        wide,
        np.concatenate([costs.ravel(), far_costs]),
        np.concatenate([slopes.map.reshape(2, -1), wide.layers[SLOPE_X : SLOPE_Y + 1].reshape(2, -1)], axis=1),
        slopes.limits,
    )


class Pairs(NamedTuple):
    """Neighbouring cells, each pair once."""

    first: NDArray[np.int64]
    second: NDArray[np.int64]
    way: FloatArray
    """From the one to the other, shape (2, pairs), in cells or metres."""


@lru_cache(maxsize=4)
def neighbours(rows: int, columns: int) -> Pairs:
    """Of a grid, row by row, the way in cells."""
    numbers = np.arange(rows * columns).reshape(rows, columns)
    pairs = [
        (numbers[:, :-1], numbers[:, 1:], (1.0, 0.0)),
        (numbers[:-1], numbers[1:], (0.0, 1.0)),
        (numbers[:-1, :-1], numbers[1:, 1:], (1.0, 1.0)),
        (numbers[1:, :-1], numbers[:-1, 1:], (1.0, -1.0)),
    ]
    first = np.concatenate([one.ravel() for one, _, _ in pairs])
    second = np.concatenate([other.ravel() for _, other, _ in pairs])
    ways = np.concatenate([np.tile(np.array(way)[:, np.newaxis], one.size) for one, _, way in pairs], axis=1)
    return Pairs(first, second, ways)


def _links(graph: Graph, places: FloatArray) -> Pairs:
    """From each cell at the edge of the map to the wide cell beyond, the way in metres."""
    clearance, wide = graph.clearance, graph.wide
    size, many = len(clearance.distances), wide.layers.shape[1]
    number = np.arange(size * size).reshape(size, size)
    first, second = [], []
    sides = ((number[0], (0, -1)), (number[-1], (0, 1)), (number[:, 0], (-1, 0)), (number[:, -1], (1, 0)))
    for cells, outwards in sides:
        # beyond the wide cells whose middles are on the map
        beyond = places[cells] + 0.5 * (clearance.cell + wide.cell) * np.array(outwards)
        columns, rows = (np.floor((beyond - (wide.x0, wide.y0)) / wide.cell).astype(np.int64)).T
        there = (rows >= 0) & (rows < many) & (columns >= 0) & (columns < many)
        first.append(cells[there])
        second.append(size * size + (rows * many + columns)[there])
    one, other = np.concatenate(first), np.concatenate(second)
    return Pairs(one, other, (places[other] - places[one]).T)


def slope_costs(along: FloatArray, across: FloatArray, limits: TiltLimits) -> FloatArray:
    """Extra cost of a metre for a slope along and across its direction [-]; infinite where it is too steep."""
    side = np.abs(across) / limits.side
    found = CLIMB * np.maximum(along, 0.0) / limits.climb + SIDE * side
    return np.asarray(np.where((along > limits.climb) | (along < -limits.descent) | (side > 1.0), np.inf, found))


def cheapest_ways(graph: Graph, start: int) -> tuple[FloatArray, NDArray[np.int32]]:
    """Cost of the cheapest way from a cell to each, shape (nodes,), and the cell before each on it."""
    clearance, wide = graph.clearance, graph.wide
    near, far = neighbours(*clearance.distances.shape), neighbours(*wide.layers.shape[1:])
    links = _links(graph, graph.places())
    offset = clearance.distances.size
    pairs = Pairs(
        np.concatenate([near.first, far.first + offset, links.first]),
        np.concatenate([near.second, far.second + offset, links.second]),
        np.concatenate([near.way * clearance.cell, far.way * wide.cell, links.way], axis=1),
    )
    return cheapest_over(pairs, graph.costs, graph.slopes, graph.limits, start)


def cheapest_over(
    pairs: Pairs, costs: FloatArray, slopes: FloatArray, limits: TiltLimits, start: int
) -> tuple[FloatArray, NDArray[np.int32]]:
    """The same over cells with their neighbours.

    Args:
        pairs: of them, the way in metres. costs: of a metre, shape (nodes,). slopes: shape (2, nodes) [-].
    """
    from scipy.sparse import csr_matrix  # here: a drive without a camera need not wait for it to load
    from scipy.sparse.csgraph import dijkstra

    first, second, ways = pairs
    count = len(costs)
    open_ = np.isfinite(costs[first] + costs[second])
    first, second, ways = first[open_], second[open_], ways[:, open_]
    lengths = np.hypot(*ways)
    slope = 0.5 * (slopes[:, first] + slopes[:, second])
    along, across = (slope * ways).sum(axis=0) / lengths, (slope[1] * ways[0] - slope[0] * ways[1]) / lengths
    base = 0.5 * (costs[first] + costs[second])
    there = lengths * (base + slope_costs(along, across, limits))
    back = lengths * (base + slope_costs(-along, across, limits))
    weights = np.concatenate([there, back])
    passable = np.isfinite(weights)
    from_, to = np.concatenate([first, second])[passable], np.concatenate([second, first])[passable]
    matrix = csr_matrix((weights[passable], (from_, to)), shape=(count, count))
    found, before = dijkstra(matrix, directed=True, indices=start, return_predecessors=True)
    return found, before


def taut_path(graph: Graph, ways: FloatArray, before: NDArray[np.int32], end: int) -> list[Point]:
    """The cheapest way to a cell that can be reached as few points, without the first (the rover's own)."""
    nodes = nodes_to(before, end)
    return drawn_taut(graph.places()[nodes], ways[nodes], lambda one, other: straight_cost(graph, one, other))


def nodes_to(before: NDArray[np.int32], end: int) -> list[int]:
    """Cells of the cheapest way to one, from its start. before: of each the cell before it, negative at the start."""
    nodes = [end]
    while before[nodes[-1]] >= 0:
        nodes.append(int(before[nodes[-1]]))
    nodes.reverse()
    return nodes


def drawn_taut(
    places: FloatArray, ways: FloatArray, straight: Callable[[FloatArray, FloatArray], float]
) -> list[Point]:
    """A way as few points, without the first.

    Args:
        places: of its cells, shape (n, 2) [m]. ways: cost of the way up to each, shape (n,).
        straight: cost of a straight line between two places.
    """
    points: list[Point] = []
    here = 0
    while here < len(places) - 1:
        there = here + 1
        for far in range(len(places) - 1, here + 1, -1):
            if straight(places[here], places[far]) <= TAUT * (ways[far] - ways[here]):
                there = far
                break
        here = there
        points.append((float(places[here, 0]), float(places[here, 1])))
    return points


def straight_cost(graph: Graph, start: FloatArray, end: FloatArray) -> float:
    """Cost of a straight line between two places on the maps, shape (2,) [m]."""
    way = end - start
    length = float(np.hypot(*way))
    parts = np.linspace(0.0, 1.0, max(2, math.ceil(length / (PROBE * graph.clearance.cell)) + 1))
    return float(line_costs(graph, start + parts[:, np.newaxis] * way, way[np.newaxis, :]).mean()) * length


def line_costs(graph: Graph, places: FloatArray, ways: FloatArray) -> FloatArray:
    """Cost of a metre at places on the maps, shape (n, 2), towards `ways`, shape (n or 1, 2): shape (n,)."""
    clearance, wide = graph.clearance, graph.wide
    size, many = len(clearance.distances), wide.layers.shape[1]
    columns, rows = np.floor((places - (clearance.x0, clearance.y0)) / clearance.cell).astype(np.int64).T
    far = np.clip(np.floor((places - (wide.x0, wide.y0)) / wide.cell).astype(np.int64), 0, many - 1)
    on_map = (rows >= 0) & (rows < size) & (columns >= 0) & (columns < size)
    nodes = np.where(on_map, rows * size + columns, size * size + far[:, 1] * many + far[:, 0])
    ahead = (ways / np.maximum(np.hypot(ways[:, 0], ways[:, 1]), 1e-9)[:, np.newaxis]).T
    slopes = graph.slopes[:, nodes]
    along, across = slopes[0] * ahead[0] + slopes[1] * ahead[1], slopes[1] * ahead[0] - slopes[0] * ahead[1]
    return np.asarray(graph.costs[nodes] + slope_costs(along, across, graph.limits))


def on_maps(graph: Graph, places: FloatArray) -> NDArray[np.bool_]:
    """Whether a map holds each of the places, shape (n, 2): shape (n,)."""
    return np.array([graph.node_of(x, y) is not None for x, y in places.tolist()], dtype=np.bool_)
