"""What is remembered of the ground beyond the map: a coarse square grid in odom that rolls along, for long ways round.

A cell keeps what a plan has to know of it: the cost of a metre there (infinite where the rover cannot be), the slope,
and at which distance driven it was seen. It is taken from the map with each cloud: from the cell of the map in its
middle, where the map knows ground in it or an obstacle stands so near that the rover would touch it. Near the edge of
the map, where obstacles beyond it are not seen, a cell is closed but not opened again.

It forgets after `wide_memory` metres: odometry's drift puts an obstacle some cells off by then, and what is in view is
judged by the map anyway.

Source: Carsten, Rankin, Ferguson & Stentz (2009), J. Field Robotics 26(4):337 (a wide, coarse map with costs beside the
local one with its goodness, on Mars); Singh et al. (2000), IEEE Int. Conf. Robotics and Automation 2:1194 (its cells
filled from the local map's).
"""

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sojourn_flight.hazards.obstacle_map import CellGrid
from sojourn_flight.hazards.obstacle_params import ObstacleMapParams
from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray

COST, SLOPE_X, SLOPE_Y, SEEN_AT, LAYERS = 0, 1, 2, 3, 4
"""Layers: cost of a metre [-], slope along x and y [-], odometer [m]."""
RECENTRE = 4.0
"""The grid moves when the rover is so far from its middle [m]."""
NEVER = -1.0
"""Odometer of a cell that has not been seen."""


@dataclass(frozen=True, slots=True)
class WideMap:
    """The grid; nobody writes to it after it was made."""

    x0: float
    """Corner in odom [m], a whole number of cells."""
    y0: float
    cell: float
    """Side of a cell [m]."""
    layers: FloatArray
    """Shape (LAYERS, cells, cells); row along y, column along x."""

    @property
    def known(self) -> NDArray[np.bool_]:
        """Cells that have been seen."""
        known: NDArray[np.bool_] = self.layers[SEEN_AT] > NEVER
        return known


class JudgedCells(NamedTuple):
    """What is thought of the cells of the map."""

    grid: CellGrid
    costs: FloatArray
    """Shape (cells, cells) [-]; infinite where closed."""
    slopes: FloatArray
    """Along x and y, shape (2 or more, cells, cells) [-]."""
    known: NDArray[np.bool_]
    """Shape (cells, cells)."""


def empty_wide_map(params: ObstacleMapParams, x: float, y: float) -> WideMap:
    """Nothing known round a place in odom [m]."""
    cell = params.wide_cell
    count = round(params.wide_size / cell)
    corner = [(round(value / cell) - count // 2) * cell for value in (x, y)]
    return WideMap(corner[0], corner[1], cell, _unseen(count))


def _unseen(count: int) -> FloatArray:
    layers = np.zeros((LAYERS, count, count))
    layers[COST], layers[SEEN_AT] = 1.0, NEVER
    return layers


def remembered(
    params: ObstacleMapParams, wide: WideMap, judged: JudgedCells, here: tuple[float, float, float]
) -> WideMap:
    """The wide map after a cloud.

    Args:
        here: place of the rover in odom, and odometer [m].
    """
    rolled = _rolled(wide, here[0], here[1])
    layers = rolled.layers.copy()
    layers[:, layers[SEEN_AT] < here[2] - params.wide_memory] = _unseen(1)[:, 0]
    take(layers, CellGrid(rolled.x0, rolled.y0, rolled.cell), judged, here[2])
    return replace(rolled, layers=layers)


def _rolled(wide: WideMap, x: float, y: float) -> WideMap:
    """The grid with (x, y) near its middle; what leaves it is forgotten."""
    count = wide.layers.shape[1]
    right, up = (round((value - corner) / wide.cell) - count // 2 for value, corner in ((x, wide.x0), (y, wide.y0)))
    if max(abs(right), abs(up)) * wide.cell <= RECENTRE:
        return wide
    layers = _unseen(count)
    if abs(right) < count and abs(up) < count:
        old = wide.layers[:, max(up, 0) : count + min(up, 0), max(right, 0) : count + min(right, 0)]
        layers[:, max(-up, 0) : count - max(up, 0), max(-right, 0) : count - max(right, 0)] = old
    return replace(wide, x0=wide.x0 + right * wide.cell, y0=wide.y0 + up * wide.cell, layers=layers)


@njit(cache=True)
def take(layers: FloatArray, wide: CellGrid, judged: JudgedCells, driven: float) -> None:
    """Write what a map says into the layers of a wide one, see the module."""
    costs, slopes, known, fine = judged.costs, judged.slopes, judged.known, judged.grid
    size, count = layers.shape[1], costs.shape[0]
    ratio = round(wide.cell / fine.cell)
    edge = 2 * ratio
    for row in range(size):
        first = round((wide.y0 + row * wide.cell - fine.y0) / fine.cell)
        if first < 0 or first + ratio > count:
            continue
        for column in range(size):
            begin = round((wide.x0 + column * wide.cell - fine.x0) / fine.cell)
            if begin < 0 or begin + ratio > count:
                continue
            i, j = first + ratio // 2, begin + ratio // 2
            closed = np.isinf(costs[i, j])
            if not closed and not known[first : first + ratio, begin : begin + ratio].any():
                continue
            inner = edge <= first and first + ratio <= count - edge and edge <= begin and begin + ratio <= count - edge
            if np.isinf(layers[0, row, column]) and not closed and not inner:
                continue
            layers[0, row, column] = costs[i, j]
            layers[1, row, column] = slopes[0, i, j]
            layers[2, row, column] = slopes[1, i, j]
            layers[3, row, column] = driven
