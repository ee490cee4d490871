"""Tell the drive where it is."""

import math
from typing import ClassVar

from pydantic import Field

from sojourn_config.steps import FARTHEST
from sojourn_contract.values import Message
from sojourn_machine.params import Params
from sojourn_operator.goal_messages import place_message
from sojourn_operator.steps.step import View
from sojourn_operator.steps.word import Word


class PlaceStep(Params, Word):
    """An operator's word where the machine is: /initialpose."""

    role: ClassVar[str] = "drive"
    topic: ClassVar[str] = "/initialpose"
    x: float = Field(ge=-FARTHEST, le=FARTHEST, description="position in map [m]")
    y: float = Field(ge=-FARTHEST, le=FARTHEST, description="position in map [m]")
    yaw: float = Field(ge=-2 * math.pi, le=2 * math.pi, description="heading [rad]")
    within: float = Field(default=0.05, gt=0.0, le=100.0, description="standard deviation of the place [m], and [rad]")

    def describe(self) -> str:
        """See OperatorStep."""
        return f"say that it is at ({self.x:.2f}, {self.y:.2f}) heading {self.yaw:.2f} rad"

    def goal(self, view: View) -> Message:
        """See OperatorStep."""
        return place_message(view.stamp, (self.x, self.y), self.yaw, self.within)
