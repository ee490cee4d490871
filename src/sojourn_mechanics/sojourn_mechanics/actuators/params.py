"""Parameters of a joint's drive: motor, gear, servo. A joint without a motor has friction alone."""

from typing import Literal, Self

from pydantic import Field, model_validator

from sojourn_mechanics.params import Params


class MotorParams(Params):
    """Permanent-magnet DC motor (or brushless with its amplifier, as seen from the supply)."""

    resistance: float = Field(gt=0.0, le=1e4, description="winding resistance [ohm]")
    torque_constant: float = Field(
        gt=0.0, le=10.0, description="torque constant, equal to the back-EMF constant [N m/A]"
    )
    rotor_inertia: float = Field(gt=0.0, le=1.0, description="rotor inertia, brake and encoder included [kg m^2]")
    no_load_current: float = Field(ge=0.0, le=10.0, description="current at no load, from friction in the motor [A]")
    max_current: float = Field(gt=0.0, le=500.0, description="largest current that the amplifier gives [A]")


class GearParams(Params):
    """Reduction gear."""

    ratio: float = Field(ge=1.0, le=1e5, description="motor turns for one output turn [-]")
    efficiency: float = Field(gt=0.0, le=1.0, description="efficiency under load [-]")
    friction_torque: float = Field(ge=0.0, le=1e4, description="Coulomb friction at the output, without load [N m]")
    viscous_friction: float = Field(ge=0.0, le=1e5, description="viscous friction at the output [N m s/rad]")


class JointFrictionParams(Params):
    """Friction of a joint without a motor (rockers, bogies)."""

    friction_torque: float = Field(ge=0.0, le=1e4, description="Coulomb friction [N m]")
    viscous_friction: float = Field(ge=0.0, le=1e5, description="viscous friction [N m s/rad]")


class ServoParams(Params):
    """Motor controller, closed on the angle that its encoder sees and the motor's rate, at the physics rate."""

    mode: Literal["rate", "position"] = Field(description="what it holds: the commanded rate, or position and rate")
    proportional: float = Field(
        ge=0.0,
        le=1e7,
        description="rate: torque for a rate error [N m s/rad]; position: for a position error [N m/rad]",
    )
    integral: float = Field(
        default=0.0,
        ge=0.0,
        le=1e7,
        description="rate: torque for an angle error [N m/rad]; position: [N m/(rad s)]",
    )
    derivative: float = Field(default=0.0, ge=0.0, le=1e6, description="position: torque for a rate error [N m s/rad]")
    max_torque: float = Field(gt=0.0, le=1e5, description="largest torque that it asks for at the output [N m]")
    encoder: Literal["motor", "joint"] = Field(
        default="motor", description="shaft whose angle it is closed on; they differ where the gear has play"
    )


class PlayParams(Params):
    """Play and give of a gear. Where it is left out, motor and joint turn as one."""

    backlash: float = Field(ge=0.0, le=0.2, description="way of the output from flank to flank, motor held [rad]")
    stiffness: float = Field(gt=0.0, le=1e9, description="stiffness of the gear on a flank, at the output [N m/rad]")
    damping: float = Field(ge=0.0, le=1e6, description="damping on a flank, at the output [N m s/rad]")
    bearing_friction: float = Field(
        ge=0.0, le=1e4, description="Coulomb friction of the joint's own bearing and seal [N m]"
    )
    bearing_viscous: float = Field(ge=0.0, le=1e5, description="their viscous friction [N m s/rad]")


class DriveParams(Params):
    """A joint's whole drive.

    Args:
        joints: joints of the URDF that have one of these.
        load: name of the electrical load that feeds it; the power manager switches and limits it by this
            name.
    """

    joints: tuple[str, ...] = Field(min_length=1, description="joints of the URDF with this drive")
    load: str = Field(min_length=1, description="name of the electrical load that feeds it")
    motor: MotorParams
    gear: GearParams
    servo: ServoParams
    play: PlayParams | None = Field(default=None, description="play and give between motor and joint")

    @model_validator(mode="after")
    def _check(self) -> Self:
        if len(set(self.joints)) != len(self.joints):
            raise ValueError("joints: allowed is each joint once")
        if self.servo.mode == "position" and self.servo.derivative == 0.0:
            raise ValueError("servo.derivative = 0: allowed is above 0 in mode 'position', or the joint swings")
        return self

    @property
    def reflected_inertia(self) -> float:
        """Rotor inertia as the joint feels it [kg m^2]."""
        return self.motor.rotor_inertia * self.gear.ratio**2

    @property
    def torque_per_current(self) -> float:
        """Of the motor over its gear, without losses [N m/A]."""
        return self.motor.torque_constant * self.gear.ratio

    @property
    def friction_torque(self) -> float:
        """Coulomb friction at the output without load, motor's own included [N m]."""
        motor = self.motor
        return self.gear.friction_torque + motor.no_load_current * motor.torque_constant * self.gear.ratio
