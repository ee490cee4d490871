"""Parameter set of an arm and of the laws that move it.

Lengths, masses and position limits are the URDF's and are not repeated here. What is here is what a URDF
cannot say: how fast each joint may be moved, which poses have a name, which way the tool points, how close
links may come to each other, and how the inverse kinematics searches.

Sources of the laws are named in the modules that use them. Assumption: a serial chain of
one-degree-of-freedom joints; every per-joint list is in the order of `joint_names`, which is the order
along the chain.
"""

import math
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from sojourn_flight.arm.contact_params import ContactParams
from sojourn_flight.arm.force_control import ForceControlParams
from sojourn_flight.arm.interlock import InterlockParams
from sojourn_machine.params import Params

PositiveRate = Annotated[float, Field(gt=0.0, le=1.0e4)]
NonNegative = Annotated[float, Field(ge=0.0, le=1.0e6)]
JointAngle = Annotated[float, Field(ge=-100.0, le=100.0)]
Direction = tuple[float, float, float]


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


class ArmParams(Params):
    """One arm: see the module header. Tuples are per joint, in the order of `joint_names`."""

    joint_names: tuple[str, ...] = Field(..., min_length=1, max_length=16, description="joints from base to tip")
    base_link: str = Field(default="base_link", min_length=1, description="link of the frame in which goals are given")
    tip_link: str = Field(..., min_length=1, description="link whose frame is the tip")
    max_velocity: tuple[PositiveRate, ...] = Field(..., description="speed limit per joint [rad/s or m/s]")
    max_acceleration: tuple[PositiveRate, ...] = Field(..., description="acceleration limit per joint [rad/s2]")
    max_jerk: tuple[PositiveRate, ...] = Field(..., description="jerk limit per joint [rad/s3]")
    reflected_inertia: tuple[NonNegative, ...] = Field(
        default=(),
        description="rotor and gear inertia at the joint, for the feed-forward [kg m2]; empty is zero",
    )
    coulomb_friction: tuple[NonNegative, ...] = Field(
        default=(), description="joint friction torque to feed forward while moving [N m]; empty is zero"
    )
    viscous_friction: tuple[NonNegative, ...] = Field(
        default=(), description="joint friction per speed to feed forward [N m s]; empty is zero"
    )
    gear_efficiency: tuple[PositiveRate, ...] = Field(default=(), description="of each gear [-]; empty is one")
    winding_loss: tuple[NonNegative, ...] = Field(
        default=(), description="R/(N k)^2 of each motor over its gear [W/(N m)^2]; empty is zero"
    )
    motor_effort: tuple[PositiveRate, ...] = Field(
        default=(), description="largest torque of each motor over its gear [N m or N]; empty: the URDF's effort alone"
    )
    power_limit: float | None = Field(
        default=None, gt=0.0, le=1e6, description="power that a motion may draw from the bus [W]; null: any"
    )
    gear_compliance: tuple[NonNegative, ...] = Field(
        default=(), description="twist of a joint's gear per torque, motor side measured [rad/(N m)]; empty: rigid"
    )
    gear_backlash: tuple[NonNegative, ...] = Field(
        default=(), description="way of a joint between the flanks of its gear [rad]; empty is zero"
    )
    bearing_friction: tuple[NonNegative, ...] = Field(
        default=(), description="Coulomb friction behind the gear, of the joint's own bearing [N m]; empty is zero"
    )
    friction_velocity: float = Field(
        default=0.005,
        gt=0.0,
        le=1.0,
        description="reference speed at which the Coulomb term reaches 76 % [rad/s]",
    )
    named_poses: dict[str, tuple[JointAngle, ...]] = Field(
        ..., description="joint positions by name; 'stow' and 'unfold' are required [rad or m]"
    )
    locked_positions: dict[str, JointAngle] = Field(
        default_factory=dict, description="positions of joints that are not the arm's, for collisions [rad]"
    )
    tool_axis: Direction = Field(
        default=(0.0, 0.0, 1.0), description="axis of the tip frame that points at the target [-]"
    )
    preferred_direction: Direction | None = Field(
        default=(0.0, 0.0, -1.0),
        description="direction in base_link tried first when a goal leaves it free [-]; null: none",
    )
    goal_orientation: Literal["direction", "full"] = Field(
        default="direction",
        description="what the orientation of a pose goal asks for: the direction of the tool axis, with any roll about "
        "it (five joints cannot do more), or all of it",
    )
    secondary_task: Literal["none", "centred", "manipulability", "clear"] = Field(
        default="none",
        description="what joints to spare are used for at the target of a pose goal: joints near the middle of their "
        "ranges, manipulability, distance from `obstacles`",
    )
    obstacles: tuple[tuple[float, float, float, float], ...] = Field(
        default=(), description="spheres to keep clear of with secondary_task clear: x y z radius in base_link [m]"
    )
    approach_distance: float = Field(
        default=0.06,
        ge=0.0,
        le=1.0,
        description="a pose goal is approached and left along the tool axis over this far [m]",
    )
    via_poses: tuple[str, ...] = Field(
        default=("unfold",),
        description="named poses to go through, tried in this order when the direct way collides",
    )
    joint_tolerance: float = Field(
        default=0.002,
        gt=0.0,
        le=0.2,
        description="measured against reference at rest, to count as reached [rad or m]",
    )
    planning_attempts: int = Field(default=8, ge=1, le=100, description="most ways that are tried for one goal [-]")
    settle_velocity: float = Field(
        default=0.05,
        gt=0.0,
        le=10.0,
        description="measured speed at rest, to count as reached [rad/s or m/s]",
    )
    resync_error: float = Field(
        default=0.02,
        gt=0.0,
        le=3.2,
        description="measured against reference, above which the reference starts anew where the arm is "
        "when motion is allowed again [rad or m]",
    )
    settle_time: float = Field(default=0.2, ge=0.0, le=60.0, description="time within tolerance before 'reached' [s]")
    settle_timeout: float = Field(
        default=6.0, gt=0.0, le=600.0, description="time allowed to settle after the motion [s]"
    )
    following_error_limit: float = Field(
        default=0.15,
        gt=0.0,
        le=3.2,
        description="measured against reference, above which a motion is stopped [rad or m]",
    )
    retime: bool = Field(
        default=True, description="stretch a timed trajectory that breaks a limit (true) or refuse it (false)"
    )
    collision_clearance: float = Field(
        default=0.01, ge=0.0, le=0.5, description="links may not come closer than this [m]"
    )
    collision_step: float = Field(
        default=0.02, gt=0.0, le=0.2, description="largest joint step between two checks [rad or m]"
    )
    avoid_ground: bool = Field(
        default=True, description="motions are checked against the ground on which the machine stands"
    )
    ground_height: float | None = Field(
        default=None,
        ge=-100.0,
        le=100.0,
        description="the ground is the plane z = this in base_link [m]; null: that under the wheels, if there are any",
    )
    ground_clearance: float = Field(default=0.02, ge=-0.5, le=1.0, description="links to ground plane, at least [m]")
    ground_contact_links: tuple[str, ...] = Field(
        default=(), description="links that may touch the ground: they keep ground_contact_depth instead"
    )
    ground_contact_depth: float = Field(
        default=0.01,
        ge=0.0,
        le=0.5,
        description="how far a ground_contact_link may go below the ground plane [m]",
    )
    seen_ground_depth: float = Field(
        default=0.025,
        ge=0.0,
        le=0.5,
        description="how far a ground_contact_link may go below ground that the hazard camera has seen: its error [m]",
    )
    ignored_link_pairs: tuple[tuple[str, str], ...] = Field(
        default=(), description="pairs of links whose collision is not checked (beside adjacent ones)"
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
