"""Parameters of the drive that comes with us: motor, gear, servo. A joint without a drive has friction alone."""

import math
from collections.abc import Collection, Mapping
from typing import Annotated, Any, ClassVar, Literal, Self, TypeAlias

from pydantic import Discriminator, Field, Tag, model_validator

from sojourn_machine.actuator_choice import ActuatorParams
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import Params
from sojourn_machine.screw import ScrewParams

LEAST_BACK = 0.5
"""Least efficiency of a gear, the load driving, that the plant's friction over the motor's torque can follow [-]."""


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
    rotor_inertia: float = Field(gt=0.0, le=1.0, description="[kg m^2]")
    friction_torque: float = Field(ge=0.0, le=10.0, description="T_f, brushes and bearings [N m]")
    viscous_friction: float = Field(ge=0.0, le=1.0, description="b, windage and iron losses [N m s/rad]")
    max_current: float = Field(gt=0.0, le=5000.0, description="largest current that the amplifier gives [A]")


class BrushlessMotorParams(Params):
    """A brushless motor with its inverter, see `sojourn_physics.actuators.brushless`. Its cogging is left out."""

    kind: Literal["brushless"] = Field(description="kind of motor")

    phase_resistance: float = Field(gt=0.0, le=1e4, description="R of one phase [ohm]")
    inductance_d: float = Field(gt=0.0, le=10.0, description="L_d [H]")
    inductance_q: float = Field(gt=0.0, le=10.0, description="L_q [H]")
    flux: float = Field(gt=0.0, le=100.0, description="psi, flux linkage of the magnets [V s]")
    pole_pairs: int = Field(ge=1, le=100, description="p [-]")
    rotor_inertia: float = Field(gt=0.0, le=1.0, description="[kg m^2]")
    friction_torque: float = Field(default=0.0, ge=0.0, le=10.0, description="T_f [N m]")
    viscous_friction: float = Field(default=0.0, ge=0.0, le=1.0, description="b [N m s/rad]")
    max_current: float = Field(gt=0.0, le=500.0, description="amplitude of the phase current [A]")

    @property
    def from_supply(self) -> MotorParams:
        """The DC motor that takes the same current from the supply, without its viscous friction: k = sqrt(3) p psi,
        R = 2 R_phase, current by sqrt(3)/2 (amplitude-invariant Park transform, no field weakening).
        """
        constant = math.sqrt(3.0) * self.pole_pairs * self.flux
        return MotorParams(
            resistance=2.0 * self.phase_resistance,
            torque_constant=constant,
            rotor_inertia=self.rotor_inertia,
            no_load_current=self.friction_torque / constant,
            max_current=0.5 * math.sqrt(3.0) * self.max_current,
        )


class MotorThermalParams(Params):
    """Thermal side of a motor with magnets, see `sojourn_physics.actuators.motor_thermal`."""

    winding_capacity: float = Field(gt=0.0, le=1e6, description="C_w [J/K]")
    housing_capacity: float = Field(gt=0.0, le=1e6, description="C_h [J/K]")
    winding_to_housing: float = Field(gt=0.0, le=1e4, description="R_wh [K/W]")
    housing_to_ambient: float = Field(gt=0.0, le=1e4, description="R_ha [K/W]; larger in vacuum")
    surroundings: float = Field(default=298.15, ge=0.0, le=1000.0, description="T_a, and at the start [K]")
    magnet_coefficient: float = Field(default=-0.0011, ge=-0.01, le=0.0, description="a_m [1/K]")
    derate_temperature: float = Field(gt=0.0, le=1000.0, description="T_derate of the winding [K]")
    largest_temperature: float = Field(gt=0.0, le=1000.0, description="T_max of the winding [K]")
    demagnetisation_cold: tuple[float, float] = Field(description="temperature of the magnets [K] and current [A]")
    demagnetisation_hot: tuple[float, float] = Field(description="temperature of the magnets [K] and current [A]")

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if not self.derate_temperature < self.largest_temperature:
            raise ValueError(f"derate_temperature: allowed is less than {self.largest_temperature:g} K")
        if not self.demagnetisation_cold[0] < self.demagnetisation_hot[0]:
            raise ValueError("demagnetisation_cold: allowed is a lower temperature than demagnetisation_hot")
        if min(self.demagnetisation_cold[1], self.demagnetisation_hot[1]) < 0.0:
            raise ValueError("demagnetisation: allowed are currents of at least 0 A")
        return self


class BrakeParams(Params):
    """A friction brake on the motor's shaft that opens with its current: closed while the drive's load is off."""

    holding_torque: float = Field(gt=0.0, le=1e6, description="at the motor's shaft [N m]")
    closing_time: float = Field(default=0.02, ge=0.0, le=10.0, description="until it holds in full [s]")
    opening_time: float = Field(default=0.03, ge=0.0, le=10.0, description="until it is open [s]")


class GearParams(Params):
    """Reduction gear."""

    ratio: float = Field(ge=1.0, le=1e5, description="motor turns for one output turn [-]")
    efficiency: float = Field(gt=0.0, le=1.0, description="efficiency under load, the motor driving [-]")
    back_efficiency: float | None = Field(
        default=None, ge=LEAST_BACK, le=1.0, description="the load driving [-]; none: 1/(2 - efficiency), the same loss"
    )
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
    Annotated[MotorParams, Tag("permanent_magnet")]
    | Annotated[SeriesMotorParams, Tag("series")]
    | Annotated[BrushlessMotorParams, Tag("brushless")],
    Discriminator(motor_kind),
]


class JointDriveParams(ActuatorParams):
    """A motor with its gear and servo: the drive that the plant's kernels solve."""

    kind: Literal["geared_motor"] = Field(default="geared_motor", description="kind of drive")
    torque_key: ClassVar[tuple[str, ...]] = ("servo", "max_torque")
    motor: AnyMotorParams
    gear: GearParams
    servo: ServoParams
    play: PlayParams | None = Field(default=None, description="play and give between motor and joint")
    screw: ScrewParams | None = Field(default=None, description="behind the gear, of a joint that slides")
    brake: BrakeParams | None = Field(default=None, description="on the motor's shaft, closed without current")
    thermal: MotorThermalParams | None = Field(default=None, description="heat of the motor; none: it stays at 25 C")

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.servo.mode == "position" and self.servo.derivative == 0.0:
            raise ValueError("servo.derivative = 0: allowed is above 0 in mode 'position', or the joint swings")
        if self.servo.mode == "position" and isinstance(self.motor, SeriesMotorParams):
            raise ValueError("motor.kind = 'series': allowed in mode 'rate' alone: it brakes by friction")
        if self.thermal is not None and isinstance(self.motor, SeriesMotorParams):
            raise ValueError("thermal: allowed with a motor that has magnets, not with motor.kind = 'series'")
        if self.screw is not None and self._back_through(self.screw) < LEAST_BACK and self.brake is None:
            raise ValueError(
                f"screw: its load drives it with an efficiency below {LEAST_BACK:g}, or not at all, which the plant "
                "takes from a brake alone: allowed is one with a brake"
            )
        return self

    @property
    def mode(self) -> Literal["rate", "position"]:
        """See the class above."""
        return self.servo.mode

    @property
    def largest_torque(self) -> float:
        """See the class above."""
        return self.servo.max_torque

    @property
    def encoder_ratio(self) -> float | None:
        """See the class above."""
        return self.gear.ratio

    @property
    def efficiency(self) -> float:
        """See the class above."""
        return self.transmission.efficiency

    @property
    def electric(self) -> MotorParams | SeriesMotorParams:
        """The motor as its supply sees it."""
        return self.motor.from_supply if isinstance(self.motor, BrushlessMotorParams) else self.motor

    @property
    def transmission(self) -> GearParams:
        """Gear and screw in one, the viscous friction of a brushless motor with them; of a joint that slides the ratio
        is in rad/m, friction in N and N s/m.
        """
        found = self.gear
        if self.screw is not None:
            found = found.model_copy(
                update={
                    "ratio": found.ratio * self.screw.turns,
                    "efficiency": found.efficiency * self.screw.raising_efficiency,
                    "back_efficiency": max(self._back_through(self.screw), LEAST_BACK),
                }
            )
        if isinstance(self.motor, BrushlessMotorParams):
            viscous = found.viscous_friction + self.motor.viscous_friction * found.ratio**2
            found = found.model_copy(update={"viscous_friction": viscous})
        return found

    def _back_through(self, screw: ScrewParams) -> float:
        """Efficiency of gear and screw, the load driving [-]."""
        return (self.gear.back_efficiency or 1.0 / (2.0 - self.gear.efficiency)) * screw.back_driving_efficiency

    @property
    def reflected_inertia(self) -> float:
        """Rotor inertia as the joint feels it [kg m^2]."""
        return self.motor.rotor_inertia * self.transmission.ratio**2

    @property
    def winding_loss(self) -> float:
        """Heat of the winding over the square of the torque at the output, without losses of the gear [W/(N m)^2]; of a
        series motor at its largest current.
        """
        motor = self.electric
        resistance = motor.series_resistance if isinstance(motor, SeriesMotorParams) else motor.resistance
        return resistance * (motor.max_current / self._torque_at_largest_current) ** 2

    @property
    def motor_effort(self) -> float:
        """Largest torque at the output that servo and current allow [N m]."""
        return min(self.servo.max_torque, self._torque_at_largest_current)

    @property
    def _torque_at_largest_current(self) -> float:
        motor, current = self.electric, self.electric.max_current
        if isinstance(motor, SeriesMotorParams):
            constant = motor.field_constant * current / (1.0 + current / motor.saturation_current)
        else:
            constant = motor.torque_constant
        return constant * current * self.transmission.ratio

    @property
    def friction_torque(self) -> float:
        """Coulomb friction at the output without load, motor's own included [N m]."""
        motor, gear = self.electric, self.transmission
        if isinstance(motor, SeriesMotorParams):
            return gear.friction_torque + motor.friction_torque * gear.ratio
        return gear.friction_torque + motor.no_load_current * motor.torque_constant * gear.ratio

    @property
    def viscous_friction(self) -> float:
        """Viscous friction at the output, motor's own included [N m s/rad]."""
        gear, motor = self.transmission, self.motor
        own = motor.viscous_friction * gear.ratio**2 if isinstance(motor, SeriesMotorParams) else 0.0
        return gear.viscous_friction + own


def geared_motor_of(drives: Collection[ActuatorParams], joint: str) -> JointDriveParams:
    """The motor, gear and servo that drive a joint, for closed forms that are about these.

    Raises:
        InvalidValueError: the joint has no drive, or one of another kind.
    """
    for drive in drives:
        if joint in drive.joints and isinstance(drive, JointDriveParams):
            return drive
    found = next((drive.kind for drive in drives if joint in drive.joints), "none")
    raise InvalidValueError(f"drive of {joint}", found, "a geared_motor, whose closed forms are known")
