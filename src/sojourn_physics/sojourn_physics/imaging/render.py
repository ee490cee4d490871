"""What a camera sees: radiance and distance of each pixel, by one ray through its middle.

Each ray ends on the machine's own shapes (`body`) or on the ground (`panorama`), whichever is nearer, or in the sky.
There the light is that of `photometry`, the Sun's as far as it is not hidden by the ground (`shadows`) or the machine.
The sky under air has the radiance D/π (0.8 + 0.6 (1 - sin elevation)), which gives D on level ground; under no air it
is black. Light that has been scattered more than once, but for what ground sends up, haze, and stars are left out.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sojourn_machine.kernels import kernel, njit, small_kernel
from sojourn_machine.params import FloatArray
from sojourn_physics.imaging.body import ALBEDO, ROUND, Shapes, hides_sun, meet_shape, near_ray
from sojourn_physics.imaging.ground import DrawnGround, is_changed, slope_at
from sojourn_physics.imaging.panorama import Eye, Panorama, first_meeting, height_over
from sojourn_physics.imaging.photometry import Illumination, Look, ambient, reflectance
from sojourn_physics.imaging.shadows import CastShadows, sunlit, sunlit_nearby
from sojourn_physics.imaging.texture import Grain, grain_at
from sojourn_physics.terrain.height_field import SoilArray, sample_soil

BLOCK = 16
"""Pixels along the side of a block for which it is found out which shapes may be in it."""
ZENITH, SLANT = 0.8, 0.6
"""Of the sky's radiance."""

Vector = tuple[float, float, float]


class PlacedLens(NamedTuple):
    """A camera where it is, for the kernels."""

    rays: NDArray[np.float32]
    """Unit vectors of the pixels in the optical frame, (rows, columns, 3)."""
    turn: FloatArray
    """From the optical frame into map, (3, 3)."""
    pixel: float
    """Angle of a pixel [rad]."""


class Soils(NamedTuple):
    """How bright the ground's soils are, for the kernels."""

    of_node: SoilArray
    """See `HeightField.soil_index`."""
    place: FloatArray
    """`HeightField.grid`."""
    brightness: FloatArray
    """Of each soil, of the albedo of the place, (soils,) [-]."""


class Scene(NamedTuple):
    """All that there is to be seen, for the kernels."""

    ground: DrawnGround
    soils: Soils
    look: Look
    grain: Grain
    light: Illumination
    cast: CastShadows
    body: Shapes


@njit(cache=True)
def render(
    scene: Scene, view: PlacedLens, eye: Eye, around: Panorama
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Radiance of the whole spectrum [W/m2/sr] and distance [m] of each pixel, (rows, columns); infinite: the sky."""
    rows, columns, _ = view.rays.shape
    radiance = np.empty((rows, columns), dtype=np.float32)
    distance = np.empty((rows, columns), dtype=np.float32)
    shapes = np.empty(scene.body.sizes.shape[0], dtype=np.int64)
    point = np.empty(3)
    turn = view.turn
    for top in range(0, rows, BLOCK):
        for left in range(0, columns, BLOCK):
            bottom, right = min(top + BLOCK, rows), min(left + BLOCK, columns)
            count = _shapes_in(scene.body, view, eye.place, (top, bottom, left, right), shapes)
            for i in range(top, bottom):
                for j in range(left, right):
                    a, b, c = view.rays[i, j, 0], view.rays[i, j, 1], view.rays[i, j, 2]
                    ray = (
                        turn[0, 0] * a + turn[0, 1] * b + turn[0, 2] * c,
                        turn[1, 0] * a + turn[1, 1] * b + turn[1, 2] * c,
                        turn[2, 0] * a + turn[2, 1] * b + turn[2, 2] * c,
                    )
                    way = first_meeting(scene.ground, eye, around, ray[0], ray[1], ray[2])
                    across = math.sqrt(ray[0] * ray[0] + ray[1] * ray[1])
                    if across < 1e-7 and way == 0.0:
                        reach = -height_over(scene.ground, eye, eye.place[0], eye.place[1], 0.0)
                    else:
                        reach = way / across
                    shown = _shape_pixel(scene, eye.place, ray, shapes[:count], point, reach)
                    if shown[0] < reach:
                        radiance[i, j] = shown[1]
                        distance[i, j] = shown[0]
                    elif reach < math.inf:
                        radiance[i, j] = _ground_pixel(scene, eye.place, ray, reach, view.pixel, point)
                        distance[i, j] = reach
                    else:
                        radiance[i, j] = _sky(scene, ray)
                        distance[i, j] = math.inf
    return radiance, distance


@kernel
def _shapes_in(
    body: Shapes, view: PlacedLens, place: FloatArray, block: tuple[int, int, int, int], shapes: NDArray[np.int64]
) -> int:
    """How many shapes may be seen in a block of pixels; `shapes` is filled with their numbers."""
    top, bottom, left, right = block
    middle = view.rays[(top + bottom) // 2, (left + right) // 2]
    spread = 1.0
    for i in (top, bottom - 1):
        for j in (left, right - 1):
            corner = view.rays[i, j]
            spread = min(spread, middle[0] * corner[0] + middle[1] * corner[1] + middle[2] * corner[2])
    half = math.acos(min(spread, 1.0)) + view.pixel
    turn = view.turn
    x = turn[0, 0] * middle[0] + turn[0, 1] * middle[1] + turn[0, 2] * middle[2]
    y = turn[1, 0] * middle[0] + turn[1, 1] * middle[1] + turn[1, 2] * middle[2]
    z = turn[2, 0] * middle[0] + turn[2, 1] * middle[1] + turn[2, 2] * middle[2]
    count = 0
    for shape in range(body.sizes.shape[0]):
        dx, dy, dz = (
            body.places[shape, 0] - place[0],
            body.places[shape, 1] - place[1],
            body.places[shape, 2] - place[2],
        )
        apart = math.sqrt(dx * dx + dy * dy + dz * dz)
        radius = body.sizes[shape, ROUND]
        seen = apart <= radius
        if not seen:
            cosine = min(max((dx * x + dy * y + dz * z) / apart, -1.0), 1.0)
            seen = math.acos(cosine) <= half + math.asin(radius / apart)
        if seen:
            shapes[count] = shape
            count += 1
    return count


@small_kernel
def _shape_pixel(
    scene: Scene, place: FloatArray, ray: Vector, shapes: NDArray[np.int64], point: FloatArray, reach: float
) -> tuple[float, float]:
    """Distance to the nearest of some shapes, infinite for none nearer than `reach` [m], and its radiance."""
    nearest, found = reach, -1
    normal = (0.0, 0.0, 0.0)
    for k in range(shapes.shape[0]):
        if near_ray(scene.body, shapes[k], place, ray):
            at, x, y, z = meet_shape(scene.body, shapes[k], place, ray)
            if at < nearest:
                nearest, found, normal = at, shapes[k], (x, y, z)
    if found < 0:
        return math.inf, 0.0
    albedo = scene.body.sizes[found, ALBEDO]
    x, y, z = place[0] + nearest * ray[0], place[1] + nearest * ray[1], place[2] + nearest * ray[2]
    sun = scene.cast.sun
    facing = normal[0] * sun[0] + normal[1] * sun[1] + normal[2] * sun[2]
    bright = ambient(scene.light, albedo, _sent_up(scene), normal[2])
    if facing > 0.0 and scene.light.direct > 0.0:
        part = sunlit(scene.ground, scene.cast, x, y, z)
        lift = 1e-4  # off the surface, which is not to hide itself
        if part > 0.0 and not hides_sun(
            scene.body, sun, x + lift * normal[0], y + lift * normal[1], z + lift * normal[2], point
        ):
            bright += part * scene.light.direct * albedo * facing / math.pi
    return nearest, bright


@small_kernel
def _ground_pixel(scene: Scene, place: FloatArray, ray: Vector, reach: float, pixel: float, point: FloatArray) -> float:
    """Radiance of the ground at a distance along a ray."""
    x, y, z = place[0] + reach * ray[0], place[1] + reach * ray[1], place[2] + reach * ray[2]
    ground, soils, sun = scene.ground, scene.soils, scene.cast.sun
    slope_x, slope_y = slope_at(ground, x, y)
    length = 1.0 / math.sqrt(1.0 + slope_x * slope_x + slope_y * slope_y)
    facing = max((slope_x * ray[0] + slope_y * ray[1] - ray[2]) * length, 0.02)
    fine_x, fine_y, fine_bright = grain_at(scene.grain, x, y, reach * pixel / math.sqrt(facing))
    slope_x, slope_y = slope_x + fine_x, slope_y + fine_y
    length = 1.0 / math.sqrt(1.0 + slope_x * slope_x + slope_y * slope_y)
    soil = sample_soil(soils.of_node, soils.place[0], soils.place[1], soils.place[2], x, y)
    shade = soils.brightness[soil] * max(1.0 + fine_bright, 0.1)
    bright = ambient(scene.light, scene.look.albedo * shade, _sent_up(scene), length)
    towards_sun = (sun[2] - slope_x * sun[0] - slope_y * sun[1]) * length
    if towards_sun > 0.0 and scene.light.direct > 0.0:
        part = sunlit(ground, scene.cast, x, y, z)
        if part > 0.0 and is_changed(ground.changes, x, y):
            part *= sunlit_nearby(ground, sun, x, y, z)
        if part > 0.0 and not hides_sun(scene.body, sun, x, y, z + 1e-3, point):
            towards_eye = (slope_x * ray[0] + slope_y * ray[1] - ray[2]) * length
            phase = -(ray[0] * sun[0] + ray[1] * sun[1] + ray[2] * sun[2])
            bright += part * scene.light.direct * shade * reflectance(scene.look, towards_sun, towards_eye, phase)
    return float(bright)


@small_kernel
def _sent_up(scene: Scene) -> float:
    """What level ground around sends up [W/m2]."""
    return float(scene.look.albedo * (scene.light.direct * max(scene.cast.sun[2], 0.0) + scene.light.diffuse))


@small_kernel
def _sky(scene: Scene, ray: Vector) -> float:
    sun = scene.cast.sun
    bright = scene.light.diffuse / math.pi * (ZENITH + SLANT * (1.0 - max(ray[2], 0.0)))
    if ray[0] * sun[0] + ray[1] * sun[1] + ray[2] * sun[2] > math.cos(sun[3]):
        bright += scene.light.direct / (math.pi * sun[3] * sun[3])
    return bright
