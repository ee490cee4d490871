"""Drive through points."""

import math
from collections.abc import Iterable
from typing import ClassVar

from pydantic import Field

from sojourn_config.steps import FARTHEST
from sojourn_config.yaml_file import KeyPath
from sojourn_contract.values import Message
from sojourn_machine.params import Params
from sojourn_operator.goal_messages import route_goal
from sojourn_operator.steps.step import OperatorStep, View


class PointParams(Params):
    """A point on the way."""

    x: float = Field(ge=-FARTHEST, le=FARTHEST, description="position in map [m]")
    y: float = Field(ge=-FARTHEST, le=FARTHEST, description="position in map [m]")


class DriveRouteStep(Params, OperatorStep):
    """Points to drive through, the last one is the goal: /waypoints."""

    role: ClassVar[str] = "drive"
    topic: ClassVar[str] = "/waypoints"
    points: tuple[PointParams, ...] = Field(min_length=1, max_length=1000, description="points in order")
    yaw: float | None = Field(
        default=None, ge=-2 * math.pi, le=2 * math.pi, description="heading there; free if left out [rad]"
    )

    @property
    def corners(self) -> list[tuple[float, float]]:
        """The points as x, y in map [m]."""
        return [(point.x, point.y) for point in self.points]

    def places(self) -> Iterable[tuple[KeyPath, float, float]]:
        """See Step."""
        return [(("points", index), x, y) for index, (x, y) in enumerate(self.corners)]

    def describe(self) -> str:
        """See OperatorStep."""
        return f"drive along {len(self.points)} points"

    def goal(self, view: View) -> Message:
        """See OperatorStep."""
        return route_goal(view.stamp, self.corners, self.yaw)
