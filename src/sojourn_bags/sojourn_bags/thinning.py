"""A bag with the topics alone that some roles hear or say: enough to replay them, and a small part of the file.

Three quarters of a bag are truth, which no role that would fly ever hears. What is left out was recorded all the same:
the account of the run's completeness stays that of the whole bag.
"""

from collections.abc import Sequence
from pathlib import Path

from mcap.records import Channel, Message

from sojourn_bags.bag_copy import BagCopy
from sojourn_bags.contract_version import table_of_bag
from sojourn_bags.definitions import THINNED_RECORD
from sojourn_bags.errors import BagExistsError
from sojourn_bags.parts import BagSalvage
from sojourn_bags.provenance import run_of
from sojourn_bags.reading import Bag
from sojourn_contract.topic_table import CLOCK

_CHUNK = 1 << 24
"""Bytes: all in one chunk, which is packed best."""


def roles_of(bag: Bag) -> list[str]:
    """Roles of a bag's run whose topics it has. Raises IncompleteConfigError."""
    kept = bag.records.get(THINNED_RECORD, {}).get("roles")
    return [role for role in run_of(bag)["participants"].split(",") if kept is None or role in kept.split(",")]


def topics_of(bag: Bag, roles: Sequence[str]) -> set[str]:
    """What these roles hear or say in the run of a bag. Raises OtherContractError, IncompleteConfigError."""
    table, participants = table_of_bag(bag), run_of(bag)["participants"].split(",")
    present = [role for role in roles if role in participants]
    rows = [row for role in present for each in (table.inputs_of, table.outputs_of) for row in each(role, participants)]
    clock = {CLOCK} if table.longest_leap else set()  # nothing else tells where it leapt
    return ({row.name for row in rows} | clock) & bag.topics.keys()


def thinned(bag: Bag, folder: Path, roles: Sequence[str]) -> Path:
    """Write a bag anew with the topics of some roles. Returns its MCAP file.

    Raises:
        OtherContractError, IncompleteConfigError: of the bag. BagExistsError: the folder is there. OSError.
    """
    kept = topics_of(bag, roles)
    if folder.exists():
        raise BagExistsError(folder)
    folder.mkdir(parents=True)
    file = folder / f"{folder.name}_0.mcap"
    left_out: set[int] = set()
    with BagCopy(file, _CHUNK) as copy:
        for record in BagSalvage(bag.parts).records:
            if isinstance(record, Channel) and record.topic not in kept:
                left_out.add(record.id)
            elif not (isinstance(record, Channel | Message) and _channel(record) in left_out):
                copy.take(record)
        copy.add_metadata(THINNED_RECORD, {"roles": ",".join(roles)})
    return file


def _channel(record: Channel | Message) -> int:
    return record.id if isinstance(record, Channel) else record.channel_id
