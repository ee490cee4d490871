"""What obstacle handling consists of: the machine's fixed part, what it remembers, what it answers."""

import math
from dataclasses import dataclass, field

from sojourn_mechanics.params import FloatArray
from sojourn_mechanics.steering.goal import GoalOutcome
from sojourn_mechanics.steering.goal_follower import FollowerState
from sojourn_mechanics.steering.kinematics import PlanarTwist
from sojourn_mechanics.steering.obstacle_map import ObstacleMap
from sojourn_mechanics.steering.obstacle_params import ObstacleParams
from sojourn_mechanics.steering.params import GoalFollowerParams
from sojourn_mechanics.steering.room import Room, circles_of
from sojourn_mechanics.steering.route import Route
from sojourn_mechanics.steering.stereo_eye import StereoEye
from sojourn_mechanics.steering.traversability import Obstacle, Passability
from sojourn_mechanics.steering.turning_limits import TurningLimits
from sojourn_mechanics.steering.way_round import Area


@dataclass(frozen=True, eq=False)
class Avoidance:
    """Obstacle handling of one machine."""

    params: ObstacleParams
    follower: GoalFollowerParams
    turning_limits: TurningLimits
    eye: StereoEye
    area: Area | None = None
    """Where the rover may go; None for anywhere."""
    circles: FloatArray = field(init=False)
    radius: float = field(init=False)
    """The circles that cover the outline, see `room`."""

    def __post_init__(self) -> None:
        circles, radius = circles_of(self.params.outline)
        object.__setattr__(self, "circles", circles)
        object.__setattr__(self, "radius", radius)

    @property
    def straight(self) -> float:
        """Distance from an obstacle that a plan keeps [m]."""
        return self.radius + self.params.margin

    @property
    def turning(self) -> float:
        """That from which the rover can turn on the spot [m]."""
        return self.params.outline.turn_radius + self.params.margin


@dataclass(frozen=True, slots=True)
class AvoidanceState:
    """What is known and what is under way."""

    map: ObstacleMap
    ground: Passability
    room: Room
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
    back_until: float | None = None
    """Odometer at which backing off ends [m]; None while driving forward."""
    planned_at: float = -math.inf
    """Odometer when the last way round was planned [m]."""
    detours: int = 0
    """Ways round on the way to this goal."""


@dataclass(frozen=True, slots=True)
class Guidance:
    """What the drive is to do in a period."""

    state: AvoidanceState
    way: FollowerState
    twist: PlanarTwist | None = None
    """In place of the follower's."""
    outcome: GoalOutcome | None = None
    text: str = ""
