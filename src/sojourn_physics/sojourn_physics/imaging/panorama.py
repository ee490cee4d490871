"""Where rays from one eye meet the ground, many at a time.

All rays of one azimuth run over the same profile h(s) of the ground, s the way over it from the eye at height z_0: the
ray that rises by t for each metre meets it first where the line of sight has risen so far,

    M(s) = max over s' <= s of (h(s') - z_0)/s' >= t

M never falls, so one walk along the profile answers every ray of its azimuth (line of sight by a running maximum:
Blelloch 1990, Prefix Sums and Their Applications, CMU-CS-90-190). A `Panorama` keeps these walks by azimuth, made when
a ray first asks for one (`walks`): for each bin of the ray's rise per metre of its own length the way s at which it is
reached. A ray finds its bracket in the two walks beside it. Where that is short, and off the map, where the ground is
smooth, the ground in it is a straight line; elsewhere, and where that line is steep and not on the ground, its own
crossing is found by steps of half a node and regula falsi (Illinois): beside a wall of one cell lies level ground,
which returns nothing. A shape narrower than a bin of azimuth, about a pixel, may be missed.

The ground of a round body falls away by s²/2R under the level. Nothing is seen from below the ground.
"""

import math

import numpy as np

from sojourn_machine.kernels import kernel, njit, small_kernel, vector_kernel
from sojourn_machine.params import FloatArray
from sojourn_physics.imaging.ground import UNIT, DrawnGround, stride_at
from sojourn_physics.imaging.single import NEVER, ZERO, constant, narrowed
from sojourn_physics.imaging.walks import Eye, Panorama, azimuth_of, height_over, walk

ILLINOIS = 6
"""Steps of regula falsi at most."""
CLOSE = 1e-4
"""A ray so near to the ground has met it, by height [m]."""
SMOOTH, SMOOTH_PART = 0.5, constant(0.01)
"""Where walks beside a ray meet the ground within so much of a node, and of the way, it is smooth between them [-]."""
SMOOTH_OFF = constant(0.05)
"""The same off the map, of the way [-]."""
STEEP, ON_GROUND = constant(0.4), 1e-3
"""Where ground rises or falls so much along a ray [-], a straight line so far from it is not taken for it [m]."""
ACROSS, AZIMUTH, HEIGHT, BEGIN, END, NEAR_LEFT, NEAR_RIGHT, FAR_LEFT, FAR_RIGHT, LOW, HIGH, STEEP_AT = range(12)
"""Rows of the room to work in: see `_bearings`, `_look_up` and `_brackets`."""
ROOM = 12
PLUMB, ALONG = 1e-7, constant(1e-9)
"""Way over ground of a ray that is plumb, for each metre, and the slope of ground over that of a ray along it [-]."""
UNKNOWN = constant(-1.0)
"""Instead of a distance."""
MARGIN = 0.25
"""Of a stride, on both sides of what two walks say [-]."""


@kernel
def meet_ground(
    ground: DrawnGround, eye: Eye, around: Panorama, rays: FloatArray, distance: np.ndarray, room: FloatArray
) -> None:
    """Write the distance from the eye to the ground along each ray, infinite where there is none [m].

    Each step does one thing for all rays, so that the processor has the memory of several under way at once.

    Args:
        rays: unit vectors in map, (3, n). distance: (n,). room: to work in, (ROOM, n).
    """
    _bearings(around, rays, room)
    last = around.way.shape[0] - 1
    for i in range(distance.shape[0]):
        left = min(int(room[AZIMUTH, i]), last - 1)
        if not around.done[left]:
            walk(ground, eye, around, left)
        if not around.done[left + 1]:
            walk(ground, eye, around, left + 1)
    _look_up(around, room)
    _brackets(ground, eye, around, rays, distance, room)
    for i in range(distance.shape[0]):
        across = np.float64(room[ACROSS, i])
        if across < PLUMB:
            distance[i] = -height_over(ground, eye, eye.place[0], eye.place[1], 0.0) if rays[2, i] < 0.0 else math.inf
        elif distance[i] < 0.0:
            ray = (rays[0, i] / across, rays[1, i] / across, rays[2, i] / across)
            way = np.float64(room[STEEP_AT, i])
            if way < 0.0 or abs(_over(ground, eye, ray, way)) > ON_GROUND:
                way = _crossing(ground, eye, ray, np.float64(room[BEGIN, i]), min(np.float64(room[END, i]), eye.reach))
            distance[i] = way / across


@vector_kernel
def _bearings(around: Panorama, rays: FloatArray, room: FloatArray) -> None:
    """Of rays: azimuth and height in bins, way over ground for each metre."""
    azimuths, lowest = narrowed(0.25 * (around.way.shape[0] - 1)), narrowed(around.lowest)
    bins = narrowed(1.0 / around.bin)
    for i in range(rays.shape[1]):
        x, y = rays[0, i], rays[1, i]
        room[ACROSS, i] = math.sqrt(x * x + y * y)
        room[AZIMUTH, i] = azimuth_of(x, y) * azimuths
        room[HEIGHT, i] = (rays[2, i] - lowest) * bins


@small_kernel
def _look_up(around: Panorama, room: FloatArray) -> None:
    """Write what the walks beside each ray say of its bin: ways to its lower and its upper edge, and their rises."""
    ways, rises = around.way, around.rises
    last, bins = ways.shape[0] - 1, ways.shape[1] - 1
    for i in range(room.shape[1]):
        left = np.uint64(min(int(room[AZIMUTH, i]), last - 1))  # without a sign there is nothing to be looked up
        at = np.uint64(min(max(int(room[HEIGHT, i]), 0), bins - 1))  # from the end
        room[NEAR_LEFT, i], room[NEAR_RIGHT, i] = ways[left, at], ways[left + UNIT, at]
        room[FAR_LEFT, i], room[FAR_RIGHT, i] = ways[left, at + UNIT], ways[left + UNIT, at + UNIT]
        room[LOW, i], room[HIGH, i] = rises[at], rises[at + UNIT]


@vector_kernel
def _brackets(
    ground: DrawnGround, eye: Eye, around: Panorama, rays: FloatArray, distance: np.ndarray, room: FloatArray
) -> None:
    """Write the distance of rays where the walks beside them tell it, UNKNOWN where they say no more than between which
    two ways it is, and where ground that is steep was met, if their line fits it.
    """
    last, smooth = narrowed(around.way.shape[0] - 2), narrowed(SMOOTH * ground.place[3])
    west, east = narrowed(ground.bounds[0] - eye.place[0]), narrowed(ground.bounds[1] - eye.place[0])
    south, north = narrowed(ground.bounds[2] - eye.place[1]), narrowed(ground.bounds[3] - eye.place[1])
    for i in range(distance.shape[0]):
        a, b, c, d = room[NEAR_LEFT, i], room[NEAR_RIGHT, i], room[FAR_LEFT, i], room[FAR_RIGHT, i]
        begin, end, across = min(a, b), max(c, d), room[ACROSS, i]
        room[BEGIN, i], room[END, i] = begin, end
        x, y = begin * rays[0, i] / across, begin * rays[1, i] / across
        on = (west <= x) & (x <= east) & (south <= y) & (y <= north)  # as `on_map`, without a branch
        short = smooth + SMOOTH_PART * begin if on else SMOOTH_OFF * begin
        part = room[AZIMUTH, i] - min(np.floor(room[AZIMUTH, i]), last)
        low, high = a + part * (b - a), c + part * (d - c)
        met, slope = _on_line((room[LOW, i], room[HIGH, i]), (low, high), rays[2, i] / across)
        straight, steep = end - begin < short, abs(slope) >= STEEP
        room[STEEP_AT, i] = met if straight & steep else UNKNOWN
        met = UNKNOWN if steep | (not straight) else met / across
        distance[i] = NEVER if begin == NEVER else met


@vector_kernel
def _on_line(rises: tuple[float, float], ways: tuple[float, float], rise: float) -> tuple[float, float]:
    """Where a ray meets the straight ground between the places that two others meet [m], and its slope [-].

    Args:
        rises: of the two for each metre over ground [-]. ways: over ground to their places [m]. rise: of the ray [-].
    """
    low, high = ways
    slope = (rises[1] * high - rises[0] * low) / (high - low)
    met = min(max(low + (rise - rises[0]) * low / (slope - rise), ZERO), high)  # a plumb ray is before the first bin
    return low if (high <= low) | (slope - rise < ALONG) else met, slope  # or along the ground


@small_kernel
def _over(ground: DrawnGround, eye: Eye, ray: tuple[float, float, float], way: float) -> float:
    """How far a ray, see `_crossing`, is over the ground after a way over it [m]."""
    x, y = eye.place[0] + way * ray[0], eye.place[1] + way * ray[1]
    return float(ray[2] * way - height_over(ground, eye, x, y, way))


@small_kernel
def _crossing(ground: DrawnGround, eye: Eye, ray: tuple[float, float, float], begin: float, end: float) -> float:
    """First crossing of a ray near `begin` to `end` over ground [m]; infinite where there is none.

    Args:
        ray: direction over ground, and rise for each metre of it.
    """
    ahead_x, ahead_y, rise = ray
    x0, y0 = eye.place[0], eye.place[1]
    stride = stride_at(ground, x0 + begin * ahead_x, y0 + begin * ahead_y, begin)
    near = max(begin - MARGIN * stride, 0.0)
    over = _over(ground, eye, ray, near)
    while over <= 0.0 and near > 0.0:  # between two walks the ground may stand higher than on both
        near = max(near - stride, 0.0)
        over = _over(ground, eye, ray, near)
    if over <= 0.0:
        return 0.0
    far, limit = min(end + MARGIN * stride, near + stride), end + 4.0 * stride
    top = ground.place[4] - eye.place[2]
    while True:
        beyond = _over(ground, eye, ray, far)
        if beyond <= 0.0:
            return float(_between(ground, eye, ray, (near, far), (over, beyond)))
        if far > limit or (rise * far > top and rise >= 0.0):
            return far if far > limit and end < eye.reach else math.inf
        near, over = far, beyond
        far = near + stride_at(ground, x0 + near * ahead_x, y0 + near * ahead_y, near)


@small_kernel
def _between(
    ground: DrawnGround,
    eye: Eye,
    ray: tuple[float, float, float],
    ways: tuple[float, float],
    overs: tuple[float, float],
) -> float:
    """The crossing between two ways: how far the ray is over the ground at them, more than 0 and not."""
    near, far = ways
    over, beyond = overs
    middle = near + (far - near) * over / (over - beyond)
    for _ in range(ILLINOIS):
        here = _over(ground, eye, ray, middle)
        if abs(here) < CLOSE:
            break
        if here > 0.0:
            near, over = middle, here
            beyond *= 0.5
        else:
            far, beyond = middle, here
            over *= 0.5
        middle = near + (far - near) * over / (over - beyond)
    return middle


@njit(cache=True)
def meetings(ground: DrawnGround, eye: Eye, around: Panorama, directions: FloatArray) -> FloatArray:
    """Distance from the eye along each ray to the ground, shape (n,), infinite where there is none [m].

    Args:
        directions: unit vectors in map, shape (n, 3).
    """
    found = np.empty(directions.shape[0])
    rays = np.ascontiguousarray(directions.T).astype(np.float32)
    meet_ground(ground, eye, around, rays, found, np.empty((ROOM, found.shape[0]), dtype=np.float32))
    return found
