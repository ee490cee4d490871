"""A bag with both sides of a comparison: the first under its own names, the second under a prefix.

So a plotting tool lays the two over each other: /odom and /replay/odom.
"""

import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from sojourn_bags.comparison import stamps_of
from sojourn_bags.definitions import ChannelSpec, qos_entry
from sojourn_bags.messages import Messages
from sojourn_bags.reading import Bag
from sojourn_bags.transforms import channel as transform_channel
from sojourn_bags.writer import Attachment, BagWriter
from sojourn_contract import qos
from sojourn_contract.run_table import row_named

RECORD = "sojourn_comparison"
"""Name of the metadata record that holds the verdict."""


def write_both(
    folder: Path,
    one: Mapping[str, Messages],
    other: Mapping[str, Messages],
    prefix: str,
    source: Bag,
    result: Mapping[str, Any],
) -> None:
    """Write a new bag.

    Args:
        one, other: the two sets. prefix: of the second one's topics, as "/replay".
        source: bag whose attachments go along. result: the comparison as data.

    Raises:
        BagExistsError, UnwritableBagError: the folder cannot take it.
    """
    channels = [_channel(name, each) for name, each in one.items()]
    channels += [_channel(name, each, prefix) for name, each in other.items()]
    attachments = [Attachment(name, "application/octet-stream", data) for name, data in source.attachments.items()]
    writer = BagWriter(folder, channels, attachments)
    entries = _entries(one.values(), 0) + _entries(other.values(), len(one))
    for log_time, _, index, _, stamp, data in sorted(entries, key=lambda entry: entry[:4]):
        writer.write(index, log_time, stamp, data)
    writer.close({RECORD: {"prefix": prefix, "result": json.dumps(result)}})


def _entries(sets: Iterable[Messages], first: int) -> list[tuple[int, int, int, int, int, bytes]]:
    """Log time [ns], order within it, channel, number, stamp [ns], CDR of each message."""
    found = []
    for index, messages in enumerate(sets, start=first):
        stamps = stamps_of(messages)
        log_times = messages.log_times if len(messages.log_times) == len(messages) else stamps
        for number, (log_time, stamp, data) in enumerate(zip(log_times, stamps, messages.data, strict=True)):
            place = messages.places[number] if messages.places else 0
            found.append((log_time, place, index, number, stamp if stamp > 0 else log_time, data))
    return found


def _channel(name: str, messages: Messages, prefix: str = "") -> ChannelSpec:
    package, _, short = messages.type.partition("/msg/")
    row = row_named(name)
    entry = transform_channel().qos if row is None else qos_entry(qos.profile(row, True, row.publisher))
    return ChannelSpec(prefix + name, f"{package}/{short}", entry)
