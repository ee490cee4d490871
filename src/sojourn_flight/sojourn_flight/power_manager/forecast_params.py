"""Parameters of the forecast of power and charge (`forecast`)."""

from pydantic import Field

from sojourn_machine.params import Params


class ForecastParams(Params):
    """How far it looks, and how wrong it may be."""

    hours: float = Field(default=24.0, gt=0.0, le=1000.0, description="how far it looks ahead [h]")
    step: float = Field(default=600.0, ge=1.0, le=7200.0, description="length of its steps [s]")
    charge_sigma: float = Field(
        default=0.02, ge=0.0, le=1.0, description="deviation of a charge that is counted; a filter tells its own [1]"
    )
    light_error: float = Field(default=0.1, ge=0.0, lt=1.0, description="part by which light may be less or more [1]")
    load_error: float = Field(default=0.1, ge=0.0, lt=1.0, description="part by which loads may be more or less [1]")

    @property
    def count(self) -> int:
        """Steps, at least one."""
        return max(round(self.hours * 3600.0 / self.step), 1)
