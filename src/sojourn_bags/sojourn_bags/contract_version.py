"""Whether a bag was recorded under our contract, so that it can be judged, compared or replayed."""

import json

from sojourn_bags.definitions import full_type
from sojourn_bags.errors import OtherContractError
from sojourn_bags.provenance import CONTRACT_NAME, VERSIONS_NAME, versions
from sojourn_bags.reading import Bag
from sojourn_contract.description import contract_data, contract_differences, contract_name
from sojourn_contract.topics import TOPICS

PACKAGE = "sojourn_contract"
_ADDED = ("/tf",)
"""Topics that the recorder adds to those of the table."""
_SHOWN = 3
"""Differences of two contracts that a sentence names."""


def check_contract(bag: Bag) -> None:
    """Raise OtherContractError for a bag of another contract: of one that it carries, or of another version (the last
    number aside), with a topic that ours does not have, or with another type on one.
    """
    recorded, ours = recorded_version(bag), versions()[PACKAGE]
    if not check_own_contract(bag) and recorded is not None and _release(recorded) != _release(ours):
        raise OtherContractError(bag.path, f"it was recorded with version {recorded} of the contract, this is {ours}")
    types = {row.name: full_type(row.type) for row in TOPICS}
    for name, messages in bag.topics.items():
        if name not in types and name not in _ADDED:
            raise OtherContractError(bag.path, f"its topic {name} is not in the contract")
        if name in types and messages.type != types[name]:
            raise OtherContractError(bag.path, f"its {name} is a {messages.type}, the contract says {types[name]}")


def check_own_contract(bag: Bag) -> bool:
    """Whether the bag carries its contract. Raises OtherContractError if that is not ours, with the differences."""
    text = bag.attachments.get(CONTRACT_NAME)
    if text is None:
        return False
    ours = contract_data()
    try:
        theirs = json.loads(text)
        same = theirs["digest"] == ours["digest"]
    except (ValueError, KeyError, TypeError) as error:
        raise OtherContractError(bag.path, f"its {CONTRACT_NAME} cannot be read: {error}") from error
    if not same:
        differences = list(contract_differences(theirs, ours))
        more = f"; and {len(differences) - _SHOWN} more" if len(differences) > _SHOWN else ""
        raise OtherContractError(
            bag.path,
            f"it was recorded under {contract_name(theirs)}, ours is {contract_name(ours)} "
            f"({'; '.join(differences[:_SHOWN])}{more}): use the Sojourn that recorded it",
        )
    return True


def recorded_version(bag: Bag) -> str | None:
    """Version of the contract that the bag names, None where it names none."""
    try:
        version = json.loads(bag.attachments[VERSIONS_NAME])[PACKAGE]
    except (KeyError, TypeError, ValueError):
        return None
    return str(version)


def _release(version: str) -> list[str]:
    return version.split(".")[:2]
