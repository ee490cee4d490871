"""Memory of the ground: what wheels and tools have done to it, cell by cell.

Each node of a fine square grid keeps four numbers: the greatest sinkage z_u that it has seen, the depth z_r of the rut
that has stayed (`soil/repeated_loading.py`), the greatest shear displacement, and how much of the ground has been dug
away there (less than zero where soil was heaped up, see `earthwork`). Ruts lie below the ground as it was dug. The
first three are maxima over time, so that the order of writing does not matter; all are bilinear between nodes.

`GroundMemory` is the value that a plant's state holds: tiles of TILE x TILE nodes, only where a wheel has been. A
tile is never written once it is in a value; a step makes new tiles of those that it changes and shares all others, so
that the cost of a branch, and of a step, does not depend on the size of the map. `MemoryBoard` is the working copy
that the kernels write: tiles one after another (page 0 is the untouched ground, all zero) and a hash table from tile
to page. It is loaded anew only when it is given another value than the one that it made last.

A wheel must not meet what it does itself in the same contact: it reads the ground just ahead of its contact, in the
direction in which it has been rolling, and writes just behind (see `contact/ground_memory.py`).
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np
from numba import njit
from numpy.typing import NDArray

from sojourn_mechanics.errors import MechanicsError
from sojourn_mechanics.params import FloatArray, IntArray

Tile: TypeAlias = NDArray[np.float32]
MemoryTables: TypeAlias = tuple[Tile, IntArray, IntArray, FloatArray]
"""Pool, slots, pages and place of a MemoryBoard, for the kernels."""

TILE = 32
"""Nodes along the side of a tile."""
SINKAGE, RUT, SHEAR, DUG = 0, 1, 2, 3
CHANNELS = 4
SPARE_PAGES = 128
"""Pages that a step may take; a wheel crosses into four tiles at once at most."""

_KEY_SHIFT = 1 << 31
_HASH = 0x9E3779B1
_EMPTY = -1
_USED, _OVERFLOW = 0, 1


class MemoryFullError(MechanicsError):
    """A step touched more new ground than it can take in."""

    def __init__(self) -> None:
        super().__init__(f"the wheels have run over more than {SPARE_PAGES} new tiles of ground in one control period")


@dataclass(frozen=True, slots=True)
class GroundMemory:
    """What the ground remembers. A value: nobody writes to its tiles.

    Attributes:
        cell: distance of the nodes [m]; 0 is ground that remembers nothing.
        origin_x, origin_y: position of node (0, 0) in `map` [m].
        tiles: by (column, row) of the tile; float32, shape (TILE, TILE, CHANNELS): sinkage, rut, shear, dug [m].
    """

    cell: float
    origin_x: float
    origin_y: float
    tiles: Mapping[tuple[int, int], Tile] = field(default_factory=dict)

    def sample(self, x: float, y: float) -> tuple[float, float, float]:
        """Greatest sinkage, rut depth and shear displacement at (x, y) in `map` [m]; zero where nobody has been."""
        values = self.grid(np.array([x]), np.array([y]))[0, 0]
        return float(values[SINKAGE]), float(values[RUT]), float(values[SHEAR])

    def lowered(self, x: float, y: float) -> float:
        """How far the ground at (x, y) in `map` lies below what it was, by ruts and digging [m]."""
        values = self.grid(np.array([x]), np.array([y]))[0, 0]
        return float(values[RUT] + values[DUG])

    def grid(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """All channels at the crossings of x, shape (nx,), and y, shape (ny,): shape (ny, nx, CHANNELS) [m]."""
        columns = (np.asarray(x, dtype=np.float64) - self.origin_x) / self.cell
        rows = (np.asarray(y, dtype=np.float64) - self.origin_y) / self.cell
        first_column, first_row = np.floor(columns).astype(np.int64), np.floor(rows).astype(np.int64)
        u = (columns - first_column)[np.newaxis, :, np.newaxis]
        v = (rows - first_row)[:, np.newaxis, np.newaxis]
        low = (1.0 - u) * self._nodes(first_column, first_row) + u * self._nodes(first_column + 1, first_row)
        high = (1.0 - u) * self._nodes(first_column, first_row + 1) + u * self._nodes(first_column + 1, first_row + 1)
        return np.asarray((1.0 - v) * low + v * high)

    def _nodes(self, columns: IntArray, rows: IntArray) -> FloatArray:
        values = np.zeros((rows.size, columns.size, CHANNELS))
        for (tile_column, tile_row), tile in self.tiles.items():
            i = np.flatnonzero(rows // TILE == tile_row)
            j = np.flatnonzero(columns // TILE == tile_column)
            if i.size and j.size:
                values[np.ix_(i, j)] = tile[np.ix_(rows[i] % TILE, columns[j] % TILE)]
        return values

    def touched(self) -> Iterator[tuple[float, float, Tile]]:
        """Position in `map` of node (0, 0) [m], and numbers, of each tile that a wheel has touched."""
        for (column, row), tile in self.tiles.items():
            yield self.origin_x + column * TILE * self.cell, self.origin_y + row * TILE * self.cell, tile


class MemoryBoard:
    """Working copy of a memory, for the kernels.

    Attributes:
        pool: float32, (pages, TILE, TILE, CHANNELS). slots: int64, (capacity, 2), hash table of key and page.
        pages: int64, (pages, 3): tile column, tile row, changed since the last `store`; row 0: pages in use, overflow.
        place: float64, (3,): origin_x, origin_y, cell of the grid [m].
    """

    def __init__(self, memory: GroundMemory) -> None:
        self._memory = memory
        self.place = np.array([memory.origin_x, memory.origin_y, memory.cell])
        self._fill(memory)

    @property
    def tables(self) -> MemoryTables:
        """For the kernels; stands until the next `load`."""
        return self.pool, self.slots, self.pages, self.place

    def load(self, memory: GroundMemory) -> None:
        """Make this the working copy of a memory, with room for a period. Free of cost if it was made here last."""
        used = int(self.pages[0, _USED])
        abandoned = bool(self.pages[1:used, 2].any())  # by a step that raised an error before it was stored
        if memory is not self._memory or abandoned or self.pool.shape[0] - used < SPARE_PAGES:
            self._fill(memory)

    def store(self) -> GroundMemory:
        """The memory as it is now; shares all tiles that have not changed.

        Raises:
            MemoryFullError: there was not enough room.
        """
        if self.pages[0, _OVERFLOW]:
            self._fill(self._memory)
            raise MemoryFullError()
        used = int(self.pages[0, _USED])
        changed = np.flatnonzero(self.pages[1:used, 2])
        if changed.size:
            tiles = dict(self._memory.tiles)
            for page in (changed + 1).tolist():
                column, row, _ = self.pages[page].tolist()
                tiles[column, row] = tile = self.pool[page].copy()
                tile.setflags(write=False)
            self.pages[1:used, 2] = 0
            old = self._memory
            self._memory = GroundMemory(old.cell, old.origin_x, old.origin_y, tiles)
        return self._memory

    def _fill(self, memory: GroundMemory) -> None:
        used = 1 + len(memory.tiles)
        room = 1 << math.ceil(math.log2(used + 2 * SPARE_PAGES))
        self.pool = np.zeros((room, TILE, TILE, CHANNELS), dtype=np.float32)
        self.slots = np.full((4 * room, 2), _EMPTY, dtype=np.int64)
        self.pages = np.zeros((room, 3), dtype=np.int64)
        self.pages[0, _USED] = 1
        for (column, row), tile in memory.tiles.items():
            page = new_page(self.slots, self.pages, column, row)
            self.pool[page] = tile
        self.pages[1:, 2] = 0
        self._memory = memory


@njit(cache=True)
def find_slot(slots: IntArray, column: int, row: int) -> int:
    """Slot of a tile in the hash table, or the empty one where it would be."""
    key = row * _KEY_SHIFT + column
    mask = slots.shape[0] - 1
    slot: int = ((key ^ (key >> 31)) * _HASH >> 8) & mask
    while slots[slot, 0] != key and slots[slot, 0] != _EMPTY:
        slot = (slot + 1) & mask
    return slot


@njit(cache=True)
def find_page(slots: IntArray, column: int, row: int) -> int:
    """Page of a tile; 0, which is all zero, where no wheel has been."""
    slot = find_slot(slots, column, row)
    return int(slots[slot, 1]) if slots[slot, 0] != _EMPTY else 0


@njit(cache=True)
def new_page(slots: IntArray, pages: IntArray, column: int, row: int) -> int:
    """Page of a tile, taken from the spare ones if there is none yet; 0 where there is no room."""
    slot = find_slot(slots, column, row)
    if slots[slot, 0] != _EMPTY:
        return int(slots[slot, 1])
    page = int(pages[0, _USED])
    if page >= pages.shape[0]:
        pages[0, _OVERFLOW] = 1
        return 0
    pages[0, _USED] = page + 1
    pages[page, 0] = column
    pages[page, 1] = row
    slots[slot, 0] = row * _KEY_SHIFT + column
    slots[slot, 1] = page
    return page


@njit(cache=True)
def read_lowered(pool: Tile, slots: IntArray, place: FloatArray, x: float, y: float) -> float:
    """How far the ground at (x, y) in map lies below what it was, by ruts and digging [m]; arguments as below."""
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
                lowered += u * v * (node[1] + node[3])
    return float(lowered)


@njit(cache=True)
def read_ground(
    pool: Tile,
    slots: IntArray,
    place: FloatArray,
    x: float,
    y: float,
    ahead_x: float,
    ahead_y: float,
    length: float,
    width: float,
) -> tuple[float, float, float, float, float]:
    """Weighted mean of the ground's memory over a rectangle: sum(w v)/sum(w) over its nodes.

    w = (1 - s^2)^2 (1 - t^2)^2 with s, t from -1 to 1 along and across it: a node comes and goes with no weight, so
    that the mean and its gradients are smooth in the place of the rectangle.

    Args:
        pool, slots, place: of a MemoryBoard.
        x, y: middle of the rectangle in map [m]. ahead_x, ahead_y: unit vector along it. length, width: its sides [m];
            at least two cells count.

    Returns:
        greatest sinkage, depth of the rut, depth of what was dug away [m], and the gradients of the two depths together
        by x and y [-].
    """
    cell = place[2]
    half = max(0.5 * length, cell)
    half_across = max(0.5 * width, cell)
    middle_x = x - place[0]
    middle_y = y - place[1]
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
                sinkage += weight * node[0]
                rut += weight * node[1]
                dug += weight * node[3]
                depth = node[1] + node[3]
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


@njit(cache=True)
def _touched(slots: IntArray, first_column: int, last_column: int, first_row: int, last_row: int) -> bool:
    """Whether a wheel has been in any tile of these nodes."""
    for row in range(first_row // TILE, last_row // TILE + 1):
        for column in range(first_column // TILE, last_column // TILE + 1):
            if find_page(slots, column, row) > 0:
                return True
    return False


@njit(cache=True)
def write_ground(
    pool: Tile,
    slots: IntArray,
    pages: IntArray,
    place: FloatArray,
    x: float,
    y: float,
    ahead_x: float,
    ahead_y: float,
    width: float,
    sinkage: float,
    rut: float,
    shear: float,
) -> None:
    """Raise the memory to these values [m] behind a line across a wheel: in a rectangle of its width, one cell long.

    Args:
        pool, slots, pages, place: of a MemoryBoard, written.
        x, y: middle of the line in map [m]. ahead_x, ahead_y: unit vector of travel. width: of the wheel [m].
    """
    cell = place[2]
    # a wheel narrower than a cell still leaves a trace of nodes
    half = max(0.5 * width, 0.5 * math.sqrt(2.0) * cell)
    middle_x = x - 0.5 * cell * ahead_x - place[0]
    middle_y = y - 0.5 * cell * ahead_y - place[1]
    reach_x = 0.5 * cell * abs(ahead_x) + half * abs(ahead_y)
    reach_y = 0.5 * cell * abs(ahead_y) + half * abs(ahead_x)
    if not (middle_x >= reach_x and middle_y >= reach_y and middle_x < 1e9 * cell and middle_y < 1e9 * cell):
        return
    first_column = math.ceil((middle_x - reach_x) / cell)
    last_column = math.floor((middle_x + reach_x) / cell)
    first_row = math.ceil((middle_y - reach_y) / cell)
    last_row = math.floor((middle_y + reach_y) / cell)
    # compared as they are stored: a number that lost its last digits there would be written again and again
    new_sinkage = np.float32(sinkage)
    new_rut = np.float32(rut)
    new_shear = np.float32(shear)
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
            if new_sinkage > node[0] or new_rut > node[1] or new_shear > node[2]:
                node[0] = max(node[0], new_sinkage)
                node[1] = max(node[1], new_rut)
                node[2] = max(node[2], new_shear)
                pages[page, 2] = 1
