"""A ground that is read from a file: the keys below `file:` of a terrain. Reading it is
`sojourn_config.raster_file`."""

from typing import Literal, Self

from pydantic import Field, model_validator

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import Params


class SoilClassParams(Params):
    """A number of a soil raster and the soil that it stands for."""

    value: int = Field(ge=-(2**31), lt=2**31, description="number in the raster [-]")
    soil: str = Field(min_length=1, description="name in config/soils")


class RasterParams(Params):
    """A digital elevation model. The terrain's size, centre and resolution say which part of it is used, and how
    fine."""

    path: str = Field(
        min_length=1, description="GeoTIFF, 16-bit PNG or .npy; from the scenario's folder or the working one"
    )
    east: float | None = Field(
        default=None,
        ge=-1e9,
        le=1e9,
        description="of map (0, 0) in the file's projection [m]; else the middle of the file",
    )
    north: float | None = Field(default=None, ge=-1e9, le=1e9, description="as east, northwards [m]")
    cell: float | None = Field(
        default=None,
        ge=0.001,
        le=1000.0,
        description="side of a pixel where the file does not say it [m]; its south-west corner is then 0, 0",
    )
    height_scale: float = Field(default=1.0, gt=0.0, le=1e4, description="metres of a unit of the file [m]")
    height_offset: float | None = Field(
        default=None, ge=-1e5, le=1e5, description="added to the scaled heights [m]; else the map's middle is at 0"
    )
    no_data: float | None = Field(default=None, description="number that marks a hole, beside what the file says")
    fill: Literal["no", "nearest", "linear"] = Field(default="no", description="what to do with holes: no refuses them")
    soil_path: str | None = Field(
        default=None, min_length=1, description="raster of the same area with numbers of soils"
    )
    soil_classes: tuple[SoilClassParams, ...] = Field(default=(), description="the soils of those numbers")

    @model_validator(mode="after")
    def _origin_and_soils_are_whole(self) -> Self:
        if (self.east is None) != (self.north is None):
            name = "north" if self.north is None else "east"
            raise InvalidValueError(name, None, "a number, since the other coordinate is given")
        if (self.soil_path is None) != (not self.soil_classes):
            raise InvalidValueError("soil_path", self.soil_path, "a file together with soil_classes, or neither")
        values = [item.value for item in self.soil_classes]
        if len(set(values)) != len(values):
            raise InvalidValueError("soil_classes", values, "each value once")
        return self
