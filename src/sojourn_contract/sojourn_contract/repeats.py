"""What the nodes of a run say again where it stands still, in lock-step between processes.

The middleware keeps the newest messages of a topic alone: a node that does not get to them, since somebody floods it or
the machine is busy, loses one for which it then waits without end, and all others for it. So whoever has not acted for
a while says again what it has said of the last periods, on one hidden topic for all companions; each takes of it what
it lacks. A run that goes on says nothing again, and its record is the same either way.
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


class Repeats:
    """Of one node with companions.

    Args:
        node: it knows when it acts and what it lacks. take: called with a row and the bytes of a message that it lacks.
    """

    def __init__(self, node: "ContractNode", take: Callable[[Topic, bytes], None]) -> None:
        self._node, self._take = node, take
        self._said = deque[Sequence[tuple[str, bytes]]](maxlen=KEPT)
        self._awaited = {row.name: row for row in node.awaited}
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
            self._sender.publish(pack(one for said in self._said for one in said))

    def _hear(self, data: bytes) -> None:
        try:
            for name, content in unpack(REPEATS.name, data):
                row = self._awaited.get(name)
                if row is not None and self._node.lacks(row, stamp_of(name, content)):
                    self._take(row, content)
        except RefusedMessageError as refusal:
            self._node.refuse(REPEATS.name, str(refusal))
