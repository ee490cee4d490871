"""The sensor suite of a machine as one parameter set."""

from typing import Literal, Self

from pydantic import Field, model_validator

from sojourn_machine.params import Params
from sojourn_physics.sensors.bus import BusTelemetryParams
from sojourn_physics.sensors.encoder import EncoderParams
from sojourn_physics.sensors.hazcam import HazcamParams
from sojourn_physics.sensors.imu import ImuParams
from sojourn_physics.sensors.sun_sensor import SunSensorParams
from sojourn_physics.sensors.wrench import WrenchSensorParams


class JointGroupParams(Params):
    """Joints with the same encoder and the same measurement of effort (from motor current)."""

    joints: tuple[str, ...] = Field(min_length=1, description="names of the joints, as in the URDF")
    encoder: EncoderParams = Field(description="encoder of each joint")
    effort_resolution: float = Field(gt=0.0, le=1e4, description="step of the measured joint effort [N m]")
    effort_noise: float = Field(ge=0.0, le=1e4, description="standard deviation of the measured effort [N m]")


class SensorSuiteParams(Params):
    """Encoders by joint group, IMU, bus telemetry and, where it has one, a hazard camera and the wrist's force sensor.

    A joint that is in no group is not measured.
    """

    joint_groups: dict[str, JointGroupParams] = Field(default_factory=dict, description="group name to its joints")
    imu: ImuParams = Field(description="the inertial measurement unit")
    bus: BusTelemetryParams = Field(description="telemetry channels of every energy store")
    wrist: WrenchSensorParams | None = Field(
        default=None, description="force/torque sensor of the arm's wrist, or none"
    )
    sun: SunSensorParams | None = Field(default=None, description="the sun sensor, if there is one")
    hazcam: HazcamParams | None = Field(default=None, description="stereo camera for hazards; left out: it has none")

    powered_by: dict[Literal["imu", "sun", "hazcam", "wrist"], str] = Field(
        default_factory=dict, description="load of the bus that feeds each sensor; one that is left out always works"
    )

    @model_validator(mode="after")
    def _check(self) -> Self:
        seen: dict[str, str] = {}
        for name, group in self.joint_groups.items():
            for joint in group.joints:
                if joint in seen:
                    raise ValueError(f"joint {joint!r} is in {seen[joint]!r} and {name!r}: allowed is one group")
                seen[joint] = name
        return self
