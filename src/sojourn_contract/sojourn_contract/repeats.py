"""What the nodes of a run say again where it stands still, in lock-step between processes.

The middleware keeps the newest messages of a topic alone: a node that does not get to them, since somebody floods it or
the machine is busy, loses one for which it then waits without end, and all others for it. So whoever has not acted for
a while says again what it has said at a rate in the last periods, on one hidden topic for all companions; each takes of
it what it lacks, and passes over the first saying where that is late and not lost. A run that goes on says nothing
again, and its record is the same either way. Goals and heartbeats, which go both ways, are not said again.
"""

from collections import deque
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

from sojourn_contract import qos
from sojourn_contract.bundling import REPEATS, pack, unpack
from sojourn_contract.decoding import stamp_of
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.topic_types import Topic
from sojourn_contract.topics import RECORDER_LAG
from sojourn_contract.types import message_class

if TYPE_CHECKING:  # a node has repeats
    from sojourn_contract.node import ContractNode

AFTER_S, PART = 0.5, 0.02
"""Wall time without a period after which a node speaks, and again and again [s]: more rarely the longer it stands, by
this part of it, for somebody may have halted a node on purpose.
"""
KEPT = RECORDER_LAG + 5
"""Bundles that are kept: nobody is further behind than the recorder may be."""
MOST_TAKEN = 500
"""Messages of which the first saying may come late."""


class Repeats:
    """Of one node with companions.

    Args:
        node: it knows when it acts and what it lacks. take: called with a row and the bytes of a message that it lacks.
    """

    def __init__(self, node: "ContractNode", take: Callable[[Topic, bytes], None]) -> None:
        self._node, self._take = node, take
        self._said = deque[Sequence[tuple[str, bytes]]](maxlen=KEPT)
        self._awaited = {row.name: row for row in node.awaited}
        self._at_a_rate = {row.name for row in node.table if row.publisher == node.role and not row.is_event}
        self._taken = deque[tuple[str, int]](maxlen=MOST_TAKEN)
        """Topic and stamp of what was taken when it was said again."""
        self._stands_at, self._stands_since = -1, 0.0
        """Stamp at which the node has acted last [ns], and since when it has not [s]."""
        self._spoke_at = 0.0
        kind, name = message_class(REPEATS.type), REPEATS.name.lstrip("/")
        self._sender: Any = node.create_publisher(kind, name, qos.profile(REPEATS, True))
        self._reader: Any = node.create_subscription(kind, name, self._hear, qos.profile(REPEATS, True), raw=True)

    def note(self, said: Sequence[tuple[str, bytes]]) -> None:
        """Of what the node says, by topic."""
        self._said.append(said)

    def look(self, now: float) -> None:
        """Say again what has been said, if the run stands still at a wall time [s]."""
        if self._node.now != self._stands_at:
            self._stands_at, self._stands_since, self._spoke_at = self._node.now, now, now
        elif self._said and now - self._spoke_at > max(AFTER_S, PART * (now - self._stands_since)):
            self._spoke_at = now
            self._sender.publish(pack(one for said in self._said for one in said if one[0] in self._at_a_rate))

    def is_late(self, row: Topic, data: bytes) -> bool:
        """Whether a message has been taken already when it was said again; the second such one is not."""
        if not self._taken:
            return False
        try:
            self._taken.remove((row.name, stamp_of(row.name, data)))
        except (ValueError, RefusedMessageError):
            return False
        return True

    def _hear(self, data: bytes) -> None:
        try:
            for name, content in unpack(REPEATS.name, data):
                row = self._awaited.get(name)
                if row is not None and self._node.lacks(row, stamp := stamp_of(name, content)):
                    self._taken.append((name, stamp))
                    self._take(row, content)
        except RefusedMessageError as refusal:
            self._node.refuse(REPEATS.name, str(refusal))
