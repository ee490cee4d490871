"""What a node says in a period, in one message to the nodes of its own run, in lock-step between processes.

A message of ROS to a reader in another process costs a call of the kernel and a thread that wakes up there, however
small it is. So the roles of a run that are its own nodes (companions) hear each other once a period, on the hidden
topic `_period/ROLE`, and not once a topic. What it holds are the topics' own bytes, one after the other, in the order
in which they were said. Whoever else listens hears the topics themselves. In real time nothing is bundled: there the
middleware is part of what is tried out.

A bundle has all that its role says, heartbeats and goals too: what went beside it could come before or after it, as
the load of the machine has it. On the topics of heartbeats and goals others may speak as well, so they are always sent
there besides, and who hears both ways takes the first of two twins.

A companion that acts more rarely than another speaks does not hear that one's bundles, which would wake it in vain:
it hears the topics.
"""

from collections.abc import Callable, Iterable
from functools import partial
from typing import TYPE_CHECKING, Any

from sojourn_contract import qos
from sojourn_contract.barrier import awaited_inputs
from sojourn_contract.bundling import bundle_of, pack, padded, unpack
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.repeats import Repeats
from sojourn_contract.topic_types import Topic
from sojourn_contract.types import message_class
from sojourn_contract.values import Message

if TYPE_CHECKING:  # a node has bundles
    from sojourn_contract.node import ContractNode

MOST_TWINS = 1000
"""Messages of which the twin is awaited: what others say has none."""


class Twins:
    """Tells the second of two equal messages, one of which comes in a bundle and one by its topic.

    The first that comes counts, whichever way it came; as each way keeps its order, so do the first ones.
    """

    def __init__(self) -> None:
        self._ahead: dict[tuple[str, bytes], int] = {}
        """By how many more have come in bundles; negative: by the topic."""

    def __len__(self) -> int:
        """Messages whose twin has not come."""
        return len(self._ahead)

    def is_second(self, topic: str, data: bytes, bundled: bool) -> bool:
        """Whether the message has come the other way already."""
        key, way = (topic, padded(data)), 1 if bundled else -1
        ahead = self._ahead.pop(key, 0)
        if ahead != -way:
            self._ahead[key] = ahead + way
        while len(self._ahead) > MOST_TWINS:
            self._ahead.pop(next(iter(self._ahead)))
        return ahead * way < 0


class Bundles:
    """Of one node: what it says to its companions and has not sent yet, and what they say to it.

    Args:
        node: it knows its role, its companions and the table of the run.
        outputs: rows that it publishes. take: called with the row and the bytes of each message that comes.

    Attributes:
        speakers, listeners: companions that it hears, and that hear it, in bundles; none where nothing is bundled.
        repeats: what is said again; None without companions.
    """

    def __init__(self, node: "ContractNode", outputs: Iterable[Topic], take: Callable[[Topic, bytes], None]) -> None:
        others = [role for role in node.companions if node.lockstep and role != node.role]
        self.speakers = [role for role in others if _hears(node, node.role, role)]
        self.listeners = [role for role in others if _hears(node, role, node.role)]
        self._node, self._take = node, take
        self._twins = Twins()
        self._inputs = {row.name: row for row in node.table.inputs_of(node.role, {*node.participants, node.role})}
        self._heard = {row.name for row in outputs if any(is_for(row, role) for role in self.listeners)}
        self._said: list[tuple[str, bytes]] = []
        self._aloud: list[tuple[Any, bytes]] = []
        self._is_held = False
        self._readers = {role: self._reader(role) for role in self.speakers}
        self._sender: Any = self._make_sender() if self.listeners else None
        self.repeats = Repeats(node, take) if others else None

    def brings(self, row: Topic) -> bool:
        """Whether the node hears a row in bundles alone: what another companion says at a rate."""
        return not row.is_event and row.publisher in self.speakers

    def carries(self, row: Topic, message: Message) -> bool:
        """Whether a message goes to companions in the bundle. A heartbeat from before the run goes by its topic."""
        return row.name in self._heard and (row.publisher != "all" or message.stamp > 0)

    def has_come(self, row: Topic, data: bytes, bundled: bool) -> bool:
        """Whether a message that comes in a bundle or by its topic has come before: the other way, or said again."""
        if self.repeats is not None and self.repeats.is_late(row, data):
            return True
        both_ways = self.speakers and (row.is_event or row.publisher == "all")
        return bool(both_ways) and self._twins.is_second(row.name, data, bundled)

    def say(self, row: Topic, data: bytes, aloud: Any) -> None:
        """Put a message into the bundle. `aloud`: sender by which it goes on its topic too, None where nobody listens
        there; after the bundle, for which others wait.
        """
        self._said.append((row.name, data))
        if aloud is not None:
            self._aloud.append((aloud, data))
        if not self._is_held:
            self.release()

    def hold(self) -> None:
        """Send nothing until `release`: a period has begun."""
        self._is_held = True

    def release(self) -> None:
        """Send what is said."""
        self._is_held = False
        if not self._said:
            return
        said, self._said = self._said, []
        aloud, self._aloud = self._aloud, []
        self._sender.publish(pack(said))
        if self.repeats is not None:
            self.repeats.note(said)
        for sender, data in aloud:
            sender.publish(data)
        for name, data in said:  # its own heartbeat, where it listens to all
            if name in self._inputs:
                self._hear(name, data)

    def look(self, now: float) -> None:
        """At a wall time [s]: say again what may be lost."""
        if self.repeats is not None:
            self.repeats.look(now)

    def unmatched(self) -> list[str]:
        """Bundles that do not reach a companion yet, in words."""
        missing = [
            f"no publisher of {bundle_of(role).name} ({role})"
            for role, reader in self._readers.items()
            if reader.get_publisher_count() == 0
        ]
        if self._sender is not None and self._sender.get_subscription_count() < len(self.listeners):
            name = bundle_of(self._node.role).name
            missing.append(f"{name} is not heard by all of {', '.join(self.listeners)}")
        return missing

    def senders(self) -> list[Any]:
        """The sender of bundles, if it has one."""
        return [] if self._sender is None else [self._sender]

    def _make_sender(self) -> Any:
        row = bundle_of(self._node.role)
        return self._node.create_publisher(message_class(row.type), row.name.lstrip("/"), _quality(row))

    def _reader(self, role: str) -> Any:
        row = bundle_of(role)
        receive = partial(self._receive, row.name)
        return self._node.create_subscription(
            message_class(row.type), row.name.lstrip("/"), receive, _quality(row), raw=True
        )

    def _receive(self, topic: str, data: bytes) -> None:
        try:
            said = unpack(topic, data)
        except RefusedMessageError as refusal:
            self._node.refuse(topic, str(refusal))
            return
        for name, content in said:
            if name in self._inputs:
                self._hear(name, content)

    def _hear(self, name: str, data: bytes) -> None:
        row = self._inputs[name]
        if not self.has_come(row, data, bundled=True):
            self._take(row, data)


def is_for(row: Topic, role: str) -> bool:
    """Whether a role takes a row."""
    return role in row.subscribers or (role == "recorder" and row.logged)


def _hears(node: "ContractNode", listener: str, speaker: str) -> bool:
    """Whether a listener acts as often as a speaker speaks to anybody."""
    heard = [row.every for row in awaited_inputs(listener, node.participants, node.table) if row.publisher == speaker]
    rows = node.table.outputs_of(speaker, node.participants)
    said = [row.every for row in rows if not row.is_event and row.publisher == speaker]
    return bool(heard) and min(heard) == min(said)


def _quality(row: Topic) -> Any:
    """As the recorder's: no bundle is lost while it lags."""
    return qos.profile(row, True, "recorder")
