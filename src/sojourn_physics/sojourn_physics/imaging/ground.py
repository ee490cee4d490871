"""The ground as a camera finds it: the height field of the scenario, lower by what wheels and tools have changed.

Cameras ask for heights a million times an image, so they have a grid of their own in single precision (0.03 mm at 500
m), bilinear between its nodes. It is the height field's own grid where that is bilinear; a bicubic one is taken twice
as fine, which is off by an eighth of the second difference of two nodes at most. Off the map the ground goes from the
height of the nearest edge to that of all edges' mean, halfway after FADE: hills of the edge would else stand to the
horizon.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sojourn_machine.kernels import njit, small_kernel
from sojourn_machine.params import FloatArray, IntArray
from sojourn_physics.terrain.height_field import HeightField, sample_ground
from sojourn_physics.terrain.memory import GroundMemory
from sojourn_physics.terrain.memory_tiles import CHANNELS, DUG, RUT, TILE, Tile

FADE = 10.0
"""[m]"""
FAR_STRIDE = 0.05
"""Off the map a stride grows with the distance, by this part of it [-]."""
UNIT = np.uint64(1)
INSIDE = 1.00001
"""Nodes by which a place is off the far edge at least: it has a node beyond it."""
HIGHEST_HEAP = 0.5
"""Above the height field's own highest node [m]."""


class Changes(NamedTuple):
    """What has been changed of the ground, for the kernels."""

    pool: Tile
    """(pages, TILE, TILE, CHANNELS), see `terrain/memory_tiles`; page 0 is untouched."""
    pages: IntArray
    """Page of each tile of the map, (rows, columns)."""
    place: FloatArray
    """x and y of the first node in map, distance of nodes [m], how many pages there are: (4,)."""


class DrawnGround(NamedTuple):
    """For the kernels."""

    heights: NDArray[np.float32]
    """At the nodes, (rows, columns) [m]."""
    place: FloatArray
    """(6,): x, y of the first node in map [m], nodes a metre, distance of nodes, highest ground, mean of edges [m]."""
    bounds: FloatArray
    """x_min, x_max, y_min, y_max of the map, (4,) [m]."""
    changes: Changes


def seen_ground(field: HeightField) -> DrawnGround:
    """Of a scenario, as it was at the start."""
    resolution, heights = field.resolution, field.heights
    if field.interpolation == "bicubic":
        resolution, heights = 0.5 * resolution, _twice_as_fine(heights, field.grid)
    highest = float(heights.max()) + HIGHEST_HEAP
    edge = float(np.concatenate([heights[0], heights[-1], heights[:, 0], heights[:, -1]]).mean())
    place = np.array([field.origin_x, field.origin_y, 1.0 / resolution, resolution, highest, edge])
    return DrawnGround(np.ascontiguousarray(heights, dtype=np.float32), place, np.array(field.bounds), NO_CHANGES)


def with_changes(ground: DrawnGround, memory: GroundMemory) -> DrawnGround:
    """The same ground as wheels and tools have left it."""
    side = TILE * memory.cell
    if not memory.tiles:
        return ground._replace(changes=NO_CHANGES)
    columns = int((ground.bounds[1] - memory.origin_x) / side) + 2
    rows = int((ground.bounds[3] - memory.origin_y) / side) + 2
    return ground._replace(changes=_changes_in(memory, (0, columns), (0, rows)))


def changes_within(memory: GroundMemory, x: float, y: float, reach: float) -> Changes:
    """What has been changed within `reach` of a place in map at least, each way [m]."""
    if not memory.tiles:
        return NO_CHANGES
    side = TILE * memory.cell
    column, row = (x - memory.origin_x) / side, (y - memory.origin_y) / side
    columns = math.floor(column - reach / side), math.floor(column + reach / side) + 2
    rows = math.floor(row - reach / side), math.floor(row + reach / side) + 2
    return _changes_in(memory, columns, rows)


def _changes_in(memory: GroundMemory, columns: tuple[int, int], rows: tuple[int, int]) -> Changes:
    """Of the tiles from one column to before another, and rows likewise."""
    inside = [
        (row - rows[0], column - columns[0], tile)
        for (column, row), tile in memory.tiles.items()
        if columns[0] <= column < columns[1] and rows[0] <= row < rows[1]
    ]
    if not inside:
        return NO_CHANGES
    pages = np.zeros((rows[1] - rows[0], columns[1] - columns[0]), dtype=np.int64)
    pool = np.zeros((len(inside) + 1, TILE, TILE, CHANNELS), dtype=np.float32)
    for page, (row, column, tile) in enumerate(inside, start=1):
        pages[row, column], pool[page] = page, tile
    side = TILE * memory.cell
    first = memory.origin_x + columns[0] * side, memory.origin_y + rows[0] * side
    return Changes(pool, pages, np.array([*first, memory.cell, len(pool)]))


NO_CHANGES = Changes(
    np.zeros((1, TILE, TILE, CHANNELS), dtype=np.float32),
    np.zeros((1, 1), dtype=np.int64),
    np.array([0.0, 0.0, 1.0, 1.0]),
)


@njit(cache=True)
def _twice_as_fine(heights: FloatArray, grid: FloatArray) -> NDArray[np.float32]:
    rows, columns = 2 * heights.shape[0] - 1, 2 * heights.shape[1] - 1
    finer = np.empty((rows, columns), dtype=np.float32)
    for i in range(rows):
        for j in range(columns):
            height, _, _, _ = sample_ground(heights, grid, grid[0] + 0.5 * j * grid[2], grid[1] + 0.5 * i * grid[2])
            finer[i, j] = height
    return finer


@small_kernel
def height_at(ground: DrawnGround, x: float, y: float) -> float:
    """Of the ground at (x, y) in map as it is now [m]."""
    rows, columns = ground.heights.shape
    x_in_nodes, y_in_nodes = (x - ground.place[0]) * ground.place[2], (y - ground.place[1]) * ground.place[2]
    column, row = min(max(x_in_nodes, 0.0), columns - INSIDE), min(max(y_in_nodes, 0.0), rows - INSIDE)
    i, j = int(row), int(column)
    height = between(ground.heights, (i, j), (np.float32(row - i), np.float32(column - j)))
    off = (abs(x_in_nodes - column) + abs(y_in_nodes - row)) * ground.place[3]
    if off > ground.place[3]:
        height = ground.place[5] + (height - ground.place[5]) * FADE * FADE / (FADE * FADE + off * off)
    if any_change(ground.changes):
        height -= lowered_at(ground.changes, x, y)
    return float(height)


@small_kernel
def between(heights: NDArray[np.float32], node: tuple[int, int], part: tuple[float, float]) -> float:
    """At parts of a node, in single precision, above and to the right of a node, its row and its column."""
    lower, left = np.uint64(node[0]), np.uint64(node[1])  # without a sign there is nothing to be looked up from the end
    right, upper = left + UNIT, lower + UNIT
    up, beside = part
    low = heights[lower, left] + beside * (heights[lower, right] - heights[lower, left])
    high = heights[upper, left] + beside * (heights[upper, right] - heights[upper, left])
    return float(low + up * (high - low))


@small_kernel
def is_untouched(changes: Changes, here: tuple[float, float], there: tuple[float, float]) -> bool:
    """Whether nothing has been changed on the line between two places in map."""
    found = True
    if any_change(changes):
        x, y, cell = changes.place[0], changes.place[1], changes.place[2]
        column, row = (min(here[0], there[0]) - x) / cell, (min(here[1], there[1]) - y) / cell
        to_column, to_row = (max(here[0], there[0]) - x) / cell, (max(here[1], there[1]) - y) / cell
        rows, columns = changes.pages.shape  # a cell more: the last of a tile has nodes of the next
        for i in range(max(int(row) // TILE, 0), min((int(to_row) + 1) // TILE + 1, rows)):
            for j in range(max(int(column) // TILE, 0), min((int(to_column) + 1) // TILE + 1, columns)):
                found = found and changes.pages[i, j] == 0
    return found


@small_kernel
def lowered_at(changes: Changes, x: float, y: float) -> float:
    """By how much the ground at (x, y) in map is lower than it was [m]."""
    column = (x - changes.place[0]) / changes.place[2]
    row = (y - changes.place[1]) / changes.place[2]
    lowered = 0.0
    if column >= 0.0 and row >= 0.0:
        j, i = int(column), int(row)
        u, v = column - j, row - i
        if i // TILE < changes.pages.shape[0] and j // TILE < changes.pages.shape[1]:
            page = changes.pages[i // TILE, j // TILE]
            if i % TILE < TILE - 1 and j % TILE < TILE - 1:
                if page > 0:
                    a, b = _lowered(changes, page, i, j), _lowered(changes, page, i, j + 1)
                    c, d = _lowered(changes, page, i + 1, j), _lowered(changes, page, i + 1, j + 1)
                    lowered = (1.0 - v) * ((1.0 - u) * a + u * b) + v * ((1.0 - u) * c + u * d)
            else:
                for up in range(2):
                    for beside in range(2):
                        at_i, at_j = (i + up) // TILE, (j + beside) // TILE
                        if at_i < changes.pages.shape[0] and at_j < changes.pages.shape[1]:
                            weight = (u if beside else 1.0 - u) * (v if up else 1.0 - v)
                            lowered += weight * _lowered(changes, changes.pages[at_i, at_j], i + up, j + beside)
    return lowered


@small_kernel
def _lowered(changes: Changes, page: int, i: int, j: int) -> float:
    return float(changes.pool[page, i % TILE, j % TILE, RUT] + changes.pool[page, i % TILE, j % TILE, DUG])


@small_kernel
def any_change(changes: Changes) -> bool:
    """Whether any of the ground has been changed."""
    return bool(changes.place[3] > 1.0)


@small_kernel
def is_changed(changes: Changes, x: float, y: float) -> bool:
    """Whether the ground has been changed in the tile of (x, y) in map."""
    found = False
    if any_change(changes):
        column, row = (x - changes.place[0]) / changes.place[2], (y - changes.place[1]) / changes.place[2]
        if column >= 0.0 and row >= 0.0:
            i, j = int(row) // TILE, int(column) // TILE
            found = i < changes.pages.shape[0] and j < changes.pages.shape[1] and changes.pages[i, j] > 0
    return found


@small_kernel
def on_map(ground: DrawnGround, x: float, y: float) -> bool:
    """Whether (x, y) is on the map."""
    bounds = ground.bounds
    return bool(bounds[0] <= x <= bounds[1] and bounds[2] <= y <= bounds[3])


@small_kernel
def stride_at(ground: DrawnGround, x: float, y: float, distance: float) -> float:
    """How far a search may step over the ground from (x, y) in map, `distance` from the camera [m]."""
    stride = 0.5 * float(ground.place[3])
    return stride if on_map(ground, x, y) else max(stride, FAR_STRIDE * distance)


@small_kernel
def slope_at(ground: DrawnGround, x: float, y: float) -> tuple[float, float]:
    """Gradient of the ground at (x, y) in map as it is now [-]; none off the map."""
    dx, dy = 0.0, 0.0
    if on_map(ground, x, y):
        rows, columns = ground.heights.shape
        column = min(max((x - ground.place[0]) * ground.place[2], 0.0), columns - INSIDE)
        row = min(max((y - ground.place[1]) * ground.place[2], 0.0), rows - INSIDE)
        left, lower = np.uint64(int(column)), np.uint64(int(row))
        right, upper = left + UNIT, lower + UNIT
        u, v = column - int(column), row - int(row)
        a, b = ground.heights[lower, left], ground.heights[lower, right]
        c, d = ground.heights[upper, left], ground.heights[upper, right]
        dx = ((b - a) * (1.0 - v) + (d - c) * v) * ground.place[2]
        dy = ((c - a) * (1.0 - u) + (d - b) * u) * ground.place[2]
        if is_changed(ground.changes, x, y):
            down_x, down_y = slope_of_changes(ground.changes, x, y)
            dx, dy = dx - down_x, dy - down_y
    return float(dx), float(dy)


@small_kernel
def slope_of_changes(changes: Changes, x: float, y: float) -> tuple[float, float]:
    """Gradient of `lowered_at` at (x, y) in map [-]."""
    cell = changes.place[2]
    half = 0.5 * cell
    return (
        (lowered_at(changes, x + half, y) - lowered_at(changes, x - half, y)) / cell,
        (lowered_at(changes, x, y + half) - lowered_at(changes, x, y - half)) / cell,
    )
