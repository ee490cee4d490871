"""The ellipsoid that stands for the surface of a body: altitudes are counted from it, verticals are its normals."""

from typing import Self

from pydantic import Field, model_validator

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import Params


class ShapeParams(Params):
    """Reference ellipsoid. x points to longitude 0, z to the pole about which the body turns."""

    semi_axes: tuple[float, float, float] = Field(description="along x, y and z, the longest first [m]")

    @model_validator(mode="after")
    def _longest_first(self) -> Self:
        a, b, c = self.semi_axes
        if not a >= b >= c > 0.0:
            raise InvalidValueError("semi_axes", self.semi_axes, "three lengths above 0, the longest first")
        return self

    @property
    def volumetric_radius(self) -> float:
        """Of the sphere of the same volume [m]."""
        a, b, c = self.semi_axes
        return float((a * b * c) ** (1.0 / 3.0))
