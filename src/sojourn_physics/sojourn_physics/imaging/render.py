"""What a camera sees: radiance and distance of each pixel, by one ray through its middle.

Each ray ends on the machine's own shapes (`body`) or on the ground (`panorama`), whichever is nearer, or in the sky.
There the light is that of `lighting`. The sky under air has the radiance D/π (0.8 + 0.6 (1 - sin elevation)), which
gives D on level ground; under no air it is black. Haze and stars are left out.

An image is made in passes over strips of rows, each of which does one thing to all of its pixels: where rays meet the
ground, what of the machine is before it, what light is there. So each is small enough for the processor's registers,
and the last, without a branch, takes several pixels at once.
"""

import math

import numpy as np
from numpy.typing import NDArray

from sojourn_machine.kernels import kernel, njit, small_kernel
from sojourn_machine.params import FloatArray
from sojourn_physics.imaging.lighting import SURFACE, PlacedLens, Scene, Seat, light_ground, ray_of, shape_light
from sojourn_physics.imaging.panorama import ROOM, Eye, Panorama, meet_ground
from sojourn_physics.imaging.shapes_ahead import BEARING, NONE, bearings_of, first_shape, shapes_in_cone

BLOCK = 16
"""Pixels along the side of a block for which it is found out which shapes may be in it."""
ZENITH, SLANT = 0.8, 0.6
"""Of the sky's radiance."""
UNLIT = np.float32(-1.0)
"""Instead of the radiance of a pixel that is not known yet."""

Vector = tuple[float, float, float]
Image = NDArray[np.float32]


@njit(cache=True)
def render(scene: Scene, view: PlacedLens, eye: Eye, around: Panorama) -> tuple[Image, Image]:
    """Radiance of the whole spectrum [W/m2/sr] and distance [m] of each pixel, (rows, columns); infinite: the sky."""
    rows, columns, _ = view.rays.shape
    radiance = np.full((rows, columns), UNLIT)
    distance = np.empty((rows, columns), dtype=np.float32)
    bearings = np.empty((scene.body.sizes.shape[0], BEARING))
    near = np.empty(bearings.shape[0], dtype=np.int64)
    surface = np.empty((max(SURFACE, ROOM), columns))
    rays = np.empty((BLOCK, 3, columns))
    point = np.empty(3)
    bearings_of(scene.body, eye.place, bearings)
    for top in range(0, rows, BLOCK):
        bottom = min(top + BLOCK, rows)
        for i in range(top, bottom):
            _rays_of(view, i, rays[i - top])
            meet_ground(scene.ground, eye, around, rays[i - top], distance[i], surface)
        for left in range(0, columns, BLOCK):
            block = (top, bottom, left, min(left + BLOCK, columns))
            count = _shapes_in(view, bearings, block, near)
            if count > 0:
                _meet_shapes(scene, view, eye.place, block, near[:count], point, (radiance, distance))
        for i in range(top, bottom):
            light_ground(scene, rays[i - top], Seat(eye.place, view.pixel), distance[i], radiance[i], surface, point)
            _look_into_the_sky(scene, view, i, distance[i], radiance[i])
    return radiance, distance


@small_kernel
def _rays_of(view: PlacedLens, i: int, rays: FloatArray) -> None:
    """Write the rays of a row in map, (3, columns)."""
    for j in range(rays.shape[1]):
        rays[0, j], rays[1, j], rays[2, j] = ray_of(view, i, j)


@kernel
def _shapes_in(
    view: PlacedLens, bearings: FloatArray, block: tuple[int, int, int, int], near: NDArray[np.int64]
) -> int:
    """How many shapes may be seen in a block of pixels; `near` is filled with their numbers."""
    top, bottom, left, right = block
    middle = ray_of(view, (top + bottom) // 2, (left + right) // 2)
    cosine = 1.0
    for i in (top, bottom - 1):
        for j in (left, right - 1):
            corner = ray_of(view, i, j)
            cosine = min(cosine, middle[0] * corner[0] + middle[1] * corner[1] + middle[2] * corner[2])
    # a pixel more: between its corners the image of a lens is no straight line
    sine = math.sqrt(max(1.0 - cosine * cosine, 0.0))
    cosine = cosine * math.cos(view.pixel) - sine * math.sin(view.pixel)
    return int(shapes_in_cone(bearings, middle, cosine, near))


@kernel
def _meet_shapes(
    scene: Scene,
    view: PlacedLens,
    place: FloatArray,
    block: tuple[int, int, int, int],
    shapes: NDArray[np.int64],
    point: FloatArray,
    image: tuple[Image, Image],
) -> None:
    """Write the radiance and distance of pixels of a block that see a shape before the ground."""
    radiance, distance = image
    top, bottom, left, right = block
    for i in range(top, bottom):
        for j in range(left, right):
            ray = ray_of(view, i, j)
            shape, nearest, normal = first_shape(scene.body, shapes, place, ray, distance[i, j])
            if shape != NONE:
                at = (place[0] + nearest * ray[0], place[1] + nearest * ray[1], place[2] + nearest * ray[2])
                radiance[i, j] = shape_light(scene, shape, at, normal, point)
                distance[i, j] = nearest


@small_kernel
def _look_into_the_sky(scene: Scene, view: PlacedLens, i: int, distance: Image, radiance: Image) -> None:
    """Light the pixels of a row that see neither ground nor machine."""
    sun = scene.cast.sun
    for j in range(distance.shape[0]):
        if distance[j] == math.inf:
            ray = ray_of(view, i, j)
            bright = scene.light.diffuse / math.pi * (ZENITH + SLANT * (1.0 - max(ray[2], 0.0)))
            if ray[0] * sun[0] + ray[1] * sun[1] + ray[2] * sun[2] > math.cos(sun[3]):
                bright += scene.light.direct / (math.pi * sun[3] * sun[3])
            radiance[j] = bright
