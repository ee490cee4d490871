"""What is read of beams: lidars, range finders.

A beam that its target covers, and sends back as a matt surface does, returns the power

    P ~ ρ cos i / r²

of a target of reflectance ρ under the angle of incidence i at the distance r; what is less than the receiver hears is
lost. A data sheet's range R_0 is that for a target of the reflectance ρ_0 square to the beam, so that a return is heard
within

    r <= R_0 sqrt(ρ cos i / ρ_0)

(range equation of an extended target, without air: Jelalian 1992, Laser Radar Systems, ch. 1). The distance is read
with an error of the deviation sqrt(σ² + (s r)²), in steps of the resolution; a part of the returns is dropped. What is
no distance is said as REP 117 has it: +infinity where nothing comes back within the range, -infinity where something
is too near to be read. All of a scan is made at one moment: what the machine moves while a scanner turns is left out,
as are echoes of two targets.
"""

import math
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from sojourn_machine.params import FloatArray, Params

WIDEST = math.radians(1.0)
"""Step of the walks along the ground at most [rad]: what is narrower than this, and than the beams are apart, may be
missed."""
DEVIATIONS = 8.0
"""No error is so many times its deviation."""


class RangingParams(Params):
    """What one beam reads."""

    nearest: float = Field(ge=0.0, le=100.0, description="shortest distance that is read [m]")
    range: float = Field(gt=0.0, le=5000.0, description="R_0: longest distance, to a target of `reflectance` [m]")
    reflectance: float = Field(default=0.8, gt=0.0, le=1.0, description="rho_0: of the target of the data sheet [-]")
    noise: float = Field(ge=0.0, le=10.0, description="sigma: standard deviation of a distance [m]")
    noise_per_metre: float = Field(default=0.0, ge=0.0, le=0.1, description="s: what is added to it a metre [-]")
    resolution: float = Field(default=0.0, ge=0.0, le=10.0, description="least step of a distance [m]")
    dropped: float = Field(default=0.0, ge=0.0, lt=1.0, description="part of the returns that is lost [-]")

    @property
    def reach(self) -> float:
        """Nothing that is farther is ever read [m]."""
        return self.range + DEVIATIONS * float(self.deviation(self.range)) + self.resolution

    def deviation(self, distance: float | FloatArray) -> FloatArray:
        """Of the error at distances, of their shape [m]."""
        return np.asarray(np.hypot(self.noise, self.noise_per_metre * np.asarray(distance)))

    @model_validator(mode="after")
    def _check_range(self) -> Self:
        if not self.nearest < self.range:
            raise ValueError(f"nearest = {self.nearest}: allowed is less than range = {self.range}")
        return self


class LidarParams(RangingParams):
    """What a data sheet says of a scanner: beams in even steps of azimuth and elevation."""

    columns: int = Field(ge=1, le=4096, description="beams from left to right [-]")
    rows: int = Field(ge=1, le=512, description="beams from top to bottom [-]")
    horizontal_view_deg: float = Field(
        ge=0.0, le=360.0, description="between the outer beams, 360 for all round [degree]"
    )
    vertical_view_deg: float = Field(ge=0.0, le=180.0, description="between the upper and lower beams [degree]")
    pointing_noise_deg: float = Field(
        default=0.0, ge=0.0, le=5.0, description="standard deviation of a beam's direction, each way [degree]"
    )

    @model_validator(mode="after")
    def _check_view(self) -> Self:
        for count, view in (("columns", "horizontal_view_deg"), ("rows", "vertical_view_deg")):
            if getattr(self, count) > 1 and getattr(self, view) == 0.0:
                raise ValueError(f"{view} = 0: allowed is more than 0 with {getattr(self, count)} {count}")
        return self

    @property
    def azimuths(self) -> FloatArray:
        """Of the columns, from left to right (to the left positive), (columns,) [rad]; all round, the last is a step
        from the first.
        """
        whole = self.horizontal_view_deg == 360.0
        return _spread(self.horizontal_view_deg, self.columns + whole)[: self.columns]

    @property
    def elevations(self) -> FloatArray:
        """Of the rows, from top to bottom, (rows,) [rad]."""
        return _spread(self.vertical_view_deg, self.rows)


def _spread(view_deg: float, count: int) -> FloatArray:
    half = 0.5 * math.radians(view_deg)
    return np.linspace(half, -half, count) if count > 1 else np.zeros(1)


@dataclass(frozen=True, eq=False, slots=True)
class Beams:
    """Of one instrument."""

    directions: FloatArray
    """Unit vectors in the frame of its link (x ahead, y left, z up), (n, 3)."""
    spacing: float
    """Angle from beam to beam [rad]."""
    reach: float = math.inf
    """Nothing that is farther is ever read [m]."""
    reflectance: float | None = None
    """Of all that they meet [-]; None: its albedo, as light has it."""


def beams_of(params: LidarParams) -> Beams:
    """Rows from top to bottom, in each the beams from left to right."""
    azimuths, elevations = params.azimuths, params.elevations
    up, across = np.meshgrid(elevations, azimuths, indexing="ij")
    directions = np.stack([np.cos(up) * np.cos(across), np.cos(up) * np.sin(across), np.sin(up)], axis=-1)
    steps = [abs(angles[1] - angles[0]) for angles in (azimuths, elevations) if len(angles) > 1]
    return Beams(directions.reshape(-1, 3), float(min([*steps, WIDEST])), params.reach)


def strayed(directions: FloatArray, deviation: float, random: np.random.Generator) -> FloatArray:
    """Unit vectors, (n, 3), each off by an angle of a standard deviation [rad] in both ways across it."""
    off = directions + deviation * random.standard_normal(directions.shape)
    return np.asarray(off / np.linalg.norm(off, axis=1, keepdims=True))


def is_heard(params: RangingParams, distance: FloatArray, returned: FloatArray) -> NDArray[np.bool_]:
    """Of which beams enough comes back, (n,); distance [m] and ρ cos i [-] of what each meets, (n,)."""
    return np.asarray(distance <= params.range * np.sqrt(returned / params.reflectance))


def measured(
    params: RangingParams, distance: FloatArray, returned: FloatArray, random: np.random.Generator
) -> FloatArray:
    """What is read of each beam [m], (n,); infinite where it is no distance, see above.

    Args:
        distance, returned: as `is_heard` has them, (n,).
    """
    noise, luck = random.standard_normal(len(distance)), random.random(len(distance))
    heard = is_heard(params, distance, returned) & (luck >= params.dropped)
    true = np.where(heard, distance, 0.0)
    read = true + noise * params.deviation(true)
    if params.resolution > 0.0:
        read = params.resolution * np.round(read / params.resolution)
    return np.where(heard, within(params, read), math.inf)


def within(params: RangingParams, read: FloatArray) -> FloatArray:
    """Distances that the instrument can say, of the shape of `read` [m]: infinite for those that it cannot."""
    return np.where(read < params.nearest, -math.inf, np.where(read > params.range, math.inf, read))
