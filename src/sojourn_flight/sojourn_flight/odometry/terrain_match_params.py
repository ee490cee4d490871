"""Parameters of terrain-relative odometry: see `terrain_match` and `key_frames`."""

from typing import Self

from pydantic import Field, model_validator

from sojourn_flight.odometry.relative_fix_params import RelativeFixParams


class TerrainMatchParams(RelativeFixParams):
    """How clouds of the hazard camera are matched with the ground seen before. Sigmas are standard deviations."""

    range: float = Field(gt=0.0, le=100.0, description="points farther from the camera are left out [m]")
    radius: float = Field(gt=0.01, le=10.0, description="round each node whose points make its plane [m]")
    cell: float = Field(gt=0.005, le=5.0, description="distance of the nodes of the surface [m]")
    clouds: int = Field(ge=1, le=50, description="looks that make the surface of a key frame [-]")
    spacing: float = Field(gt=0.0, le=100.0, description="way after which there is a new key frame [m]")
    turn: float = Field(gt=0.0, le=3.2, description="turn after which there is a new key frame [rad]")
    least_step: float = Field(gt=0.0, le=10.0, description="way or turn from one match to the next [m or rad]")
    least_points: int = Field(ge=20, le=100_000, description="points that a match needs [-]")
    sharing: float = Field(ge=1.0, le=100.0, description="points that share one error of the surface [-]")
    tilt_sigma: float = Field(gt=0.0, le=0.2, description="error of roll and pitch against the key frame's [rad]")
    reference_sigma: float = Field(ge=0.0, le=1.0, description="error of a key frame's surface as a whole [m]")
    misfit: float = Field(
        gt=1.0, le=100.0, description="mean square of the residuals, over their variance, at most [-]"
    )

    @model_validator(mode="after")
    def _check(self) -> Self:
        if not self.cell <= self.radius:
            raise ValueError(f"cell = {self.cell}: allowed is at most radius = {self.radius}")
        if not self.least_step <= self.spacing:
            raise ValueError(f"least_step = {self.least_step}: allowed is at most spacing = {self.spacing}")
        return self
