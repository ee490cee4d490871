"""Parameters of the odometry and of the sun sensor's part in it."""

import math

from pydantic import Field

from sojourn_machine.params import Params


class OdometryParams(Params):
    """How far wheels and gyro can be trusted. Sigmas are standard deviations."""

    mean_slip: float = Field(
        ..., ge=-0.5, le=0.9, description="expected slip: ground travel = wheel travel x (1 - mean_slip) [-]"
    )
    slip_per_grade: float = Field(
        default=0.0,
        ge=-5.0,
        le=5.0,
        description="growth of the expected slip with the sine of the grade that is climbed [-]",
    )
    side_slip_per_grade: float = Field(
        default=0.0,
        ge=0.0,
        le=5.0,
        description="expected drift downhill per distance, for the sine of the roll [-]",
    )
    turn_drift_per_grade: float = Field(
        default=0.0,
        ge=0.0,
        le=50.0,
        description="expected drift downhill per radian of a turn on the spot, for the sine of the slope [m/rad]",
    )
    slope_error: float = Field(
        default=0.5,
        ge=0.0,
        le=2.0,
        description="lasting error of all that is expected of a slope, as a part of it: the soil is another [-]",
    )
    slip_sigma: float = Field(..., gt=0.0, le=1.0, description="lasting error of mean_slip [-]")
    side_slip_sigma: float = Field(..., gt=0.0, le=1.0, description="lasting sideways drift per distance [-]")
    slip_length: float = Field(
        ..., gt=0.0, le=1e9, description="distance after which slip and drift are others than before [m]"
    )
    travel_sigma: float = Field(
        ..., gt=0.0, le=1.0, description="random error of travel, per square root of metre [m/m^0.5]"
    )
    turn_sigma: float = Field(
        default=0.0,
        ge=0.0,
        le=1.0,
        description="random error of the position in turning, per square root of radian [m/rad^0.5]",
    )
    wheel_yaw_sigma: float = Field(
        ...,
        gt=0.0,
        le=5.0,
        description="random yaw error without a gyro, per square root of metre [rad/m^0.5]",
    )
    gyro_random_walk: float = Field(..., gt=0.0, le=0.1, description="angle random walk of the gyro [rad/s^0.5]")
    gyro_bias_sigma: float = Field(..., gt=0.0, le=0.1, description="bias of the gyro before it is estimated [rad/s]")
    gyro_bias_walk: float = Field(..., gt=0.0, le=1e-3, description="random walk of the bias [rad/s/s^0.5]")
    start_height_sigma: float = Field(
        default=0.02, gt=0.0, le=1.0, description="error of the height at the start: what supports and soil yield [m]"
    )
    tilt_sigma: float = Field(..., gt=0.0, le=0.5, description="error of roll and pitch [rad]")
    standing_speed: float = Field(..., gt=0.0, le=0.1, description="rim speed below which a wheel stands [m/s]")
    standing_yaw_rate: float = Field(..., gt=0.0, le=0.5, description="gyro rate below which the body stands [rad/s]")
    standing_time: float = Field(
        ..., gt=0.0, le=60.0, description="time of standing after which the gyro bias is estimated [s]"
    )


class HeadingFixParams(Params):
    """Trust in the sun sensor. Sigmas are standard deviations about one axis."""

    noise_sigma: float = Field(..., gt=0.0, le=0.2, description="noise of a sighting [rad]")
    misalignment_sigma: float = Field(..., gt=0.0, le=0.2, description="lasting error of the mounting [rad]")
    levelling_bias_sigma: float = Field(
        ..., gt=0.0, le=0.2, description="error of roll and pitch to which the levelling always goes back [rad]"
    )
    levelling_sigma: float = Field(..., gt=0.0, le=0.2, description="error of roll and pitch that comes and goes [rad]")
    levelling_time: float = Field(..., gt=0.0, le=1e5, description="in this time [s]")
    gate: float = Field(..., gt=1.0, le=10.0, description="standard deviations beyond which a sighting is refused [-]")
    max_elevation: float = Field(
        ..., gt=0.0, lt=0.5 * math.pi, description="a Sun that stands higher gives no heading [rad]"
    )
