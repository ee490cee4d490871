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

from sojourn_flight.arm.force_control import ForceControlParams
from sojourn_flight.arm.interlock import InterlockParams
from sojourn_flight.arm.law_params import JoggingParams, PlanningParams
from sojourn_flight.arm.param_groups import ArmGearParams, FollowingParams, JointAngle, SettlingParams, SpeedLimits
from sojourn_machine.params import Params


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


_DRIVE_DATA = (
    "reflected_inertia", "coulomb_friction", "viscous_friction", "gear_efficiency", "winding_loss", "motor_effort",
)  # fmt: skip


class ArmParams(SpeedLimits, ArmGearParams, PlanningParams, JoggingParams, SettlingParams, FollowingParams):
    """One arm: see the module header. What a law needs of it is one of its bases."""

    joint_names: tuple[str, ...] = Field(..., min_length=1, max_length=16, description="joints from base to tip")
    base_link: str = Field(default="base_link", min_length=1, description="link of the frame in which goals are given")
    tip_link: str = Field(..., min_length=1, description="link whose frame is the tip")
    locked_positions: dict[str, JointAngle] = Field(
        default_factory=dict, description="positions of joints that are not the arm's, for collisions [rad]"
    )
    force_control: ForceControlParams = Field(
        default=ForceControlParams(), description="control of contact forces through the joints' references"
    )
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
