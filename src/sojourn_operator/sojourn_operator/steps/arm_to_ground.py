"""Tip of the arm to the ground."""

from typing import ClassVar

from pydantic import Field

from sojourn_contract.values import UPRIGHT, Message
from sojourn_machine.params import Params
from sojourn_operator.goal_messages import pose_message
from sojourn_operator.steps.step import OperatorStep, View


class ArmGroundStep(Params, OperatorStep):
    """A place over the ground: the operator looks its height up and sends /arm/goal_pose."""

    role: ClassVar[str] = "arm"
    topic: ClassVar[str] = "/arm/goal_pose"
    looks_at_ground: ClassVar[bool] = True
    x: float = Field(ge=-10.0, le=10.0, description="position of the target in base_link [m]")
    y: float = Field(ge=-10.0, le=10.0, description="position of the target in base_link [m]")
    height: float = Field(default=0.0, ge=-0.1, le=2.0, description="of the tip above the ground [m]")

    def describe(self) -> str:
        """See OperatorStep."""
        above = f", {self.height:.3f} m above it" if self.height else ""
        return f"arm to the ground at ({self.x:.2f}, {self.y:.2f}){above}"

    def goal(self, view: View) -> Message:
        """See OperatorStep."""
        return pose_message(view.stamp, "base_link", view.over_ground(self.x, self.y, self.height), UPRIGHT)
