"""Whether a bag was recorded under the contract of this version, so that it can be compared or replayed."""

import json

from sojourn_bags.definitions import full_type
from sojourn_bags.errors import OtherContractError
from sojourn_bags.provenance import VERSIONS_NAME, versions
from sojourn_bags.reading import Bag
from sojourn_contract.topics import TOPICS

PACKAGE = "sojourn_contract"
_ADDED = ("/tf",)
"""Topics that the recorder adds to those of the table."""


def check_contract(bag: Bag) -> None:
    """Raise OtherContractError for a bag of another contract: of another version (the last number aside), with a
    topic that ours does not have, or with another type on one.
    """
    recorded, ours = recorded_version(bag), versions()[PACKAGE]
    if recorded is not None and _release(recorded) != _release(ours):
        raise OtherContractError(bag.path, f"it was recorded with version {recorded} of the contract, this is {ours}")
    types = {row.name: full_type(row.type) for row in TOPICS}
    for name, messages in bag.topics.items():
        if name not in types and name not in _ADDED:
            raise OtherContractError(bag.path, f"its topic {name} is not in the contract")
        if name in types and messages.type != types[name]:
            raise OtherContractError(bag.path, f"its {name} is a {messages.type}, the contract says {types[name]}")


def recorded_version(bag: Bag) -> str | None:
    """Version of the contract that the bag names, None where it names none."""
    try:
        version = json.loads(bag.attachments[VERSIONS_NAME])[PACKAGE]
    except (KeyError, TypeError, ValueError):
        return None
    return str(version)


def _release(version: str) -> list[str]:
    return version.split(".")[:2]
