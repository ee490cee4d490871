"""Parameters of the goal follower."""

from typing import Self

from pydantic import Field, model_validator

from sojourn_machine.params import Params


class GoalFollowerParams(Params):
    """How goals are approached and when they are met."""

    position_tolerance: float = Field(..., gt=0.0, le=10.0, description="a goal is met within this distance [m]")
    yaw_tolerance: float = Field(..., gt=0.0, le=3.2, description="a goal heading is met within this angle [rad]")
    arrive_fraction: float = Field(
        ..., gt=0.0, le=1.0, description="driving ends at this fraction of the position tolerance [-]"
    )
    corner_cut: float = Field(..., gt=0.0, le=50.0, description="a waypoint is passed within this distance [m]")
    max_curvature: float = Field(
        ..., gt=0.0, le=20.0, description="sharpest curve while driving, if the steering can [1/m]"
    )
    planned_curvature: float = Field(..., gt=0.0, le=1.0, description="part of it that paths may ask for [-]")
    lateral_length: float = Field(..., gt=0.0, le=100.0, description="distance that takes out a lateral error [m]")
    heading_length: float = Field(..., gt=0.0, le=100.0, description="distance that takes out a course error [m]")
    align_tolerance: float = Field(..., gt=0.0, le=0.5, description="a point turn ends within this angle [rad]")
    realign_angle: float = Field(..., gt=0.0, le=1.5, description="bearing from which a point turn is made [rad]")
    yaw_gain: float = Field(..., gt=0.0, le=10.0, description="turn rate per heading error in a point turn [1/s]")
    distance_gain: float = Field(..., gt=0.0, le=10.0, description="speed per distance near a stop [1/s]")
    approach_speed: float = Field(..., gt=0.0, le=1.0, description="slowest speed of an approach [m/s]")
    stop_time: float = Field(
        default=0.9,
        gt=0.0,
        le=10.0,
        description="braking from approach_speed at the end of a way; one period of the body's rocking on soil [s]",
    )
    progress_distance: float = Field(..., gt=0.0, le=10.0, description="gain that counts as progress [m]")
    progress_angle: float = Field(..., gt=0.0, le=1.0, description="turn that counts as progress [rad]")
    progress_timeout: float = Field(..., gt=0.0, le=86400.0, description="time without progress that ends a goal [s]")
    settle_timeout: float = Field(..., gt=0.0, le=600.0, description="longest wait for standing still at the goal [s]")
    settle_attempts: int = Field(..., ge=1, le=100, description="approaches after which a goal is given up [-]")
    max_range: float = Field(..., gt=0.0, le=1e5, description="longest path to a goal [m]")
    max_waypoints: int = Field(..., ge=1, le=100_000, description="most points of a path [-]")

    @property
    def room(self) -> float:
        """By how much a machine that has arrived may be found elsewhere, and its goal is met [m]."""
        return (1.0 - self.arrive_fraction) * self.position_tolerance

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if not self.align_tolerance < self.realign_angle:
            raise ValueError(
                f"align_tolerance = {self.align_tolerance}: allowed is less than realign_angle = {self.realign_angle}"
            )
        return self
