"""Which message of one set belongs to which of the other: by stamp, and by order within a stamp.

Heartbeats of all nodes share a topic, and their order within a stamp depends on who is quicker: there the
sender belongs to the key.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sojourn_bags.messages import Messages
from sojourn_contract.run_table import row_named
from sojourn_contract.stamps import NANOSECONDS
from sojourn_contract.topics import TOPICS

_OF_EVERYBODY = frozenset(row.name for row in TOPICS if row.publisher == "all")


@dataclass(frozen=True)
class MatchedMessages:
    """Messages of one topic that belong together.

    Attributes:
        one, other: indices into the two sets, shape (n,), in the order of the first.
        stamps: their common stamps [ns], shape (n,).
        missing: stamps [ns] of messages that only the first set holds. extra: that only the second holds.
    """

    one: NDArray[np.int64]
    other: NDArray[np.int64]
    stamps: NDArray[np.int64]
    missing: tuple[int, ...]
    extra: tuple[int, ...]


def match(one: Messages, other: Messages) -> MatchedMessages:
    """Match the messages of a topic. Either set may be empty."""
    keys, other_keys = _keys(one), _keys(other)
    places = {key: place for place, key in enumerate(other_keys)}
    pairs = [(place, places.pop(key)) for place, key in enumerate(keys) if key in places]
    known = set(other_keys)
    indices = np.array(pairs, dtype=np.int64).reshape(-1, 2)
    return MatchedMessages(
        indices[:, 0],
        indices[:, 1],
        np.array([keys[place][0] for place, _ in pairs], dtype=np.int64),
        tuple(key[0] for key in keys if key not in known),
        tuple(key[0] for key in places),
    )


def stamps_of(messages: Messages) -> list[int]:
    """Stamps [ns]: of the header or clock for topics of the contract, for others the time in the file."""
    if row_named(messages.topic) is None and len(messages.log_times) == len(messages):
        return list(messages.log_times)
    found = np.frombuffer(b"".join(data[4:12] for data in messages.data), dtype="<u4").reshape(-1, 2)
    if any(not data[1] & 1 for data in messages.data):  # big endian
        found = found.byteswap()
    return [seconds * NANOSECONDS + part for seconds, part in found.tolist()]


def _keys(messages: Messages) -> list[tuple[int, str, int]]:
    """Stamp, sender where that counts, and number among those with the same of both."""
    found: list[tuple[int, str, int]] = []
    counts: dict[tuple[int, str], int] = {}
    by_sender = messages.topic in _OF_EVERYBODY
    for index, stamp in enumerate(stamps_of(messages)):
        sender = ""
        if by_sender:
            statuses = messages.decode(index).status
            sender = statuses[0].name if statuses else ""
        number = counts.get((stamp, sender), 0)
        counts[stamp, sender] = number + 1
        found.append((stamp, sender, number))
    return found
