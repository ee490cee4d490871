"""Shapes and soils that a scenario puts on its ground by hand. The field names are the keys below `features:` and
`soil_patches:` of a terrain. Each has a place in map, a heading (from x towards y) and a size; they add up in any
number.
"""

from typing import Annotated, Literal, Self, TypeAlias

from pydantic import Field, model_validator

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import Params


class PlacedParams(Params):
    """What every one of them has."""

    x: float = Field(ge=-1e6, le=1e6, description="place in map [m]")
    y: float = Field(ge=-1e6, le=1e6, description="place in map [m]")
    heading_deg: float = Field(default=0.0, ge=-360.0, le=360.0, description="direction of its length [degree]")
    length: float = Field(gt=0.0, le=5000.0, description="along the heading [m]")
    width: float = Field(gt=0.0, le=5000.0, description="across the heading [m]")


class RampParams(PlacedParams):
    """A ramp: from (x, y), the middle of its foot, up over `length`, level over `plateau`, and down again."""

    kind: Literal["ramp"]
    height: float = Field(ge=-100.0, le=100.0, description="of the top, negative for a dip [m]")
    plateau: float = Field(default=1.0, ge=0.0, le=5000.0, description="length of the top [m]")
    descent: float | None = Field(
        default=None, gt=0.0, le=5000.0, description="length of the way down [m]; else length"
    )


class StepParams(PlacedParams):
    """A raised (or sunken) rectangle with upright walls: (x, y) is the middle of the edge that is met first."""

    kind: Literal["step"]
    height: float = Field(ge=-10.0, le=10.0, description="rise, negative for a drop [m]")


class TrenchParams(PlacedParams):
    """A trench: (x, y) is its middle, `width` that of its bottom, `length` that of its bottom along the heading."""

    kind: Literal["trench"]
    depth: float = Field(gt=0.0, le=100.0, description="below the ground around [m]")
    wall_deg: float = Field(default=60.0, ge=5.0, le=90.0, description="steepness of its walls [degree]")


class SideSlopeParams(PlacedParams):
    """A lane that slopes across: from (x, y), the middle of its beginning, the left side higher by `slope_deg`; beyond
    the high side the ground falls again as steeply. `blend` is the way over which the tilt comes and goes."""

    kind: Literal["side_slope"]
    slope_deg: float = Field(ge=-45.0, le=45.0, description="steepness across, negative for right side high [degree]")
    blend: float = Field(default=1.0, gt=0.0, le=1000.0, description="[m]")

    @model_validator(mode="after")
    def _blends_fit(self) -> Self:
        if 2.0 * self.blend > self.length:
            raise InvalidValueError("blend", self.blend, f"at most half the length, {0.5 * self.length:g} m")
        return self


FeatureParams: TypeAlias = Annotated[
    RampParams | StepParams | TrenchParams | SideSlopeParams, Field(discriminator="kind")
]


class SoilPatchParams(PlacedParams):
    """A rectangle (or an ellipse) of another soil, (x, y) its middle. Later ones lie on earlier ones, rocks on all."""

    soil: str = Field(min_length=1, description="name in config/soils")
    shape: Literal["rectangle", "ellipse"] = Field(default="rectangle", description="outline")
