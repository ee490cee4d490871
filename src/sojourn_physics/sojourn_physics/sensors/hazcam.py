"""Stereo camera for hazards: points of the ground in its view, with occlusion and the error of stereo.

Rays leave the camera at equal angles, as pixels of a fisheye lens do: azimuth a and elevation e about its optical
axis x (y left, z up) give the direction [cos e cos a, cos e sin a, sin e]. Along each ray the first crossing with
the ground is sought in steps of half a node of the height field (not below LEAST_STEP), and halved down. So what
lies behind an edge is not seen, and a shape narrower than half a node can be missed. The cost is bounded by rays
x range / step.

Stereo. With depth z along the optical axis, focal length f [px] and baseline b the disparity is d = f b / z. What is
matched is d + n with n normal, of standard deviation sigma_d; the point moves along its ray to the depth f b / (d + n):

    sigma_z = z^2 / (f b) sigma_d        (first order in n / d)

Sources: Matthies & Shafer (1987), IEEE J. Robotics and Automation 3(3):239 (error of stereo); Maki et al. (2003), J.
Geophys. Res. 108(E12):8071 (hazard cameras of the Mars Exploration Rovers: 124 degrees square, 2.1 mrad a pixel);
Goldberg, Maimone & Matthies (2002), IEEE Aerospace Conf. 5:2025 (their use for navigation).

The ground is that of now: height field less what wheels and tools have taken off it. A ray may end before, on the
machine's own body. By night, and where the machine stands in a shadow, a camera without a lamp sees nothing:
`least_light`.

Assumptions: a good match on every ray that meets something within range (no lack of texture, single shadow or glare);
the error of direction, a fraction of a pixel, is left out. Beyond the edge of the map the ground goes on level, as in
the plant. Points are rounded to RESOLUTION, far below the noise: float32 numbers with few digits are what a bag can
pack.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.kernels import njit, small_kernel
from sojourn_machine.mounting import mounting
from sojourn_machine.params import FloatArray, Params
from sojourn_machine.shapes import Shapes
from sojourn_physics.imaging.ground import NO_CHANGES, Changes, lowered_at
from sojourn_physics.imaging.shapes_ahead import shorten
from sojourn_physics.sensors.noise import NoiseStream, draw, initial_stream
from sojourn_physics.terrain.height_field import HeightArray, HeightField, sample_ground

LEAST_STEP = 0.02
"""Shortest step along a ray [m]."""
HALVINGS = 8
"""Of a step, to find the crossing in it."""
RESOLUTION = 2.0**-10
"""Of the coordinates of a point [m]."""
LEAST_DISPARITY = 0.5
"""A match below it is no distance [px]."""


class HazcamParams(Params):
    """One stereo pair."""

    link: str = Field(min_length=1, description="link of the URDF: x along the optical axis, z up in the image")
    columns: int = Field(ge=2, le=512, description="rays across [-]")
    rows: int = Field(ge=2, le=512, description="rays from bottom to top [-]")
    horizontal_view_deg: float = Field(gt=0.0, le=170.0, description="angle between the outermost columns [degree]")
    vertical_view_deg: float = Field(gt=0.0, le=170.0, description="angle between the outermost rows [degree]")
    nearest: float = Field(ge=0.0, le=10.0, description="shortest distance at which images are matched [m]")
    range: float = Field(gt=0.0, le=100.0, description="longest distance of a point [m]")
    baseline: float = Field(gt=0.0, le=2.0, description="distance of the two cameras [m]")
    focal_length_px: float = Field(gt=0.0, le=1e5, description="in pixels of the matched images [px]")
    disparity_noise_px: float = Field(ge=0.0, le=10.0, description="standard deviation of a match [px]")
    sees_body: bool = Field(
        default=False, description="whether the machine's own body is in its way; false: it is nowhere in its view [-]"
    )
    least_light: float = Field(
        default=0.0, ge=0.0, le=1e4, description="sunlight it needs to match images; 0: it has a lamp [W/m2]"
    )

    @model_validator(mode="after")
    def _check(self) -> Self:
        if not self.nearest < self.range:
            raise ValueError(f"nearest = {self.nearest}: allowed is less than range = {self.range}")
        return self


@dataclass(frozen=True, eq=False, slots=True)
class Hazcam:
    """A camera on a machine, ready for the kernel."""

    params: HazcamParams
    position: FloatArray
    """In base_link, shape (3,) [m]."""
    directions: FloatArray
    """Unit vectors in base_link, shape (rays, 3), row by row from the bottom, from right to left."""
    depths: FloatArray
    """Depth along the optical axis for each metre of a ray, shape (rays,) [-]."""


class HazcamView(NamedTuple):
    """What there is before a camera."""

    ground: HeightField
    changes: Changes = NO_CHANGES
    """Of the ground, since the start."""
    body: Shapes | None = None
    """The machine's shapes in base_link; None where they are not in its way."""


def hazcam_on(params: HazcamParams, urdf_xml: str) -> Hazcam:
    """The camera on the machine of a URDF. Raises InvalidValueError if it has not the camera's link."""
    rotation, position = mounting(urdf_xml, params.link)
    across, up = math.radians(params.horizontal_view_deg) / 2, math.radians(params.vertical_view_deg) / 2
    azimuth = np.tile(np.linspace(-across, across, params.columns), params.rows)
    elevation = np.repeat(np.linspace(-up, up, params.rows), params.columns)
    in_link = np.stack(
        [np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)], axis=1
    )
    return Hazcam(params, position, np.ascontiguousarray(in_link @ rotation.T), np.ascontiguousarray(in_link[:, 0]))


def initial_state(camera: Hazcam, seed: int, name: str = "hazcam") -> NoiseStream:
    """The camera's noise, from the stream of its name and link: all that it remembers."""
    return initial_stream(seed, f"{name}.{camera.params.link}", len(camera.directions))


def step(
    camera: Hazcam, state: NoiseStream, seen: HazcamView, position_base_in_map: FloatArray, rotation: FloatArray
) -> tuple[NoiseStream, NDArray[np.float32]]:
    """One look: the state after it, and points in base_link, shape (points, 3) [m].

    Args:
        position_base_in_map: shape (3,) [m]. rotation: from base_link to map, shape (3, 3).

    Raises:
        InvalidValueError: a pose that is not finite.
    """
    if not (np.isfinite(position_base_in_map).all() and np.isfinite(rotation).all()):
        raise InvalidValueError("pose of base_link", position_base_in_map.tolist(), "finite numbers")
    params, ground = camera.params, seen.ground
    ranges = cast_rays(
        relief_of(ground, seen.changes),
        position_base_in_map + rotation @ camera.position,
        camera.directions @ rotation.T,
        max(0.5 * ground.resolution, LEAST_STEP),
        params.range,
    )
    if seen.body is not None:
        shorten(seen.body, camera.position, camera.directions, ranges)
    state, noise = draw(state)
    met = (ranges >= params.nearest) & (ranges <= params.range)
    ray, noise = ranges[met], noise[met]
    scale = params.focal_length_px * params.baseline
    disparity = scale / (ray * camera.depths[met]) + params.disparity_noise_px * noise
    measured = scale / (np.maximum(disparity, LEAST_DISPARITY) * camera.depths[met])
    within = measured <= params.range
    points = camera.position + measured[within, np.newaxis] * camera.directions[met][within]
    return state, (np.round(points / RESOLUTION) * RESOLUTION).astype(np.float32)


class Relief(NamedTuple):
    """The ground as it is now, for the kernel: a height field and what has been changed of it since."""

    heights: HeightArray
    grid: FloatArray
    changes: Changes


def relief_of(field: HeightField, changes: Changes = NO_CHANGES) -> Relief:
    """Of a height field."""
    return Relief(field.heights, field.grid, changes)


@small_kernel
def _height(relief: Relief, x: float, y: float) -> float:
    height, _, _, _ = sample_ground(relief.heights, relief.grid, x, y)
    if relief.changes.place[3] > 1.0:
        height -= lowered_at(relief.changes, x, y)
    return float(height)


@njit(cache=True)
def cast_rays(relief: Relief, origin: FloatArray, directions: FloatArray, step: float, reach: float) -> FloatArray:
    """Distance to the ground along each ray, shape (rays,) [m]; infinite where there is none within `reach`.

    Args:
        origin: in map, shape (3,) [m]; below the ground nothing is seen. directions: unit vectors in map, shape (rays,
            3). step: of the march, over ground [m]. reach: [m].
    """
    count = directions.shape[0]
    found = np.full(count, np.inf)
    if origin[2] <= _height(relief, origin[0], origin[1]):
        return found
    for i in range(count):
        dx, dy, dz = directions[i, 0], directions[i, 1], directions[i, 2]
        # a steep ray passes over little ground in a step, a vertical one over none
        stride = step / max(math.sqrt(dx * dx + dy * dy), 0.1)
        near = 0.0
        while near < reach:
            far = min(near + stride, reach)
            if origin[2] + far * dz <= _height(relief, origin[0] + far * dx, origin[1] + far * dy):
                for _ in range(HALVINGS):
                    middle = 0.5 * (near + far)
                    if origin[2] + middle * dz <= _height(relief, origin[0] + middle * dx, origin[1] + middle * dy):
                        far = middle
                    else:
                        near = middle
                found[i] = 0.5 * (near + far)
                break
            near = far
    return found
