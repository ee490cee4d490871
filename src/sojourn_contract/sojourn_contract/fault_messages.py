"""Messages of /faults: a fault that comes, with the words of its kind, or one that goes."""

import json
from typing import NamedTuple

from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.goal_topics import FAULTS_TOPIC
from sojourn_contract.heartbeat import status_message
from sojourn_contract.values import DiagnosticArray
from sojourn_machine.errors import InvalidValueError, UnknownNameError
from sojourn_machine.fault_choice import FaultChoice, read_fault_words
from sojourn_machine.names import names_text

PRESENT, GONE = "present", "gone"


class FaultEvent(NamedTuple):
    """What a message says."""

    name: str
    fault: FaultChoice
    comes: bool
    """Whether it comes; else it goes."""


def fault_message(stamp: int, event: FaultEvent) -> DiagnosticArray:
    """As it is sent, stamped `stamp` [ns]."""
    words = {key: value for key, value in event.fault.words().items() if value is not None}
    values = {"state": PRESENT if event.comes else GONE, **{key: _text(value) for key, value in words.items()}}
    return status_message(stamp, event.name, values, level=2 if event.comes else 0)


def read_fault(message: DiagnosticArray) -> FaultEvent:
    """What a message says.

    Raises:
        RefusedMessageError: it names no fault that there is, or has words that its kind does not take.
    """
    if len(message.status) != 1:
        raise RefusedMessageError(FAULTS_TOPIC, "status", f"{len(message.status)} faults", "one a message")
    status = message.status[0]
    words = dict(status.values)
    state, kind = words.pop("state", PRESENT), words.get("kind", "")
    if state not in (PRESENT, GONE):
        raise RefusedMessageError(FAULTS_TOPIC, "state", state, f"{PRESENT} or {GONE}")
    try:
        fault = read_fault_words({key: _value(text) for key, text in words.items()})
    except InvalidValueError as error:
        raise RefusedMessageError(FAULTS_TOPIC, error.name, error.value, error.allowed) from None
    except UnknownNameError as error:
        allowed = names_text(kind, error.valid).removeprefix("allowed is ")
        raise RefusedMessageError(FAULTS_TOPIC, "kind", kind, allowed) from None
    return FaultEvent(status.name or fault.called, fault, state == PRESENT)


def _text(value: object) -> str:
    return value if isinstance(value, str) else json.dumps(value)


def _value(text: str) -> object:
    """A number, a list or a truth value where it reads as one; else the text."""
    try:
        return json.loads(text)
    except ValueError:
        return text
