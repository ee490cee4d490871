"""Lidars: how far it is along their beams, and how much of their light comes back.

A beam that its target covers, and sends back as a matt surface does, returns the power

    P ~ ρ cos i / r²

of a target of reflectance ρ under the angle of incidence i at the distance r; what is less than the receiver hears is
lost. A data sheet's range R_0 is that for a target of the reflectance ρ_0 square to the beam, so that a return is heard
within

    r <= R_0 sqrt(ρ cos i / ρ_0)

(range equation of an extended target, without air: Jelalian 1992, Laser Radar Systems, ch. 1). The distance is read
with an error of the deviation sqrt(σ² + (s r)²), in steps of the resolution; a part of the returns is dropped. All of
a scan is made at one moment: what the machine moves while a scanner turns is left out, as are echoes of two targets.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple, Self

import numpy as np
from pydantic import Field, model_validator

from sojourn_machine.kernels import njit, small_kernel
from sojourn_machine.params import FloatArray, Params
from sojourn_physics.imaging.body import ALBEDO, Shapes, meet_shape, near_ray
from sojourn_physics.imaging.ground import DrawnGround, slope_at
from sojourn_physics.imaging.panorama import Eye, Panorama, first_meeting, height_over
from sojourn_physics.imaging.render import Soils
from sojourn_physics.terrain.height_field import sample_soil


class LidarParams(Params):
    """What a data sheet says: beams in even steps of azimuth and elevation, and what one of them reads."""

    columns: int = Field(ge=1, le=4096, description="beams from left to right [-]")
    rows: int = Field(ge=1, le=512, description="beams from top to bottom [-]")
    horizontal_view_deg: float = Field(
        ge=0.0, le=360.0, description="between the outer beams, 360 for all round [degree]"
    )
    vertical_view_deg: float = Field(ge=0.0, le=180.0, description="between the upper and lower beams [degree]")
    nearest: float = Field(ge=0.0, le=100.0, description="shortest distance that is read [m]")
    range: float = Field(gt=0.0, le=5000.0, description="R_0: longest distance, to a target of `reflectance` [m]")
    reflectance: float = Field(default=0.8, gt=0.0, le=1.0, description="rho_0: of the target of the data sheet [-]")
    noise: float = Field(ge=0.0, le=10.0, description="sigma: standard deviation of a distance [m]")
    noise_per_metre: float = Field(default=0.0, ge=0.0, le=0.1, description="s: what is added to it a metre [-]")
    resolution: float = Field(default=0.0, ge=0.0, le=10.0, description="least step of a distance [m]")
    dropped: float = Field(default=0.0, ge=0.0, lt=1.0, description="part of the returns that is lost [-]")

    @model_validator(mode="after")
    def _check(self) -> Self:
        if not self.nearest < self.range:
            raise ValueError(f"nearest = {self.nearest}: allowed is less than range = {self.range}")
        for count, view in (("columns", "horizontal_view_deg"), ("rows", "vertical_view_deg")):
            if getattr(self, count) > 1 and getattr(self, view) == 0.0:
                raise ValueError(f"{view} = 0: allowed is more than 0 with {getattr(self, count)} {count}")
        return self


@dataclass(frozen=True, eq=False, slots=True)
class Beams:
    """Of one instrument."""

    directions: FloatArray
    """Unit vectors in the frame of its link (x ahead, y left, z up), (n, 3)."""
    spacing: float
    """Angle from beam to beam [rad]."""


def beams_of(params: LidarParams) -> Beams:
    """Rows from top to bottom, in each the beams from left to right; all round, the last is a step from the first."""
    whole = params.horizontal_view_deg == 360.0
    azimuths = _spread(params.horizontal_view_deg, params.columns + whole)[: params.columns]
    elevations = _spread(params.vertical_view_deg, params.rows)
    up, across = np.meshgrid(elevations, azimuths, indexing="ij")
    directions = np.stack([np.cos(up) * np.cos(across), np.cos(up) * np.sin(across), np.sin(up)], axis=-1)
    steps = [abs(angles[1] - angles[0]) for angles in (azimuths, elevations) if len(angles) > 1]
    return Beams(directions.reshape(-1, 3), float(min([*steps, WIDEST])))


def _spread(view_deg: float, count: int) -> FloatArray:
    half = 0.5 * math.radians(view_deg)
    return np.linspace(half, -half, count) if count > 1 else np.zeros(1)


WIDEST = math.radians(1.0)
"""Step of the walks along the ground at most [rad]: what is narrower than this, and than the beams are apart, may be
missed."""


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
    distance, returned = np.empty(rays.shape[0]), np.zeros(rays.shape[0])
    for i in range(rays.shape[0]):
        ray = (rays[i, 0], rays[i, 1], rays[i, 2])
        way = first_meeting(scene.ground, eye, around, ray[0], ray[1], ray[2])
        across = math.sqrt(ray[0] * ray[0] + ray[1] * ray[1])
        if across < 1e-7 and way == 0.0:
            reach = -height_over(scene.ground, eye, eye.place[0], eye.place[1], 0.0)
        else:
            reach = way / across if way < math.inf else math.inf
        nearest, back = _body_echo(scene.body, eye.place, ray, reach)
        if nearest < reach:
            distance[i], returned[i] = nearest, back
        else:
            distance[i] = reach
            if reach < math.inf:
                returned[i] = _ground_echo(scene, eye.place, ray, reach)
    return distance, returned


@small_kernel
def _body_echo(body: Shapes, place: FloatArray, ray: tuple[float, float, float], reach: float) -> tuple[float, float]:
    nearest, back = reach, 0.0
    for shape in range(body.sizes.shape[0]):
        if near_ray(body, shape, place, ray):
            at, x, y, z = meet_shape(body, shape, place, ray)
            if at < nearest:
                nearest = at
                back = body.sizes[shape, ALBEDO] * max(-(x * ray[0] + y * ray[1] + z * ray[2]), 0.0)
    return nearest, back


@small_kernel
def _ground_echo(scene: Sounded, place: FloatArray, ray: tuple[float, float, float], reach: float) -> float:
    x, y = place[0] + reach * ray[0], place[1] + reach * ray[1]
    slope_x, slope_y = slope_at(scene.ground, x, y)
    facing = (slope_x * ray[0] + slope_y * ray[1] - ray[2]) / math.sqrt(1.0 + slope_x * slope_x + slope_y * slope_y)
    soils = scene.soils
    soil = sample_soil(soils.of_node, soils.place[0], soils.place[1], soils.place[2], x, y)
    return float(scene.albedo * soils.brightness[soil] * max(facing, 0.0))


def measured(
    params: LidarParams, distance: FloatArray, returned: FloatArray, random: np.random.Generator
) -> FloatArray:
    """What is read of each beam [m], (n,); NaN where nothing is.

    Args:
        distance, returned: as `echoes` has them, (n,).
    """
    noise, luck = random.standard_normal(len(distance)), random.random(len(distance))
    heard = distance <= params.range * np.sqrt(returned / params.reflectance)
    heard &= np.isfinite(distance) & (luck >= params.dropped)
    true = np.where(heard, distance, np.nan)
    read = true + noise * np.hypot(params.noise, params.noise_per_metre * true)
    if params.resolution > 0.0:
        read = params.resolution * np.round(read / params.resolution)
    return np.where((read >= params.nearest) & (read <= params.range), read, np.nan)
