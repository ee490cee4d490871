"""Point joints that neither drive nor arm moves, as a mast's pan and tilt."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from pydantic import Field, model_validator

from sojourn_config.steps import StepProblem
from sojourn_contract.values import JointState, Message
from sojourn_machine.names import names_text
from sojourn_machine.params import Params
from sojourn_operator.steps.step import DONE, OperatorStep, View

if TYPE_CHECKING:
    from sojourn_config.bundle import Bundle


class MastStep(Params, OperatorStep):
    """Joint positions: /mast/joint_goal. Nobody says when they are reached: the step lasts `time`."""

    topic: ClassVar[str] = "/mast/joint_goal"
    positions: dict[str, float] = Field(min_length=1, description="by the joints' names [rad]")
    time: float = Field(default=0.0, ge=0.0, le=3600.0, description="how long the step lasts [s]")

    @model_validator(mode="after")
    def _finite(self) -> "MastStep":
        if not np.isfinite(list(self.positions.values())).all():
            raise ValueError("positions: allowed are finite numbers")
        return self

    def problems(self, bundle: "Bundle") -> Iterator[StepProblem]:
        """A joint that nobody points, an angle beyond a limit."""
        names = bundle.pointed_joints
        for name, value in self.positions.items():
            if name not in names:
                yield ("positions", name), value, "is no joint that an operator points: " + names_text(name, names)
                continue
            joint = bundle.urdf.joints[name]
            if not joint.lower <= value <= joint.upper:
                allowed = f"allowed is {joint.lower:g} to {joint.upper:g} {joint.unit}, the limits of {name}"
                yield ("positions", name), value, allowed

    def describe(self) -> str:
        """See OperatorStep."""
        return "mast to " + ", ".join(f"{name} {angle:g} rad" for name, angle in self.positions.items())

    def goal(self, view: View) -> Message:
        """See OperatorStep."""
        return JointState(view.stamp, tuple(self.positions), np.array(list(self.positions.values())))

    def end(self, view: View) -> tuple[str, str] | None:
        """See OperatorStep."""
        return (DONE, "") if view.is_over(self.time) else None
