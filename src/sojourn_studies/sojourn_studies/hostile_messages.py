"""Bytes that somebody may send on a topic: messages with some of them changed, cut off, or none at all."""

import struct
from collections.abc import Sequence
from functools import cache

import numpy as np
from rclpy.serialization import serialize_message

from sojourn_contract.stamps import CONTROL_PERIOD_NS, NANOSECONDS
from sojourn_contract.topic_types import Topic
from sojourn_contract.types import message_class

GARBAGE = {
    "/diagnostics": bytes.fromhex("00010000ffffffffffffffff"),
    "/odom": bytes.fromhex("0001000001000000002d3101ffffffff0000"),
}
"""As they were sent to nodes that did not survive them."""
NASTY = (0, 1, 2, 7, 63, 127, 128, 240, 255)
"""Bytes that make lengths, signs and exponents what they should not be."""
MOST_CHANGES, LONGEST_GARBAGE = 6, 80
GARBAGE_PART, CUT_PART, TIMELY_PART = 0.2, 0.2, 0.5
"""Of all messages: no message at all, cut off, and stamped about now, so that they are not refused for their age."""
SHORTEST = 4
"""Bytes below which the middleware sends nothing: those that say how the rest is encoded."""
STAMP = struct.Struct("<iI")
STAMP_AT = 4
"""Where the stamp of a header begins, behind the encapsulation."""
SOONEST, LATEST = -5, 50
"""Control periods from now of a stamp about now."""
LISTS = ("name", "position", "velocity", "effort", "poses", "points", "status", "fields")


@cache
def whole(row: Topic) -> bytes:
    """A message of the topic's type with something in every list that can be filled without knowing it."""
    message = message_class(row.type)()
    for name in LISTS:
        kind = message.get_fields_and_field_types().get(name, "")
        if kind == "sequence<string>":
            setattr(message, name, ["a", "b"])
        elif kind == "sequence<double>":
            setattr(message, name, [1.0, 2.0])
        elif kind.startswith("sequence<"):
            package, short = kind.removeprefix("sequence<").removesuffix(">").split("/")
            setattr(message, name, [message_class(f"{package}/{short}")() for _ in range(2)])
    return bytes(serialize_message(message))


def spoiled(random: np.random.Generator, samples: Sequence[bytes], now: int) -> bytes:
    """A hostile message.

    Args:
        samples: good ones of its topic, at least one. now: simulation time [ns], for a stamp that is not too old.
    """
    data = bytearray(samples[int(random.integers(len(samples)))])
    if random.random() < GARBAGE_PART:  # no longer than a message: of some types all are of one size
        return random.bytes(int(random.integers(SHORTEST, min(len(data), LONGEST_GARBAGE) + 1)))
    if random.random() < TIMELY_PART and len(data) >= STAMP_AT + STAMP.size:
        stamp = max(0, now + int(random.integers(SOONEST, LATEST)) * CONTROL_PERIOD_NS)
        STAMP.pack_into(data, STAMP_AT, stamp // NANOSECONDS % 2**31, stamp % NANOSECONDS)
    for place in random.integers(len(data), size=random.integers(MOST_CHANGES + 1)):
        data[place] = NASTY[random.integers(len(NASTY))]
    if random.random() < CUT_PART:
        del data[random.integers(SHORTEST, len(data)) :]
    return bytes(data)
