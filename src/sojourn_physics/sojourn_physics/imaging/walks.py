"""Walks along the ground around an eye: how far the line of sight has risen, see `panorama`.

A walk goes by strides of half a node, or of a whole one where half a node is less than a bin of azimuth, off the map by
strides that grow with the way. It writes of each bin of rise at which way over ground the line of sight first comes so
high: on the straight line between the two ends of its stride. It goes part by part, and does one thing to all places of
a part before the next, so that the processor takes several at once: heights, how many bins there are below each place,
in which stride each bin is reached, and where in that.

Azimuth is counted in quarters by p = y/(|x| + |y|), which needs no arc tangent.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sojourn_machine.kernels import kernel, small_kernel, vector_kernel
from sojourn_machine.params import FloatArray
from sojourn_physics.imaging.ground import UNIT, DrawnGround, height_at, is_untouched, stride_at
from sojourn_physics.imaging.nodes import Nodes, heights_between, nodes_for
from sojourn_physics.imaging.single import FOUR, NEVER, ONE, TWO, ZERO, narrowed

RISE = 0.5
"""Height of a bin, of its width [-]: a walk costs no more for it, and a ray has less to search."""
CHUNK = 64
"""Places that are looked up together."""
BEYOND = 16
"""Of them off the map."""
CLEAR_OF_EDGE = 1.01
"""Nodes by which a walk begins off the far edge at least: along it no place may be taken for one beyond it."""
AT_ONCE = 8
"""Bins that are written at once."""
Line = NDArray[np.float32]
Course = tuple[float, float, float, float]
"""Of a walk: from where, counted in nodes, and the unit vector over ground."""


class Eye(NamedTuple):
    """From where, and how far."""

    place: FloatArray
    """In map, shape (3,) [m]."""
    reach: float
    """The farthest ground that is looked for, over ground [m]."""
    fall: float
    """By which the ground falls away under the level, 1/2R, for the square of the way [1/m]."""


class WalkPart(NamedTuple):
    """Of a walk: room for CHUNK places after the one before."""

    far: Line
    """Way from the eye over ground, (CHUNK + 1,) [m]."""
    high: Line
    """Height over the eye's level, (CHUNK + 1,) [m]."""
    nodes: Nodes
    """Of those on the map."""
    below: NDArray[np.int32]
    """How many bins there are up to the line of sight to a place, (CHUNK + 1,)."""
    stride: NDArray[np.int32]
    """Of each bin in which stride of the part it is reached, (bins + 1 + AT_ONCE,)."""


class Panorama(NamedTuple):
    """Walks along the ground around an eye."""

    way: np.ndarray
    """float32, (azimuths + 1, bins + 1): way over ground to where a bin is reached, infinite where it never is [m]."""
    done: np.ndarray
    """bool, (azimuths + 1,): which walks have been made."""
    rises: Line
    """(bins + 1,): rise of the bins' lower edges for each metre over ground."""
    lowest: float
    """Rise of the lowest bin for each metre of the ray's own length."""
    bin: float
    """Height of a bin, in the same."""
    part: WalkPart


class WalkRoom:
    """Memory for one panorama after another: new memory comes from the system page by page, which takes a tenth of the
    time of an image.
    """

    def __init__(self) -> None:
        self._numbers = np.empty(0, dtype=np.float32)

    def of(self, rows: int, columns: int) -> np.ndarray:
        """Of this shape, with what was in it; it is that of the last time as well."""
        if self._numbers.size < rows * columns:
            self._numbers = np.empty(rows * columns, dtype=np.float32)
        return self._numbers[: rows * columns].reshape(rows, columns)


def panorama(resolution: float, lowest: float, highest: float, ways: WalkRoom) -> Panorama:
    """An empty one.

    Args:
        resolution: angle of its bins [rad]. lowest, highest: least and greatest rise of the rays that will be asked
            for, for each metre of their length, -1 to 1. ways: where it is made; one made there before ends.
    """
    azimuths = 4 * math.ceil(0.5 * math.pi / resolution)
    lowest, highest = max(lowest - resolution, -1.0), min(highest + resolution, 1.0)
    height = RISE * resolution
    bins = max(math.ceil((highest - lowest) / height), 1)
    edges = np.clip(lowest + height * np.arange(bins + 1), -1.0 + 1e-9, 1.0 - 1e-9)
    way = ways.of(azimuths + 1, bins + 1)
    done = np.zeros(azimuths + 1, dtype=np.bool_)
    rises = (edges / np.sqrt(1.0 - edges**2)).astype(np.float32)
    part = WalkPart(
        np.empty(CHUNK + 1, dtype=np.float32),
        np.empty(CHUNK + 1, dtype=np.float32),
        nodes_for(CHUNK),
        np.empty(CHUNK + 1, dtype=np.int32),
        np.empty(bins + 1 + AT_ONCE, dtype=np.int32),
    )
    return Panorama(way, done, rises, lowest, height, part)


@vector_kernel
def azimuth_of(x: float, y: float) -> float:
    """Of a direction, from 0 to 4, a quarter each."""
    length = abs(x) + abs(y)
    part = y / length if length > ZERO else ZERO * y  # in its precision
    if x >= ZERO:
        return part if y >= ZERO else FOUR + part
    return TWO - part


@kernel
def direction_of(azimuth: float) -> tuple[float, float]:
    """Unit vector over ground of an azimuth: the inverse of `azimuth_of`."""
    part = azimuth - 4.0 if azimuth > 3.0 else (2.0 - azimuth if azimuth > 1.0 else azimuth)
    x, y = 1.0 - abs(part), part
    if 1.0 < azimuth <= 3.0:
        x = -x
    length = math.sqrt(x * x + y * y)
    return x / length, y / length


@small_kernel
def height_over(ground: DrawnGround, eye: Eye, x: float, y: float, way: float) -> float:
    """Of the ground over the eye's level, `way` from it over ground [m]."""
    return float(height_at(ground, x, y) - eye.place[2] - way * way * eye.fall)


@kernel
def walk(ground: DrawnGround, eye: Eye, around: Panorama, place: int) -> None:
    """Walk along one azimuth and write where each bin is reached."""
    ways, rises, part = around.way[place], around.rises, around.part
    count = ways.shape[0]
    for i in range(count):
        ways[i] = NEVER
    around.done[place] = True
    ahead_x, ahead_y = direction_of(4.0 * place / (around.way.shape[0] - 1))
    x0, y0, top, reach = eye.place[0], eye.place[1], ground.place[4] - eye.place[2], narrowed(eye.reach)
    low = height_over(ground, eye, x0, y0, 0.0)
    if low >= 0.0:  # under the ground
        return
    part.far[0], part.high[0] = ZERO, low
    stride, resolution = 0.5 * ground.place[3], around.bin / RISE
    course = ((x0 - ground.place[0]) * ground.place[2], (y0 - ground.place[1]) * ground.place[2], ahead_x, ahead_y)
    inside = _strides_inside(ground, course)
    step, following, near = 1, 0, ZERO
    while near < reach and following < count:
        if rises[following] >= ZERO and top < rises[following] * near:  # nothing is so high
            break
        pace = 2 if stride < near * resolution else 1
        strides = min((inside - step + pace - 1) // pace, CHUNK)
        if strides > 0:
            _look_along(ground, eye, part, course, (step, pace, strides))
            step += pace * strides
        else:
            strides = BEYOND if inside > 0 else 1  # who has left the map does not come back
            _look_beyond(ground, eye, part, course, strides)
        _count_below(around, strides)
        reached = _climb(part, strides, following)
        _write_ways(around, ways, following, reached)
        following, near = reached, part.far[strides]
        part.far[0], part.high[0] = near, part.high[strides]


@small_kernel
def _look_along(ground: DrawnGround, eye: Eye, part: WalkPart, course: Course, steps: tuple[int, int, int]) -> None:
    """Write the ways and heights of places along a course, on the map.

    Args:
        steps: half nodes to the first place, and from one to the next; how many places.
    """
    _, _, ahead_x, ahead_y = course
    step, pace, count = steps
    half, x0, y0 = 0.5 * ground.place[3], eye.place[0], eye.place[1]
    first, last = step * half, (step + pace * (count - 1)) * half
    here, there = (x0 + first * ahead_x, y0 + first * ahead_y), (x0 + last * ahead_x, y0 + last * ahead_y)
    if is_untouched(ground.changes, here, there):  # as `height_at` has it, without asking whether there is a map
        _nodes_along(course, (narrowed(step), narrowed(pace)), part.nodes)
        heights_between(ground, part.nodes, part.high[1 : count + 1])
        _over_level(eye, part, (narrowed(first), narrowed(pace * half)), count)
    else:
        for k in range(count):
            far = (step + pace * k) * half
            part.far[k + 1] = far
            part.high[k + 1] = height_over(ground, eye, x0 + far * ahead_x, y0 + far * ahead_y, far)


@vector_kernel
def _nodes_along(course: Course, steps: tuple[float, float], nodes: Nodes) -> None:
    """Write between which nodes places along a course are, in single precision, all of CHUNK; steps: half nodes."""
    from_x, from_y = narrowed(course[0]), narrowed(course[1])
    half_x, half_y = narrowed(0.5 * course[2]), narrowed(0.5 * course[3])
    step, pace = steps
    for k in range(CHUNK):
        halves = step + pace * np.float32(np.int32(k))
        x, y = from_x + halves * half_x, from_y + halves * half_y
        left, lower = np.int32(x), np.int32(y)
        nodes.column[k], nodes.row[k] = left, lower
        nodes.right[k], nodes.up[k] = x - np.float32(left), y - np.float32(lower)


@vector_kernel
def _over_level(eye: Eye, part: WalkPart, steps: tuple[float, float], count: int) -> None:
    """Write the ways of places, and of their heights how far they are over the eye's level.

    Args:
        steps: way to the first place, and from one to the next [m].
    """
    first, step = steps
    level, fall = narrowed(eye.place[2]), narrowed(eye.fall)
    for k in range(count):
        far = first + np.float32(np.int32(k)) * step
        part.far[k + 1] = far
        part.high[k + 1] -= level + far * far * fall


@small_kernel
def _look_beyond(ground: DrawnGround, eye: Eye, part: WalkPart, course: Course, count: int) -> None:
    """Write the ways and heights of the next places along a course, off the map, where strides grow with the way."""
    _, _, ahead_x, ahead_y = course
    x0, y0, far = eye.place[0], eye.place[1], np.float64(part.far[0])
    for k in range(1, count + 1):
        far = min(far + stride_at(ground, x0 + far * ahead_x, y0 + far * ahead_y, far), eye.reach)
        part.far[k] = far
    for k in range(1, count + 1):
        far = np.float64(part.far[k])
        part.high[k] = height_over(ground, eye, x0 + far * ahead_x, y0 + far * ahead_y, far)


@vector_kernel
def _count_below(around: Panorama, strides: int) -> None:
    """Write how many bins there are up to the line of sight to each place."""
    part, last = around.part, narrowed(around.way.shape[1])
    lowest, bins = narrowed(around.lowest), narrowed(1.0 / around.bin)
    for k in range(1, strides + 1):
        far, high = part.far[k], part.high[k]
        rise = high / math.sqrt(far * far + high * high)
        part.below[k] = np.int32(min(max(np.floor((rise - lowest) * bins) + ONE, ZERO), last))


@small_kernel
def _climb(part: WalkPart, strides: int, following: int) -> int:
    """Write of each bin that is reached on the way along places in which stride it is; the first that is not.

    Args:
        strides: of the part. following: the first bin that has not been reached before.
    """
    stride, below = part.stride, part.below
    for k in range(1, strides + 1):
        for i in range(AT_ONCE):  # more than are reached mostly, without a branch; the next stride writes over them
            stride[following + i] = k
        for i in range(following + AT_ONCE, below[k]):
            stride[i] = k
        following = max(following, below[k])
    return following


@vector_kernel
def _write_ways(around: Panorama, ways: Line, begin: int, end: int) -> None:
    """Write at which way bins from one to before another are reached."""
    part, rises = around.part, around.rises
    for i in range(np.uint64(begin), np.uint64(end)):
        k, rise = np.uint64(part.stride[i]), rises[i]
        near, low, far, high = part.far[k - UNIT], part.high[k - UNIT], part.far[k], part.high[k]
        above = max(rise * near - low, ZERO)  # of the ray over the ground
        passed = above / max(above + high - rise * far, above)
        ways[i] = near + passed * (far - near) if above > ZERO else near


@small_kernel
def _strides_inside(ground: DrawnGround, course: Course) -> int:
    """How many strides of half a node of a course stay on the map."""
    rows, columns = ground.heights.shape
    column, row, ahead_x, ahead_y = course
    far = 0.0
    if 0.0 <= column <= columns - CLEAR_OF_EDGE and 0.0 <= row <= rows - CLEAR_OF_EDGE:
        far = 2.0 * (rows + columns)
        if ahead_x > 1e-9:
            far = min(far, (columns - 1 - column) / ahead_x)
        elif ahead_x < -1e-9:
            far = min(far, -column / ahead_x)
        if ahead_y > 1e-9:
            far = min(far, (rows - 1 - row) / ahead_y)
        elif ahead_y < -1e-9:
            far = min(far, -row / ahead_y)
    return int(2.0 * far) - 1
