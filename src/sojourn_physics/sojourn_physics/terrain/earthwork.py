"""Soil taken from the ground and put back: what a tool changes of the ground's memory (`memory`), nothing lost.

Cut: a blade of width w whose edge moves from one place to another takes all soil above the line of its edge from the
nodes that it passes: those with 0 < s <= 1 along the line and -w/2 < t <= w/2 across it, so that each node is passed
once, and a furrow along the grid is as many nodes wide as cells fit into w. Its walls stand: a wall of cohesive soil
does up to the height (4 c/γ) tan(45° + φ/2) (Terzaghi 1943, Theoretical Soil Mechanics), 0.5 m in lunar soil.

Heap: soil that falls onto a place piles up to the cone

    z = z_top - tan(φ_r) r

over what is there, with the angle of repose φ_r; z_top is such that the volume between ground and cone is that of the
soil (bisection, from below). On sloping or rough ground the heap fills what lies lower first.

Volume is counted on the nodes as they are stored, each with the area of a cell: what one kernel takes is what the
others find, to the rounding of a sum in double precision. Nodes are single precision: depths of 1 m to 6e-8 m. The
volume put down is short of that asked by some roundings of the nodes of the heap; it is returned and the rest is for
the caller to keep. Assumption: soil is as dense in a heap as it was in the ground.
"""

import math
from typing import NamedTuple

import numpy as np

from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray
from sojourn_physics.terrain.height_field import HeightArray, HeightField, sample_ground
from sojourn_physics.terrain.memory import MemoryBoard
from sojourn_physics.terrain.memory_tiles import DUG, RUT, TILE, MemoryTables, find_page, new_page

BISECTIONS = 60


class ToolGround(NamedTuple):
    """The ground that a tool works in."""

    memory: MemoryTables
    """Advanced in place."""
    heights: HeightArray
    """See `HeightField`, these two."""
    grid: FloatArray


def cut(
    board: MemoryBoard, terrain: HeightField, grid: FloatArray, begin: FloatArray, end: FloatArray, width: float
) -> float:
    """Take the soil above a blade's way from `begin` to `end`, each (3,) in map [m]: volume taken [m3].

    Args:
        board: written. grid: of the terrain, see `HeightField.grid`. width: of the blade [m].
    """
    return float(_cut(ToolGround(board.tables, terrain.heights, grid), begin, end, width))


def heap(
    board: MemoryBoard, terrain: HeightField, grid: FloatArray, x: float, y: float, volume: float, tan_repose: float
) -> float:
    """Let soil of a volume [m3] fall onto (x, y) in map: volume that has been put there, never more than that [m3].

    Args:
        board: written. grid: of the terrain, see `HeightField.grid`. tan_repose: of the angle of repose.
    """
    return float(_heap(ToolGround(board.tables, terrain.heights, grid), x, y, volume, tan_repose))


def warm_up(board: MemoryBoard, terrain: HeightField, grid: FloatArray) -> None:
    """Have the kernels ready for this ground, so that no dig waits for the compiler; changes nothing."""
    here = np.array([terrain.origin_x, terrain.origin_y, 0.0])
    cut(board, terrain, grid, here, here.copy(), 0.0)
    heap(board, terrain, grid, terrain.origin_x, terrain.origin_y, 0.0, 1.0)


@njit(cache=True)
def _height(ground: ToolGround, column: int, row: int) -> float:
    memory = ground.memory
    place = memory.place
    found = sample_ground(ground.heights, ground.grid, place[0] + column * place[2], place[1] + row * place[2])
    page = find_page(memory.slots, column // TILE, row // TILE)
    node = memory.pool[page, row % TILE, column % TILE]
    return float(found[0] - node[RUT] - node[DUG])


@njit(cache=True)
def _raise(memory: MemoryTables, column: int, row: int, by: float) -> float:
    """Put soil of a height [m], less than 0 to take it, onto a node; what it has come to as stored."""
    page = new_page(memory.slots, memory.pages, column // TILE, row // TILE)
    if page == 0:
        return 0.0
    node = memory.pool[page, row % TILE, column % TILE]
    before = np.float64(node[DUG])  # float() would leave it in single precision here
    node[DUG] = np.float32(before - by)
    memory.pages[page, 2] = 1
    return float(before - np.float64(node[DUG]))


@njit(cache=True)
def _cut(ground: ToolGround, begin: FloatArray, end: FloatArray, width: float) -> float:
    place = ground.memory.place
    cell = place[2]
    along_x, along_y = end[0] - begin[0], end[1] - begin[1]
    length = math.sqrt(along_x * along_x + along_y * along_y)
    if not (cell > 0.0 and length > 0.0):
        return 0.0
    along_x /= length
    along_y /= length
    half = 0.5 * width
    margin = half + cell
    low_x, high_x = min(begin[0], end[0]) - margin, max(begin[0], end[0]) + margin
    low_y, high_y = min(begin[1], end[1]) - margin, max(begin[1], end[1]) + margin
    volume = 0.0
    for row in range(max(math.ceil((low_y - place[1]) / cell), 0), math.floor((high_y - place[1]) / cell) + 1):
        for column in range(max(math.ceil((low_x - place[0]) / cell), 0), math.floor((high_x - place[0]) / cell) + 1):
            dx = place[0] + column * cell - begin[0]
            dy = place[1] + row * cell - begin[1]
            along = dx * along_x + dy * along_y
            across = dy * along_x - dx * along_y
            if not (0.0 < along <= length and -half < across <= half):
                continue
            edge = begin[2] + along / length * (end[2] - begin[2])
            depth = _height(ground, column, row) - edge
            if depth > 0.0:
                volume -= _raise(ground.memory, column, row, -depth) * cell * cell
    return volume


@njit(cache=True)
def _cone(ground: FloatArray, before: FloatArray, distance: FloatArray, top: float, slope: float, cell: float) -> float:
    """Volume of the heap with a top, as it would be stored."""
    volume = 0.0
    for i in range(ground.shape[0]):
        height = top - slope * distance[i] - ground[i]
        if height > 0.0:
            volume += (before[i] - np.float64(np.float32(before[i] - height))) * cell * cell
    return volume


@njit(cache=True)
def _heap(ground: ToolGround, x: float, y: float, volume: float, slope: float) -> float:
    memory, place = ground.memory, ground.memory.place
    cell = place[2]
    if not (cell > 0.0 and volume > 0.0 and slope > 0.0):
        return 0.0
    # a cone on level ground has the radius (3 V/(π tan φ))^(1/3); one on a slope reaches further down
    reach = 3.0 * (3.0 * volume / (math.pi * slope)) ** (1.0 / 3.0) + 2.0 * cell
    first_column = max(math.ceil((x - reach - place[0]) / cell), 0)
    last_column = math.floor((x + reach - place[0]) / cell)
    first_row = max(math.ceil((y - reach - place[1]) / cell), 0)
    last_row = math.floor((y + reach - place[1]) / cell)
    count = max(last_column - first_column + 1, 0) * max(last_row - first_row + 1, 0)
    if count == 0:
        return 0.0
    height, before, distance = np.empty(count), np.empty(count), np.empty(count)
    k = 0
    for row in range(first_row, last_row + 1):
        for column in range(first_column, last_column + 1):
            height[k] = _height(ground, column, row)
            before[k] = memory.pool[
                find_page(memory.slots, column // TILE, row // TILE), row % TILE, column % TILE, DUG
            ]
            dx, dy = place[0] + column * cell - x, place[1] + row * cell - y
            distance[k] = math.sqrt(dx * dx + dy * dy)
            k += 1
    low = float(np.min(height + slope * distance))  # the cone that just touches
    high = low + volume / (cell * cell) + slope * cell
    for _ in range(BISECTIONS):
        top = 0.5 * (low + high)
        if _cone(height, before, distance, top, slope, cell) <= volume:
            low = top
        else:
            high = top
    put = 0.0
    k = 0
    for row in range(first_row, last_row + 1):
        for column in range(first_column, last_column + 1):
            fill = low - slope * distance[k] - height[k]
            if fill > 0.0:
                put += _raise(memory, column, row, fill) * cell * cell
            k += 1
    return put
