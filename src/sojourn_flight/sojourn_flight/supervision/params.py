"""Parameters of steering, odometry and goal following: the wheels of a machine and the limits of its motion.

Frame: everything is in base_link (x forward, y left), seen from above, with the steering straight. A wheel is a point
at (x, y) that rolls along its heading; a steered wheel turns about a vertical axis, through that same point unless its
pivot says otherwise. Wheels that name the same steering joint are rigid on one body that this joint turns. Angles are
positive to the left. Arrays of wheels are always in the order of `SteeringGeometryParams.wheels`.
"""

import math
from typing import Self

import numpy as np
from pydantic import Field, model_validator

from sojourn_flight.hazards.obstacle_params import ObstacleParams
from sojourn_flight.mobility.wheel_spin import WheelSpinParams
from sojourn_flight.mobility.wheel_table import wheel_table
from sojourn_flight.odometry.slip_params import SlipParams
from sojourn_flight.odometry.terrain_match_params import TerrainMatchParams
from sojourn_flight.planning.energy_params import EnergyParams
from sojourn_flight.supervision.slip_policy import SlipPolicyParams
from sojourn_machine.params import FloatArray, Params

SMALLEST_BASE = 1e-3
"""Two wheels must be at least this far apart [m], or the yaw rate cannot be told from the wheels."""


class WheelGeometry(Params):
    """One wheel, seen from above."""

    name: str = Field(..., min_length=1, description="name of the wheel, for example front_left")
    x: float = Field(..., ge=-100.0, le=100.0, description="position forward of base_link [m]")
    y: float = Field(..., ge=-100.0, le=100.0, description="position to the left of base_link [m]")
    radius: float = Field(..., gt=0.0, le=10.0, description="rolling radius [m]")
    steered: bool = Field(..., description="true if a motor turns the wheel's heading")
    steer_min: float = Field(0.0, ge=-2 * math.pi, le=2 * math.pi, description="smallest steer angle [rad]")
    steer_max: float = Field(0.0, ge=-2 * math.pi, le=2 * math.pi, description="largest steer angle [rad]")
    pivot_x: float | None = Field(
        default=None, ge=-100.0, le=100.0, description="steering axis; none: through the wheel [m]"
    )
    pivot_y: float | None = Field(
        default=None, ge=-100.0, le=100.0, description="steering axis; none: through the wheel [m]"
    )
    steer_joint: str | None = Field(default=None, min_length=1, description="what turns it; wheels may share one")
    roller_angle: float | None = Field(
        default=None,
        ge=-math.pi / 2,
        le=math.pi / 2,
        description="axle to roller axis, towards ahead; none: no rollers [rad]",
    )
    max_rate: float | None = Field(
        default=None, gt=0.0, le=1e3, description="of its drive motor; none: the machine's [rad/s]"
    )
    max_steer_rate: float | None = Field(
        default=None, gt=0.0, le=1e3, description="of its steering; none: likewise [rad/s]"
    )

    @property
    def pivot(self) -> tuple[float, float]:
        """Steering axis in base_link [m]; the origin for a fixed wheel."""
        if not self.steered:
            return 0.0, 0.0
        return self.x if self.pivot_x is None else self.pivot_x, self.y if self.pivot_y is None else self.pivot_y

    @property
    def steer_group(self) -> str | None:
        """What turns the wheel, by a name that rigid neighbours share; none for a fixed wheel."""
        return (self.steer_joint or self.name) if self.steered else None

    @model_validator(mode="after")
    def _limits_fit(self) -> Self:
        if self.steered and not self.steer_min < self.steer_max:
            raise ValueError(
                f"wheel {self.name}: steer_min = {self.steer_min}, allowed is less than steer_max = {self.steer_max}"
            )
        if not self.steered and (self.steer_min != 0.0 or self.steer_max != 0.0):
            raise ValueError(f"wheel {self.name}: steer limits of a fixed wheel must both be 0")
        if self.roller_angle == 0.0:
            raise ValueError(f"wheel {self.name}: roller_angle = 0, allowed is another: these rollers carry no wheel")
        return self


class SteeringGeometryParams(Params):
    """The wheels of a machine. Their order is the order of every array of wheels in this chapter."""

    wheels: tuple[WheelGeometry, ...] = Field(..., min_length=2, max_length=64, description="wheels, two or more")

    @model_validator(mode="after")
    def _wheels_differ(self) -> Self:
        names = [wheel.name for wheel in self.wheels]
        if len(set(names)) != len(names):
            raise ValueError(f"wheel names must differ, got {names}")
        first = self.wheels[0]
        base = max(math.hypot(wheel.x - first.x, wheel.y - first.y) for wheel in self.wheels)
        if base < SMALLEST_BASE:
            raise ValueError(f"wheels must be at least {SMALLEST_BASE} m apart, largest distance is {base} m")
        joints: dict[str, tuple[object, ...]] = {}
        for wheel in self.wheels:
            axis = (*wheel.pivot, wheel.steer_min, wheel.steer_max)
            if wheel.steer_joint and joints.setdefault(wheel.steer_joint, axis) != axis:
                raise ValueError(f"wheel {wheel.name}: pivot and limits must be those of all on {wheel.steer_joint}")
        return self

    @model_validator(mode="after")
    def _motion_is_observable(self) -> Self:
        rows = []
        for wheel in self.wheels:
            side = 0.0 if wheel.roller_angle is None else 1.0 / math.tan(wheel.roller_angle)
            rows.append((1.0, side, side * wheel.x - wheel.y))
            if wheel.roller_angle is None:
                rows.append((0.0, 1.0, wheel.x))
        if np.linalg.matrix_rank(np.array(rows)) < len(rows[0]):
            raise ValueError("wheels: their rollers leave a motion free; allowed are angles that hold all three")
        return self

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the wheels, in order."""
        return tuple(wheel.name for wheel in self.wheels)

    @property
    def steered(self) -> tuple[bool, ...]:
        """True for each wheel that can be steered, in order."""
        return tuple(wheel.steered for wheel in self.wheels)

    def table(self, track_ratio: float = 1.0) -> FloatArray:
        """Array for the kernels, one row a wheel, see `wheel_table`."""
        return wheel_table(self.wheels, track_ratio)


class MotionLimits(Params):
    """What the machine may be asked to do."""

    max_speed: float = Field(..., gt=0.0, le=10.0, description="fastest speed over ground [m/s]")
    max_yaw_rate: float = Field(..., gt=0.0, le=5.0, description="fastest turn [rad/s]")
    max_wheel_rate: float = Field(..., gt=0.0, le=500.0, description="fastest wheel rotation [rad/s]")
    max_steer_rate: float = Field(..., gt=0.0, le=20.0, description="fastest steering rotation [rad/s]")
    max_steer_acceleration: float = Field(
        ..., gt=0.0, le=200.0, description="speeding up and slowing down of the steering [rad/s^2]"
    )
    max_acceleration: float = Field(..., gt=0.0, le=20.0, description="speeding up of a wheel at its rim [m/s^2]")
    max_deceleration: float = Field(..., gt=0.0, le=20.0, description="slowing down of a wheel at its rim [m/s^2]")


class SteeringTransitionParams(Params):
    """How the wheels slow down while the steering is not where it should be."""

    full_speed_error: float = Field(..., ge=0.0, le=1.0, description="steer error up to which wheels roll freely [rad]")
    stop_error: float = Field(..., gt=0.0, le=3.2, description="steer error from which wheels stand still [rad]")
    rolling_speed: float = Field(
        ...,
        gt=0.0,
        le=1.0,
        description="rim speed below which a wheel counts as standing for large steer moves [m/s]",
    )
    stuck_timeout: float = Field(
        ..., gt=0.0, le=3600.0, description="waiting time for the steering after which a goal is given up [s]"
    )
    steering_at_stand: bool = Field(
        default=True, description="true if wheels may be steered at a stand when a motion needs it; else only rolling"
    )

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if not self.full_speed_error < self.stop_error:
            raise ValueError(
                f"full_speed_error = {self.full_speed_error}: allowed is less than stop_error = {self.stop_error}"
            )
        return self


class MotorWatchParams(Params):
    """When a motor counts as failed."""

    steer_error: float = Field(
        default=0.06, gt=0.0, le=0.5, description="off its command by more than this, a steering does not follow [rad]"
    )
    steer_time: float = Field(default=3.0, gt=0.0, le=60.0, description="so long, and it has failed [s]")
    rate_error: float = Field(
        default=0.1, gt=0.0, le=1.0, description="off its command by more than this part, a wheel does not follow [-]"
    )
    drive_time: float = Field(default=2.0, gt=0.0, le=60.0, description="so long, and its motor has failed [s]")


class OdometryParams(Params):
    """How far wheels and gyro can be trusted. Sigmas are standard deviations."""

    lateral_weight: float = Field(
        ...,
        ge=1e-6,
        le=1.0,
        description="weight of 'a wheel does not slide sideways' against 'a wheel rolls' [-]",
    )
    plausible_wheel_rate: float = Field(
        ..., gt=0.0, le=1000.0, description="rate above which a step of an encoder is not motion [rad/s]"
    )
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

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if not self.align_tolerance < self.realign_angle:
            raise ValueError(
                f"align_tolerance = {self.align_tolerance}: allowed is less than realign_angle = {self.realign_angle}"
            )
        return self


class DriveParams(Params):
    """Everything the drive node's model needs besides the wheels' geometry."""

    cmd_vel_timeout: float = Field(..., gt=0.0, le=10.0, description="age at which a twist command is dropped [s]")
    track_ratio: float = Field(
        default=1.0,
        ge=1.0,
        le=5.0,
        description="distance of the free-rolling centres over the track, of wheels that scrub in a turn [-]",
    )
    slip_feed_forward: bool = Field(
        default=True, description="true if wheels turn faster by the slip that the odometry expects"
    )
    limits: MotionLimits = Field(..., description="what the machine may be asked to do")
    transition: SteeringTransitionParams = Field(..., description="slowing down while steering")
    motors: MotorWatchParams = Field(default=MotorWatchParams(), description="when a motor counts as failed")
    odometry: OdometryParams = Field(..., description="trust in wheels and gyro")
    heading_fix: HeadingFixParams | None = Field(None, description="trust in the sun sensor; none: it is not used")
    slip: SlipParams | None = Field(None, description="slip from torques; none: the expected one is taken")
    slip_policy: SlipPolicyParams | None = Field(None, description="what slip means for a goal; none: only the stop")
    spin: WheelSpinParams | None = Field(None, description="when wheels spin; none: the accelerometer is not asked")
    terrain_match: TerrainMatchParams | None = Field(
        None, description="odometry from the hazard camera; none: its clouds are for obstacles only"
    )
    follower: GoalFollowerParams = Field(..., description="approach to goals")
    obstacles: ObstacleParams | None = Field(None, description="obstacle handling; left out: it avoids nothing")
    energy: EnergyParams | None = Field(None, description="what driving costs; none: no forecast")
