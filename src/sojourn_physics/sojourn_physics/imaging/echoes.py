"""Where beams end, on the ground or the machine, and how much of their light is returned there.

The beams are taken by blocks of neighbours, for each of which it is found out which of the machine's shapes may be in
it: those whose ball is within the block's own angle α of its middle, angle(shape, middle) <= α + asin(R/d).
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sojourn_machine.kernels import kernel, njit, small_kernel
from sojourn_machine.params import FloatArray
from sojourn_physics.imaging.body import ALBEDO, ROUND, Shapes, meet_shape, near_ray
from sojourn_physics.imaging.ground import DrawnGround, slope_at
from sojourn_physics.imaging.panorama import Eye, Panorama, first_meeting, height_over
from sojourn_physics.imaging.render import Soils
from sojourn_physics.terrain.height_field import sample_soil

BLOCK = 16
"""Beams of a block."""
ALWAYS = -2.0
"""Instead of a cosine, for a shape whose ball the eye is in."""

Vector = tuple[float, float, float]


class Sounded(NamedTuple):
    """What beams meet, for the kernel."""

    ground: DrawnGround
    soils: Soils
    albedo: float
    """Of the soil that is everywhere [-]."""
    body: Shapes


@njit(cache=True)
def echoes(scene: Sounded, rays: FloatArray, eye: Eye, around: Panorama) -> tuple[FloatArray, FloatArray]:
    """Distance to what each ray meets, infinite for nothing [m], and what that returns, ρ cos i [-], each (n,).

    Args:
        rays: unit vectors in map, (n, 3).
    """
    count = rays.shape[0]
    distance, returned = np.empty(count), np.zeros(count)
    bearings = np.empty((scene.body.sizes.shape[0], 5))
    near = np.empty(bearings.shape[0], dtype=np.int64)
    _bearings(scene.body, eye.place, bearings)
    for begin in range(0, count, BLOCK):
        end = min(begin + BLOCK, count)
        shapes = near[: _shapes_near(bearings, rays[begin:end], near)]
        for i in range(begin, end):
            ray = (rays[i, 0], rays[i, 1], rays[i, 2])
            reach = _ground_ahead(scene.ground, eye, around, ray)
            nearest, back = _body_echo(scene.body, shapes, eye.place, ray, reach)
            if nearest < reach:
                distance[i], returned[i] = nearest, back
            else:
                distance[i] = reach
                if reach < math.inf:
                    returned[i] = _ground_echo(scene, eye.place, ray, reach)
    return distance, returned


@kernel
def _bearings(body: Shapes, place: FloatArray, bearings: FloatArray) -> None:
    """Write where each shape is: unit vector to it, cosine and sine of the half angle of its ball, (shapes, 5)."""
    for shape in range(bearings.shape[0]):
        x, y, z = (
            body.places[shape, 0] - place[0],
            body.places[shape, 1] - place[1],
            body.places[shape, 2] - place[2],
        )
        apart, radius = math.sqrt(x * x + y * y + z * z), body.sizes[shape, ROUND]
        bearings[shape, 3], bearings[shape, 4] = ALWAYS, 0.0
        if apart > radius:
            bearings[shape, 0], bearings[shape, 1], bearings[shape, 2] = x / apart, y / apart, z / apart
            sine = radius / apart
            bearings[shape, 3], bearings[shape, 4] = math.sqrt(1.0 - sine * sine), sine


@kernel
def _shapes_near(bearings: FloatArray, rays: FloatArray, near: NDArray[np.int64]) -> int:
    """How many shapes may be met by a block of rays; `near` is filled with their numbers."""
    middle = rays[rays.shape[0] // 2]
    cosine = 1.0
    for i in range(rays.shape[0]):
        cosine = min(cosine, middle[0] * rays[i, 0] + middle[1] * rays[i, 1] + middle[2] * rays[i, 2])
    sine = math.sqrt(max(1.0 - cosine * cosine, 0.0)) + 1e-6  # rounding
    count = 0
    for shape in range(bearings.shape[0]):
        bearing = bearings[shape]
        seen = bearing[3] == ALWAYS or cosine <= 0.0
        if not seen:
            towards = middle[0] * bearing[0] + middle[1] * bearing[1] + middle[2] * bearing[2]
            seen = towards >= cosine * bearing[3] - sine * bearing[4] - 1e-6
        if seen:
            near[count] = shape
            count += 1
    return count


@small_kernel
def _ground_ahead(ground: DrawnGround, eye: Eye, around: Panorama, ray: Vector) -> float:
    """Distance to the ground along a ray, infinite for none [m]."""
    way = first_meeting(ground, eye, around, ray[0], ray[1], ray[2])
    across = math.sqrt(ray[0] * ray[0] + ray[1] * ray[1])
    if across < 1e-7 and way == 0.0:
        return float(-height_over(ground, eye, eye.place[0], eye.place[1], 0.0))
    return way / across if way < math.inf else math.inf


@small_kernel
def _body_echo(
    body: Shapes, shapes: NDArray[np.int64], place: FloatArray, ray: Vector, reach: float
) -> tuple[float, float]:
    nearest, back = reach, 0.0
    for k in range(shapes.shape[0]):
        shape = shapes[k]
        if near_ray(body, shape, place, ray):
            at, x, y, z = meet_shape(body, shape, place, ray)
            if at < nearest:
                nearest = at
                back = body.sizes[shape, ALBEDO] * max(-(x * ray[0] + y * ray[1] + z * ray[2]), 0.0)
    return nearest, back


@small_kernel
def _ground_echo(scene: Sounded, place: FloatArray, ray: Vector, reach: float) -> float:
    x, y = place[0] + reach * ray[0], place[1] + reach * ray[1]
    slope_x, slope_y = slope_at(scene.ground, x, y)
    facing = (slope_x * ray[0] + slope_y * ray[1] - ray[2]) / math.sqrt(1.0 + slope_x * slope_x + slope_y * slope_y)
    soils = scene.soils
    soil = sample_soil(soils.of_node, soils.place[0], soils.place[1], soils.place[2], x, y)
    return float(scene.albedo * soils.brightness[soil] * max(facing, 0.0))
