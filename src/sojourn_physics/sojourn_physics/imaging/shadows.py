"""Which ground the Sun reaches: how high a shadow stands over each node of the height field.

With the Sun at elevation e in the direction a over ground, ground of height h at p is in the shadow of what lies
towards the Sun up to

    S(p, e) = max over s > 0 of (h(p + s a) - s tan e)

The Sun is a disc of angular radius δ. From ground that is higher than S(p, e - δ) all of it is seen, none of it from
ground that is lower than S(p, e + δ), and in between, the penumbra, a part that grows evenly. A shadow of something of
height H on level ground is H / tan e long.

S is a smooth function of place but at the sides of what throws it, so both are worked out at nodes and are bilinear
between them, by blocks of nodes when a camera first looks there, and kept while the Sun stands at the same place. They
are those of the height field: to ruts and holes each pixel looks itself, see `sunlit_nearby`.

Source: geometry (horizon angles as in Dozier & Frew 1990, IEEE Trans. Geosci. Remote Sens. 28:963).
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sojourn_machine.kernels import kernel, small_kernel
from sojourn_machine.params import FloatArray
from sojourn_physics.imaging.ground import DrawnGround, between, height_at, on_map

BLOCK = 8
"""Cells between nodes along the side of a block."""
BLOCK_SIDE = np.uint64(BLOCK)
UNKNOWN, MIXED, LIT = range(3)
"""What is known of a block: nothing, the shadows at its nodes, or that all of it is lit."""
CLEAR = 1e-3
"""All shadows over a block that is lit end so far below its ground at least [m]."""
WINDOW = 2048
"""Nodes along the side of the square in which shadows are known, about the middle of the map."""
NOTHING = -1e9
"""Stands over a place that nothing can throw a shadow on [m]."""
NEAR_STEPS = 16
NEAR_FIRST, NEAR_GROWTH = 0.012, 1.25
"""First step towards the Sun over ground that has been changed [m], and how steps grow: 2 m in all [-]."""


class CastShadows(NamedTuple):
    """For the kernels: of one ground under one Sun."""

    sun: FloatArray
    """Unit vector to the Sun in map, and the angular radius of its disc [rad]: (4,)."""
    first: np.ndarray
    """int64, (2,): row and column of the height field where the square begins."""
    lit: np.ndarray
    """float32, (rows, columns): S(p, e - δ) [m]."""
    dark: np.ndarray
    """float32, (rows, columns): S(p, e + δ) [m]."""
    known: np.ndarray
    """uint8, (rows, columns) of blocks: UNKNOWN, MIXED or LIT."""


def shadows(ground: DrawnGround, sun: FloatArray) -> CastShadows:
    """Of a Sun, see there, about the middle of the map; nothing is worked out yet."""
    rows, columns = ground.heights.shape
    size = min(rows, WINDOW), min(columns, WINDOW)
    x, y = 0.5 * (ground.bounds[0] + ground.bounds[1]), 0.5 * (ground.bounds[2] + ground.bounds[3])
    middle = (y - ground.place[1]) * ground.place[2], (x - ground.place[0]) * ground.place[2]
    first = [
        min(max(int(at) - length // 2, 0), all_of_it - length)
        for at, length, all_of_it in zip(middle, size, (rows, columns), strict=True)
    ]
    blocks = tuple(math.ceil(length / BLOCK) for length in size)
    return CastShadows(
        np.asarray(sun, dtype=np.float64),
        np.array(first, dtype=np.int64),
        np.empty(size, dtype=np.float32),
        np.empty(size, dtype=np.float32),
        np.zeros(blocks, dtype=np.uint8),
    )


@kernel
def _fill(ground: DrawnGround, cast: CastShadows, block_row: int, block_column: int) -> None:
    """Work out the shadows at the nodes of a block, those of all its edges among them."""
    rows, columns = cast.lit.shape
    highest = NOTHING
    for i in range(block_row * BLOCK, min((block_row + 1) * BLOCK + 1, rows)):
        y = ground.place[1] + (i + cast.first[0]) * ground.place[3]
        for j in range(block_column * BLOCK, min((block_column + 1) * BLOCK + 1, columns)):
            x = ground.place[0] + (j + cast.first[1]) * ground.place[3]
            cast.lit[i, j], cast.dark[i, j] = _shadow_tops(ground, cast.sun, x, y)
            highest = max(highest, cast.lit[i, j] - ground.heights[i + cast.first[0], j + cast.first[1]])
    cast.known[block_row, block_column] = LIT if highest < -CLEAR else MIXED


@kernel
def _shadow_tops(ground: DrawnGround, sun: FloatArray, x: float, y: float) -> tuple[float, float]:
    """S of the Sun's lower limb and of its upper one at a place [m]."""
    across = math.sqrt(sun[0] * sun[0] + sun[1] * sun[1])
    elevation = math.atan2(sun[2], across)
    if elevation + sun[3] >= 0.5 * math.pi:
        return NOTHING, NOTHING
    ahead_x, ahead_y = sun[0] / across, sun[1] / across
    low, high = math.tan(elevation - sun[3]), math.tan(elevation + sun[3])
    lit, dark, way = NOTHING, NOTHING, ground.place[3]
    while True:
        at_x, at_y = x + way * ahead_x, y + way * ahead_y
        height = height_at(ground, at_x, at_y)
        lit, dark = max(lit, height - way * low), max(dark, height - way * high)
        # past here nothing is high enough, or there is only the level ground beyond the map
        if ground.place[4] - way * low < lit or not on_map(ground, at_x, at_y):
            return lit, dark
        way += 0.5 * ground.place[3]


@small_kernel
def sunlit(ground: DrawnGround, cast: CastShadows, x: float, y: float, z: float) -> float:
    """Part of the Sun's disc that a point over the ground in map sees, as far as the height field hides it, 0 to 1."""
    if cast.sun[2] <= -cast.sun[3]:
        return 0.0
    column, row = (x - ground.place[0]) * ground.place[2], (y - ground.place[1]) * ground.place[2]
    i, j = math.floor(row), math.floor(column)
    return float(sunlit_between(ground, cast, (i, j), (np.float32(row - i), np.float32(column - j)), z))


@small_kernel
def sunlit_between(
    ground: DrawnGround, cast: CastShadows, node: tuple[int, int], part: tuple[float, float], z: float
) -> float:
    """The same where the Sun is up, of a point at a height above and to the right of a node, as in `ground.between`."""
    rows, columns = cast.lit.shape
    i, j = node[0] - cast.first[0], node[1] - cast.first[1]
    if not (0 <= i < rows - 1 and 0 <= j < columns - 1):
        return 1.0
    block_row, block_column = np.uint64(i) // BLOCK_SIDE, np.uint64(j) // BLOCK_SIDE
    if cast.known[block_row, block_column] == UNKNOWN:
        _fill(ground, cast, np.int64(block_row), np.int64(block_column))
    if cast.known[block_row, block_column] == LIT:
        return 1.0
    lit = between(cast.lit, (i, j), part)
    if z >= lit:
        return 1.0
    dark = between(cast.dark, (i, j), part)
    return float(min(max((z - dark) / max(lit - dark, 1e-6), 0.0), 1.0))


@kernel
def sunlit_ground(
    ground: DrawnGround, cast: CastShadows, x: FloatArray, y: FloatArray, seen: NDArray[np.float32]
) -> None:
    """The same of the ground itself at places in rows, into `seen`: x of the columns, y of the rows [m]."""
    for i in range(len(y)):
        for j in range(len(x)):
            seen[i, j] = sunlit(ground, cast, x[j], y[i], height_at(ground, x[j], y[i]))


@kernel
def sunlit_nearby(ground: DrawnGround, sun: FloatArray, x: float, y: float, z: float) -> float:
    """The same as far as ground close by hides it that wheels or tools have changed, 0 or 1."""
    across = math.sqrt(sun[0] * sun[0] + sun[1] * sun[1])
    if across < 1e-6:
        return 1.0
    step, way, rise = NEAR_FIRST, 0.0, sun[2] / across
    for _ in range(NEAR_STEPS):
        way += step
        step *= NEAR_GROWTH
        if height_at(ground, x + way * sun[0] / across, y + way * sun[1] / across) > z + way * rise:
            return 0.0
    return 1.0
