"""Where beams end, on the ground or the machine, and how much of their light is returned there."""

import math
from typing import NamedTuple

import numpy as np

from sojourn_machine.kernels import njit, small_kernel
from sojourn_machine.params import FloatArray
from sojourn_machine.shapes import ALBEDO, Shapes
from sojourn_physics.imaging.ground import DrawnGround, slope_at
from sojourn_physics.imaging.panorama import ROOM, meet_ground
from sojourn_physics.imaging.shapes_ahead import BEARING, BUNDLE, NONE, bearings_of, first_shape, shapes_near
from sojourn_physics.imaging.soils import Soils, brightness_at
from sojourn_physics.imaging.walks import Eye, Panorama

PART = 256
"""Rays that meet the ground together."""

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
    bearings = np.empty((scene.body.sizes.shape[0], BEARING))
    near = np.empty(bearings.shape[0], dtype=np.int64)
    bearings_of(scene.body, eye.place, bearings)
    _meet_in_parts(scene.ground, eye, around, rays, distance)
    for begin in range(0, count, BUNDLE):
        end = min(begin + BUNDLE, count)
        shapes = near[: shapes_near(bearings, rays[begin:end], near)]
        for i in range(begin, end):
            ray = (rays[i, 0], rays[i, 1], rays[i, 2])
            shape, distance[i], normal = first_shape(scene.body, shapes, eye.place, ray, distance[i])
            if shape != NONE:
                facing = -(normal[0] * ray[0] + normal[1] * ray[1] + normal[2] * ray[2])
                returned[i] = scene.body.sizes[shape, ALBEDO] * max(facing, 0.0)
            elif distance[i] < math.inf:
                returned[i] = _ground_echo(scene, eye.place, ray, distance[i])
    return distance, returned


@njit(cache=True)
def _meet_in_parts(ground: DrawnGround, eye: Eye, around: Panorama, rays: FloatArray, distance: FloatArray) -> None:
    """As `meet_ground`, of rays in a row, (n, 3): so many at a time as stay in near memory."""
    count, room = rays.shape[0], np.empty((ROOM, PART), dtype=np.float32)
    part, found = np.empty((3, PART), dtype=np.float32), np.empty(PART)
    for begin in range(0, count, PART):
        for i in range(PART):
            ray = min(begin + i, count - 1)  # beyond the last ray it once more: all parts are as long
            part[0, i], part[1, i], part[2, i] = rays[ray, 0], rays[ray, 1], rays[ray, 2]
        meet_ground(ground, eye, around, part, found, room)
        for i in range(min(PART, count - begin)):
            distance[begin + i] = found[i]


@small_kernel
def _ground_echo(scene: Sounded, place: FloatArray, ray: Vector, reach: float) -> float:
    x, y = place[0] + reach * ray[0], place[1] + reach * ray[1]
    slope_x, slope_y = slope_at(scene.ground, x, y)
    facing = (slope_x * ray[0] + slope_y * ray[1] - ray[2]) / math.sqrt(1.0 + slope_x * slope_x + slope_y * slope_y)
    return float(scene.albedo * brightness_at(scene.soils, x, y) * max(facing, 0.0))
