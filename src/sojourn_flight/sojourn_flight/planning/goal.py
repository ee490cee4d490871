"""Goals of the drive: a pose or a path of waypoints, how a goal ends, and the reasons for refusing one."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from sojourn_flight.planning.follower_params import GoalFollowerParams

Point = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Goal:
    """Where to go, in odom. Any numbers are accepted here; `refusal` says what is wrong with them."""

    points: tuple[Point, ...]
    """Points in order [m]; all but the last are only passed."""
    yaw: float | None = None
    """Heading at the last point [rad], None if any will do."""
    kind: Literal["goal", "waypoints"] = "goal"
    """How it was asked for."""
    heights: tuple[float | None, ...] = ()
    """Height of the ground at the points in odom [m], as far as it is known; empty if it is not at all."""
    number: int = 0
    """By which who sent it knows it again in its outcome: goals that ask for the same are still two."""

    @classmethod
    def at(cls, x: float, y: float, yaw: float | None = None, number: int = 0) -> "Goal":
        """One point [m] with an optional heading [rad]."""
        return cls(points=((float(x), float(y)),), yaw=yaw, kind="goal", number=number)

    @classmethod
    def along(cls, points: Sequence[Point], yaw: float | None = None, number: int = 0) -> "Goal":
        """A path [m] with an optional heading at its end [rad]."""
        return cls(points=tuple((float(x), float(y)) for x, y in points), yaw=yaw, kind="waypoints", number=number)


@dataclass(frozen=True, slots=True)
class GoalOutcome:
    """How a goal ended."""

    kind: Literal["reached", "refused", "stopped"]
    reason: str
    """In words; for `reached`, how closely."""
    goal: Goal
    distance_to_go: float
    """Along the path [m]; not a number for a goal that was refused."""
    lateral_rms: float = 0.0
    lateral_max: float = 0.0
    """Root mean square and greatest size of the lateral error on the path [m]."""


def path_lengths(start: Point, points: Sequence[Point]) -> tuple[float, ...]:
    """Length of the path from each point to the last [m], preceded by the one from `start`."""
    lengths = [0.0]
    for here, there in zip(reversed((start, *points[:-1])), reversed(points), strict=True):
        lengths.append(lengths[-1] + math.hypot(there[0] - here[0], there[1] - here[1]))
    return tuple(reversed(lengths))


def refusal(params: GoalFollowerParams, goal: Goal, position: Point) -> str | None:
    """Why a goal cannot be accepted from a position [m], or None if it can."""
    if not goal.points:
        return "the path has no points"
    if len(goal.points) > params.max_waypoints:
        return f"the path has {len(goal.points)} points, allowed are {params.max_waypoints}"
    for index, (x, y) in enumerate(goal.points):
        if not (math.isfinite(x) and math.isfinite(y)):
            return f"point {index} is ({x}, {y}), allowed are finite numbers"
    if goal.yaw is not None and not math.isfinite(goal.yaw):
        return f"the heading is {goal.yaw}, allowed is a finite number"
    length = path_lengths(position, goal.points)[0]
    if length > params.max_range:
        return f"the path is {length:.1f} m long, allowed are {params.max_range:.1f} m"
    return None
