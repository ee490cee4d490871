"""Parameter set of an arm and of the laws that move it.

Lengths, masses and position limits are the URDF's and are not repeated here. What is here is what a URDF
cannot say: how fast each joint may be moved, which poses have a name, which way the tool points, how close
links may come to each other, and how the inverse kinematics searches.

Sources of the laws are named in the modules that use them. Assumption: a serial chain of
one-degree-of-freedom joints; every per-joint list is in the order of `joint_names`, which is the order
along the chain.
"""

import math
from typing import Self

from pydantic import Field, model_validator

from sojourn_flight.arm.contact_params import ContactParams
from sojourn_flight.arm.force_control import ForceControlParams
from sojourn_flight.arm.interlock import InterlockParams
from sojourn_flight.arm.param_groups import (
    ArmDriveParams,
    ArmGearParams,
    ClearanceParams,
    FollowingParams,
    JointAngle,
    NamedPoseParams,
    PoseGoalParams,
    SettlingParams,
    SpeedLimits,
)
from sojourn_machine.params import Params


class InverseKinematicsParams(Params):
    """Settings of the search for joint positions."""

    position_tolerance: float = Field(
        default=1.0e-5, gt=0.0, le=1.0e-2, description="accepted distance to the target [m]"
    )
    pointing_tolerance: float = Field(
        default=1.0e-4,
        gt=0.0,
        le=0.2,
        description="accepted angle between tool axis and wanted direction [rad]",
    )
    characteristic_length: float = Field(
        default=0.1, gt=0.0, le=100.0, description="weight of one radian of pointing against position [m]"
    )
    damping_bias: float = Field(
        default=1.0e-8, gt=0.0, le=1.0, description="smallest damping of the least squares [m2]"
    )
    max_step: float = Field(
        default=0.5, gt=0.0, le=3.2, description="largest change of a joint in one iteration [rad or m]"
    )
    max_iterations: int = Field(default=60, ge=1, le=10000, description="iterations from one start [-]")
    starts: int = Field(
        default=100, ge=1, le=1000, description="most starts of a search, the present position included [-]"
    )
    starts_when_solved: int = Field(
        default=20, ge=1, le=1000, description="starts after which one solution is enough [-]"
    )
    solutions: int = Field(default=6, ge=1, le=64, description="distinct solutions after which the search ends [-]")


class TrimParams(Params):
    """Slow integral correction of the position reference from the measured joint error, at rest only."""

    rate: float = Field(
        default=0.8,
        ge=0.0,
        le=10.0,
        description="integral gain: trim rate per error [1/s]; 0 switches it off",
    )
    limit: float = Field(default=0.02, ge=0.0, le=0.2, description="largest trim of a joint [rad or m]")
    deadband: float = Field(
        default=5.0e-4,
        ge=0.0,
        le=0.05,
        description="error that is left alone, above one encoder step [rad or m]",
    )
    max_rate: float = Field(default=0.01, gt=0.0, le=1.0, description="largest rate of the trim [rad/s or m/s]")


class TipPathParams(Params):
    """Lines and arcs of the tip that an operator asks for."""

    speed: float = Field(default=0.05, gt=0.0, le=10.0, description="of the tip, where the joints allow it [m/s]")
    corner: float = Field(
        default=0.005, ge=0.0, le=1.0, description="a corner is rounded by at most this [m]; 0: the tip stops at each"
    )
    tolerance: float = Field(
        default=1.0e-4, gt=0.0, le=0.01, description="of the joints' way off the path [m], and of the tool's turn [rad]"
    )


class JogParams(Params):
    """Velocities of the tip by hand."""

    timeout: float = Field(default=0.2, gt=0.0, le=10.0, description="age at which a command is dropped [s]")
    speed: float = Field(default=0.05, gt=0.0, le=10.0, description="of the tip, at most [m/s]")
    turning: float = Field(default=0.2, gt=0.0, le=10.0, description="of the tool, at most [rad/s]")
    singular_stop: float = Field(
        default=0.1,
        ge=0.0,
        le=10.0,
        description="smallest singular value at which the tip rests on its way to a singular posture, in "
        "characteristic lengths of the inverse kinematics [-]",
    )
    pause: float = Field(
        default=0.5,
        ge=0.0,
        le=60.0,
        description="time without commands after which an arm that has met something can be jogged again [s]",
    )


_DRIVE_DATA = (
    "reflected_inertia", "coulomb_friction", "viscous_friction", "gear_efficiency", "winding_loss", "motor_effort",
)  # fmt: skip


class ArmParams(
    SpeedLimits,
    ArmDriveParams,
    ArmGearParams,
    NamedPoseParams,
    PoseGoalParams,
    SettlingParams,
    FollowingParams,
    ClearanceParams,
):
    """One arm: see the module header. What a law needs of it is a group of `param_groups`, which every arm is."""

    joint_names: tuple[str, ...] = Field(..., min_length=1, max_length=16, description="joints from base to tip")
    base_link: str = Field(default="base_link", min_length=1, description="link of the frame in which goals are given")
    tip_link: str = Field(..., min_length=1, description="link whose frame is the tip")
    locked_positions: dict[str, JointAngle] = Field(
        default_factory=dict, description="positions of joints that are not the arm's, for collisions [rad]"
    )
    planning_attempts: int = Field(default=8, ge=1, le=100, description="most ways that are tried for one goal [-]")
    retime: bool = Field(
        default=True, description="stretch a timed trajectory that breaks a limit (true) or refuse it (false)"
    )
    inverse_kinematics: InverseKinematicsParams = Field(
        InverseKinematicsParams(), description="settings of the inverse kinematics"
    )
    force_control: ForceControlParams = Field(
        default=ForceControlParams(), description="control of contact forces through the joints' references"
    )
    contact: ContactParams = Field(default=ContactParams(), description="contacts in motions that are to touch nothing")
    jog: JogParams = Field(default=JogParams(), description="velocities of the tip by hand")
    tip_path: TipPathParams = Field(default=TipPathParams(), description="lines and arcs of the tip")
    trim: TrimParams = Field(default=TrimParams(), description="integral trim at rest")
    interlock: InterlockParams = Field(default=InterlockParams(), description="interlock with the drive")

    @property
    def joint_count(self) -> int:
        """Number of joints [-]."""
        return len(self.joint_names)

    @model_validator(mode="after")
    def _check(self) -> Self:
        count = len(self.joint_names)
        if len(set(self.joint_names)) != count:
            raise ValueError(f"joint_names = {self.joint_names}: a name is there twice")
        for name in ("max_velocity", "max_acceleration", "max_jerk"):
            if len(getattr(self, name)) != count:
                raise ValueError(f"{name} has {len(getattr(self, name))} values: allowed is {count}, one per joint")
        gear = ("gear_compliance", "gear_backlash", "bearing_friction")
        for name in (*_DRIVE_DATA, *gear):
            if len(getattr(self, name)) not in (0, count):
                raise ValueError(f"{name} has {len(getattr(self, name))} values: allowed is none or {count}")
        if len({len(getattr(self, name)) for name in gear}) > 1:
            raise ValueError(f"{', '.join(gear)}: allowed are all of them or none")
        for required in ("stow", "unfold"):
            if required not in self.named_poses:
                raise ValueError(f"named_poses lacks '{required}': there are {sorted(self.named_poses)}")
        for pose, values in self.named_poses.items():
            if len(values) != count:
                raise ValueError(f"named_poses.{pose} has {len(values)} values: allowed is {count}, one per joint")
        for key, names in (("via_poses", self.via_poses), ("interlock.driving_poses", self.interlock.driving_poses)):
            for name in names:
                if name not in self.named_poses:
                    raise ValueError(f"{key}: '{name}' is not a named pose; there are {sorted(self.named_poses)}")
        if self.secondary_task == "clear" and not self.obstacles:
            raise ValueError("secondary_task = 'clear': obstacles are needed to keep clear of")
        for name, axis in (("tool_axis", self.tool_axis), ("preferred_direction", self.preferred_direction)):
            if axis is not None and abs(math.hypot(*axis) - 1.0) > 1.0e-6:
                raise ValueError(f"{name} = {axis} has length {math.hypot(*axis):.6g}: allowed is a unit vector")
        return self
