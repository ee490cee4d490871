"""A fault by hand: the message, and what plant and sensors say of it in their heartbeats."""

import argparse
from collections.abc import Iterable, Mapping

from sojourn_config.command_errors import CommandError
from sojourn_contract.errors import ContractError
from sojourn_contract.fault_messages import TOPIC, FaultEvent, fault_message, read_fault
from sojourn_contract.heartbeat import Heartbeat, status_message
from sojourn_contract.values import DiagnosticArray

CAME, WENT, REFUSED = "it has come", "it has gone", "refused"


def fault_event(given: argparse.Namespace, words: Iterable[tuple[str, str]]) -> FaultEvent:
    """What was asked for. Raises CommandError for words that no fault has."""
    try:
        event = read_fault(status_message(0, given.name, {"kind": given.kind, **_with_lists(words)}))
    except ContractError as error:
        raise CommandError(str(error).removeprefix(f"{TOPIC}.")) from None
    if event.fault.in_scenario_alone:
        raise CommandError(
            "allowed in a scenario alone, where whoever waits for messages that are lost or late knows it"
        )
    return event._replace(comes=not given.gone)


def message_of(event: FaultEvent) -> DiagnosticArray:
    """As it is sent, for now."""
    return fault_message(0, event)


def answer_of(
    event: FaultEvent, before: Mapping[str, Heartbeat], now: Mapping[str, Heartbeat]
) -> tuple[str, str] | None:
    """What has become of it, and why, by the heartbeats of all roles before it was sent and now; None: not known."""
    beat = now.get(event.fault.role)
    if beat is None:
        return None
    old = before.get(beat.role)
    refused = 0 if old is None else old.refused.get(TOPIC, 0)
    if beat.refused.get(TOPIC, 0) > refused:
        return REFUSED, beat.values.get("last refusal", "")
    is_there = event.name in beat.values.get("faults", "").split(", ")
    if is_there != event.comes or beat is old:
        return None
    return (CAME if event.comes else WENT), f"{event.name} of {beat.role}"


def _with_lists(words: Iterable[tuple[str, str]]) -> dict[str, str]:
    """Numbers with blanks between them are a list."""
    return {key: f"[{', '.join(text.split())}]" if " " in text.strip() else text for key, text in words}
