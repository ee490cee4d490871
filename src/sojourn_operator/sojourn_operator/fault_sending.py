"""A fault by hand: the message, and what plant and sensors say of it in their heartbeats."""

import argparse
from collections.abc import Iterable, Mapping

from sojourn_config.command_errors import UsageError
from sojourn_contract.errors import ContractError
from sojourn_contract.fault_messages import FaultEvent, fault_message, read_fault
from sojourn_contract.goal_topics import FAULTS_TOPIC
from sojourn_contract.heartbeat import Heartbeat, status_message
from sojourn_contract.values import DiagnosticArray
from sojourn_machine.fault_choice import FaultChoice
from sojourn_machine.fault_names import FAULTS

CAME, WENT, REFUSED, NOT_THERE = "it has come", "it has gone", "refused", "no such fault is there"
SCENARIO_WORDS = frozenset(FaultChoice.model_fields) - {"kind", "name"}
"""When a fault comes and goes, and how it should show: no message says so."""


def fault_event(given: argparse.Namespace, words: Iterable[tuple[str, str]]) -> FaultEvent:
    """What was asked for. Raises UsageError, ConfigError for words that no fault has."""
    all_words = {"kind": given.kind, **_with_lists(words)}
    told = {key: text for key, text in all_words.items() if key not in SCENARIO_WORDS}
    try:
        event = read_fault(status_message(0, given.name, told))
    except ContractError as error:
        if told["kind"] in FAULTS.names():
            _refuse(told)
        raise UsageError(str(error).removeprefix(f"{FAULTS_TOPIC}.")) from None
    if event.fault.in_scenario_alone:
        raise UsageError("allowed in a scenario alone, where whoever waits for messages that are lost or late knows it")
    if foreign := [key for key in all_words if key in SCENARIO_WORDS]:
        how = "by hand a fault comes at once, and goes with --gone"
        raise UsageError(f"{' and '.join(foreign)}: allowed in a scenario alone: {how}")
    return event._replace(comes=not given.gone)


def _refuse(words: Mapping[str, str]) -> None:
    """Say of words that their kind does not take what it does take, as of those of a scenario. Raises ConfigError."""
    from sojourn_config.load import validate  # not above: words that are right need none of it
    from sojourn_config.yaml_file import YamlDocument, parse_value

    file = f"fault {words['kind']}"
    validate(
        YamlDocument(file, {key: parse_value(text, file) for key, text in words.items()}), FAULTS.get(words["kind"])
    )


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
    refused = 0 if old is None else old.refused.get(FAULTS_TOPIC, 0)
    if beat.refused.get(FAULTS_TOPIC, 0) > refused:
        return REFUSED, beat.values.get("last refusal", "")
    if _is_there(event, beat) != event.comes or beat is old:
        return None
    if not event.comes and old is not None and not _is_there(event, old):
        return NOT_THERE, f"{event.name} of {beat.role}"
    return (CAME if event.comes else WENT), f"{event.name} of {beat.role}"


def _is_there(event: FaultEvent, beat: Heartbeat) -> bool:
    """Whether a heartbeat names a fault."""
    return event.name in beat.values.get("faults", "").split(", ")


def _with_lists(words: Iterable[tuple[str, str]]) -> dict[str, str]:
    """Numbers with blanks between them are a list."""
    return {key: f"[{', '.join(text.split())}]" if " " in text.strip() else text for key, text in words}
