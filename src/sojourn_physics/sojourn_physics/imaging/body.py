"""The machine's own shapes as light meets them: what a camera sees of them, and which ground lies in their shadow.

A ray is met in closed form (Glassner 1989, An Introduction to Ray Tracing, ch. 2). A ball about each shape says which
rays cannot meet it.
"""

import math

from sojourn_machine.kernels import kernel, small_kernel
from sojourn_machine.params import FloatArray
from sojourn_machine.shapes import BOX, CYLINDER, HALF_X, HALF_Y, HALF_Z, KIND, ROUND, Shapes


@small_kernel
def near_ray(body: Shapes, shape: int, origin: FloatArray, ray: tuple[float, float, float]) -> bool:
    """Whether a ray passes through the ball about a shape."""
    dx = body.places[shape, 0] - origin[0]
    dy = body.places[shape, 1] - origin[1]
    dz = body.places[shape, 2] - origin[2]
    along = dx * ray[0] + dy * ray[1] + dz * ray[2]
    square = dx * dx + dy * dy + dz * dz
    radius = body.sizes[shape, ROUND]
    return bool((square - along * along if along > 0.0 else square) <= radius * radius)


@kernel
def meet_shape(
    body: Shapes, shape: int, origin: FloatArray, ray: tuple[float, float, float]
) -> tuple[float, float, float, float]:
    """Distance along a unit ray in map to where it enters a shape, infinite where it does not or begins inside, and the
    normal there in map.
    """
    turn = body.turns[shape]
    px, py, pz = (
        origin[0] - body.places[shape, 0],
        origin[1] - body.places[shape, 1],
        origin[2] - body.places[shape, 2],
    )
    x = turn[0, 0] * px + turn[0, 1] * py + turn[0, 2] * pz
    y = turn[1, 0] * px + turn[1, 1] * py + turn[1, 2] * pz
    z = turn[2, 0] * px + turn[2, 1] * py + turn[2, 2] * pz
    dx = turn[0, 0] * ray[0] + turn[0, 1] * ray[1] + turn[0, 2] * ray[2]
    dy = turn[1, 0] * ray[0] + turn[1, 1] * ray[1] + turn[1, 2] * ray[2]
    dz = turn[2, 0] * ray[0] + turn[2, 1] * ray[1] + turn[2, 2] * ray[2]
    size = body.sizes[shape]
    found = math.inf
    nx, ny, nz = 0.0, 0.0, 0.0
    if size[KIND] == BOX:
        found, nx, ny, nz = _meet_box((x, y, z), (dx, dy, dz), (size[HALF_X], size[HALF_Y], size[HALF_Z]))
    elif size[KIND] == CYLINDER:
        found, nx, ny, nz = _meet_cylinder((x, y, z), (dx, dy, dz), size[HALF_X], size[HALF_Z])
    else:
        found, nx, ny, nz = _meet_ball((x, y, z), (dx, dy, dz), size[HALF_X])
    return (
        found,
        turn[0, 0] * nx + turn[1, 0] * ny + turn[2, 0] * nz,
        turn[0, 1] * nx + turn[1, 1] * ny + turn[2, 1] * nz,
        turn[0, 2] * nx + turn[1, 2] * ny + turn[2, 2] * nz,
    )


@small_kernel
def _meet_box(
    p: tuple[float, float, float], d: tuple[float, float, float], half: tuple[float, float, float]
) -> tuple[float, float, float, float]:
    enter, leave, axis = -math.inf, math.inf, 0
    for k in range(3):
        if abs(d[k]) < 1e-12:
            if abs(p[k]) > half[k]:
                return math.inf, 0.0, 0.0, 0.0
            continue
        a, b = (-half[k] - p[k]) / d[k], (half[k] - p[k]) / d[k]
        if min(a, b) > enter:
            enter, axis = min(a, b), k
        leave = min(leave, max(a, b))
    if enter > leave or enter <= 0.0:
        return math.inf, 0.0, 0.0, 0.0
    sign = -1.0 if d[axis] > 0.0 else 1.0
    return enter, sign if axis == 0 else 0.0, sign if axis == 1 else 0.0, sign if axis == 2 else 0.0


@small_kernel
def _meet_cylinder(
    p: tuple[float, float, float], d: tuple[float, float, float], radius: float, half: float
) -> tuple[float, float, float, float]:
    """About z."""
    a = d[0] * d[0] + d[1] * d[1]
    b = p[0] * d[0] + p[1] * d[1]
    c = p[0] * p[0] + p[1] * p[1] - radius * radius
    if a > 1e-14:
        inside = b * b - a * c
        if inside >= 0.0:
            at = (-b - math.sqrt(inside)) / a
            z = p[2] + at * d[2]
            if at > 0.0 and abs(z) <= half:
                return at, (p[0] + at * d[0]) / radius, (p[1] + at * d[1]) / radius, 0.0
    if abs(d[2]) > 1e-14:
        side = -1.0 if d[2] > 0.0 else 1.0
        at = (side * half - p[2]) / d[2]
        x, y = p[0] + at * d[0], p[1] + at * d[1]
        if at > 0.0 and x * x + y * y <= radius * radius:
            return at, 0.0, 0.0, side
    return math.inf, 0.0, 0.0, 0.0


@small_kernel
def _meet_ball(
    p: tuple[float, float, float], d: tuple[float, float, float], radius: float
) -> tuple[float, float, float, float]:
    b = p[0] * d[0] + p[1] * d[1] + p[2] * d[2]
    inside = b * b - (p[0] * p[0] + p[1] * p[1] + p[2] * p[2] - radius * radius)
    at = -b - math.sqrt(max(inside, 0.0))
    if inside < 0.0 or at <= 0.0:
        return math.inf, 0.0, 0.0, 0.0
    return at, (p[0] + at * d[0]) / radius, (p[1] + at * d[1]) / radius, (p[2] + at * d[2]) / radius


@small_kernel
def hides_sun(body: Shapes, sun: FloatArray, x: float, y: float, z: float, point: FloatArray) -> bool:
    """Whether a shape stands between a point in map and the Sun. `point`: working room, shape (3,)."""
    dx, dy, dz = body.around[0] - x, body.around[1] - y, body.around[2] - z
    along = dx * sun[0] + dy * sun[1] + dz * sun[2]
    radius = body.around[3]
    if along < -radius or dx * dx + dy * dy + dz * dz - along * along > radius * radius:
        return False
    point[0], point[1], point[2] = x, y, z
    ray = (sun[0], sun[1], sun[2])
    for shape in range(body.sizes.shape[0]):
        if near_ray(body, shape, point, ray):
            found, _, _, _ = meet_shape(body, shape, point, ray)
            if found < math.inf:
                return True
    return False
