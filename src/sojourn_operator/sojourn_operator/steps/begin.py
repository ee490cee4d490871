"""Begin another step and go on after a while, whatever has become of it: the next may cut it short."""

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, Self

from pydantic import Field, model_validator

from sojourn_config.steps import LONGEST, StepConfig, StepProblem
from sojourn_config.yaml_file import KeyPath
from sojourn_contract.values import Message
from sojourn_machine.params import Params
from sojourn_operator.steps.step import DONE, OperatorStep, View

if TYPE_CHECKING:
    from sojourn_config.bundle import Bundle


class BeginStep(Params, OperatorStep):
    """`- begin: {step: {arm_joints: {name: unfold}}, seconds: 5.0}` in a scenario."""

    step: StepConfig = Field(description="what is begun, as it would stand in the scenario")
    seconds: float = Field(gt=0.0, le=LONGEST, description="after which the operator goes on [s]")

    @model_validator(mode="after")
    def _without_limit(self) -> Self:
        if self.step.timeout_s is not None:
            raise ValueError("step.timeout_s: allowed is none, nobody waits for the end of the step")
        return self

    @property
    def role(self) -> str:  # type: ignore[override]
        """That of the step."""
        return str(self.step.action.role)

    @property
    def topic(self) -> str:  # type: ignore[override]
        """That of the step."""
        return str(self.step.action.topic)

    @property
    def looks_at_ground(self) -> bool:  # type: ignore[override]
        """That of the step."""
        return bool(self.step.action.looks_at_ground)

    def places(self) -> Iterable[tuple[KeyPath, float, float]]:
        """See Step."""
        return [(self._within(key), x, y) for key, x, y in self.step.action.places()]

    def problems(self, bundle: "Bundle") -> Iterable[StepProblem]:
        """See Step."""
        return [(self._within(key), value, allowed) for key, value, allowed in self.step.action.problems(bundle)]

    def describe(self) -> str:
        """See OperatorStep."""
        return f"begin: {self.step.action.describe()}"

    def say(self, view: View) -> Message | None:
        """See OperatorStep."""
        said: Message | None = self.step.action.say(view)
        return said

    def end(self, view: View) -> tuple[str, str] | None:
        """See OperatorStep."""
        return (DONE, "") if view.is_over(self.seconds) else None

    def _within(self, key: KeyPath) -> KeyPath:
        found: Any = ("step", self.step.kind, *key)
        return found
