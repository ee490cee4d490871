"""Arm to joint positions, or to a pose that has a name."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, ClassVar, Self

import numpy as np
from pydantic import Field, model_validator

from sojourn_config.steps import StepProblem
from sojourn_contract.values import JointState, Message
from sojourn_machine.names import names_text
from sojourn_machine.params import Params
from sojourn_operator.steps.step import OperatorStep, View

if TYPE_CHECKING:
    from sojourn_config.bundle import Bundle


class ArmJointsStep(Params, OperatorStep):
    """Joint positions, or the name of a pose of the arm: /arm/joint_goal."""

    role: ClassVar[str] = "arm"
    topic: ClassVar[str] = "/arm/joint_goal"
    name: str | None = Field(default=None, min_length=1, description="named pose of the arm: stow, unfold")
    positions: tuple[float, ...] | None = Field(
        default=None, min_length=1, description="one for each joint, in the order of the arm [rad]"
    )

    @model_validator(mode="after")
    def _one_of_them(self) -> Self:
        if (self.name is None) == (self.positions is None):
            raise ValueError("allowed is either name or positions")
        return self

    def problems(self, bundle: "Bundle") -> Iterator[StepProblem]:
        """A pose that the arm has not, another count of joints, an angle beyond a limit."""
        arm = bundle.carried_arm()
        if self.name is not None and self.name not in arm.named_poses:
            yield ("name",), self.name, "is no pose of the arm: " + names_text(self.name, arm.named_poses)
        if self.positions is None:
            return
        names = arm.joint_names
        if len(self.positions) != len(names):
            allowed = f"has {len(self.positions)} values: allowed is {len(names)}, for " + ", ".join(names)
            yield ("positions",), list(self.positions), allowed
            return
        for index, (value, name) in enumerate(zip(self.positions, names, strict=True)):
            joint = bundle.urdf.joints[name]
            if not joint.lower <= value <= joint.upper:
                allowed = f"allowed is {joint.lower:g} to {joint.upper:g} {joint.unit}, the limits of {name}"
                yield ("positions", index), value, allowed

    def describe(self) -> str:
        """See OperatorStep."""
        return f"arm: {self.name}" if self.positions is None else f"arm to {len(self.positions)} joint positions"

    def goal(self, view: View) -> Message:
        """See OperatorStep."""
        if self.positions is None:
            return JointState(view.stamp, (), np.zeros(0), frame=self.name or "")
        return JointState(view.stamp, view.around.arm_joints, np.array(self.positions))
