"""Parameters of visual odometry: see `visual_odometry`."""

from typing import Self

from pydantic import Field, model_validator

from sojourn_flight.odometry.relative_fix_params import RelativeFixParams


class VisualOdometryParams(RelativeFixParams):
    """How images of a stereo pair are used. Sigmas are standard deviations."""

    camera: str = Field(min_length=1, description="name of the stereo pair in sensors.yaml")
    step: float = Field(gt=0.0, le=10.0, description="way after which a look is compared with the key frame [m]")
    turn: float = Field(gt=0.0, le=1.0, description="turn after which it is [rad]")
    corners: int = Field(ge=20, le=5000, description="corners of a key frame, at most [-]")
    window: int = Field(ge=5, le=63, description="width of what is followed of a corner, odd [px]")
    search: int = Field(ge=0, le=200, description="how far from its expected place a point is searched for [px]")
    nearest: float = Field(gt=0.0, le=100.0, description="depth of the nearest ground in view [m]")
    least_points: int = Field(ge=6, le=5000, description="points that have to agree on a motion [-]")
    least_share: float = Field(gt=0.0, le=1.0, description="of the points that were followed, likewise [-]")
    outlier: float = Field(gt=0.0, le=20.0, description="distance from its predicted place of one that does not [px]")
    tracking_sigma: float = Field(gt=0.0, le=5.0, description="error of a place, at least [px]")
    sharing: float = Field(ge=1.0, le=100.0, description="points that share one error of tracking [-]")
    scale_sigma: float = Field(
        ge=0.0, le=0.1, description="error of a way and a turn over them, of lens and baseline [-]"
    )
    tilt_sigma: float = Field(gt=0.0, le=0.2, description="error of roll and pitch at the key frame [rad]")

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.window % 2 == 0:
            raise ValueError(f"window = {self.window}: allowed is an odd number")
        return self
