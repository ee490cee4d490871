"""Tip of the arm to a place."""

import math
from typing import ClassVar, Literal, Self

from pydantic import Field, model_validator

from sojourn_config.steps import FARTHEST
from sojourn_contract.values import Message
from sojourn_machine.params import Params
from sojourn_operator.goal_messages import pose_message
from sojourn_operator.steps.step import OperatorStep, View

UNIT_TOLERANCE = 1e-3
"""How far the length of a quaternion may be from 1."""


class ArmPoint(Params):
    """A place for the arm's tip, and the direction of its tool there."""

    x: float = Field(ge=-FARTHEST, le=FARTHEST, description="position of the tip [m]")
    y: float = Field(ge=-FARTHEST, le=FARTHEST, description="position of the tip [m]")
    z: float = Field(ge=-FARTHEST, le=FARTHEST, description="position of the tip [m]")
    orientation: tuple[float, float, float, float] = Field(
        default=(0.0, 0.0, 0.0, 1.0),
        description="of the tip frame, quaternion x y z w [-]; 0 0 0 1 leaves the direction of the tool free",
    )

    @property
    def position(self) -> tuple[float, float, float]:
        """Of the tip [m]."""
        return self.x, self.y, self.z

    @model_validator(mode="after")
    def _orientation_is_a_rotation(self) -> Self:
        length = math.hypot(*self.orientation)
        if abs(length - 1.0) > UNIT_TOLERANCE:
            raise ValueError(f"orientation = {self.orientation} has length {length:.4g}: allowed is 1")
        return self


class ArmPoseStep(ArmPoint, OperatorStep):
    """A place for the arm's tip: /arm/goal_pose."""

    role: ClassVar[str] = "arm"
    topic: ClassVar[str] = "/arm/goal_pose"
    frame: Literal["base_link", "map"] = Field(default="base_link", description="frame of the numbers")

    def describe(self) -> str:
        """See OperatorStep."""
        return f"arm to ({self.x:.3f}, {self.y:.3f}, {self.z:.3f})"

    def goal(self, view: View) -> Message:
        """See OperatorStep."""
        return pose_message(view.stamp, self.frame, self.position, self.orientation)
