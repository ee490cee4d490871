"""Parameters of a machine that rolls, on wheels or on tracks: `drive.mobility` of kind rolling."""

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Literal, Self

from pydantic import Field, model_validator

from sojourn_flight.mobility.choice import MobilityChoice
from sojourn_flight.mobility.wheel_spin_params import WheelSpinParams
from sojourn_flight.odometry.slip_params import SlipParams
from sojourn_machine.body import JointPlace, MachineBody
from sojourn_machine.machine import MachineParams
from sojourn_machine.params import Params

if TYPE_CHECKING:
    from sojourn_flight.mobility.rolling import RollingMobility
    from sojourn_flight.supervision.params import DriveParams


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


class RollingParams(MobilityChoice):
    """Everything about wheels and tracks that their geometry does not say."""

    kind: Literal["rolling"] = Field(default="rolling", description="wheels, steered or not, and tracks")
    max_wheel_rate: float = Field(..., gt=0.0, le=500.0, description="fastest wheel rotation [rad/s]")
    max_steer_rate: float = Field(..., gt=0.0, le=20.0, description="fastest steering rotation [rad/s]")
    max_steer_acceleration: float = Field(
        ..., gt=0.0, le=200.0, description="speeding up and slowing down of the steering [rad/s^2]"
    )
    track_ratio: float = Field(
        default=1.0,
        ge=1.0,
        le=5.0,
        description="distance of the free-rolling centres over the track, of wheels that scrub in a turn [-]",
    )
    slip_feed_forward: bool = Field(
        default=True, description="true if wheels turn faster by the slip that the odometry expects"
    )
    lateral_weight: float = Field(
        ...,
        ge=1e-6,
        le=1.0,
        description="weight of 'a wheel does not slide sideways' against 'a wheel rolls' [-]",
    )
    plausible_wheel_rate: float = Field(
        ..., gt=0.0, le=1000.0, description="rate above which a step of an encoder is not motion [rad/s]"
    )
    transition: SteeringTransitionParams = Field(..., description="slowing down while steering")
    motors: MotorWatchParams = Field(default=MotorWatchParams(), description="when a motor counts as failed")
    slip: SlipParams | None = Field(None, description="slip from torques; none: the expected one is taken")
    spin: WheelSpinParams | None = Field(None, description="when wheels spin; none: the accelerometer is not asked")

    def joints(self, machine: MachineParams) -> tuple[str, ...]:
        """Drive joints of wheels and tracks in their order, then the steering joints, each once."""
        return (*(one.joint for one in machine.rolling), *machine.steer_joints)

    def excesses(self, machine: MachineParams, joints: Mapping[str, JointPlace]) -> Iterator[tuple[str, float, float]]:
        """See MobilityChoice: the fastest of the joints counts, slower ones keep to their own limits."""
        for key, value, names in (
            ("max_wheel_rate", self.max_wheel_rate, [wheel.joint for wheel in machine.wheels]),
            ("max_steer_rate", self.max_steer_rate, machine.steer_joints),
        ):
            fastest = max((joints[name].velocity for name in names), default=value)
            if value > fastest:
                yield key, value, fastest

    def build(self, drive: "DriveParams", body: MachineBody) -> "RollingMobility":
        """See MobilityChoice."""
        from sojourn_flight.mobility.rolling import RollingMobility  # here: its kernels and Pinocchio take a while

        return RollingMobility.of(drive, self, body)
