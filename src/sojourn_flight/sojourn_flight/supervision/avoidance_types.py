"""What obstacle handling consists of: the machine's fixed part, what it remembers, what it answers."""

import math
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from sojourn_flight.hazards.clearance import Circles, ClearanceMap, circles_of
from sojourn_flight.hazards.keep_out import NO_ZONES, KeepOut
from sojourn_flight.hazards.obstacle_map import ObstacleMap
from sojourn_flight.hazards.obstacle_params import ObstacleParams
from sojourn_flight.hazards.stereo_camera import StereoCamera
from sojourn_flight.hazards.traversability import Obstacle, Passability
from sojourn_flight.hazards.wide_map import WideMap
from sojourn_flight.mobility.ability import TurningLimits
from sojourn_flight.mobility.twist import PlanarTwist
from sojourn_flight.planning.clothoid import Pose
from sojourn_flight.planning.follower_params import GoalFollowerParams
from sojourn_flight.planning.follower_state import FollowerState
from sojourn_flight.planning.goal import GoalOutcome
from sojourn_flight.planning.route import Route
from sojourn_flight.planning.way_back import Track, WayBack
from sojourn_machine.params import FloatArray


@dataclass(frozen=True, eq=False)
class Avoidance:
    """Obstacle handling of one machine."""

    params: ObstacleParams
    follower: GoalFollowerParams
    turning_limits: TurningLimits
    camera: StereoCamera
    supports: FloatArray
    """Their places in base_link, shape (supports, 2) [m]."""
    keep_out: KeepOut = NO_ZONES
    """Where it must not go, whatever is seen there."""
    circles: Circles = field(init=False)
    """The circles that cover the outline, see `clearance`."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "circles", circles_of(self.params.outline))

    @cached_property
    def astern(self) -> "Avoidance":
        """The same machine driven backwards: its rear is ahead."""
        outline = self.params.outline
        turned = outline.model_copy(update={"front": outline.rear, "rear": outline.front})
        return replace(self, params=self.params.model_copy(update={"outline": turned}), supports=-self.supports)

    @property
    def straight(self) -> float:
        """Distance from an obstacle that a plan keeps [m]."""
        return self.circles.radius + self.params.margin

    def straight_at(self, drift: float) -> float:
        """The same for a rover that is turned off its path by an angle [rad], and reaches to the side with its ends."""
        return min(self.straight + float(np.abs(self.circles.places).max()) * abs(math.sin(drift)), self.turning)

    @property
    def turning(self) -> float:
        """That from which the rover can turn on the spot [m]."""
        return self.params.outline.turn_radius + self.params.margin


@dataclass(frozen=True, slots=True)
class AvoidanceState:
    """What is known and what is under way."""

    map: ObstacleMap
    ground: Passability
    clearance: ClearanceMap
    wide: WideMap
    track: Track = ()
    """Poses that the rover has driven through."""
    level: float = 0.0
    """Height of the ground under the rover, as the map has it [m]."""
    since_cloud: float = 0.0
    """[s]"""
    fresh: bool = False
    """A cloud came in this period."""
    route: Route | None = None
    obstacle: Obstacle | None = None
    """What stands in the way, or has ended it."""
    blocked: bool = False
    """The guard has stopped the last motion."""
    attempts: int = 0
    """Motions that it has stopped since the rover last got on along its route."""
    mark: float = 0.0
    """Progress on the route then [m]."""
    replan: bool = False
    """The rover has backed off and needs a way from here."""
    back: WayBack | None = None
    """The way that is driven backwards; None while driving forward."""
    planned_at: float = -math.inf
    """Odometer when the last detour was planned [m]."""
    plans: int = 0
    """Detours that were planned since the rover last got on, see `avoidance.WITHOUT_HEADWAY`."""
    plans_from: float = -math.inf
    """Odometer then [m]."""
    detours: int = 0
    """Detours on the way to this goal."""


@dataclass(frozen=True, slots=True)
class ClosedPlace:
    """Where a path is closed."""

    distance: float
    """Along it from the rover [m]."""
    pose: Pose
    obstacle: Obstacle | None
    """What is there; None where the map has no name for it."""
    tilt: bool
    """It is too steep there, in the direction of the path."""


@dataclass(frozen=True, slots=True)
class Guidance:
    """What the drive is to do in a period."""

    state: AvoidanceState
    way: FollowerState
    twist: PlanarTwist | None = None
    """In place of the follower's."""
    outcome: GoalOutcome | None = None
    text: str = ""
