"""What a camera sees: radiance and distance of each pixel, by one ray through its middle.

Each ray ends on the machine's own shapes (`body`) or on the ground (`panorama`), whichever is nearer, or in the sky.
There the light is that of `lighting`. The sky under air has the radiance D/π (0.8 + 0.6 (1 - sin elevation)), which
gives D on level ground; under no air it is black. Haze and stars are left out.

An image is made block by block, each in passes that do one thing to all of its pixels: where rays meet the ground,
what of the machine is before it, what light is there. So each is small enough for the processor's registers, and the
last, without a branch and in single precision, takes eight pixels at once; and what a block looks up, walks, ground and
shadows about one place, stays in the nearest memory.
"""

import math

import numpy as np
from numpy.typing import NDArray

from sojourn_machine.kernels import kernel, njit, small_kernel, vector_kernel
from sojourn_machine.params import FloatArray
from sojourn_physics.imaging.lighting import SURFACE, PlacedLens, Room, Scene, Seat, light_ground, shape_light
from sojourn_physics.imaging.nodes import nodes_for
from sojourn_physics.imaging.panorama import ROOM, meet_ground
from sojourn_physics.imaging.shapes_ahead import BEARING, NONE, bearings_of, first_shape, shapes_in_cone
from sojourn_physics.imaging.single import narrowed
from sojourn_physics.imaging.texture import grains_for
from sojourn_physics.imaging.walks import Eye, Panorama

SIDE = 16
"""Pixels along the side of a block."""
PIXELS = SIDE * SIDE
"""Of a block."""
ZENITH, SLANT = 0.8, 0.6
"""Of the sky's radiance."""
UNLIT = np.float32(-1.0)
"""Instead of the radiance of a pixel that is not known yet."""

Line = NDArray[np.float32]
Image = NDArray[np.float32]


@njit(cache=True, nogil=True)
def render(scene: Scene, view: PlacedLens, eye: Eye, around: Panorama) -> tuple[Image, Image]:
    """Radiance of the whole spectrum [W/m2/sr] and distance [m] of each pixel, (rows, columns); infinite: the sky."""
    _, rows, columns = view.rays.shape
    image = np.empty((rows, columns), dtype=np.float32), np.empty((rows, columns), dtype=np.float32)
    bearings = np.empty((scene.body.sizes.shape[0], BEARING))
    near = np.empty(bearings.shape[0], dtype=np.int64)
    rays, surface = np.empty((3, PIXELS), dtype=np.float32), np.empty((max(SURFACE, ROOM), PIXELS), dtype=np.float32)
    room = Room(np.empty((3, PIXELS)), surface, np.empty(3), grains_for(PIXELS), nodes_for(PIXELS))
    radiance, distance = np.empty(PIXELS, dtype=np.float32), np.empty(PIXELS, dtype=np.float32)
    seat = Seat(eye.place, view.pixel)
    bearings_of(scene.body, eye.place, bearings)
    for top in range(0, rows, SIDE):
        for left in range(0, columns, SIDE):
            _rays_of(view, top, left, rays)
            meet_ground(scene.ground, eye, around, rays, distance, room.surface)
            radiance[:] = UNLIT
            count = _shapes_in(view, rays, bearings, near)
            if count > 0:
                _meet_shapes(scene, rays, eye.place, near[:count], room.point, (radiance, distance))
            ground, sky = _ends(distance, radiance)
            if ground:
                light_ground(scene, rays, seat, distance, radiance, room)
            if sky:
                _look_into_the_sky(scene, rays, distance, radiance)
            _put((radiance, distance), top, left, image)
    return image


@vector_kernel
def _rays_of(view: PlacedLens, top: int, left: int, rays: Line) -> None:
    """Write the rays of a block in map, row by row, (3, PIXELS); beyond the edge of the image those at the edge."""
    _, rows, columns = view.rays.shape
    for axis in range(3):
        a, b, c = narrowed(view.turn[axis, 0]), narrowed(view.turn[axis, 1]), narrowed(view.turn[axis, 2])
        for k in range(SIDE):
            row, at = min(top + k, rows - 1), SIDE * k
            inside = min(SIDE, columns - left)
            for m in range(inside):
                i = left + m
                rays[axis, at + m] = a * view.rays[0, row, i] + b * view.rays[1, row, i] + c * view.rays[2, row, i]
            for m in range(inside, SIDE):
                rays[axis, at + m] = rays[axis, at + inside - 1]


@small_kernel
def _put(block: tuple[Line, Line], top: int, left: int, image: tuple[Image, Image]) -> None:
    """Write a block to its place in the image."""
    rows, columns = image[0].shape
    for k in range(min(SIDE, rows - top)):
        for m in range(min(SIDE, columns - left)):
            image[0][top + k, left + m] = block[0][SIDE * k + m]
            image[1][top + k, left + m] = block[1][SIDE * k + m]


@kernel
def _shapes_in(view: PlacedLens, rays: FloatArray, bearings: FloatArray, near: NDArray[np.int64]) -> int:
    """How many shapes may be seen in a block of pixels; `near` is filled with their numbers."""
    middle = SIDE * (SIDE // 2) + SIDE // 2
    axis = (np.float64(rays[0, middle]), np.float64(rays[1, middle]), np.float64(rays[2, middle]))
    cosine = 1.0
    for corner in (0, SIDE - 1, PIXELS - SIDE, PIXELS - 1):
        cosine = min(cosine, axis[0] * rays[0, corner] + axis[1] * rays[1, corner] + axis[2] * rays[2, corner])
    # a pixel more: between its corners the image of a lens is no straight line
    sine = math.sqrt(max(1.0 - cosine * cosine, 0.0))
    cosine = cosine * math.cos(view.pixel) - sine * math.sin(view.pixel)
    return int(shapes_in_cone(bearings, axis, cosine, near))


@kernel
def _meet_shapes(
    scene: Scene,
    rays: FloatArray,
    place: FloatArray,
    shapes: NDArray[np.int64],
    point: FloatArray,
    block: tuple[Line, Line],
) -> None:
    """Write the radiance and distance of pixels of a block that see a shape before the ground."""
    radiance, distance = block
    for k in range(PIXELS):
        ray = (np.float64(rays[0, k]), np.float64(rays[1, k]), np.float64(rays[2, k]))
        shape, nearest, normal = first_shape(scene.body, shapes, place, ray, distance[k])
        if shape != NONE:
            at = (place[0] + nearest * ray[0], place[1] + nearest * ray[1], place[2] + nearest * ray[2])
            radiance[k] = shape_light(scene, shape, at, normal, point)
            distance[k] = nearest


@small_kernel
def _ends(distance: Line, radiance: Line) -> tuple[bool, bool]:
    """Whether pixels of a block end on the ground, and whether some end in the sky."""
    ground, sky = False, False
    for k in range(PIXELS):
        ground |= (distance[k] < math.inf) & (radiance[k] < 0.0)
        sky |= distance[k] == math.inf
    return ground, sky


@small_kernel
def _look_into_the_sky(scene: Scene, rays: FloatArray, distance: Line, radiance: Line) -> None:
    """Light the pixels of a block that see neither ground nor machine."""
    sun, limb = scene.cast.sun, math.cos(scene.cast.sun[3])
    for k in range(PIXELS):
        if distance[k] == math.inf:
            bright = scene.light.diffuse / math.pi * (ZENITH + SLANT * (1.0 - max(rays[2, k], 0.0)))
            if rays[0, k] * sun[0] + rays[1, k] * sun[1] + rays[2, k] * sun[2] > limb:
                bright += scene.light.direct / (math.pi * sun[3] * sun[3])
            radiance[k] = bright
