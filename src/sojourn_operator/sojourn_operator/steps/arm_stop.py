"""Stop the arm, whatever it does."""

from typing import ClassVar

from sojourn_contract.values import Header, Message
from sojourn_machine.params import Params
from sojourn_operator.steps.step import View
from sojourn_operator.steps.word import Word


class ArmStopStep(Params, Word):
    """A stop of the arm: /arm/stop. It has no words: `- arm_stop: {}`."""

    role: ClassVar[str] = "arm"
    topic: ClassVar[str] = "/arm/stop"

    def describe(self) -> str:
        """See OperatorStep."""
        return "stop the arm"

    def goal(self, view: View) -> Message:
        """See OperatorStep."""
        return Header(view.stamp)
