"""Schemas of the files of a machine, `config/machines/NAME`, and the kinds of machine by name.

A kind is a parameter set of `machine.yaml`, found by what the file says as `kind`. It says what `flight.yaml` holds,
and which set of `config/parts` stands for a file that the machine's folder does not have.
"""

import math
from collections.abc import Mapping
from typing import Annotated, ClassVar, Literal, Self

from pydantic import Field, field_validator, model_validator

from sojourn_flight.power_manager.params import PowerLawParams
from sojourn_flight.supervision.params import DriveParams
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.machine import MachineParams
from sojourn_machine.params import Params
from sojourn_machine.registry import Registry
from sojourn_machine.supports import WheelParams

Length = Annotated[float, Field(ge=-100.0, le=100.0)]
Angle = Annotated[float, Field(ge=-2.0 * math.pi, le=2.0 * math.pi)]


class ArmMountParams(Params):
    """Where an arm is bolted on."""

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
    joint: str | None = Field(
        default=None, min_length=1, description="name of the fixed joint that holds it; left out: PREFIXmount_joint"
    )
    touches: bool = Field(
        default=True, description="the first link that moves is so near what it stands on that it may touch it"
    )

    @property
    def foot(self) -> str:
        """Name of the fixed joint that holds the arm."""
        return self.joint or f"{self.prefix}mount_joint"


class FlightSet(Params):
    """`flight.yaml`: what the machine's own computer goes by."""

    power_manager: PowerLawParams = Field(description="law of the power manager")
    drive: DriveParams | None = Field(default=None, description="limits, odometry, goal follower")


class RoverFlight(FlightSet):
    """Of a machine that drives."""

    drive: DriveParams = Field(description="limits, odometry, goal follower")


class StandFlight(FlightSet):
    """Of a machine that stands fast."""

    whose: ClassVar[str] = "a stand"

    @field_validator("drive", mode="before")
    @classmethod
    def _stands(cls, drive: object) -> None:
        if drive is not None:
            raise InvalidValueError("drive", drive, f"none: {cls.whose} does not drive")


class SpacecraftFlight(StandFlight):
    """Of a machine that floats free."""

    whose: ClassVar[str] = "a spacecraft"


class MachineConfig(MachineParams):
    """`machine.yaml` of any kind. It is also the plant's parameter set: wheels, pads, drives, couplings."""

    flight: ClassVar[type[FlightSet]] = FlightSet
    defaults: ClassVar[Mapping[str, str]] = {}

    kind: str = Field(min_length=1, description="kind of machine")
    description: str = Field(min_length=1, description="what machine this is")
    mass: float | None = Field(
        default=None, gt=0.0, le=1e6, description="what the URDF should weigh, against the sum of its links [kg]"
    )
    urdf: str = Field(min_length=1, description="file in urdf/, or a path from this file")
    arm: str | None = Field(default=None, min_length=1, description="name in config/arms; left out: it has no arm")
    tool: str | None = Field(
        default=None, min_length=1, description="at the end of the arm: name in config/tools; left out: none"
    )
    arm_mount: ArmMountParams | None = Field(
        default=None, description="where the arm is bolted on; left out: the machine's own URDF has it"
    )

    @model_validator(mode="after")
    def _arm_and_mount(self) -> Self:
        if self.arm_mount is not None and self.arm is None:
            raise ValueError("arm_mount without arm: allowed is both")
        return self


class RoverConfig(MachineConfig):
    """A machine that drives on its wheels."""

    flight: ClassVar[type[FlightSet]] = RoverFlight
    defaults: ClassVar[Mapping[str, str]] = {
        "flight": "rover_flight",
        "power": "default_power",
        "sensors": "rover_sensors",
    }

    fixed_base: Literal[False] = False
    floats: Literal[False] = False


class StandConfig(MachineConfig):
    """An arm on a base that stands fast: a plate on the ground, the wall of a station."""

    flight: ClassVar[type[FlightSet]] = StandFlight
    defaults: ClassVar[Mapping[str, str]] = {
        "flight": "stand_flight",
        "power": "stand_power",
        "sensors": "stand_sensors",
    }

    fixed_base: Literal[True] = True
    floats: Literal[False] = False
    wheels: tuple[WheelParams, ...] = Field(default=(), max_length=0, description="a stand has none")

    @model_validator(mode="after")
    def _arm_and_mount(self) -> Self:
        if self.arm is None:
            raise ValueError("arm: missing: without one nothing moves on a fixed base")
        return self


class SpacecraftConfig(MachineConfig):
    """A machine that nothing holds: a spacecraft with an arm, whose base gives way under it."""

    flight: ClassVar[type[FlightSet]] = SpacecraftFlight
    defaults: ClassVar[Mapping[str, str]] = StandConfig.defaults

    fixed_base: Literal[False] = False
    floats: Literal[True] = True
    wheels: tuple[WheelParams, ...] = Field(default=(), max_length=0, description="a spacecraft has none")

    @model_validator(mode="after")
    def _arm_and_mount(self) -> Self:
        if self.arm is None:
            raise ValueError("arm: missing: a spacecraft without one has nothing to move")
        return self


MACHINE_KINDS: Registry[type[MachineConfig]] = Registry("sojourn.machine_kinds", "kind of machine")
"""Parameter sets of `machine.yaml` by the name of the kind; a package adds its own with an entry point."""
