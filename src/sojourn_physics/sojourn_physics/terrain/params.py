"""What a scenario says about its ground. The field names are the keys below `terrain:` of a scenario file.

Kinds: `flat`; `slope` (one plane); `step` (two level planes); `generated` (roughness, craters and rocks drawn from a
seed, on a plane that may slope); `file` (a digital elevation model). Features, craters, rocks and patches of soil
placed by hand go on any kind. Map coordinates: x east, y north, metres; height 0 is that of the plane at (0, 0).
"""

import math
from typing import Literal, Self

from pydantic import Field, model_validator

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import Params
from sojourn_physics.terrain.feature_params import FeatureParams, SoilPatchParams
from sojourn_physics.terrain.height_field import MAX_NODES, Interpolation
from sojourn_physics.terrain.raster_params import RasterParams

MAX_ROUGH_NODES = 36_000_000
"""Largest grid with roughness [nodes]: it is synthesised on one four times as large, which takes 3 GB here."""


class RoughnessParams(Params):
    """Fractal roughness: see `terrain/roughness.py`."""

    hurst: float = Field(default=0.8, gt=0.0, lt=1.0, description="Hurst exponent [-]")
    rms_slope_deg: float = Field(ge=0.0, le=30.0, description="RMS slope between points one baseline apart [degree]")
    baseline: float = Field(default=0.5, gt=0.0, le=100.0, description="distance at which that holds [m]")


class CraterLawParams(Params):
    """Craters drawn at random: see `terrain/craters.py`."""

    diameter_min: float = Field(default=0.5, gt=0.0, le=1000.0, description="smallest rim diameter [m]")
    diameter_max: float = Field(default=6.0, gt=0.0, le=1000.0, description="largest rim diameter [m]")
    density_at_1m: float = Field(
        default=0.0794, ge=0.0, le=10.0, description="craters of 1 m and more on a square metre [1/m2]"
    )
    exponent: float = Field(default=2.0, gt=0.0, le=6.0, description="b of N(>= D) = density_at_1m D^-b [-]")
    fresh_depth_ratio: float = Field(
        default=0.17,
        gt=0.0,
        le=0.3,
        description="depth of a new crater, from the old surface, over its diameter [-]",
    )
    rim_ratio: float = Field(default=0.036, ge=0.0, le=0.1, description="rim height over diameter of a new crater [-]")
    age_min: float = Field(default=0.0, ge=0.0, le=1.0, description="age of the freshest: 0 is new, 1 nearly gone [-]")

    @model_validator(mode="after")
    def _range_is_ordered(self) -> Self:
        if self.diameter_max <= self.diameter_min:
            allowed = f"more than diameter_min = {self.diameter_min:g} m"
            raise InvalidValueError("diameter_max", self.diameter_max, allowed)
        return self


class RockLawParams(Params):
    """Rocks drawn at random: see `terrain/rocks.py`."""

    area_fraction: float = Field(ge=0.0, le=0.5, description="k: part of the ground that rocks of all sizes cover [-]")
    diameter_min: float = Field(default=0.15, gt=0.0, le=50.0, description="smallest diameter [m]")
    diameter_max: float = Field(default=0.5, gt=0.0, le=50.0, description="largest diameter [m]")
    height_ratio: float = Field(
        default=0.5, gt=0.0, le=2.0, description="mean height above the ground over diameter [-]"
    )

    @model_validator(mode="after")
    def _range_is_ordered(self) -> Self:
        if self.diameter_max <= self.diameter_min:
            allowed = f"more than diameter_min = {self.diameter_min:g} m"
            raise InvalidValueError("diameter_max", self.diameter_max, allowed)
        return self


class CraterParams(Params):
    """One crater placed by hand."""

    x: float = Field(description="centre in map [m]")
    y: float = Field(description="centre in map [m]")
    diameter: float = Field(gt=0.0, le=1000.0, description="from rim to rim [m]")
    depth: float = Field(gt=0.0, le=300.0, description="below the ground around, when new [m]")
    rim_height: float | None = Field(
        default=None, ge=0.0, le=100.0, description="above the ground around, when new [m]; else depth / 5"
    )
    age: float = Field(default=0.0, ge=0.0, le=1.0, description="wear: 0 is new, 1 nearly gone [-]")

    @model_validator(mode="after")
    def _depth_is_possible(self) -> Self:
        if self.depth > 0.5 * self.diameter:
            allowed = f"at most half the diameter, {0.5 * self.diameter:g} m"
            raise InvalidValueError("depth", self.depth, allowed)
        return self


class RockParams(Params):
    """One rock placed by hand."""

    x: float = Field(description="centre in map [m]")
    y: float = Field(description="centre in map [m]")
    diameter: float = Field(gt=0.0, le=50.0, description="at the ground [m]")
    height: float = Field(gt=0.0, le=50.0, description="above the ground [m]")


class KeepClearParams(Params):
    """A circle that random rocks and random craters stay out of."""

    x: float = Field(description="centre in map [m]")
    y: float = Field(description="centre in map [m]")
    radius: float = Field(gt=0.0, le=1000.0, description="[m]")


class TerrainParams(Params):
    """The ground of a scenario."""

    kind: Literal["flat", "slope", "step", "generated", "file"] = Field(description="how the ground is made")
    size_x: float = Field(default=40.0, gt=0.0, le=5000.0, description="extent east-west [m]")
    size_y: float = Field(default=40.0, gt=0.0, le=5000.0, description="extent south-north [m]")
    center_x: float = Field(default=0.0, ge=-1e6, le=1e6, description="middle of the map [m]")
    center_y: float = Field(default=0.0, ge=-1e6, le=1e6, description="middle of the map [m]")
    resolution: float = Field(default=0.05, ge=0.005, le=10.0, description="distance of grid nodes [m]")
    slope_deg: float = Field(default=0.0, ge=0.0, le=60.0, description="steepness of the plane [degree]")
    slope_direction_deg: float = Field(
        default=0.0, ge=-360.0, le=360.0, description="uphill direction, from x towards y [degree]"
    )
    step_height: float = Field(default=0.0, ge=-10.0, le=10.0, description="rise, negative for a drop [m]")
    step_x: float = Field(default=0.0, description="ground is raised where x >= step_x [m]")
    step_y: float | None = Field(
        default=None, description="and, where this is given, y >= step_y: one side of the machine only [m]"
    )
    interpolation: Interpolation = Field(default="bilinear", description="of heights between the nodes")
    memory: bool = Field(default=True, description="whether the ground remembers wheels: ruts")
    memory_cell: float = Field(default=0.025, ge=0.005, le=0.5, description="distance of the nodes of that memory [m]")
    file: RasterParams | None = Field(default=None, description="the elevation model, with kind file")
    features: tuple[FeatureParams, ...] = Field(default=(), description="ramps, steps, trenches, side slopes")
    soil_patches: tuple[SoilPatchParams, ...] = Field(default=(), description="where the soil is another one")
    roughness: RoughnessParams | None = Field(default=None, description="fractal roughness")
    crater_law: CraterLawParams | None = Field(default=None, description="random craters")
    rock_law: RockLawParams | None = Field(default=None, description="random rocks")
    craters: tuple[CraterParams, ...] = Field(default=(), description="craters placed by hand")
    rocks: tuple[RockParams, ...] = Field(default=(), description="rocks placed by hand")
    keep_clear: tuple[KeepClearParams, ...] = Field(default=(), description="where nothing random goes")

    @property
    def extra_soils(self) -> tuple[str, ...]:
        """Names of the soils of patches and of the soil raster, each once, in their order."""
        classes = self.file.soil_classes if self.file is not None else ()
        names = [patch.soil for patch in self.soil_patches] + [item.soil for item in classes]
        return tuple(dict.fromkeys(names))

    @property
    def node_counts(self) -> tuple[int, int]:
        """ny, nx: number of grid nodes along y and x. The size is rounded to whole cells."""
        rows = max(1, round(self.size_y / self.resolution)) + 1
        columns = max(1, round(self.size_x / self.resolution)) + 1
        return rows, columns

    @property
    def origin(self) -> tuple[float, float]:
        """x, y of grid node (0, 0) in map [m]."""
        rows, columns = self.node_counts
        return (
            self.center_x - 0.5 * (columns - 1) * self.resolution,
            self.center_y - 0.5 * (rows - 1) * self.resolution,
        )

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """x_min, x_max, y_min, y_max of the ground in map [m]."""
        (rows, columns), (x, y) = self.node_counts, self.origin
        return x, x + (columns - 1) * self.resolution, y, y + (rows - 1) * self.resolution

    @model_validator(mode="after")
    def _fields_fit_the_kind(self) -> Self:
        foreign = {
            "flat": ("slope_deg", "step_height", "roughness", "crater_law", "rock_law", "file"),
            "slope": ("step_height", "roughness", "crater_law", "rock_law", "file"),
            "step": ("slope_deg", "roughness", "crater_law", "rock_law", "file"),
            "generated": ("step_height", "file"),
            "file": ("slope_deg", "step_height"),
        }[self.kind]
        for name in foreign:
            if getattr(self, name) not in (0.0, None):
                allowed = f"nothing: leave it out with terrain kind {self.kind!r}"
                raise InvalidValueError(name, getattr(self, name), allowed)
        if self.kind == "slope" and self.slope_deg == 0.0:
            raise InvalidValueError("slope_deg", self.slope_deg, "more than 0 with terrain kind 'slope'")
        if self.kind == "step" and self.step_height == 0.0:
            raise InvalidValueError("step_height", self.step_height, "not 0 with terrain kind 'step'")
        if self.kind == "file" and self.file is None:
            raise InvalidValueError("file", None, "an elevation model with terrain kind 'file'")
        return self

    @model_validator(mode="after")
    def _features_are_on_the_map(self) -> Self:
        rows, columns = self.node_counts
        if rows * columns > MAX_NODES:
            finest = math.sqrt(self.size_x * self.size_y / MAX_NODES)
            raise InvalidValueError("resolution", self.resolution, f"{finest:.3g} m or more for this map")
        if self.roughness is not None and rows * columns > MAX_ROUGH_NODES:
            finest = math.sqrt(self.size_x * self.size_y / MAX_ROUGH_NODES)
            raise InvalidValueError(
                "resolution", self.resolution, f"{finest:.3g} m or more for this map with roughness"
            )
        x_min, y_min = self.origin
        x_max = x_min + (columns - 1) * self.resolution
        y_max = y_min + (rows - 1) * self.resolution
        placed = [(f"craters[{i}]", crater.x, crater.y) for i, crater in enumerate(self.craters)]
        placed += [(f"rocks[{i}]", rock.x, rock.y) for i, rock in enumerate(self.rocks)]
        for name, x, y in placed:
            if not (x_min <= x <= x_max and y_min <= y <= y_max):
                allowed = f"x from {x_min:g} to {x_max:g} m and y from {y_min:g} to {y_max:g} m"
                raise InvalidValueError(name, (x, y), allowed)
        return self
