"""Requests as they come over /power/request, and what the status says of the last one."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from sojourn_contract.heartbeat import status_values
from sojourn_contract.values import DiagnosticArray
from sojourn_flight.power_manager.requests import parse_switches
from sojourn_flight.power_manager.switchboard import LoadSwitch
from sojourn_machine.errors import InvalidValueError


@dataclass(frozen=True, slots=True)
class LastRequest:
    """What an operator asked last."""

    stamp: int = 0
    """Of its message [ns]."""
    asked: Mapping[str, bool] = field(default_factory=dict)
    """Load name to on (True) or off (False); empty where it was refused, or none has come."""
    refused: str = ""
    """Why it was, in words."""

    def status(self, switches: Sequence[LoadSwitch]) -> dict[str, str]:
        """Fields of /power/status; a load that is wanted on and is off all the same waits, for the reason of its
        switch.
        """
        waiting = [f"{one.name}: {one.reason}" for one in switches if self.asked.get(one.name) and one.mode == "off"]
        state = "refused" if self.refused else "waiting" if waiting else "done" if self.asked else "none"
        return {
            "request": ", ".join(f"{name} {'on' if on else 'off'}" for name, on in self.asked.items()),
            "request_stamp": str(self.stamp),
            "request_state": state,
            "request_reason": self.refused or "; ".join(waiting),
        }


NO_REQUEST = LastRequest()


def switches_of(message: DiagnosticArray) -> Mapping[str, bool]:
    """Load name to on (True) or off (False), of the one status that a request has. Raises InvalidValueError."""
    if len(message.status) != 1:
        raise InvalidValueError("statuses", len(message.status), "one, whose keys are loads")
    return parse_switches(status_values(message))
