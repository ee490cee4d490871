"""Schema of `config/rovers/NAME.yaml`: the machine beside its URDF, and the names of its other sets."""

import math
from typing import Annotated, Self

from pydantic import Field, model_validator

from sojourn_machine.machine import MachineParams
from sojourn_machine.params import Params

Length = Annotated[float, Field(ge=-100.0, le=100.0)]
Angle = Annotated[float, Field(ge=-2.0 * math.pi, le=2.0 * math.pi)]


class ArmMountParams(Params):
    """Where an arm that has a URDF of its own is bolted on."""

    link: str = Field(default="base_link", min_length=1, description="link of the machine that carries the arm")
    xyz: tuple[Length, Length, Length] = Field(
        default=(0.0, 0.0, 0.0), description="place of the arm's first link in it [m]"
    )
    rpy: tuple[Angle, Angle, Angle] = Field(
        default=(0.0, 0.0, 0.0), description="roll, pitch and yaw of the arm's first link in it [rad]"
    )
    prefix: str = Field(
        default="arm_",
        pattern=r"^([a-z][a-z0-9_]*_)?$",
        max_length=40,
        description="with which names of the arm's joints and links begin on this machine: lower case, ends with _",
    )


class RoverConfig(MachineParams):
    """One machine. It is also the plant's parameter set: wheels, pads, drives, couplings."""

    description: str = Field(min_length=1, description="what machine this is")
    mass: float | None = Field(
        default=None, gt=0.0, le=1e6, description="what the machine should weigh, against the sum of the URDF [kg]"
    )
    urdf: str = Field(min_length=1, description="file in urdf/, or a path from this file")
    battery: str = Field(min_length=1, description="name in config/power")
    loads: str = Field(min_length=1, description="loads on the bus: name in config/power")
    power_manager: str = Field(min_length=1, description="law of the power manager: name in config/power")
    sensors: str = Field(min_length=1, description="name in config/sensors")
    arm: str | None = Field(default=None, min_length=1, description="name in config/arms; left out: it has no arm")
    tool: str | None = Field(
        default=None, min_length=1, description="at the end of the arm: name in config/tools; left out: none"
    )
    arm_mount: ArmMountParams | None = Field(
        default=None, description="where the arm is bolted on; left out: the machine's own URDF has it"
    )
    drive: str | None = Field(
        default=None,
        min_length=1,
        description="goal follower, limits, odometry: name in config/nodes; of a machine with wheels",
    )

    @model_validator(mode="after")
    def _parts_fit(self) -> Self:
        if self.wheels and self.drive is None:
            raise ValueError("drive: missing: allowed is a name in config/nodes, for a machine with wheels")
        if self.fixed_base and self.drive is not None:
            raise ValueError(f"drive = {self.drive!r}: allowed is none for a machine that stands fast")
        if self.fixed_base and self.arm is None:
            raise ValueError("arm: missing: without one nothing moves on a fixed base")
        if self.arm_mount is not None and self.arm is None:
            raise ValueError("arm_mount without arm: allowed is both")
        return self
