"""What a node does besides in a run that keeps checkpoints, or goes on from one: it hands its state over, and gets it
back. Over the middleware; nodes in one process are looked at instead, see `composed_checkpoints` of sojourn_bringup.
"""

from typing import TYPE_CHECKING, Any

from sojourn_contract import qos
from sojourn_contract.checkpoint_topic import (
    KEPT,
    MOST_PARTS,
    ONLY_OPERATOR,
    STATE,
    TAKE,
    StateParts,
    as_bytes,
    as_text,
    state_messages,
)
from sojourn_contract.codecs import encode
from sojourn_contract.decoding import hearing
from sojourn_contract.events import parse_tick
from sojourn_contract.heartbeat import read_heartbeats
from sojourn_contract.leaps import Leaps
from sojourn_contract.node import OPERATOR
from sojourn_contract.role_state import RoleAtCheckpoint
from sojourn_contract.stamps import CONTROL_PERIOD_NS
from sojourn_contract.state_tree import CheckpointError, packed, unpacked
from sojourn_contract.topic_types import Topic
from sojourn_contract.types import message_class
from sojourn_contract.values import DiagnosticArray, Header

if TYPE_CHECKING:  # a node hands over
    from rclpy.qos import QoSProfile

    from sojourn_contract.app_node import AppNode


def quality(row: Topic) -> "QoSProfile":
    """Of a row of checkpoints. Its history holds the largest state there is; that of answers the last one, for whoever
    has asked and is met only after it was given.
    """
    from rclpy.qos import DurabilityPolicy

    profile = qos.profile(row, True)
    if row is KEPT:
        profile.depth, profile.durability = 1, DurabilityPolicy.TRANSIENT_LOCAL
    else:
        profile.depth = MOST_PARTS
    return profile


def reader(node: Any, row: Topic, take: Any) -> Any:
    """A subscription of a row of checkpoints."""
    hear = hearing(row, take, lambda refusal: node.refuse(row.name, str(refusal)))
    return node.create_subscription(message_class(row.type), row.name.lstrip("/"), hear, quality(row), raw=True)


def sender(node: Any, row: Topic) -> Any:
    """A publisher of a row of checkpoints."""
    return node.create_publisher(message_class(row.type), row.name.lstrip("/"), quality(row))


class HandingOver:
    """Of one node: its state, whenever the plant asks for it.

    Args:
        node: whose. Its `words` hold what it has said.
    """

    def __init__(self, node: "AppNode") -> None:
        self._node = node
        self._asked: Header | None = None
        self._sender = sender(node, STATE)
        self._reader = None if node.ends_the_run else reader(node, TAKE, self._hear)
        ours = {*node.companions, node.role}
        self._foreign = [row for row in node.awaited if row.publisher not in ours and row.delivery is None]

    def look(self) -> None:
        """Hand over what is asked for, once it is all there. Raises as `hand`."""
        asked = self._asked
        if asked is None or self._node.now < asked.stamp:
            return
        if self._node.now == asked.stamp:
            if not self._has_all(asked):
                return
            self.hand()
        self._asked = None

    def hand(self, extra: dict[str, str] | None = None) -> None:
        """Hand over. Raises CheckpointError where the state holds what cannot be kept."""
        node, words, leaps = self._node, self._node.words, self._node.barrier.leaps
        if words is None:
            return
        words.end(node.now)
        following = leaps.after(node.now // CONTROL_PERIOD_NS)
        handed = RoleAtCheckpoint(node.role_state(), following, words.messages, words.named_ahead(), leaps)
        text = as_text(packed(handed, node.role))
        for message in state_messages(node.role, node.now, node.counters, text, extra):
            self._sender.publish(encode(STATE, message))

    def _hear(self, asked: Header) -> None:
        if (asked.frame == ONLY_OPERATOR) == (self._node.role == OPERATOR):
            self._asked = asked

    def _has_all(self, asked: Header) -> bool:
        """Whether the goals of the operator have come, and all that nodes of others say of the period."""
        node = self._node
        counts = {} if asked.frame == ONLY_OPERATOR else parse_tick(asked.frame)[0]
        kept = {} if node.words is None else node.words.messages
        heard = all(
            asked.stamp in kept.get(row.name, {})
            for row in self._foreign
            if asked.stamp // CONTROL_PERIOD_NS % row.every == 0
        )
        return heard and node.events.has_received(
            {name: n for name, n in counts.items() if name in node.endpoints.readers}
        )


class HandingBack:
    """Of one node of a run that goes on: it waits for its state.

    Args:
        node: whose. resumed_at: stamp of the state [ns].
    """

    def __init__(self, node: "AppNode", resumed_at: int) -> None:
        self._node, self._resumed_at = node, resumed_at
        self._parts = StateParts()
        self._reader: Any = reader(node, STATE, self._hear)
        self.is_here = False

    def look(self) -> None:
        """Hear no more, once the state is here."""
        if self.is_here and self._reader is not None:
            self._node.destroy_subscription(self._reader)
            self._reader = None

    def _hear(self, message: DiagnosticArray) -> None:
        for beat in read_heartbeats(message):
            if beat.role != self._node.role or beat.stamp != self._resumed_at or self.is_here:
                continue
            text = self._parts.take(beat)
            if text is None:
                continue
            try:
                begin = unpacked(as_bytes(text), beat.role)
            except CheckpointError as error:
                self._node.get_logger().error(f"the state that has come is none of this node: {error}")
                return
            if not isinstance(begin, RoleAtCheckpoint) or not isinstance(begin.leaps, Leaps):
                self._node.get_logger().error(f"what has come is no state of a role, but a {type(begin).__name__}")
                return
            self._node.go_on(begin)
            self.is_here = True
