"""A goal as it stands on the page before it is sent, as a plain value."""

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np

from sojourn_config.yaml_file import plain_scalar
from sojourn_console.errors import GoalError
from sojourn_contract.heartbeat import status_message
from sojourn_contract.values import UPRIGHT, Message, Path, PoseStamped
from sojourn_flight.hazards.zone_params import KeepOutZone, first_in
from sojourn_flight.planning.global_route import NoRouteError, SiteMap
from sojourn_machine.params import FloatArray
from sojourn_operator.goal_messages import drive_goal, pose_message, question_message, route_goal
from sojourn_physics.terrain.height_field import HeightField

Point = tuple[float, float, float]
"""x, y, z in map, or for the arm in base_link [m]."""
Kind = Literal["drive", "route", "arm", "task"]
TOPICS: Mapping[Kind, str] = {
    "drive": "/goal_pose", "route": "/waypoints", "arm": "/arm/goal_pose", "task": "/arm/task",
}  # fmt: skip
"""On which each is sent."""


@dataclass(frozen=True)
class Draft:
    """A goal.

    Args:
        kind: of goal. points: of the way in map; of the arm the one place of its tip in base_link.
        yaw: heading at the end [rad], None for any. task: its name. values: its numbers, as they are sent.
        over_map: whether the points are a way over the map.
    """

    kind: Kind = "drive"
    points: tuple[Point, ...] = ()
    yaw: float | None = None
    task: str = ""
    values: Mapping[str, str] = field(default_factory=dict)
    over_map: bool = False

    def with_point(self, point: Point) -> "Draft":
        """With one more point of a route, or another place."""
        return replace(self, points=(*self.points, point) if self.kind == "route" else (point,), over_map=False)

    def without_last(self) -> "Draft":
        """With one point less."""
        return replace(self, points=self.points[:-1])

    def moved(self, number: int, point: Point) -> "Draft":
        """With one of its points elsewhere."""
        return replace(self, points=(*self.points[:number], point, *self.points[number + 1 :]))

    def over(self, site: SiteMap, start: Point, heights: Callable[[FloatArray], FloatArray]) -> "Draft":
        """A route over a map to its last point. Raises GoalError where there is none.

        Args:
            site: the map. start: where the machine is. heights: of the ground at places, shape (n, 2) [m].
        """
        if not (self.is_way and self.points):
            raise GoalError(self.kind, "there is no place to which a route could lead: click on the ground")
        try:
            corners = np.array(site.route(start[:2], self.points[-1][:2]))
        except NoRouteError as error:
            raise GoalError("over the map", str(error)) from error
        points = np.column_stack([corners, heights(corners)])
        places = tuple((float(x), float(y), float(z)) for x, y, z in points)
        return replace(self, kind="route", points=places, over_map=True)

    @property
    def is_way(self) -> bool:
        """Whether it is one for the drive."""
        return self.kind in ("drive", "route")

    @property
    def topic(self) -> str:
        """On which it is sent."""
        return TOPICS[self.kind]

    @property
    def length(self) -> float:
        """Between its points [m]."""
        return sum(math.dist(one[:2], other[:2]) for one, other in itertools.pairwise(self.points))

    def check(self, ground: HeightField, zones: Sequence[KeepOutZone] = ()) -> None:
        """Raise GoalError for what cannot be sent. zones: into which the drive must not go."""
        if self.kind == "task":
            if not self.task:
                raise GoalError("task", "none is chosen")
            return
        if not self.points:
            raise GoalError(self.kind, "there is no place yet: click on the ground")
        if self.kind == "arm":
            return
        x_min, x_max, y_min, y_max = ground.bounds
        for x, y, _ in self.points:
            if not (x_min <= x <= x_max and y_min <= y <= y_max):
                allowed = f"allowed is x from {x_min:g} to {x_max:g} m and y from {y_min:g} to {y_max:g} m"
                raise GoalError(f"({x:.2f}, {y:.2f})", f"it is off the map: {allowed}")
        inside = first_in(zones, np.array(self.points)[:, :2])
        if inside is not None:
            x, y, _ = self.points[inside[0]]
            raise GoalError(f"({x:.2f}, {y:.2f})", f"it lies in the keep-out zone {inside[1].name}")

    def message(self, stamp: int) -> tuple[str, Message]:
        """Topic and message of it."""
        if self.kind == "task":
            return self.topic, status_message(stamp, self.task, dict(self.values))
        if self.kind == "arm":
            return self.topic, pose_message(stamp, "base_link", self.points[0], UPRIGHT)
        return self.topic, self._way(stamp)

    def question(self, stamp: int) -> Path:
        """What asks the drive what it would take. Raises GoalError for a goal of the arm."""
        if not self.is_way:
            raise GoalError(self.kind, "the drive can be asked about ways alone")
        return question_message(self._way(stamp))

    def words(self) -> str:
        """What it is, in a few words."""
        if self.kind == "task":
            return f"task {self.task}"
        x, y, z = self.points[-1]
        if self.kind == "arm":
            return f"arm to ({x:.2f}, {y:.2f}, {z:.2f})"
        way = "drive" if self.kind == "drive" else f"route of {len(self.points)} points"
        return f"{way} to ({x:.2f}, {y:.2f})"

    def step(self) -> dict[str, Any]:
        """As a step of a scenario or a sequence."""
        yaw = {} if self.yaw is None else {"yaw": round(self.yaw, 4)}
        places = [{"x": round(x, 3), "y": round(y, 3)} for x, y, _ in self.points]
        if self.kind == "task":
            values = {key: _number(text) for key, text in self.values.items()}
            return {"arm_task": {"name": self.task, "values": values}}
        if self.kind == "arm":
            return {"arm_to": {**places[0], "z": round(self.points[0][2], 3)}}
        return (
            {"drive_to": {**places[0], **yaw}} if self.kind == "drive" else {"drive_route": {"points": places, **yaw}}
        )

    def _way(self, stamp: int) -> PoseStamped | Path:
        if self.kind == "drive":
            x, y, z = self.points[0]
            return drive_goal(stamp, (x, y), self.yaw, "map", z)
        return route_goal(stamp, [(x, y) for x, y, _ in self.points], self.yaw, "map")


def _number(text: str) -> Any:
    """A value of a task as a file has it: a number, several, true, false; else the text, which is refused there."""
    parts = [plain_scalar(part) for part in text.split(",")]
    return parts[0] if len(parts) == 1 else parts
