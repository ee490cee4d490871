"""Memory of the ground: what wheels and tools have done to it, cell by cell.

Each node of a fine square grid keeps four numbers: the greatest sinkage z_u that it has seen, the depth z_r of the rut
that has stayed (`soil/repeated_loading.py`), the greatest shear displacement, and how much of the ground has been dug
away there (less than zero where soil was heaped up, see `earthwork`). Ruts lie below the ground as it was dug. The
first three are maxima over time, so that the order of writing does not matter; all are bilinear between nodes.

What a wheel presses down goes two ways: a share is compacted, the rest is found in banks beside the rut, highest at its
edge. Their volume is that rest of the rut's, node by node, however often the rut is deepened.

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

import numpy as np

from sojourn_machine.errors import MachineError
from sojourn_machine.params import FloatArray, IntArray
from sojourn_physics.terrain.memory_tiles import (
    CHANNELS,
    DUG,
    EMPTY,
    OVERFLOW,
    RUT,
    SHEAR,
    SINKAGE,
    SPARE_PAGES,
    TILE,
    USED,
    MemoryTables,
    Tile,
    new_page,
)


class MemoryFullError(MachineError):
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
        return MemoryTables(self.pool, self.slots, self.pages, self.place)

    def load(self, memory: GroundMemory) -> None:
        """Make this the working copy of a memory, with room for a period. Free of cost if it was made here last."""
        used = int(self.pages[0, USED])
        abandoned = bool(self.pages[1:used, 2].any())  # by a step that raised an error before it was stored
        if memory is not self._memory or abandoned or self.pool.shape[0] - used < SPARE_PAGES:
            self._fill(memory)

    def store(self) -> GroundMemory:
        """The memory as it is now; shares all tiles that have not changed.

        Raises:
            MemoryFullError: there was not enough room.
        """
        if self.pages[0, OVERFLOW]:
            self._fill(self._memory)
            raise MemoryFullError()
        used = int(self.pages[0, USED])
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
        self.slots = np.full((4 * room, 2), EMPTY, dtype=np.int64)
        self.pages = np.zeros((room, 3), dtype=np.int64)
        self.pages[0, USED] = 1
        for (column, row), tile in memory.tiles.items():
            page = new_page(self.slots, self.pages, column, row)
            self.pool[page] = tile
        self.pages[1:, 2] = 0
        self._memory = memory
