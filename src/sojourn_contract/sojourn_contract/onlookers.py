"""Who looks at a run and takes no part in it: the console's page, which shows thirty pictures a second.

In lock-step a run goes many times as fast as its clock. To send each message by itself to somebody who draws a picture
every dozen periods costs the loop more than all that the page does. So what a node says on topics that consoles alone
hear goes as often as they look, by the wall clock, in one message on the hidden topic `_looks/ROLE`: of a topic that
one of them hears reliably all that was said since, of any other the newest. Of nodes in one process one sends for all.
Whoever hears that topic is an onlooker; a topic to which anybody else listens is sent in full, to consoles too.
"""

import time
from collections.abc import Mapping, Sequence
from typing import Any

from sojourn_contract import qos
from sojourn_contract.bundling import pack
from sojourn_contract.codecs import encode
from sojourn_contract.topic_types import Topic
from sojourn_contract.types import message_class
from sojourn_contract.values import Message

LOOK_S = 0.03
"""Wall time between two messages to onlookers [s]."""
ASK_S = 0.5
"""Wall time between two questions of who hears a topic [s]: to ask takes a tenth of a millisecond."""
PREFIX_BYTES = 12


def looks_of(role: str) -> Topic:
    """Row of the topic on which onlookers are told what a role says."""
    what = "what the role, or its process, has said since the last look, for consoles"
    return Topic(f"/_looks/{role}", "std_msgs/UInt8MultiArray", role, (), 1, 0.1, what, logged=False)


def quality(row: Topic) -> Any:
    """Profile of a row of looks. A page that stands still for a while loses none, and holds nobody up."""
    return qos.profile(row, True, "recorder")


class LookSender:
    """What waits for the next look at a node, or at all of a process, which send it together.

    Args:
        node: of the ROS library, with its role, which sends it.
    """

    def __init__(self, node: Any) -> None:
        self._node = node
        self._waiting: dict[str, tuple[Topic, list[Message]]] = {}
        """By topic, as a row of so many columns is slow to look up."""
        self._sender: Any = None
        """None until the first console is there."""
        self._sent = 0.0

    @property
    def is_due(self) -> bool:
        """Whether it is time for the next."""
        return time.monotonic() >= self._sent + LOOK_S

    def told(self) -> frozenset[bytes]:
        """Participants that hear what is sent; none until all who want to are reached."""
        row = looks_of(self._node.role)
        name = row.name.lstrip("/")
        readers = self._node.get_subscriptions_info_by_topic(self._node.resolve_topic_name(name))
        if readers and self._sender is None:
            self._sender = self._node.create_publisher(message_class(row.type), name, quality(row))
        if not readers or self._sender.get_subscription_count() < len(readers):
            return frozenset()
        return frozenset(map(_participant, readers))

    def put(self, row: Topic, message: Message, in_full: bool) -> None:
        """Have a message wait, beside those of its topic before it or in their place; send what waits if it is time."""
        if in_full and row.name in self._waiting:
            self._waiting[row.name][1].append(message)
        else:
            self._waiting[row.name] = row, [message]
        if self.is_due:
            self.send()

    def send(self) -> None:
        """Send what waits."""
        if not self._waiting:
            return
        waiting, self._waiting, self._sent = self._waiting, {}, time.monotonic()
        self._sender.publish(pack((name, encode(row, each)) for name, (row, said) in waiting.items() for each in said))


class Onlookers:
    """Of the topics of a node.

    Args:
        node: of the ROS library, with its role. rows: what may wait for a look. senders: their publishers, by topic.

    Attributes:
        looks: by which they are told; that of another node in the same process, where one sends for all.
    """

    def __init__(self, node: Any, rows: Mapping[str, Topic], senders: Mapping[str, Any]) -> None:
        self._node, self._rows, self._senders = node, rows, senders
        self.looks = LookSender(node)
        self._in_full: dict[str, bool] = {}
        """Topics that consoles alone hear, and whether one of them wants every message."""
        self._asked = 0.0
        self._counts: Mapping[str, int] = {}

    def look(self, counts: Mapping[str, int]) -> None:
        """See who is there, and send what waits. counts: how many hear each topic."""
        if self.looks.is_due:
            self.looks.send()
        now = time.monotonic()
        if counts != self._counts or now >= self._asked + ASK_S:
            self._asked, self._counts = now, counts
            self._ask()

    def takes(self, topic: str, message: Message) -> bool:
        """Whether a message need not be sent on its topic: nobody but onlookers hears it, and they are told of it."""
        in_full = self._in_full.get(topic)
        if in_full is None:
            return False
        self.looks.put(self._rows[topic], message, in_full)
        return True

    def _ask(self) -> None:
        """Who hears each topic now."""
        names = [name for name in self._rows if self._counts[name]]
        told = self.looks.told() if names else frozenset()
        heard = {name: self._readers(name) for name in names} if told else {}
        alone = {name: readers for name, readers in heard.items() if told.issuperset(map(_participant, readers))}
        in_full = {name: any(map(_is_reliable, readers)) for name, readers in alone.items() if readers}
        if in_full != self._in_full:
            self.looks.send()  # or what waits would come after what is sent from now on
            self._in_full = in_full

    def _readers(self, topic: str) -> Sequence[Any]:
        readers: Sequence[Any] = self._node.get_subscriptions_info_by_topic(self._senders[topic].topic_name)
        return readers


def _participant(reader: Any) -> bytes:
    """Whose a reader is: the first twelve bytes of its number (Real-time Publish-Subscribe protocol 2.5, 9.3.1)."""
    return bytes(reader.endpoint_gid[:PREFIX_BYTES])


def _is_reliable(reader: Any) -> bool:
    from rclpy.qos import ReliabilityPolicy

    return reader.qos_profile.reliability is not ReliabilityPolicy.BEST_EFFORT
