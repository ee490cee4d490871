"""Parameters of a joint's drive: motor, gear, servo. A joint without a motor has friction alone."""

from collections.abc import Mapping
from typing import Annotated, Any, Literal, Self, TypeAlias

from pydantic import Discriminator, Field, Tag, model_validator

from sojourn_mechanics.params import Params


class MotorParams(Params):
    """Permanent-magnet DC motor (or brushless with its amplifier, as seen from the supply)."""

    kind: Literal["permanent_magnet"] = Field(default="permanent_magnet", description="kind of motor")

    resistance: float = Field(gt=0.0, le=1e4, description="winding resistance [ohm]")
    torque_constant: float = Field(
        gt=0.0, le=10.0, description="torque constant, equal to the back-EMF constant [N m/A]"
    )
    rotor_inertia: float = Field(gt=0.0, le=1.0, description="rotor inertia, brake and encoder included [kg m^2]")
    no_load_current: float = Field(ge=0.0, le=10.0, description="current at no load, from friction in the motor [A]")
    max_current: float = Field(gt=0.0, le=500.0, description="largest current that the amplifier gives [A]")


class SeriesMotorParams(Params):
    """A series motor, see `series_motor`. `field_constant` is the torque for one ampere squared, without saturation."""

    kind: Literal["series"] = Field(default="series", description="kind of motor")

    series_resistance: float = Field(gt=0.0, le=1e4, description="armature, field and brushes [ohm]")
    field_constant: float = Field(gt=0.0, le=10.0, description="K_0, torque over current squared [N m/A^2]")
    saturation_current: float = Field(gt=0.0, le=1e6, description="current at which the field is half of linear [A]")
    inductance: float = Field(default=1e-3, gt=0.0, le=10.0, description="of both windings in series [H]")
    rotor_inertia: float = Field(gt=0.0, le=1.0, description="[kg m^2]")
    friction_torque: float = Field(ge=0.0, le=10.0, description="T_f, brushes and bearings [N m]")
    viscous_friction: float = Field(ge=0.0, le=1.0, description="b, windage and iron losses [N m s/rad]")
    max_current: float = Field(gt=0.0, le=5000.0, description="largest current that the amplifier gives [A]")


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


def motor_kind(motor: Any) -> str:
    """Kind of a motor, as parameters or as a table that may leave it out."""
    if isinstance(motor, Mapping):
        return str(motor.get("kind", "permanent_magnet"))
    return str(getattr(motor, "kind", ""))


AnyMotorParams: TypeAlias = Annotated[
    Annotated[MotorParams, Tag("permanent_magnet")] | Annotated[SeriesMotorParams, Tag("series")],
    Discriminator(motor_kind),
]


class DriveParams(Params):
    """A joint's whole drive.

    Args:
        joints: joints of the URDF that have one of these.
        load: name of the electrical load that feeds it; the power manager switches and limits it by this
            name.
    """

    joints: tuple[str, ...] = Field(min_length=1, description="joints of the URDF with this drive")
    load: str = Field(min_length=1, description="name of the electrical load that feeds it")
    motor: AnyMotorParams
    gear: GearParams
    servo: ServoParams
    play: PlayParams | None = Field(default=None, description="play and give between motor and joint")

    @model_validator(mode="after")
    def _check(self) -> Self:
        if len(set(self.joints)) != len(self.joints):
            raise ValueError("joints: allowed is each joint once")
        if self.servo.mode == "position" and self.servo.derivative == 0.0:
            raise ValueError("servo.derivative = 0: allowed is above 0 in mode 'position', or the joint swings")
        if self.servo.mode == "position" and isinstance(self.motor, SeriesMotorParams):
            raise ValueError("motor.kind = 'series': allowed in mode 'rate' alone: it brakes by friction")
        return self

    @property
    def reflected_inertia(self) -> float:
        """Rotor inertia as the joint feels it [kg m^2]."""
        return self.motor.rotor_inertia * self.gear.ratio**2

    @property
    def winding_loss(self) -> float:
        """Heat of the winding over the square of the torque at the output, without losses of the gear [W/(N m)^2]; of a
        series motor at its largest current.
        """
        motor = self.motor
        resistance = motor.series_resistance if isinstance(motor, SeriesMotorParams) else motor.resistance
        return resistance * (motor.max_current / self._torque_at_largest_current) ** 2

    @property
    def motor_effort(self) -> float:
        """Largest torque at the output that servo and current allow [N m]."""
        return min(self.servo.max_torque, self._torque_at_largest_current)

    @property
    def _torque_at_largest_current(self) -> float:
        motor, current = self.motor, self.motor.max_current
        if isinstance(motor, SeriesMotorParams):
            constant = motor.field_constant * current / (1.0 + current / motor.saturation_current)
        else:
            constant = motor.torque_constant
        return constant * current * self.gear.ratio

    @property
    def friction_torque(self) -> float:
        """Coulomb friction at the output without load, motor's own included [N m]."""
        motor = self.motor
        if isinstance(motor, SeriesMotorParams):
            return self.gear.friction_torque + motor.friction_torque * self.gear.ratio
        return self.gear.friction_torque + motor.no_load_current * motor.torque_constant * self.gear.ratio

    @property
    def viscous_friction(self) -> float:
        """Viscous friction at the output, motor's own included [N m s/rad]."""
        own = self.motor.viscous_friction * self.gear.ratio**2 if isinstance(self.motor, SeriesMotorParams) else 0.0
        return self.gear.viscous_friction + own
