"""What a contact reads of the ground's memory, and what it writes into it: see `memory`."""

import math
from typing import NamedTuple

import numpy as np

from sojourn_machine.kernels import kernel
from sojourn_machine.params import IntArray
from sojourn_physics.terrain.memory_tiles import DUG, RUT, SHEAR, SINKAGE, TILE, MemoryTables, find_page, new_page


class Patch(NamedTuple):
    """A rectangle on the ground."""

    x: float
    """Of its middle in map [m]."""
    y: float
    ahead_x: float
    """Unit vector along it."""
    ahead_y: float
    length: float
    """[m]"""
    width: float
    """[m]"""


class Trace(NamedTuple):
    """What a wheel leaves behind [m]."""

    sinkage: float
    rut: float
    shear: float
    beside: float
    """Part of the soil that is newly pressed down which goes into the banks [-]."""


@kernel
def read_lowered(memory: MemoryTables, x: float, y: float) -> float:
    """How far the ground at (x, y) in map lies below what it was, by ruts and digging [m]."""
    pool, slots, place = memory.pool, memory.slots, memory.place
    column = (x - place[0]) / place[2]
    row = (y - place[1]) / place[2]
    if not (column >= 0.0 and row >= 0.0 and column < 1e9 and row < 1e9):
        return 0.0
    first_column, first_row = int(column), int(row)
    lowered = 0.0
    for i in range(2):
        for j in range(2):
            page = find_page(slots, (first_column + j) // TILE, (first_row + i) // TILE)
            if page > 0:
                node = pool[page, (first_row + i) % TILE, (first_column + j) % TILE]
                u = column - first_column if j else 1.0 - column + first_column
                v = row - first_row if i else 1.0 - row + first_row
                lowered += u * v * (node[RUT] + node[DUG])
    return float(lowered)


@kernel
def read_ground(memory: MemoryTables, patch: Patch) -> tuple[float, float, float, float, float]:
    """Weighted mean of the ground's memory over a rectangle: sum(w v)/sum(w) over its nodes.

    w = (1 - s^2)^2 (1 - t^2)^2 with s, t from -1 to 1 along and across it: a node comes and goes with no weight, so
    that the mean and its gradients are smooth in the place of the rectangle. Of its sides at least two cells count.

    Returns:
        greatest sinkage, depth of the rut, depth of what was dug away [m], and the gradients of the two depths together
        by x and y [-].
    """
    pool, slots, place = memory.pool, memory.slots, memory.place
    ahead_x, ahead_y = patch.ahead_x, patch.ahead_y
    cell = place[2]
    half = max(0.5 * patch.length, cell)
    half_across = max(0.5 * patch.width, cell)
    middle_x = patch.x - place[0]
    middle_y = patch.y - place[1]
    reach_x = half * abs(ahead_x) + half_across * abs(ahead_y)
    reach_y = half * abs(ahead_y) + half_across * abs(ahead_x)
    if not (middle_x >= reach_x and middle_y >= reach_y and middle_x < 1e9 * cell and middle_y < 1e9 * cell):
        return 0.0, 0.0, 0.0, 0.0, 0.0
    first_column = math.ceil((middle_x - reach_x) / cell)
    last_column = math.floor((middle_x + reach_x) / cell)
    first_row = math.ceil((middle_y - reach_y) / cell)
    last_row = math.floor((middle_y + reach_y) / cell)
    if not _touched(slots, first_column, last_column, first_row, last_row):
        return 0.0, 0.0, 0.0, 0.0, 0.0
    weights = 0.0
    along_weights = 0.0
    across_weights = 0.0
    sinkage = 0.0
    rut = 0.0
    dug = 0.0
    along_depth = 0.0
    across_depth = 0.0
    page = 0
    page_column = -1
    page_row = -1
    for row in range(first_row, last_row + 1):
        dy = row * cell - middle_y
        for column in range(first_column, last_column + 1):
            dx = column * cell - middle_x
            s = (dx * ahead_x + dy * ahead_y) / half
            t = (dy * ahead_x - dx * ahead_y) / half_across
            if abs(s) >= 1.0 or abs(t) >= 1.0:
                continue
            if column // TILE != page_column or row // TILE != page_row:
                page_column = column // TILE
                page_row = row // TILE
                page = find_page(slots, page_column, page_row)
            along = 1.0 - s * s
            across = 1.0 - t * t
            weight = along * along * across * across
            by_along = 4.0 * s * along * across * across  # of the weight by the place of the rectangle, times half
            by_across = 4.0 * t * across * along * along
            weights += weight
            along_weights += by_along
            across_weights += by_across
            if page > 0:
                node = pool[page, row % TILE, column % TILE]
                sinkage += weight * node[SINKAGE]
                rut += weight * node[RUT]
                dug += weight * node[DUG]
                depth = node[RUT] + node[DUG]
                along_depth += by_along * depth
                across_depth += by_across * depth
    if weights <= 0.0:
        return 0.0, 0.0, 0.0, 0.0, 0.0
    rut /= weights
    dug /= weights
    slope_along = (along_depth - (rut + dug) * along_weights) / (weights * half)
    slope_across = (across_depth - (rut + dug) * across_weights) / (weights * half_across)
    slope_x = slope_along * ahead_x - slope_across * ahead_y
    slope_y = slope_along * ahead_y + slope_across * ahead_x
    return sinkage / weights, rut, dug, slope_x, slope_y


@kernel
def _touched(slots: IntArray, first_column: int, last_column: int, first_row: int, last_row: int) -> bool:
    """Whether a wheel has been in any tile of these nodes."""
    for row in range(first_row // TILE, last_row // TILE + 1):
        for column in range(first_column // TILE, last_column // TILE + 1):
            if find_page(slots, column, row) > 0:
                return True
    return False


@kernel
def write_ground(memory: MemoryTables, line: Patch, trace: Trace) -> None:
    """Raise the memory to a wheel's trace behind a line across it: in a rectangle of its width, one cell long.

    Args:
        memory: written. line: its middle, the way of travel, and the width of the wheel; of no length.
    """
    pool, slots, pages, place = memory.pool, memory.slots, memory.pages, memory.place
    ahead_x, ahead_y = line.ahead_x, line.ahead_y
    cell = place[2]
    # a wheel narrower than a cell still leaves a trace of nodes
    half = max(0.5 * line.width, 0.5 * math.sqrt(2.0) * cell)
    middle_x = line.x - 0.5 * cell * ahead_x - place[0]
    middle_y = line.y - 0.5 * cell * ahead_y - place[1]
    reach_x = 0.5 * cell * abs(ahead_x) + half * abs(ahead_y)
    reach_y = 0.5 * cell * abs(ahead_y) + half * abs(ahead_x)
    if not (middle_x >= reach_x and middle_y >= reach_y and middle_x < 1e9 * cell and middle_y < 1e9 * cell):
        return
    first_column = math.ceil((middle_x - reach_x) / cell)
    last_column = math.floor((middle_x + reach_x) / cell)
    first_row = math.ceil((middle_y - reach_y) / cell)
    last_row = math.floor((middle_y + reach_y) / cell)
    # compared as they are stored: a number that lost its last digits there would be written again and again
    new_sinkage = np.float32(trace.sinkage)
    new_rut = np.float32(trace.rut)
    new_shear = np.float32(trace.shear)
    pressed = 0.0
    page = 0
    page_column = -1
    page_row = -1
    for row in range(first_row, last_row + 1):
        dy = row * cell - middle_y
        for column in range(first_column, last_column + 1):
            dx = column * cell - middle_x
            along = dx * ahead_x + dy * ahead_y
            across = dy * ahead_x - dx * ahead_y
            if abs(along) > 0.5 * cell or abs(across) > half:
                continue
            if column // TILE != page_column or row // TILE != page_row:
                page_column = column // TILE
                page_row = row // TILE
                page = new_page(slots, pages, page_column, page_row)
                if page == 0:
                    return
            node = pool[page, row % TILE, column % TILE]
            if new_sinkage > node[SINKAGE] or new_rut > node[RUT] or new_shear > node[SHEAR]:
                if new_rut > node[RUT]:
                    pressed += np.float64(new_rut) - np.float64(node[RUT])
                node[SINKAGE] = max(node[SINKAGE], new_sinkage)
                node[RUT] = max(node[RUT], new_rut)
                node[SHEAR] = max(node[SHEAR], new_shear)
                pages[page, 2] = 1
    if trace.beside > 0.0 and pressed > 0.0:
        middle = Patch(middle_x, middle_y, ahead_x, ahead_y, cell, line.width)
        _bank(memory, middle, max(half, cell), trace.beside * pressed)


@kernel
def _bank(memory: MemoryTables, line: Patch, edge: float, amount: float) -> None:
    """Heap soil up on both sides of a rut, falling evenly from its edge over half as much again.

    Args:
        line: that was written, its middle from the grid's origin. edge: where the banks begin, from there: no nearer
            than what a wheel reads of its own track [m]. amount: sum of the nodes' heights [m].
    """
    pool, slots, pages, cell = memory.pool, memory.slots, memory.pages, memory.place[2]
    middle_x, middle_y, ahead_x, ahead_y = line.x, line.y, line.ahead_x, line.ahead_y
    wide = max(0.5 * edge, 2.0 * cell)
    reach_x = 0.5 * cell * abs(ahead_x) + (edge + wide) * abs(ahead_y)
    reach_y = 0.5 * cell * abs(ahead_y) + (edge + wide) * abs(ahead_x)
    first_column = max(math.ceil((middle_x - reach_x) / cell), 0)
    last_column = math.floor((middle_x + reach_x) / cell)
    first_row = max(math.ceil((middle_y - reach_y) / cell), 0)
    last_row = math.floor((middle_y + reach_y) / cell)
    total = 0.0
    for put in range(2):  # weigh the nodes, then share the soil among them
        for row in range(first_row, last_row + 1):
            dy = row * cell - middle_y
            for column in range(first_column, last_column + 1):
                dx = column * cell - middle_x
                along = dx * ahead_x + dy * ahead_y
                weight = 1.0 - (abs(dy * ahead_x - dx * ahead_y) - edge) / wide
                if abs(along) > 0.5 * cell or weight <= 0.0 or weight >= 1.0:
                    continue
                if put == 0:
                    total += weight
                    continue
                page = new_page(slots, pages, column // TILE, row // TILE)
                if page == 0:
                    return
                node = pool[page, row % TILE, column % TILE]
                node[DUG] = np.float32(np.float64(node[DUG]) - amount * weight / total)
                pages[page, 2] = 1
        if total <= 0.0:
            return
