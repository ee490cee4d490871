"""Parameters of a run of the plant: how it is integrated, and what fails in it."""

from typing import Literal, Self

from pydantic import Field, model_validator

from sojourn_machine.params import Params
from sojourn_machine.timing import CONTROL_PERIOD_S


class FaultParams(Params):
    """One motor that fails."""

    joint: str = Field(min_length=1, description="joint with a motor")
    kind: Literal["locked", "dead"] = Field(description="locked: holds its angle; dead: gives no torque")
    at_s: float = Field(ge=0.0, le=1e6, description="simulated time at which it fails [s]")
    angle_deg: float | None = Field(
        default=None, ge=-360.0, le=360.0, description="angle at which it locks; none: where it is [degree]"
    )

    @model_validator(mode="after")
    def _only_a_lock_has_an_angle(self) -> Self:
        if self.kind == "dead" and self.angle_deg is not None:
            raise ValueError(f"angle_deg = {self.angle_deg:g} of {self.joint}: only a locked joint has an angle")
        return self


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
