"""What the goal follower remembers of a goal on its way, what it is told, and what it answers. Positions [m], angles
[rad]."""

import math
from dataclasses import dataclass
from enum import StrEnum
from typing import NamedTuple

from sojourn_flight.mobility.ability import TurningLimits
from sojourn_flight.planning.goal import Goal, GoalOutcome
from sojourn_flight.planning.path import PlannedPath


class FollowerPhase(StrEnum):
    """What the follower is doing."""

    ALIGN = "align"
    DRIVE = "drive"
    FINAL_ALIGN = "final_align"
    SETTLE = "settle"


@dataclass(frozen=True, slots=True)
class FollowerState:
    """One goal on its way."""

    goal: Goal
    path: PlannedPath
    phase: FollowerPhase
    leg: int = 0
    """Leg of the path."""
    on_leg: float = 0.0
    """Distance gone on it [m]."""
    passed: int = 0
    """Waypoints passed."""
    elapsed: float = 0.0
    """Time since the goal was accepted [s]."""
    phase_elapsed: float = 0.0
    """Time in this phase [s]."""
    distance_to_go: float = 0.0
    """Along the path [m]; at its end the distance to the goal."""
    yaw_error: float = 0.0
    """Heading still to turn in the present phase [rad]."""
    lateral_error: float = 0.0
    """Position to the left of the path [m]."""
    lateral_max: float = 0.0
    """Greatest size of it so far [m]."""
    lateral_square: float = 0.0
    """Integral of its square over the distance followed [m^3]."""
    followed: float = 0.0
    """Distance driven on the path, all plans together [m]."""
    drift: float = 0.0
    """Angle by which the rover slides off its heading, to the left [rad]."""
    best_distance: float = math.inf
    """distance_to_go at the last progress [m]."""
    drive_stall: float = 0.0
    """Time of driving since then [s]."""
    best_yaw_error: float = math.inf
    """|yaw_error| at the last progress of this turn [rad]."""
    turn_stall: float = 0.0
    """Time of turning since then [s]."""
    attempts: int = 0
    """Times the rover stood still and was not within tolerance."""
    astern: bool = False
    """It is driven backwards."""
    trails: bool = False
    """It is to be driven backwards wherever that can be, see `supervision.astern`."""

    @property
    def index(self) -> int:
        """Waypoint the rover drives to."""
        return min(self.passed, len(self.goal.points) - 1)

    @property
    def lateral_rms(self) -> float:
        """Root mean square of the lateral error so far [m]."""
        return math.sqrt(self.lateral_square / self.followed) if self.followed > 0.0 else 0.0


class FollowerLimits(NamedTuple):
    """What the machine can do at the moment."""

    speed: float
    """[m/s]"""
    yaw_rate: float
    """[rad/s]"""
    deceleration: float
    """At the rim of a wheel [m/s^2]."""
    yaw_deceleration: float
    """Of a point turn [rad/s^2]."""
    turning: TurningLimits
    slide: tuple[float, float] = (0.0, 0.0)
    """By which a turn on the spot moves it here, for each radian, in odom [m/rad]."""


class FollowerStep(NamedTuple):
    """Result of one period."""

    state: FollowerState
    v_x: float
    """Wanted speed [m/s]."""
    yaw_rate: float
    """Wanted yaw rate [rad/s]."""
    outcome: GoalOutcome | None
    """Not None when the goal has ended."""
