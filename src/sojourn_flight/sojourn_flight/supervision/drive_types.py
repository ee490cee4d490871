"""What goes into the drive and comes out of it in a period, and what it remembers in between. No ROS types.

Joints are in the order of the mobility. Positions [m], angles [rad], time [s].
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, NamedTuple

from sojourn_flight.hazards.camera_watch import CameraState
from sojourn_flight.mobility.easing import NOTHING, Behind
from sojourn_flight.mobility.mobility import NOTHING_FELT, InertialMeasurement, JointReferences, MobilityJoints, Moves
from sojourn_flight.mobility.twist import PlanarTwist
from sojourn_flight.odometry.heading_fix import HeadingFixState, SunSighting
from sojourn_flight.odometry.key_frames import TerrainMatchState
from sojourn_flight.odometry.odometry import OdometryState
from sojourn_flight.odometry.visual_state import StereoImages, VisualOdometryState
from sojourn_flight.planning.energy_forecast import EnergyLeft, EnergyUse
from sojourn_flight.planning.follower_state import FollowerState
from sojourn_flight.planning.goal import Goal, GoalOutcome
from sojourn_flight.supervision.avoidance_types import AvoidanceState
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray

Mode = Literal["idle", "goal", "waypoints", "cmd_vel"]


@dataclass(frozen=True, slots=True)
class TwistCommand:
    """The operator's newest /cmd_vel.

    Raises:
        InvalidValueError: if a number is not finite or the age is negative.
    """

    twist: PlanarTwist
    """Wanted motion of base_link."""
    age: float
    """Time since its stamp [s]."""

    def __post_init__(self) -> None:
        for name, value in zip(self.twist._fields, self.twist, strict=True):
            if not math.isfinite(value):
                raise InvalidValueError(f"cmd_vel {name}", value, "a finite number")
        if not (math.isfinite(self.age) and self.age >= 0.0):
            raise InvalidValueError("cmd_vel age", self.age, "a finite number, 0 s or more")


@dataclass(frozen=True, slots=True)
class DriveInput:
    """What is known at the start of a period."""

    joints: MobilityJoints
    felt: InertialMeasurement = NOTHING_FELT
    sun: SunSighting | None = None
    """A reading of the sun sensor that came in this period."""
    cloud: FloatArray | None = None
    """Points of the hazard camera that came in this period, in base_link, shape (n, 3) [m]."""
    images: StereoImages | None = None
    """Of the stereo pair, that came in this period."""
    twist: TwistCommand | None = None
    """Newest /cmd_vel, every period until it is replaced; its age tells when it came."""
    goal: Goal | None = None
    """A goal or path that arrived in this period, in odom."""
    question: Goal | None = None
    """A goal that somebody wants to know the cost of, asked in this period, in odom: nothing moves for it."""
    stop: bool = False
    """A stop request that arrived in this period."""
    stop_reason: str = "stop requested"
    supply: EnergyLeft | None = None
    """The newest reading of the battery, None as long as none has come."""
    power_limit: float = 1.0
    """Factor of the power manager on all speeds, 0 to 1 [-]."""


@dataclass(frozen=True, slots=True)
class DriveState:
    """Everything the drive remembers."""

    mode: Mode
    odometry: OdometryState
    mobility: Any
    """Of what it moves on: commands, motors, slip; the state of its kind."""
    follower: FollowerState | None
    """The goal on its way."""
    last_outcome: GoalOutcome | None
    """How the last goal ended."""
    since_override: float
    """Time since the last goal or stop request [s]; a twist command older than that does not count."""
    text: str
    """What the drive is doing, in words."""
    twist_refused: bool = False
    """Whether an operator's twist is not driven because the machine does not allow it; `text` says why."""
    waits: bool = False
    """Whether a goal on its way does not get on; `text` says why."""
    energy: EnergyUse = field(default_factory=EnergyUse)
    """Of the goal on its way, or of the last one."""
    mean_slip: float = 0.0
    """Of the machine, averaged, see `slip_policy` [-]."""
    heading: HeadingFixState = field(default_factory=HeadingFixState)
    """What became of the sightings of the Sun."""
    terrain: TerrainMatchState | None = None
    """Key frame and matches of the hazard camera; None without one."""
    visual: VisualOdometryState | None = None
    """Key frame and matches of the stereo pair's images; None without."""
    behind: Behind = NOTHING
    """Corrections that are not in the published odometry yet."""
    avoidance: AvoidanceState | None = None
    """Obstacles; None without obstacle handling."""
    camera: CameraState = field(default_factory=CameraState)
    """What is thought of the hazard camera."""
    foreseen: Mapping[str, str | float] = field(default_factory=dict)
    """The answer to the last question; see `foresight`."""


class Pace(NamedTuple):
    """How fast a period was driven, and why no faster."""

    power_limit: float
    """Factor of the power manager on all speeds [-]."""
    moves: Moves


@dataclass(frozen=True, slots=True)
class DriveOutput:
    """Result of one period."""

    references: JointReferences
    """Commands to the joints."""
    odometry: OdometryState
    """Pose of base_link in odom and twist in base_link."""
    pose_covariance: FloatArray
    """x, y, z, roll, pitch, yaw; shape (6, 6)."""
    twist_covariance: FloatArray
    """v_x, v_y, v_z, w_x, w_y, w_z; shape (6, 6)."""
    outcomes: tuple[GoalOutcome, ...]
    """Goals that ended in this period."""
    pace: Pace | None = None
    """None before the first step."""
    make_status: Callable[[], dict[str, str | float]] | None = None
    """Makes the fields of /drive/status, which are wanted once in many periods; None of an output that is kept."""

    @property
    def status(self) -> dict[str, str | float]:
        """Fields of /drive/status; none before the first step."""
        return {} if self.make_status is None else self.make_status()
