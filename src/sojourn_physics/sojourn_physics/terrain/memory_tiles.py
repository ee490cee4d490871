"""Tiles of the ground's memory for the kernels: what a node keeps, and the hash table from tile to page.

`MemoryBoard` (see `memory`) holds the tiles one after another, page 0 the untouched ground, all zero; a kernel finds
the page of a tile here, or takes a new one.
"""

from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from sojourn_machine.kernels import small_kernel
from sojourn_machine.params import FloatArray, IntArray

Tile: TypeAlias = NDArray[np.float32]


class MemoryTables(NamedTuple):
    """A MemoryBoard (see there), for the kernels."""

    pool: Tile
    slots: IntArray
    pages: IntArray
    place: FloatArray


TILE = 32
"""Nodes along the side of a tile."""
SINKAGE, RUT, SHEAR, DUG = 0, 1, 2, 3
CHANNELS = 4
SPARE_PAGES = 128
"""Pages that a step may take; a wheel crosses into four tiles at once at most."""

_KEY_SHIFT = 1 << 31
_HASH = 0x9E3779B1
EMPTY = -1
USED, OVERFLOW = 0, 1


@small_kernel
def find_slot(slots: IntArray, column: int, row: int) -> int:
    """Slot of a tile in the hash table, or the empty one where it would be."""
    key = row * _KEY_SHIFT + column
    mask = slots.shape[0] - 1
    slot: int = ((key ^ (key >> 31)) * _HASH >> 8) & mask
    while slots[slot, 0] != key and slots[slot, 0] != EMPTY:
        slot = (slot + 1) & mask
    return slot


@small_kernel
def find_page(slots: IntArray, column: int, row: int) -> int:
    """Page of a tile; 0, which is all zero, where no wheel has been."""
    slot = find_slot(slots, column, row)
    return int(slots[slot, 1]) if slots[slot, 0] != EMPTY else 0


@small_kernel
def new_page(slots: IntArray, pages: IntArray, column: int, row: int) -> int:
    """Page of a tile, taken from the spare ones if there is none yet; 0 where there is no room."""
    slot = find_slot(slots, column, row)
    if slots[slot, 0] != EMPTY:
        return int(slots[slot, 1])
    page = int(pages[0, USED])
    if page >= pages.shape[0]:
        pages[0, OVERFLOW] = 1
        return 0
    pages[0, USED] = page + 1
    pages[page, 0] = column
    pages[page, 1] = row
    slots[slot, 0] = row * _KEY_SHIFT + column
    slots[slot, 1] = page
    return page
