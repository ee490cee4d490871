"""Triangles of the ground, small only where it is curved: a browser without a graphics card draws ten thousand of them
several times a second, but not a hundred thousand.

A right-triangulated irregular network (Evans, Kirkpatrick and Townsend 2001): each square of nodes is two right
triangles, and a triangle is halved at the middle of its longest side where the ground lies away from that side by more
than is borne, or must be halved there for the sake of a smaller one. The middle belongs to the triangles on both of its
sides, in one tile or in two, so that no gap opens anywhere.
"""

import numpy as np
from numpy.typing import NDArray

from sojourn_machine.params import FloatArray


class GroundMesh:
    """Of heights on a grid of tiles.

    Args:
        heights: of the nodes, (rows * tile + 1, columns * tile + 1) [m]. tile: spaces between nodes along a tile, a
            power of two. most: nodes that are kept at most, but for the corners of tiles. finest: what the ground may
            lie away from its triangles in any case [m].
    """

    def __init__(self, heights: FloatArray, tile: int, most: int, finest: float) -> None:
        self._tile, self._width = tile, heights.shape[1]
        away = errors_of(heights, tile)
        self.borne = max(
            finest, float(np.partition(away, -most - 1, axis=None)[-most - 1]) if most < away.size else 0.0
        )
        """How far the ground may lie away from its triangles [m]."""
        self._is_kept = away > self.borne

    def triangles(self, row: int, column: int) -> NDArray[np.int64]:
        """Of one tile, counter-clockwise from above: numbers of nodes, those of a row one after the other, (n, 3)."""
        tile = self._tile
        low, left = row * tile, column * tile
        a, b, c, d = (low, left), (low, left + tile), (low + tile, left + tile), (low + tile, left)
        # of each the right angle comes first
        pending = np.array([[b, c, a], [d, a, c]] if (row + column) % 2 == 0 else [[a, b, d], [c, d, b]])
        done = []
        while len(pending):
            apex, one, other = pending[:, 0], pending[:, 1], pending[:, 2]
            middle = (one + other) // 2
            splits = ((one - other) % 2 == 0).all(axis=1) & self._is_kept[middle[:, 0], middle[:, 1]]
            done.append(pending[~splits])
            apex, one, other, middle = apex[splits], one[splits], other[splits], middle[splits]
            halves = np.stack([middle, apex, one], axis=1), np.stack([middle, other, apex], axis=1)
            pending = np.concatenate(halves)
        found = np.concatenate(done)
        return found[:, :, 0] * self._width + found[:, :, 1]


def errors_of(heights: FloatArray, tile: int) -> FloatArray:
    """How far each node lies from the middle of the side that it halves, or a node that needs it from its own: never
    less than for any of those, (rows, columns) [m]; zero at the corners of tiles.

    Args:
        heights: as of GroundMesh. tile: likewise.
    """
    away = np.zeros_like(heights)
    step = 2
    while step <= tile:
        _judge_sides(heights, away, step)
        _judge_sides(heights.T, away.T, step)
        _judge_centres(heights, away, step)
        step *= 2
    return away


def _judge_sides(heights: FloatArray, away: FloatArray, step: int) -> None:
    """Middles of the sides along a row of all squares of a step; each is needed by the centres of the four squares of
    half the step round it."""
    half, quarter = step // 2, step // 4
    own = np.abs(heights[::step, half::step] - 0.5 * (heights[::step, :-1:step] + heights[::step, step::step]))
    if quarter:
        centres = away[quarter::half, quarter::half]
        pairs = np.pad(np.maximum(centres[:, ::2], centres[:, 1::2]), ((1, 1), (0, 0)))
        own = np.maximum(own, np.maximum(pairs[::2], pairs[1::2]))
    away[::step, half::step] = own


def _judge_centres(heights: FloatArray, away: FloatArray, step: int) -> None:
    """Centres of all squares of a step; each is needed by the middles of the four sides of its square."""
    half = step // 2
    rising = heights[:-1:step, :-1:step] + heights[step::step, step::step]
    falling = heights[:-1:step, step::step] + heights[step::step, :-1:step]
    is_rising = np.indices(rising.shape).sum(axis=0) % 2 == 0  # so that the diagonals of four squares meet
    own = np.abs(heights[half::step, half::step] - 0.5 * np.where(is_rising, rising, falling))
    sides = (
        away[:-1:step, half::step],
        away[step::step, half::step],
        away[half::step, :-1:step],
        away[half::step, step::step],
    )
    away[half::step, half::step] = np.maximum.reduce([own, *sides])
