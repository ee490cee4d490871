"""Tip of the arm along lines and arcs."""

from typing import ClassVar, Literal, Self

from pydantic import Field, model_validator

from sojourn_contract.values import Message, Path
from sojourn_machine.params import Params
from sojourn_operator.goal_messages import pose_message
from sojourn_operator.steps.arm_to import ArmPoint
from sojourn_operator.steps.step import OperatorStep, View


class ArmPathPoint(ArmPoint):
    """A point of a path of the arm's tip."""

    on_arc: bool = Field(default=False, description="gone by on an arc, from the point before to the one after")


class ArmPathStep(Params, OperatorStep):
    """Straight lines and arcs of the arm's tip, from where it is: /arm/path."""

    role: ClassVar[str] = "arm"
    topic: ClassVar[str] = "/arm/path"
    frame: Literal["base_link", "map"] = Field(default="base_link", description="frame of the numbers")
    points: tuple[ArmPathPoint, ...] = Field(min_length=1, max_length=1000, description="points in order")

    @model_validator(mode="after")
    def _arcs_have_ends(self) -> Self:
        for k, point in enumerate(self.points):
            if point.on_arc and (k + 1 == len(self.points) or self.points[k + 1].on_arc):
                raise ValueError(f"points[{k}] is on an arc: allowed is one such point, then the arc's end")
        return self

    def describe(self) -> str:
        """See OperatorStep."""
        return f"arm along {len(self.points)} points"

    def goal(self, view: View) -> Message:
        """See OperatorStep."""
        poses = (
            pose_message(view.stamp, "arc" if point.on_arc else self.frame, point.position, point.orientation)
            for point in self.points
        )
        return Path(view.stamp, self.frame, tuple(poses))
