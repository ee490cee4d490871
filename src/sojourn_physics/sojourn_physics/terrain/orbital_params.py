"""What a map from orbit is like, see `terrain/orbital.py`."""

from pydantic import Field

from sojourn_machine.params import Params


class OrbitalMapParams(Params):
    """What operators have of the site before the machine is there."""

    cell: float = Field(default=1.0, gt=0.05, le=100.0, description="side of a cell [m]")
    height_error: float = Field(default=0.2, ge=0.0, le=100.0, description="standard deviation of heights [m]")
    error_length: float = Field(default=10.0, gt=0.0, le=1e4, description="over which errors are correlated [m]")
