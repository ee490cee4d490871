"""Publishers and readers of a node, from the topic table, and who is at their other ends."""

from collections.abc import Callable, Collection
from typing import TYPE_CHECKING, Any

from rclpy.duration import Duration

from sojourn_contract import qos
from sojourn_contract.bundles import Bundles, is_for
from sojourn_contract.codecs import encode
from sojourn_contract.neighbours import Neighbours, are_near
from sojourn_contract.onlookers import Onlookers
from sojourn_contract.topic_types import Topic
from sojourn_contract.types import message_class
from sojourn_contract.values import Message

if TYPE_CHECKING:  # a node has endpoints
    from sojourn_contract.node import ContractNode


class Endpoints:
    """Of one node.

    Args:
        node: it knows its role, the participants, the mode of time, and what it waits for.
        take: called with the row and the bytes of each message that comes over the middleware.

    Attributes:
        inputs: rows to subscribe: in lock-step what is awaited, in real time whoever may publish it; goals always.
        outputs: rows that the node publishes, by topic. senders, readers: of the ROS library, by topic.
        wanted: topics on demand to which somebody listens.
        bundles: what goes to and comes from companions, nodes of the same run in other processes.
        onlookers: consoles that alone hear some of the outputs.
    """

    def __init__(self, node: "ContractNode", take: Callable[[Topic, bytes], None]) -> None:
        self._node = node
        everyone, awaited = {*node.participants, node.role}, {row.name for row in node.awaited}
        self.inputs = [
            row
            for row in node.table.inputs_of(node.role, everyone)
            if row.is_event or row.publisher == "all" or not node.lockstep or row.name in awaited
        ]
        self.outputs = {row.name: row for row in node.table.outputs_of(node.role, everyone)}
        self.senders = {name: self._sender(row) for name, row in self.outputs.items()}
        self.bundles = Bundles(node, self.outputs.values(), take)
        self.readers = {row.name: self._reader(row, take) for row in self.inputs if not self.bundles.brings(row)}
        self.wanted: Collection[str] = frozenset()
        self._neighbours: Neighbours | None = None
        self._near: Collection[str] = ()
        self._unheard: Collection[str] = ()
        self.onlookers = Onlookers(node, self._rows_that_may_wait(), self.senders)
        self._on_demand = [name for name, row in self.outputs.items() if row.on_demand]

    def join(self, neighbours: Neighbours, roles: Collection[str]) -> list[str]:
        """Hear what nodes of these roles say from them, not over the middleware. Returns those topics."""
        self._neighbours, self._near = neighbours, roles
        direct = [row.name for row in self.inputs if are_near(row, roles)]
        for name in direct:
            self._node.destroy_subscription(self.readers.pop(name))
        return direct

    def look(self, now: float) -> None:
        """At a wall time [s]: see which topics nobody hears but neighbours and companions, who hear them otherwise;
        those are not sent. And of those on demand which somebody hears. Say again what may be lost.
        """
        self.bundles.look(now)
        counts = {name: sender.get_subscription_count() for name, sender in self.senders.items()}
        self.wanted = frozenset(name for name in self._on_demand if counts[name])
        if self._neighbours is not None or self.bundles.listeners:
            self._unheard = {
                name for name, count in counts.items() if not count and not self._listeners(self.outputs[name])
            }
            self.onlookers.look(counts)

    def send(self, topic: str, message: Message) -> None:
        """To the neighbours, to companions in the bundle, and on its topic to all others who listen."""
        row = self.outputs[topic]
        if self._node.words is not None:
            self._node.words.hear(row, message)
        if self._neighbours is not None:
            self._neighbours.say(row, message)
        is_silent = topic in self._unheard or self.onlookers.takes(topic, message)
        sender = None if is_silent else self.senders[topic]
        if self.bundles.carries(row, message):
            self.bundles.say(row, encode(row, message), sender)
        elif sender is not None:
            sender.publish(encode(row, message))

    def await_arrival(self, seconds: float) -> None:
        """Wait until what has been said last is with those who hear it, so long at most [s]."""
        self.onlookers.looks.send()
        for sender in (*self.bundles.senders(), self.senders["/diagnostics"]):
            sender.wait_for_all_acked(Duration(seconds=seconds))

    def unmatched(self) -> list[str]:
        """Endpoints of other participants that are not connected yet, in words."""
        missing = []
        for row in self._node.awaited:
            if row.name in self.readers and self.readers[row.name].get_publisher_count() == 0:
                missing.append(f"no publisher of {row.name} ({row.publisher})")
        for name, sender in self.senders.items():
            row = self.outputs[name]
            listeners = self._listeners(row) if row.needs_listener else []
            if sender.get_subscription_count() < len(listeners):
                missing.append(f"{name} is not heard by all of {', '.join(listeners)}")
        return missing

    def _rows_that_may_wait(self) -> dict[str, Topic]:
        """Topics of which onlookers are told as often as they look: in lock-step what is said at a rate."""
        rows = self.outputs if self._node.lockstep else {}
        return {name: row for name, row in rows.items() if not row.is_event and row.publisher != "all"}

    def _listeners(self, row: Topic) -> list[str]:
        """Roles that hear a row on its topic. Heartbeats and goals all do."""
        node = self._node
        near = (*self._near, *self.bundles.listeners) if are_near(row, (node.role,)) else ()
        roles = [role for role in node.participants if is_for(row, role)]
        return [role for role in roles if (role != node.role or row.publisher == "all") and role not in near]

    def _sender(self, row: Topic) -> Any:
        profile = qos.profile(row, self._node.lockstep, self._node.role)
        return self._node.create_publisher(message_class(row.type), row.name.lstrip("/"), profile)

    def _reader(self, row: Topic, take: Callable[[Topic, bytes], None]) -> Any:
        def receive(data: bytes) -> None:
            if not self.bundles.has_come(row, data, bundled=False):
                take(row, data)

        return self._node.create_subscription(
            message_class(row.type),
            row.name.lstrip("/"),
            receive,
            qos.profile(row, self._node.lockstep, self._node.role),
            raw=True,  # the ROS library's own decoding ends the executor with bytes that it cannot read
        )
