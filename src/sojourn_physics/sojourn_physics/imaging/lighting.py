"""The light of what rays end on: ground and the machine's shapes.

It is that of `photometry`: the Sun's as far as it is not hidden by the ground (`shadows`) or the machine, the sky's,
and what sunlit ground sends up. Light that has been scattered more than once besides is left out.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sojourn_machine.kernels import kernel, small_kernel, vector_kernel
from sojourn_machine.params import FloatArray
from sojourn_machine.shapes import ALBEDO, Shapes
from sojourn_physics.imaging.body import hides_sun
from sojourn_physics.imaging.ground import DrawnGround, any_change, is_changed, lowered_at, slope_of_changes
from sojourn_physics.imaging.nodes import Nodes, find_nodes, slopes_between
from sojourn_physics.imaging.photometry import GRAZING, Illumination, Look, ambient, reflectance
from sojourn_physics.imaging.shadows import CastShadows, sunlit, sunlit_between, sunlit_nearby
from sojourn_physics.imaging.single import NEVER, ONE, ZERO, constant, narrowed
from sojourn_physics.imaging.soils import Soils, brightness_between
from sojourn_physics.imaging.texture import Grain, Grains, add_grain

X, Y, Z = range(3)
"""Rows of spots: place in map [m]."""
SLOPE_X, SLOPE_Y, WIDTH, TOWARDS_SUN, TOWARDS_EYE, PHASE, UPRIGHT, SHADE, LIT = range(9)
"""Rows of a surface: slope [-], width of the pixel on it [m], cosines of incidence, emission and
phase, of the normal to the vertical, brightness of the albedo of the place, part of the Sun's disc that is seen [-]."""
SURFACE = 9
FAR = constant(1e6)
"""Instead of the infinite distance of the sky [m]."""
DARKEST = constant(0.1)
"""Least brightness of a place, over the mean [-]."""
ABOVE = 1e-3
"""The ground from which the Sun is looked for, which a wheel in it is not to hide [m]."""

Vector = tuple[float, float, float]
Line = NDArray[np.float32]


class Seat(NamedTuple):
    """Of a camera, for the kernels."""

    place: FloatArray
    """In map, (3,) [m]."""
    pixel: float
    """Angle of a pixel [rad]."""


class Room(NamedTuple):
    """To work in, for so many pixels."""

    spots: FloatArray
    """(3, n)."""
    surface: Line
    """(SURFACE, n) or more."""
    point: FloatArray
    """(3,)."""
    grains: Grains
    nodes: Nodes


class PlacedLens(NamedTuple):
    """A camera where it is, for the kernels."""

    rays: NDArray[np.float32]
    """Unit vectors of the pixels in the optical frame, (3, rows, columns)."""
    turn: FloatArray
    """From the optical frame into map, (3, 3)."""
    pixel: float
    """Angle of a pixel [rad]."""


class Scene(NamedTuple):
    """All that there is to be seen, for the kernels."""

    ground: DrawnGround
    soils: Soils
    look: Look
    grain: Grain
    light: Illumination
    cast: CastShadows
    body: Shapes


@kernel
def shape_light(scene: Scene, shape: int, at: Vector, normal: Vector, point: FloatArray) -> float:
    """Radiance of a shape at a place with a normal, both in map [W/m2/sr]. `point`: working room, (3,)."""
    albedo, sun = scene.body.sizes[shape, ALBEDO], scene.cast.sun
    facing = normal[0] * sun[0] + normal[1] * sun[1] + normal[2] * sun[2]
    bright = ambient(scene.light, albedo, _sent_up(scene), normal[2])
    if facing > 0.0 and scene.light.direct > 0.0:
        part = sunlit(scene.ground, scene.cast, at[0], at[1], at[2])
        lift = 1e-4  # off the surface, which is not to hide itself
        x, y, z = at[0] + lift * normal[0], at[1] + lift * normal[1], at[2] + lift * normal[2]
        if part > 0.0 and not hides_sun(scene.body, sun, x, y, z, point):
            bright += part * scene.light.direct * albedo * facing / math.pi
    return float(bright)


@kernel
def light_ground(scene: Scene, rays: Line, eye: Seat, distance: Line, radiance: Line, room: Room) -> None:
    """Write the radiance of those pixels of a bundle that see the ground: whose radiance is not known yet, less
    than 0.

    Each step does one thing for all pixels, so that the processor has the memory of several under way at once.

    Args:
        rays: in map, (3, n). distance, radiance: of them, (n,). room: to work in.
    """
    spots, surface = room.spots, room.surface
    _places(rays, eye, distance, radiance, spots)
    find_nodes(scene.ground, spots[X], spots[Y], room.nodes)
    _slopes(scene.ground, room)
    _widths(rays, eye, distance, surface)
    _grains(scene, room)
    _normals(scene, rays, surface)
    _sunlight(scene, room)
    _radiances(scene, surface, radiance)


@vector_kernel
def _places(rays: Line, eye: Seat, distance: Line, radiance: Line, spots: FloatArray) -> None:
    """Where the pixels see the ground; of others the place of the camera."""
    place = eye.place
    for j in range(distance.shape[0]):
        reach = distance[j] if radiance[j] < ZERO and distance[j] < NEVER else ZERO
        spots[X, j] = place[0] + reach * rays[0, j]
        spots[Y, j] = place[1] + reach * rays[1, j]
        spots[Z, j] = place[2] + reach * rays[2, j]


@small_kernel
def _slopes(ground: DrawnGround, room: Room) -> None:
    spots, surface, changes = room.spots, room.surface, ground.changes
    slopes_between(ground, room.nodes, surface[SLOPE_X], surface[SLOPE_Y])
    if any_change(changes):
        for j in range(spots.shape[1]):
            x, y = spots[X, j], spots[Y, j]
            if room.nodes.on[j] > ZERO and is_changed(changes, x, y):
                down_x, down_y = slope_of_changes(changes, x, y)
                surface[SLOPE_X, j] -= narrowed(down_x)
                surface[SLOPE_Y, j] -= narrowed(down_y)


@vector_kernel
def _widths(rays: Line, eye: Seat, distance: Line, surface: Line) -> None:
    """Of the pixels on the ground [m]."""
    pixel = narrowed(eye.pixel)
    for j in range(distance.shape[0]):
        slope_x, slope_y = surface[SLOPE_X, j], surface[SLOPE_Y, j]
        length = ONE / math.sqrt(ONE + slope_x * slope_x + slope_y * slope_y)
        facing = max((slope_x * rays[0, j] + slope_y * rays[1, j] - rays[2, j]) * length, GRAZING)
        surface[WIDTH, j] = min(distance[j], FAR) * pixel / math.sqrt(facing)


@small_kernel
def _grains(scene: Scene, room: Room) -> None:
    """The fine slope and the brightness of the ground."""
    spots, surface = room.spots, room.surface
    add_grain(scene.grain, spots[X], spots[Y], surface[WIDTH], room.grains)
    brightness_between(scene.soils, scene.ground, room.nodes, surface[SHADE])
    for j in range(spots.shape[1]):
        surface[SLOPE_X, j] += room.grains.slope_x[j]
        surface[SLOPE_Y, j] += room.grains.slope_y[j]
        surface[SHADE, j] *= max(ONE + room.grains.bright[j], DARKEST)


@vector_kernel
def _normals(scene: Scene, rays: Line, surface: Line) -> None:
    east, north, up = narrowed(scene.cast.sun[0]), narrowed(scene.cast.sun[1]), narrowed(scene.cast.sun[2])
    for j in range(rays.shape[1]):
        slope_x, slope_y = surface[SLOPE_X, j], surface[SLOPE_Y, j]
        length = ONE / math.sqrt(ONE + slope_x * slope_x + slope_y * slope_y)
        surface[TOWARDS_SUN, j] = (up - slope_x * east - slope_y * north) * length
        surface[TOWARDS_EYE, j] = (slope_x * rays[0, j] + slope_y * rays[1, j] - rays[2, j]) * length
        surface[PHASE, j] = -(rays[0, j] * east + rays[1, j] * north + rays[2, j] * up)
        surface[UPRIGHT, j] = length


@small_kernel
def _sunlight(scene: Scene, room: Room) -> None:
    """The part of the Sun that the ground sees, where it faces it."""
    ground, sun, spots, surface, nodes = scene.ground, scene.cast.sun, room.spots, room.surface, room.nodes
    if scene.light.direct <= 0.0 or sun[2] <= -sun[3]:
        surface[LIT] = ZERO
        return
    changed = any_change(ground.changes)
    for j in range(spots.shape[1]):
        x, y, z = spots[X, j], spots[Y, j], spots[Z, j]
        if changed and is_changed(ground.changes, x, y):  # below its own surface as it was all would be dark
            z += lowered_at(ground.changes, x, y)
        surface[LIT, j] = ONE
        if nodes.on[j] > ZERO:
            part = nodes.up[j], nodes.right[j]
            surface[LIT, j] = sunlit_between(ground, scene.cast, (nodes.row[j], nodes.column[j]), part, z)
    if changed:
        for j in range(spots.shape[1]):
            x, y, z = spots[X, j], spots[Y, j], spots[Z, j]
            if surface[LIT, j] > ZERO and surface[TOWARDS_SUN, j] > ZERO and is_changed(ground.changes, x, y):
                surface[LIT, j] *= narrowed(sunlit_nearby(ground, sun, x, y, z))
    if _may_be_shaded(scene.body, sun, spots):
        for j in range(spots.shape[1]):
            x, y, z = spots[X, j], spots[Y, j], spots[Z, j] + ABOVE
            if (
                surface[LIT, j] > ZERO
                and surface[TOWARDS_SUN, j] > ZERO
                and hides_sun(scene.body, sun, x, y, z, room.point)
            ):
                surface[LIT, j] = ZERO


@vector_kernel
def _may_be_shaded(body: Shapes, sun: FloatArray, spots: FloatArray) -> bool:
    """Whether the ball about the machine stands between one of the spots and the Sun."""
    towards = body.around[0], body.around[1], body.around[2] - ABOVE
    radius, count = body.around[3], 0
    for j in range(spots.shape[1]):
        dx, dy, dz = towards[0] - spots[X, j], towards[1] - spots[Y, j], towards[2] - spots[Z, j]
        along = dx * sun[0] + dy * sun[1] + dz * sun[2]
        count += (along >= -radius) & (dx * dx + dy * dy + dz * dz - along * along <= radius * radius)
    return count > 0


@vector_kernel
def _radiances(scene: Scene, surface: Line, radiance: Line) -> None:
    look = Look(narrowed(scene.look.albedo), narrowed(scene.look.regolith))
    light = Illumination(narrowed(scene.light.direct), narrowed(scene.light.diffuse))
    up = narrowed(_sent_up(scene))
    for j in range(radiance.shape[0]):
        shade = surface[SHADE, j]
        bright = ambient(light, look.albedo * shade, up, surface[UPRIGHT, j])
        seen = reflectance(look, surface[TOWARDS_SUN, j], surface[TOWARDS_EYE, j], surface[PHASE, j])
        bright += surface[LIT, j] * light.direct * shade * seen
        radiance[j] = bright if radiance[j] < ZERO else radiance[j]


@small_kernel
def _sent_up(scene: Scene) -> float:
    """What level ground around sends up [W/m2]."""
    return float(scene.look.albedo * (scene.light.direct * max(scene.cast.sun[2], 0.0) + scene.light.diffuse))
