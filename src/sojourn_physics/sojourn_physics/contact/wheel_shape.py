"""A rigid wheel as the soil sees it: rim and grousers. The sets in `config/wheels`."""

from pydantic import Field

from sojourn_machine.params import Params


class WheelShape(Params):
    """One wheel of a test bed or a vehicle. The field names are the keys of the files in `config/wheels`."""

    name: str = Field(min_length=1, pattern=r"^[a-z][a-z0-9_]*$", description="name of the wheel, as its file")
    citation: str = Field(min_length=1, description="where the numbers are from")
    estimates: tuple[str, ...] = Field(default=(), description="fields that no source gives: estimates of ours")
    radius: float = Field(gt=0.0, le=5.0, description="radius of the rim, without grousers [m]")
    width: float = Field(gt=0.0, le=3.0, description="width of the rim [m]")
    grouser_height: float = Field(default=0.0, ge=0.0, le=0.2, description="height of the grousers [m]")
    grouser_count: int = Field(default=0, ge=0, le=500, description="number of grousers on the rim [-]")
    grouser_thickness: float = Field(default=0.0, ge=0.0, le=0.1, description="thickness along the rim [m]")

    @property
    def shear_radius(self) -> float:
        """Radius of the circle on which the soil shears [m]: the tips of the grousers, if there are any."""
        return self.radius + (self.grouser_height if self.grouser_count else 0.0)
