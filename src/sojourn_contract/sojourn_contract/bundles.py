"""What a node says in a period, in one message to the nodes of its own run, in lock-step between processes.

A message of ROS to a reader in another process costs a call of the kernel and a thread that wakes up there, however
small it is. So the roles of a run that are its own nodes (companions) hear each other once a period, on the hidden
topic `_period/ROLE`, and not once a topic. What it holds are the topics' own bytes, one after the other. Whoever
else listens hears the topics themselves. In real time nothing is bundled: there the middleware is part of what is
tried out.
"""

import struct
from collections.abc import Callable, Collection, Iterable
from functools import partial
from typing import TYPE_CHECKING, Any

from sojourn_contract import qos
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.neighbours import are_near
from sojourn_contract.topic_types import Topic
from sojourn_contract.types import message_class

if TYPE_CHECKING:  # a node has bundles
    from sojourn_contract.node import ContractNode

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
    refusal = RefusedMessageError(topic, "message", f"{len(data)} bytes", "a bundle of messages")
    if len(data) < _OPENING.size:
        raise refusal
    *opening, size = _OPENING.unpack_from(data)
    place, end = _OPENING.size, _OPENING.size + size
    if opening != [0, 1, 0, 0] or end > len(data):  # the middleware may append some bytes
        raise refusal
    said = []
    while place < end:
        if place + _HEAD.size > end:
            raise refusal
        name_size, size = _HEAD.unpack_from(data, place)
        name_end = place + _HEAD.size + name_size
        name, place = data[place + _HEAD.size : name_end], name_end + size
        if place > end or not name.isascii():
            raise refusal
        said.append((name.decode(), data[name_end:place]))
    return said


class Bundles:
    """Of one node: what it says to its companions and has not sent yet, and what they say to it.

    Args:
        node: one of the companions. inputs: rows that it acts on. outputs: those that it publishes.
        take: called with the row and the bytes of each message that comes.

    Attributes:
        roles: the companions; none where nothing is bundled.
    """

    def __init__(
        self,
        node: "ContractNode",
        inputs: Iterable[Topic],
        outputs: Iterable[Topic],
        take: Callable[[Topic, bytes], None],
    ) -> None:
        self.roles: Collection[str] = node.companions if node.lockstep else ()
        self._node = node
        self._take = take
        self._said: list[tuple[str, bytes]] = []
        self._inputs = {row.name: row for row in inputs if self.carries(row)}
        self._readers = {role: self._reader(role) for role in {row.publisher for row in self._inputs.values()}}
        heard = {role for row in outputs if self.carries(row) for role in self.listeners(row)}
        self._listeners = sorted(heard)
        self._sender: Any = self._make_sender() if heard else None

    def carries(self, row: Topic) -> bool:
        """Whether companions hear a row in bundles: those that come every period. The others would wake roles that act
        more rarely.
        """
        return row.every == 1 and are_near(row, self.roles)

    def listeners(self, row: Topic) -> list[str]:
        """Companions that hear a row of this node."""
        roles = (*row.subscribers, "recorder") if row.logged else row.subscribers
        return [role for role in roles if role in self.roles and role != self._node.role]

    def say(self, row: Topic, data: bytes) -> None:
        """Keep a message until `send`."""
        self._said.append((row.name, data))

    def send(self) -> None:
        """Send what is kept."""
        if self._said:
            said, self._said = self._said, []
            if self._sender is not None:
                self._sender.publish(pack(said))

    def unmatched(self) -> list[str]:
        """Bundles that do not reach a companion yet, in words."""
        missing = [
            f"no publisher of {bundle_of(role).name} ({role})"
            for role, reader in self._readers.items()
            if reader.get_publisher_count() == 0
        ]
        if self._sender is not None and self._sender.get_subscription_count() < len(self._listeners):
            name = bundle_of(self._node.role).name
            missing.append(f"{name} is not heard by all of {', '.join(self._listeners)}")
        return missing

    def _make_sender(self) -> Any:
        row = bundle_of(self._node.role)
        kind = message_class(row.type)
        return self._node.create_publisher(kind, row.name.lstrip("/"), qos.profile(row, True, self._node.role))

    def _reader(self, role: str) -> Any:
        row = bundle_of(role)
        kind, quality = message_class(row.type), qos.profile(row, True, self._node.role)
        return self._node.create_subscription(
            kind, row.name.lstrip("/"), partial(self._receive, row.name), quality, raw=True
        )

    def _receive(self, topic: str, data: bytes) -> None:
        try:
            said = unpack(topic, data)
        except RefusedMessageError as refusal:
            self._node.refuse(topic, refusal)
            return
        for name, content in said:
            row = self._inputs.get(name)
            if row is not None:
                self._take(row, content)
