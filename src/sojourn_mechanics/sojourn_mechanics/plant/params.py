"""Parameters of the plant: what the URDF does not say about a machine."""

from typing import Literal, Self

from pydantic import Field, model_validator

from sojourn_mechanics.actuators.params import DriveParams, JointFrictionParams
from sojourn_mechanics.contact.params import PadParams, WheelParams
from sojourn_mechanics.params import Params


class CouplingParams(Params):
    """Two joints held to  q_first + ratio q_second = 0  by a mechanism (a rocker differential: ratio 1)."""

    first: str = Field(min_length=1, description="first joint")
    second: str = Field(min_length=1, description="second joint")
    ratio: float = Field(ge=-1e3, le=1e3, description="rates: first + ratio times second is zero [-]")


class SuspensionParams(Params):
    """Spring and damper on joints that no motor drives: torsion bars on swing arms, springs on guides. Units are of
    a joint that turns; of one that slides they are N/m, N s/m and m.
    """

    joints: tuple[str, ...] = Field(min_length=1, description="joints of the URDF with this spring")
    stiffness: float = Field(gt=0.0, le=1e7, description="of the spring [N m/rad]")
    damping: float = Field(ge=0.0, le=1e6, description="of the damper [N m s/rad]")
    rest: float = Field(default=0.0, ge=-10.0, le=10.0, description="angle at which the spring is relaxed [rad]")


class MachineParams(Params):
    """A rover: wheels, pads, drives and couplings; or an arm on a base that is fixed. Kinematics, masses, inertias
    and joint limits are in its URDF.

    Joints that no drive names are passive: they have `passive_joint` friction.
    """

    fixed_base: bool = Field(default=False, description="base_link stands fast: a stand, the wall of a station")
    wheels: tuple[WheelParams, ...] = Field(
        default=(), description="wheels, in the order of all reports; a fixed base has none, all others at least one"
    )
    pads: tuple[PadParams, ...] = Field(default=(), description="other points that may touch the ground")
    drives: tuple[DriveParams, ...] = Field(default=(), description="motor, gear and servo of groups of joints")
    passive_joint: JointFrictionParams
    suspensions: tuple[SuspensionParams, ...] = Field(default=(), description="springs and dampers on joints")
    wrench_sensor_link: str | None = Field(
        default=None,
        min_length=1,
        description="link of the arm that hangs on a force/torque sensor at that link's joint; null: there is none",
    )
    couplings: tuple[CouplingParams, ...] = Field(default=(), description="joints coupled by a mechanism")
    stop_stiffness: float = Field(default=2e4, gt=0.0, le=1e8, description="stiffness of joint stops [N m/rad]")
    stop_damping: float = Field(default=200.0, ge=0.0, le=1e6, description="damping of joint stops [N m s/rad]")
    roll_over_tilt_deg: float = Field(
        default=75.0, gt=0.0, lt=180.0, description="tilt of the chassis that counts as rolled over [degree]"
    )

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.fixed_base and self.wheels:
            raise ValueError(f"fixed_base with {len(self.wheels)} wheels: allowed is one or the other")
        if not (self.fixed_base or self.wheels):
            raise ValueError("wheels: allowed is one at least, or fixed_base = true")
        joints = [joint for drive in self.drives for joint in drive.joints]
        for joint in joints:
            if joints.count(joint) > 1:
                raise ValueError(f"drives: joint {joint} has {joints.count(joint)} drives, allowed is one")
        sprung = [joint for suspension in self.suspensions for joint in suspension.joints]
        for joint in sprung:
            if sprung.count(joint) > 1:
                raise ValueError(f"suspensions: joint {joint} has {sprung.count(joint)} springs, allowed is one")
            if joint in joints:
                raise ValueError(f"suspensions: joint {joint} has a drive, allowed is a joint without one")
        for wheel in self.wheels:
            if wheel.steer_joint is not None and wheel.steer_joint not in joints:
                raise ValueError(f"wheels: steer_joint {wheel.steer_joint} of wheel {wheel.name} has no drive")
        names = [wheel.name for wheel in self.wheels] + [pad.name for pad in self.pads]
        for name in names:
            if names.count(name) > 1:
                raise ValueError(f"wheels, pads: name {name} is used {names.count(name)} times, allowed is once")
        return self

    @property
    def steer_joints(self) -> tuple[str, ...]:
        """Steering joints, each once: several wheels may be rigid on a body that one joint turns."""
        return tuple(dict.fromkeys(wheel.steer_joint for wheel in self.wheels if wheel.steer_joint is not None))


class FaultParams(Params):
    """One motor that fails."""

    joint: str = Field(min_length=1, description="joint with a motor")
    kind: Literal["locked", "dead"] = Field(description="locked: holds its angle; dead: gives no torque")
    at_s: float = Field(ge=0.0, le=1e6, description="simulated time at which it fails [s]")
    angle_deg: float | None = Field(
        default=None, ge=-360.0, le=360.0, description="angle at which it locks; none: where it is [degree]"
    )

    @model_validator(mode="after")
    def _only_a_lock_has_an_angle(self) -> Self:
        if self.kind == "dead" and self.angle_deg is not None:
            raise ValueError(f"angle_deg = {self.angle_deg:g} of {self.joint}: only a locked joint has an angle")
        return self


class SimulationParams(Params):
    """How the plant is integrated."""

    physics_step: float = Field(default=0.001, gt=0.0, le=0.005, description="step of the integrator [s]")
    control_period: float = Field(default=0.02, gt=0.0, le=1.0, description="time between two commands [s]")
    settle_time: float = Field(
        default=30.0, ge=0.0, le=1000.0, description="longest rest on the ground before the run [s]"
    )

    @model_validator(mode="after")
    def _periods_are_whole_steps(self) -> Self:
        if self.substeps < 1 or abs(self.substeps * self.physics_step - self.control_period) > 1e-9:
            raise ValueError(
                f"control_period = {self.control_period:g}: allowed is a whole multiple of "
                f"physics_step = {self.physics_step:g} s"
            )
        return self

    @property
    def substeps(self) -> int:
        """Physics steps in a control period."""
        return round(self.control_period / self.physics_step)
