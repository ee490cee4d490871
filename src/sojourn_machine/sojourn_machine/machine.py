"""Parameters of the plant: what the URDF does not say about a machine."""

from collections.abc import Collection
from typing import Self

from pydantic import Field, model_validator

from sojourn_machine.actuator_choice import Drive
from sojourn_machine.drives import JointFrictionParams
from sojourn_machine.params import Params
from sojourn_machine.supports import FootParams, PadParams, SupportParams, TrackParams, WheelParams


class DifferentialBarParams(Params):
    """A bar on an upright axis in the middle of the chassis whose ends are linked to points of the two rockers."""

    half_length: float = Field(gt=0.0, le=10.0, description="w, from the axis to an end of the bar [m]")
    arm: float = Field(gt=0.0, le=10.0, description="e, height of the rockers' points over their axis [m]")
    bar_height: float = Field(ge=-10.0, le=10.0, description="z_b, height of the bar's ends over the same axis [m]")
    link: float = Field(gt=0.0, le=10.0, description="L, length of the links [m]")

    @model_validator(mode="after")
    def _links_reach(self) -> Self:
        if not self.link > abs(self.arm - self.bar_height):
            raise ValueError(f"link = {self.link:g}: allowed is more than |arm - bar_height|")
        return self


class CouplingParams(Params):
    """Two joints held to  q_first + ratio q_second = 0  by a mechanism (a rocker differential: ratio 1).

    A bar is what the mechanism is; the plant takes its ratio, and the data sheet tells how far the bar is off that.
    """

    first: str = Field(min_length=1, description="first joint")
    second: str = Field(min_length=1, description="second joint")
    ratio: float = Field(ge=-1e3, le=1e3, description="rates: first + ratio times second is zero [-]")
    bar: DifferentialBarParams | None = Field(default=None, description="the bar that couples them; none: a gear")


class SuspensionParams(Params):
    """Spring and damper on joints that no motor drives: torsion bars on swing arms, springs on guides. Units are of
    a joint that turns; of one that slides they are N/m, N s/m and m.
    """

    joints: tuple[str, ...] = Field(min_length=1, description="joints of the URDF with this spring")
    stiffness: float = Field(gt=0.0, le=1e7, description="of the spring [N m/rad]")
    damping: float = Field(ge=0.0, le=1e6, description="of the damper [N m s/rad]")
    rest: float = Field(default=0.0, ge=-10.0, le=10.0, description="angle at which the spring is relaxed [rad]")


class MachineParams(Params):
    """A machine: what it stands on, drives and couplings; or an arm on a base that is fixed, or that floats free.
    Kinematics, masses, inertias and joint limits are in its URDF.

    Joints that no drive names are passive: they have `passive_joint` friction.
    """

    fixed_base: bool = Field(default=False, description="base_link stands fast: a stand, the wall of a station")
    floats: bool = Field(default=False, description="nothing holds base_link: a spacecraft in orbit")
    wheels: tuple[WheelParams, ...] = Field(default=(), description="wheels")
    tracks: tuple[TrackParams, ...] = Field(default=(), description="tracks")
    feet: tuple[FootParams, ...] = Field(default=(), description="feet of legs")
    pads: tuple[PadParams, ...] = Field(default=(), description="other points that may touch the ground")
    drives: tuple[Drive, ...] = Field(default=(), description="what drives groups of joints")
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
        stands_on = [support.name for support in self.stands_on]
        if self.fixed_base and stands_on:
            raise ValueError(f"fixed_base with {', '.join(stands_on)}: allowed is one or the other")
        if self.floats and (self.fixed_base or stands_on):
            other = "fixed_base" if self.fixed_base else ", ".join(stands_on)
            raise ValueError(f"floats with {other}: allowed is one or the other")
        if not (self.fixed_base or self.floats or stands_on):
            raise ValueError("wheels, tracks, feet: allowed is one at least, or fixed_base = true, or floats = true")
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
        for track in self.tracks:
            if track.joint not in joints:
                raise ValueError(f"tracks: joint {track.joint} of track {track.name} has no drive")
        names = [support.name for support in self.supports]
        for name in names:
            if names.count(name) > 1:
                raise ValueError(f"supports: name {name} is used {names.count(name)} times, allowed is once")
        return self

    @property
    def stands_on(self) -> tuple[WheelParams | TrackParams | FootParams, ...]:
        """What it stands on when it is as it should be."""
        return (*self.rolling, *self.feet)

    @property
    def rolling(self) -> tuple[WheelParams | TrackParams, ...]:
        """What it drives with: each has a joint whose rate moves the machine over the ground."""
        return (*self.wheels, *self.tracks)

    @property
    def why_it_stays(self) -> str:
        """Why it does not drive, in words; empty of a machine that stands on something."""
        if self.stands_on:
            return ""
        return "floats free: it has no wheels" if self.floats else "stands fast: it has no wheels"

    @property
    def support_word(self) -> str:
        """What to call one thing that it stands on: wheel, track or foot; support where they are of several kinds."""
        kinds = [name for name, those in (("wheel", self.wheels), ("track", self.tracks), ("foot", self.feet)) if those]
        return kinds[0] if len(kinds) == 1 else "support"

    @property
    def supports(self) -> tuple[SupportParams, ...]:
        """All that may meet the ground, in the order of all reports."""
        return (*self.stands_on, *self.pads)

    def loads_of(self, joints: Collection[str]) -> tuple[str, ...]:
        """Loads of the bus that feed the drives of any of these joints, each once."""
        return tuple(dict.fromkeys(drive.load for drive in self.drives if set(drive.joints) & set(joints)))

    @property
    def steer_joints(self) -> tuple[str, ...]:
        """Steering joints, each once: several wheels may be rigid on a body that one joint turns."""
        return tuple(dict.fromkeys(wheel.steer_joint for wheel in self.wheels if wheel.steer_joint is not None))
