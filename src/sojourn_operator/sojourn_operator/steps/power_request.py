"""Ask the power manager to switch loads."""

from typing import ClassVar, Literal

from pydantic import Field

from sojourn_contract.heartbeat import status_message
from sojourn_contract.values import Message
from sojourn_machine.params import Params
from sojourn_operator.steps.step import View
from sojourn_operator.steps.word import Word


class PowerRequestStep(Params, Word):
    """Loads to switch on or off: /power/request. A load that is not there is refused by the power manager."""

    topic: ClassVar[str] = "/power/request"
    loads: dict[str, Literal["on", "off"]] = Field(min_length=1, description="by name of the load")

    def describe(self) -> str:
        """See OperatorStep."""
        return "switch " + ", ".join(f"{load} {switch}" for load, switch in self.loads.items())

    def goal(self, view: View) -> Message:
        """See OperatorStep."""
        return status_message(view.stamp, "request", dict(self.loads))
