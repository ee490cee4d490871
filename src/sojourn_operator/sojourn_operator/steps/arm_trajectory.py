"""Arm through joint positions, each at its time."""

from collections.abc import Iterator
from itertools import pairwise
from typing import TYPE_CHECKING, ClassVar, Self

import numpy as np
from pydantic import Field, model_validator

from sojourn_config.steps import LONGEST, StepProblem
from sojourn_contract.stamps import NANOSECONDS
from sojourn_contract.values import JointTrajectory, Message, TrajectoryPoint
from sojourn_machine.params import Params
from sojourn_operator.steps.arm_joints import ArmJointsStep
from sojourn_operator.steps.step import OperatorStep, View

if TYPE_CHECKING:
    from sojourn_config.bundle import Bundle


class TimedPositions(Params):
    """Where the arm is to be at a time."""

    positions: tuple[float, ...] = Field(min_length=1, description="one for each joint, in the order of the arm [rad]")
    at: float = Field(gt=0.0, le=LONGEST, description="after the start of the motion [s]")


class ArmTrajectoryStep(Params, OperatorStep):
    """Joint positions with their times: /arm/joint_trajectory."""

    role: ClassVar[str] = "arm"
    topic: ClassVar[str] = "/arm/joint_trajectory"
    points: tuple[TimedPositions, ...] = Field(min_length=1, max_length=1000, description="in order")

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        times = [point.at for point in self.points]
        if any(later <= earlier for earlier, later in pairwise(times)):
            raise ValueError(f"times {times}: allowed is each later than the one before")
        return self

    def problems(self, bundle: "Bundle") -> Iterator[StepProblem]:
        """Another count of joints, an angle beyond a limit."""
        for index, point in enumerate(self.points):
            for key, value, allowed in ArmJointsStep(positions=point.positions).problems(bundle):
                yield ("points", index, *key), value, allowed

    def describe(self) -> str:
        """See OperatorStep."""
        return f"arm through {len(self.points)} joint positions in {self.points[-1].at:g} s"

    def goal(self, view: View) -> Message:
        """See OperatorStep."""
        points = (
            TrajectoryPoint(np.array(point.positions), time_from_start=round(point.at * NANOSECONDS))
            for point in self.points
        )
        return JointTrajectory(view.stamp, view.around.arm_joints, tuple(points))
