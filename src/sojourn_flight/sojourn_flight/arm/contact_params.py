"""Parameters of the arm's guard against contacts that nobody asked for."""

from pydantic import Field

from sojourn_machine.params import Params


class ContactParams(Params):
    """When a motion that is to touch nothing is given up, and how the arm then gives way."""

    force: float = Field(
        default=30.0, gt=0.0, le=1e5, description="felt beyond what there was when the motion began, ends it [N]"
    )
    unknown_share: float = Field(
        default=0.05,
        ge=0.0,
        le=1.0,
        description="of each joint's largest effort by which the model may be wrong: taken for no contact [-]",
    )
    observer_rate: float = Field(
        default=40.0, gt=0.0, le=50.0, description="K of the momentum observer: it lags by 1/K [1/s]"
    )
    released_force: float = Field(
        default=2.0, ge=0.0, le=1e4, description="contact force that an arm which gives way leaves [N]"
    )
    damping: float = Field(
        default=1500.0, gt=0.0, le=1e6, description="force at the tip per speed with which the arm gives way [N s/m]"
    )
    max_speed: float = Field(default=0.03, gt=0.0, le=1.0, description="of the tip while the arm gives way [m/s]")
    approach_speed: float | None = Field(
        default=None, gt=0.0, le=10.0, description="of the tip on its last stretch to a place [m/s]; null: any"
    )
    least_wheel_load: float = Field(
        default=0.3,
        ge=0.0,
        lt=1.0,
        description="share of its load without contact that every wheel keeps while the arm presses [-]",
    )
