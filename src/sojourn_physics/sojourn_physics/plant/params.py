"""Parameters of a run of the plant: how it is integrated."""

from typing import Self

from pydantic import Field, model_validator

from sojourn_machine.params import Params
from sojourn_machine.timing import CONTROL_PERIOD_S


class LeapParams(Params):
    """How the clock leaps while the machine rests and its operator waits."""

    longest_s: float = Field(gt=0.0, le=86400.0, description="longest leap [s]")


class SimulationParams(Params):
    """How the plant is integrated."""

    physics_step: float = Field(default=0.001, gt=0.0, le=0.005, description="step of the integrator [s]")
    control_period: float = Field(default=CONTROL_PERIOD_S, gt=0.0, le=1.0, description="time between two commands [s]")
    settle_time: float = Field(
        default=30.0, ge=0.0, le=1000.0, description="longest rest on the ground before the run [s]"
    )

    @model_validator(mode="after")
    def _periods_are_whole_steps(self) -> Self:
        if self.substeps < 1 or abs(self.substeps * self.physics_step - self.control_period) > 1e-9:
            raise ValueError(
                f"control_period = {self.control_period:g}: allowed is a whole multiple of "
                f"physics_step = {self.physics_step:g} s"
            )
        return self

    @property
    def substeps(self) -> int:
        """Physics steps in a control period."""
        return round(self.control_period / self.physics_step)
