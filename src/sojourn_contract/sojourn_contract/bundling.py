"""Several messages as the bytes of one message of ROS, and the hidden topics on which they go. No ROS in here."""

import struct
from collections.abc import Iterable

from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.topic_types import Topic

REPEATS = Topic(
    "/_period/repeats", "std_msgs/UInt8MultiArray", "all", (), 1, 0.1, "what is said again in a run that stands still"
)
_OPENING = struct.Struct("<BBxxIII")
"""CDR of std_msgs/UInt8MultiArray up to its data: encapsulation, no dimensions, no offset, how many bytes follow."""
_HEAD = struct.Struct("<HI")
"""Before each message: bytes of its topic's name, bytes of the message."""


def bundle_of(role: str) -> Topic:
    """Row of the topic on which a role's bundles go."""
    what = "what the role says in a period, for the other nodes of its run"
    return Topic(f"/_period/{role}", "std_msgs/UInt8MultiArray", role, (), 1, 0.1, what, logged=False)


def pack(said: Iterable[tuple[str, bytes]]) -> bytes:
    """One message of ROS, as bytes, that holds (topic, message as bytes) in their order."""
    parts: list[bytes] = []
    for topic, data in said:
        name = topic.encode()
        parts += (_HEAD.pack(len(name), len(data)), name, data)
    content = b"".join(parts)
    return _OPENING.pack(0, 1, 0, 0, len(content)) + content


def unpack(topic: str, data: bytes) -> list[tuple[str, bytes]]:
    """What `pack` has put into these bytes. Raises RefusedMessageError of `topic` for any others."""
    said = _unpacked(data)
    if said is None:
        raise RefusedMessageError(topic, "message", f"{len(data)} bytes", "a bundle of messages")
    return said


def _unpacked(data: bytes) -> list[tuple[str, bytes]] | None:
    """As `unpack`; None for bytes that `pack` has not made."""
    if len(data) < _OPENING.size:
        return None
    *opening, size = _OPENING.unpack_from(data)
    place, end = _OPENING.size, _OPENING.size + size
    if opening != [0, 1, 0, 0] or end > len(data):  # the middleware may append some bytes
        return None
    said = []
    while place < end:
        if place + _HEAD.size > end:
            return None
        name_size, size = _HEAD.unpack_from(data, place)
        name_end = place + _HEAD.size + name_size
        name, place = data[place + _HEAD.size : name_end], name_end + size
        if place > end or not name.isascii():
            return None
        said.append((name.decode(), data[name_end:place]))
    return said


def padded(data: bytes) -> bytes:
    """A message as the middleware brings it, which fills up to four bytes."""
    return data + bytes(-len(data) % 4)
