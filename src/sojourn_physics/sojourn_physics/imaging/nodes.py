"""Where places are between the nodes of the ground's grid, many at a time, and what grids over it say there.

Each step does one thing for all places of a row, so that the processor takes several at once, or has the memory of
several under way.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sojourn_machine.kernels import njit, small_kernel, vector_kernel
from sojourn_machine.params import FloatArray
from sojourn_physics.imaging.ground import INSIDE, UNIT, DrawnGround
from sojourn_physics.imaging.single import ONE, ZERO, narrowed


class Nodes(NamedTuple):
    """Of places over the ground, for the kernels: (n,) each. Those off the map are where its edge is nearest."""

    row: NDArray[np.int32]
    """Of the node below, in the grid of `DrawnGround.heights`, as all of these."""
    column: NDArray[np.int32]
    """Of the node to the left."""
    right: NDArray[np.float32]
    """By how much of a node the place is to the right of that, 0 to 1."""
    up: NDArray[np.float32]
    on: NDArray[np.float32]
    """1 on the map, 0 off it."""
    corners: NDArray[np.float32]
    """Room, (4, n): what a grid has at the nodes below left and right, above left and right."""


@njit(cache=True)
def nodes_for(count: int) -> Nodes:
    """Room for so many places."""
    whole, part = np.empty((2, count), dtype=np.int32), np.empty((3, count), dtype=np.float32)
    return Nodes(whole[0], whole[1], part[0], part[1], part[2], np.empty((4, count), dtype=np.float32))


@vector_kernel
def find_nodes(ground: DrawnGround, x: FloatArray, y: FloatArray, nodes: Nodes) -> None:
    """Write where places in map are, (n,) each [m]."""
    rows, columns = ground.heights.shape
    west, south, a_metre = ground.place[0], ground.place[1], ground.place[2]
    x_min, x_max, y_min, y_max = ground.bounds[0], ground.bounds[1], ground.bounds[2], ground.bounds[3]
    for j in range(x.shape[0]):
        column = min(max((x[j] - west) * a_metre, 0.0), columns - INSIDE)
        row = min(max((y[j] - south) * a_metre, 0.0), rows - INSIDE)
        left, lower = np.int32(column), np.int32(row)
        nodes.column[j], nodes.row[j] = left, lower
        nodes.right[j], nodes.up[j] = np.float32(column - left), np.float32(row - lower)
        # as `on_map`, without a branch
        nodes.on[j] = ONE if (x_min <= x[j]) & (x[j] <= x_max) & (y_min <= y[j]) & (y[j] <= y_max) else ZERO


@small_kernel
def _look_up(grid: NDArray[np.float32], nodes: Nodes, count: int) -> None:
    """Write what a grid has at the corners of the first places."""
    corners = nodes.corners
    for j in range(count):
        left, lower = np.uint64(nodes.column[j]), np.uint64(nodes.row[j])  # without a sign: see `ground.between`
        corners[0, j], corners[1, j] = grid[lower, left], grid[lower, left + UNIT]
        corners[2, j], corners[3, j] = grid[lower + UNIT, left], grid[lower + UNIT, left + UNIT]


@small_kernel
def heights_between(ground: DrawnGround, nodes: Nodes, heights: NDArray[np.float32]) -> None:
    """Write the height of the ground as it was at the first so many places [m]."""
    _look_up(ground.heights, nodes, heights.shape[0])
    _bilinear(nodes, heights)


@vector_kernel
def _bilinear(nodes: Nodes, found: NDArray[np.float32]) -> None:
    corners = nodes.corners
    for j in range(found.shape[0]):
        right = nodes.right[j]
        low = corners[0, j] + right * (corners[1, j] - corners[0, j])
        high = corners[2, j] + right * (corners[3, j] - corners[2, j])
        found[j] = low + nodes.up[j] * (high - low)


@small_kernel
def slopes_between(ground: DrawnGround, nodes: Nodes, along: NDArray[np.float32], across: NDArray[np.float32]) -> None:
    """Write the gradient of the ground as it was, along x and y [-], none off the map: (n,) each."""
    _look_up(ground.heights, nodes, along.shape[0])
    _gradients(narrowed(ground.place[2]), nodes, along, across)


@vector_kernel
def _gradients(a_metre: float, nodes: Nodes, along: NDArray[np.float32], across: NDArray[np.float32]) -> None:
    corners = nodes.corners
    for j in range(along.shape[0]):
        scale, right, up = nodes.on[j] * a_metre, nodes.right[j], nodes.up[j]
        below, above = corners[1, j] - corners[0, j], corners[3, j] - corners[2, j]
        left, beside = corners[2, j] - corners[0, j], corners[3, j] - corners[1, j]
        along[j] = (below + up * (above - below)) * scale
        across[j] = (left + right * (beside - left)) * scale
