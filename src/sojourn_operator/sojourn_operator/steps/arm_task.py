"""Task of the arm."""

from typing import ClassVar, Self

from pydantic import Field, model_validator

from sojourn_contract.heartbeat import status_message
from sojourn_contract.values import Message
from sojourn_flight.arm.refusal import GoalRefusedError
from sojourn_flight.arm.tasks.requests import parse_task
from sojourn_machine.params import Params
from sojourn_operator.steps.step import OperatorStep, View


class ArmTaskStep(Params, OperatorStep):
    """A task of the arm with its numbers: /arm/task."""

    role: ClassVar[str] = "arm"
    topic: ClassVar[str] = "/arm/task"
    name: str = Field(min_length=1, description="name of the task: guarded_move, ...")
    values: dict[str, bool | float | tuple[float, ...]] = Field(default_factory=dict, description="its numbers, by key")

    @model_validator(mode="after")
    def _task_is_known(self) -> Self:
        try:
            parse_task(self.name, self.texts)
        except GoalRefusedError as error:
            raise ValueError(str(error)) from error
        return self

    @property
    def texts(self) -> dict[str, str]:
        """The numbers as /arm/task carries them."""
        return {key: _text(value) for key, value in self.values.items()}

    def describe(self) -> str:
        """See OperatorStep."""
        return " ".join((f"arm: {self.name}", *(f"{key}={value}" for key, value in self.texts.items())))

    def goal(self, view: View) -> Message:
        """See OperatorStep."""
        return status_message(view.stamp, self.name, self.texts)


def _text(value: bool | float | tuple[float, ...]) -> str:
    if isinstance(value, tuple):
        return " ".join(f"{number:g}" for number in value)
    return str(value).lower() if isinstance(value, bool) else f"{value:g}"
