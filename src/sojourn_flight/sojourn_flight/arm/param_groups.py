"""Groups of an arm's parameters, so that a law takes what it needs. Their keys stand side by side in the arm's file.

Tuples are per joint, in the order along the chain.
"""

from typing import Annotated, Literal

from pydantic import Field

from sojourn_machine.params import Params

PositiveRate = Annotated[float, Field(gt=0.0, le=1.0e4)]
NonNegative = Annotated[float, Field(ge=0.0, le=1.0e6)]
JointAngle = Annotated[float, Field(ge=-100.0, le=100.0)]
Direction = tuple[float, float, float]


class SpeedLimits(Params):
    """How fast each joint may be moved."""

    max_velocity: tuple[PositiveRate, ...] = Field(..., description="speed limit per joint [rad/s or m/s]")
    max_acceleration: tuple[PositiveRate, ...] = Field(..., description="acceleration limit per joint [rad/s2]")
    max_jerk: tuple[PositiveRate, ...] = Field(..., description="jerk limit per joint [rad/s3]")


class ArmDriveParams(Params):
    """What the joints' drives ask for beside the rigid bodies, and what they can give."""

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
    friction_velocity: float = Field(
        default=0.005,
        gt=0.0,
        le=1.0,
        description="reference speed at which the Coulomb term reaches 76 % [rad/s]",
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


class ArmGearParams(Params):
    """Play and give of gears whose encoders are on the motors."""

    gear_compliance: tuple[NonNegative, ...] = Field(
        default=(), description="twist of a joint's gear per torque, motor side measured [rad/(N m)]; empty: rigid"
    )
    gear_backlash: tuple[NonNegative, ...] = Field(
        default=(), description="way of a joint between the flanks of its gear [rad]; empty is zero"
    )
    bearing_friction: tuple[NonNegative, ...] = Field(
        default=(), description="Coulomb friction behind the gear, of the joint's own bearing [N m]; empty is zero"
    )


class NamedPoseParams(Params):
    """Poses that have a name, and what they are for."""

    named_poses: dict[str, tuple[JointAngle, ...]] = Field(
        ..., description="joint positions by name; 'stow' and 'unfold' are required [rad or m]"
    )
    via_poses: tuple[str, ...] = Field(
        default=("unfold",),
        description="named poses to go through, tried in this order when the direct way collides",
    )


class PoseGoalParams(Params):
    """What a pose goal asks of the tool, and how its target is chosen and approached."""

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
    approach_distance: float = Field(
        default=0.06,
        ge=0.0,
        le=1.0,
        description="a pose goal is approached and left along the tool axis over this far [m]",
    )
    secondary_task: Literal["none", "centred", "manipulability", "clear"] = Field(
        default="none",
        description="what joints to spare are used for at the target of a pose goal: joints near the middle of their "
        "ranges, manipulability, distance from `obstacles`",
    )
    obstacles: tuple[tuple[float, float, float, float], ...] = Field(
        default=(), description="spheres to keep clear of with secondary_task clear: x y z radius in base_link [m]"
    )


class SettlingParams(Params):
    """When a motion counts as finished."""

    joint_tolerance: float = Field(
        default=0.002,
        gt=0.0,
        le=0.2,
        description="measured against reference at rest, to count as reached [rad or m]",
    )
    settle_velocity: float = Field(
        default=0.05,
        gt=0.0,
        le=10.0,
        description="measured speed at rest, to count as reached [rad/s or m/s]",
    )
    settle_time: float = Field(default=0.2, ge=0.0, le=60.0, description="time within tolerance before 'reached' [s]")
    settle_timeout: float = Field(
        default=6.0, gt=0.0, le=600.0, description="time allowed to settle after the motion [s]"
    )


class FollowingParams(Params):
    """How far the joints may be from their reference."""

    following_error_limit: float = Field(
        default=0.15,
        gt=0.0,
        le=3.2,
        description="measured against reference, above which a motion is stopped [rad or m]",
    )
    resync_error: float = Field(
        default=0.02,
        gt=0.0,
        le=3.2,
        description="measured against reference, above which the reference starts anew where the arm is "
        "when motion is allowed again [rad or m]",
    )


class ClearanceParams(Params):
    """How near links may come to one another and to the ground."""

    collision_clearance: float = Field(
        default=0.01, ge=0.0, le=0.5, description="links may not come closer than this [m]"
    )
    collision_step: float = Field(
        default=0.02, gt=0.0, le=0.2, description="largest joint step between two checks [rad or m]"
    )
    ignored_link_pairs: tuple[tuple[str, str], ...] = Field(
        default=(), description="pairs of links whose collision is not checked (beside adjacent ones)"
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
