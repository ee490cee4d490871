"""Drive to a pose."""

import math
from collections.abc import Iterable
from typing import ClassVar

from pydantic import Field

from sojourn_config.steps import FARTHEST
from sojourn_config.yaml_file import KeyPath
from sojourn_contract.values import Message
from sojourn_machine.params import Params
from sojourn_operator.goal_messages import drive_goal
from sojourn_operator.steps.step import OperatorStep, View


class DriveGoalStep(Params, OperatorStep):
    """A pose to drive to: /goal_pose."""

    role: ClassVar[str] = "drive"
    topic: ClassVar[str] = "/goal_pose"
    x: float = Field(ge=-FARTHEST, le=FARTHEST, description="position in map [m]")
    y: float = Field(ge=-FARTHEST, le=FARTHEST, description="position in map [m]")
    yaw: float | None = Field(
        default=None, ge=-2 * math.pi, le=2 * math.pi, description="heading there; free if left out [rad]"
    )

    def places(self) -> Iterable[tuple[KeyPath, float, float]]:
        """See Step."""
        return [((), self.x, self.y)]

    def describe(self) -> str:
        """See OperatorStep."""
        return f"drive to ({self.x:.2f}, {self.y:.2f})" + ("" if self.yaw is None else f" heading {self.yaw:.2f} rad")

    def goal(self, view: View) -> Message:
        """See OperatorStep."""
        return drive_goal(view.stamp, (self.x, self.y), self.yaw)
