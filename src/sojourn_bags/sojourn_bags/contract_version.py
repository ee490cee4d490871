"""Whether a bag was recorded under our contract, so that it can be judged, compared or replayed."""

import json
from collections.abc import Mapping
from typing import Any

from sojourn_bags.definitions import full_type
from sojourn_bags.errors import OtherContractError
from sojourn_bags.provenance import CONTRACT_NAME, VERSIONS_NAME, versions
from sojourn_bags.reading import Bag
from sojourn_contract.description import (
    LEAP,
    contract_data,
    contract_differences,
    contract_name,
    delivered_by_data,
    heard_by_data,
    row_of_data,
)
from sojourn_contract.errors import TopicNameError
from sojourn_contract.goal_topics import FAULTS_TOPIC as FAULTS
from sojourn_contract.link_topics import LINK_STATUS, OPERATOR
from sojourn_contract.run_table import RECORDED_BESIDES, TICK, row_named
from sojourn_contract.topic_table import TopicTable
from sojourn_contract.topics import STANDARD

PACKAGE = "sojourn_contract"
_UNREADABLE = (ValueError, KeyError, TypeError, AttributeError)
_SHOWN = 3
"""Differences of two contracts that a sentence names."""


def check_contract(bag: Bag) -> None:
    """Raise OtherContractError for a bag of another contract: of one that it carries, or of another version (the last
    number aside), with a topic that ours does not have, or with another type on one.
    """
    recorded, ours = recorded_version(bag), versions()[PACKAGE]
    if not check_own_contract(bag) and recorded is not None and _release(recorded) != _release(ours):
        raise OtherContractError(bag.path, f"it was recorded with version {recorded} of the contract, this is {ours}")
    table = table_of_bag(bag)
    for name, messages in bag.topics.items():
        row = table.get(name)
        if row is None and name not in RECORDED_BESIDES:
            raise OtherContractError(bag.path, f"its topic {name} is not in the contract")
        if row is not None and messages.type != full_type(row.type):
            kind = full_type(row.type)
            raise OtherContractError(bag.path, f"its {name} is a {messages.type}, the contract says {kind}")


def check_own_contract(bag: Bag) -> bool:
    """Whether the bag carries its contract. Raises OtherContractError if that is not ours, with the differences."""
    theirs = _own_contract(bag)
    if theirs is None:
        return False
    ours = contract_data(table_of_bag(bag))
    if theirs["digest"] != ours["digest"]:
        differences = list(contract_differences(theirs, ours))
        more = f"; and {len(differences) - _SHOWN} more" if len(differences) > _SHOWN else ""
        raise OtherContractError(
            bag.path,
            f"it was recorded under {contract_name(theirs)}, ours is {contract_name(ours)} "
            f"({'; '.join(differences[:_SHOWN])}{more}): use the Sojourn that recorded it",
        )
    return True


def table_of_bag(bag: Bag) -> TopicTable:
    """The topics of the run that is in a bag: those that every run has, and those that its machine brought, by the
    contract that the bag carries, or else by its topics.

    Raises:
        OtherContractError: the contract that it carries cannot be read.
    """
    theirs = _own_contract(bag)
    described: Mapping[str, Any] = dict.fromkeys(bag.topics) if theirs is None else theirs["topics"]
    rows, delivered = [], []
    try:
        for name, data in described.items():
            row = row_named(name) or (None if data is None else row_of_data(name, data))
            if row is not None and name not in STANDARD:
                row = row if data is None else heard_by_data(row, data)
                rows.append(row)
            if row is not None and data is not None:
                delivered.append(delivered_by_data(row, data))
        waits = described.get(TICK)  # with faults in its schedule whoever they happen to waits for the operator
        roles = () if waits is None else STANDARD.topic(FAULTS).subscribers
        hearing = [role for role in roles if waits is not None and role in waits["subscribers"]]
        leap = 0 if theirs is None else int(theirs.get(LEAP, 0))
        table = STANDARD.joined_with(rows).heard_by(TICK, hearing)
        if LINK_STATUS.name in described:
            table = _with_telemetry(table, described)
        asked = {name for name, data in described.items() if data is not None and data.get("on_demand")}
        return TopicTable(table.delivered(delivered).on_demand(asked), leap)
    except (TopicNameError, *_UNREADABLE) as error:
        raise OtherContractError(bag.path, f"its {CONTRACT_NAME} cannot be read: {error}") from error


def _with_telemetry(table: TopicTable, described: Mapping[str, Any]) -> TopicTable:
    """The table in which the operator hears what a link takes to the Earth."""
    for name, data in described.items():
        if data is not None and OPERATOR in data["subscribers"] and name in table:
            table = table.heard_by(name, (OPERATOR,))
    return table


def _own_contract(bag: Bag) -> dict[str, Any] | None:
    """What the bag says of its contract, None where it says nothing. Raises OtherContractError."""
    text = bag.attachments.get(CONTRACT_NAME)
    if text is None:
        return None
    try:
        found: dict[str, Any] = json.loads(text)
        return found | {"digest": str(found["digest"]), "topics": dict(found["topics"])}
    except _UNREADABLE as error:
        raise OtherContractError(bag.path, f"its {CONTRACT_NAME} cannot be read: {error}") from error


def recorded_version(bag: Bag) -> str | None:
    """Version of the contract that the bag names, None where it names none."""
    try:
        version = json.loads(bag.attachments[VERSIONS_NAME])[PACKAGE]
    except (KeyError, TypeError, ValueError):
        return None
    return str(version)


def _release(version: str) -> list[str]:
    return version.split(".")[:2]
