"""Which of the machine's shapes a bundle of rays from one eye may meet, and the first that a ray meets.

Rays are taken by bundles of neighbours within a cone of half angle α: of the shapes those are near whose ball, of
radius R at the distance d, is within it, angle(shape, axis) <= α + asin(R/d). With cosines and sines alone:
cos(angle) >= cos α cos(asin R/d) - sin α R/d.
"""

import math

import numpy as np
from numpy.typing import NDArray

from sojourn_machine.kernels import kernel, njit, small_kernel
from sojourn_machine.params import FloatArray
from sojourn_machine.shapes import HALF_X, ROUND, Shapes
from sojourn_physics.imaging.body import meet_shape, near_ray

BUNDLE = 16
"""Rays of a bundle, where they are in a row."""
BEARING = 5
"""Columns of bearings: unit vector to a shape, cosine and sine of the half angle of its ball."""
ALWAYS = -2.0
"""Instead of a cosine, for a shape whose ball the eye is in."""
ROUNDING = 1e-6
NONE = -1

Vector = tuple[float, float, float]


@kernel
def bearings_of(body: Shapes, place: FloatArray, bearings: FloatArray) -> None:
    """Write where each shape is as seen from a place, (shapes, BEARING)."""
    for shape in range(bearings.shape[0]):
        x, y, z = (
            body.places[shape, 0] - place[0],
            body.places[shape, 1] - place[1],
            body.places[shape, 2] - place[2],
        )
        apart, radius = math.sqrt(x * x + y * y + z * z), body.sizes[shape, ROUND]
        if apart > radius:
            sine = radius / apart
            cosine, ahead = math.sqrt(1.0 - sine * sine), (x / apart, y / apart, z / apart)
        else:
            cosine, sine, ahead = _half_space(body, shape, place)
        bearings[shape, 0], bearings[shape, 1], bearings[shape, 2] = ahead
        bearings[shape, 3], bearings[shape, 4] = cosine, sine


@small_kernel
def _half_space(body: Shapes, shape: int, place: FloatArray) -> tuple[float, float, Vector]:
    """Of a shape in whose ball the eye is: of one that lies behind one of its faces all of it is in a half space."""
    turn, size = body.turns[shape], body.sizes[shape]
    x, y, z = (
        place[0] - body.places[shape, 0],
        place[1] - body.places[shape, 1],
        place[2] - body.places[shape, 2],
    )
    for axis in range(3):
        along = turn[axis, 0] * x + turn[axis, 1] * y + turn[axis, 2] * z
        if abs(along) >= size[HALF_X + axis] - ROUNDING:
            side = -1.0 if along > 0.0 else 1.0
            return 0.0, 1.0, (side * turn[axis, 0], side * turn[axis, 1], side * turn[axis, 2])
    return ALWAYS, 0.0, (0.0, 0.0, 0.0)


@kernel
def shapes_in_cone(bearings: FloatArray, axis: Vector, cosine: float, near: NDArray[np.int64]) -> int:
    """How many shapes may be met within a cone about a unit vector; `near` is filled with their numbers.

    Args:
        bearings: see there, in the frame of the axis. cosine: of the cone's half angle.
    """
    sine = math.sqrt(max(1.0 - cosine * cosine, 0.0)) + ROUNDING
    count = 0
    for shape in range(bearings.shape[0]):
        bearing = bearings[shape]
        seen = bearing[3] == ALWAYS or cosine <= 0.0
        if not seen:
            towards = axis[0] * bearing[0] + axis[1] * bearing[1] + axis[2] * bearing[2]
            seen = towards >= cosine * bearing[3] - sine * bearing[4] - ROUNDING
        if seen:
            near[count] = shape
            count += 1
    return count


@kernel
def shapes_near(bearings: FloatArray, rays: FloatArray, near: NDArray[np.int64]) -> int:
    """The same for rays, unit vectors, (n, 3)."""
    middle = rays[rays.shape[0] // 2]
    cosine = 1.0
    for i in range(rays.shape[0]):
        cosine = min(cosine, middle[0] * rays[i, 0] + middle[1] * rays[i, 1] + middle[2] * rays[i, 2])
    return int(shapes_in_cone(bearings, (middle[0], middle[1], middle[2]), cosine, near))


@small_kernel
def first_shape(
    body: Shapes, shapes: NDArray[np.int64], place: FloatArray, ray: Vector, reach: float
) -> tuple[int, float, Vector]:
    """The first of some shapes that a ray meets before `reach` [m], NONE for none, the distance to it and the normal
    there.
    """
    nearest, found, normal = reach, NONE, (0.0, 0.0, 0.0)
    for k in range(shapes.shape[0]):
        shape = shapes[k]
        if near_ray(body, shape, place, ray):
            at, x, y, z = meet_shape(body, shape, place, ray)
            if at < nearest:
                nearest, found, normal = at, shape, (x, y, z)
    return found, nearest, normal


@njit(cache=True)
def shorten(body: Shapes, place: FloatArray, rays: FloatArray, ranges: FloatArray) -> None:
    """End each ray where it meets a shape, if that is nearer than where it ends.

    Args:
        place: from where, (3,) [m]. rays: unit vectors, neighbours beside each other, (n, 3). ranges: written to,
            (n,) [m].
    """
    bearings = np.empty((body.sizes.shape[0], BEARING))
    near = np.empty(bearings.shape[0], dtype=np.int64)
    bearings_of(body, place, bearings)
    for begin in range(0, rays.shape[0], BUNDLE):
        end = min(begin + BUNDLE, rays.shape[0])
        shapes = near[: shapes_near(bearings, rays[begin:end], near)]
        for i in range(begin, end):
            _, ranges[i], _ = first_shape(body, shapes, place, (rays[i, 0], rays[i, 1], rays[i, 2]), ranges[i])
