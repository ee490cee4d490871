"""Parameters of all relative fixes: see `relative_fix`."""

from pydantic import Field

from sojourn_machine.params import Params


class RelativeFixParams(Params):
    """What a way that a camera has seen may say of slip. Sigmas are standard deviations."""

    gate: float = Field(gt=1.0, le=10.0, description="standard deviations beyond which the slip is not as believed [-]")
    slip_walk: float = Field(
        ge=0.0, le=1.0, description="change of the believed slip's error, per square root of metre [1/m^0.5]"
    )
    lost_slip: float = Field(gt=0.0, le=2.0, description="slip and drift that are then thought possible, sigma [-]")
