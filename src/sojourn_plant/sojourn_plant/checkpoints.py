"""Checkpoints of a run whose nodes are processes of their own: the plant has all of them hand their states over.

At a period's end of which a checkpoint is wanted it waits until all others have acted on that period and have handed
over what they are; then it acts, which nobody else can before it, and hands over its own state with the word of who has
answered. Who writes them into a file is none of its affairs, but it asks for the next ones only when he is done.
"""

import time
from typing import Any

from sojourn_contract.checkpoint_times import EvenTimes, common_grid
from sojourn_contract.checkpoint_topic import FILED, ONLY_OPERATOR, STATE, TAKE, StateParts
from sojourn_contract.codecs import encode
from sojourn_contract.events import format_tick
from sojourn_contract.handing_over import HandingOver, reader, sender
from sojourn_contract.heartbeat import Heartbeat, read_heartbeats
from sojourn_contract.node import OPERATOR
from sojourn_contract.stamps import CONTROL_PERIOD_NS, seconds
from sojourn_contract.values import DiagnosticArray, Header

ANSWERED, SILENT = "answered", "silent"
"""Keys of the plant's own state, as messages: the roles that have handed over theirs, and those that have not."""
NO_STATES = ("plant", "recorder")
"""Who is not asked."""


class AskingKeeper:
    """Has the nodes of a run hand over their states; the plant asks it, see `PacingNode`.

    Args:
        node: the plant's. every_s: simulation time from one checkpoint to the next [s].
        wait_s: wall time after which a node that does not answer takes part in no checkpoint [s].
    """

    def __init__(self, node: Any, every_s: float, wait_s: float) -> None:
        self._node, self._wait_s = node, wait_s
        self._times = EvenTimes(every_s, seconds(node.resumed_at))
        self._grid = common_grid(node.participants, node.table)
        self._others = [role for role in node.participants if role not in NO_STATES]
        self._handing_over = HandingOver(node)
        self._sender = sender(node, TAKE)
        self._readers = (reader(node, STATE, self._hear), reader(node, FILED, self._hear_filed))
        self._parts = StateParts()
        self._at = 0
        """The period that is kept [ns]."""
        self._asked_since = 0.0
        self._goals: str | None = None
        """How many goals the operator has sent, once it has said so."""
        self._answered: set[str] = set()
        self._silent: set[str] = set()
        """Who has not answered once, and is asked no more."""
        self._is_asked = False
        self._to_be_filed = 0
        """The last period that was kept [ns], 0 once it is in a file."""
        self._handed_since = 0.0
        self._is_late = False
        """Who writes files was so for longer than it waits for him, and has not been heard since."""
        self.answered = 0
        """See `Keeper`."""

    def ask(self) -> None:
        """Keep the state at the next period that can be."""
        self._is_asked = True

    def may_act(self, stamp: int) -> bool:
        """Before the plant acts on a period [ns]."""
        if stamp != self._at:
            is_common = stamp // CONTROL_PERIOD_NS % self._grid == 0
            if not (is_common and (self._is_asked or self._times.is_due(seconds(stamp)))):
                return True
            if not self._is_filed():
                return False
            self._begin(stamp)
        missing = {role for role in self._others if role not in self._answered | self._silent}
        if missing and time.monotonic() - self._asked_since > self._wait_s:
            if self._goals is None:
                self._ask_all("")
            else:
                self._silent |= missing
                missing = set()
        return not missing

    def acted(self, stamp: int) -> None:
        """After it has. Raises CheckpointError: its own state holds what cannot be kept."""
        if stamp != self._at or self._node.finished:
            return
        self._handing_over.hand({ANSWERED: " ".join(sorted(self._answered)), SILENT: " ".join(sorted(self._silent))})
        self._to_be_filed, self._handed_since = stamp, time.monotonic()
        self._times.passed(seconds(stamp))
        if self._is_asked and not self._silent:
            self.answered = stamp
        self._is_asked = False

    def _is_filed(self) -> bool:
        """Whether who writes files is done with the last states, is late, or is not there."""
        if not self._to_be_filed or not self._node.count_publishers(self._readers[1].topic_name):
            return True
        self._is_late = self._is_late or time.monotonic() - self._handed_since > self._wait_s
        return self._is_late

    def _hear_filed(self, message: Header) -> None:
        self._is_late = False
        if message.stamp == self._to_be_filed:
            self._to_be_filed = 0

    def _begin(self, stamp: int) -> None:
        self._at, self._goals, self._answered = stamp, None, set()
        if OPERATOR in self._others and OPERATOR not in self._silent:
            self._take(ONLY_OPERATOR)
        else:
            self._ask_all("")

    def _ask_all(self, goals: str) -> None:
        self._goals = goals
        self._take(goals)

    def _take(self, text: str) -> None:
        self._asked_since = time.monotonic()
        self._sender.publish(encode(TAKE, Header(self._at, text)))

    def _hear(self, message: DiagnosticArray) -> None:
        for beat in read_heartbeats(message):
            if beat.stamp == self._at and beat.role in self._others and self._parts.take(beat) is not None:
                self._take_answer(beat)

    def _take_answer(self, beat: Heartbeat) -> None:
        self._answered.add(beat.role)
        if beat.role == OPERATOR and self._goals is None:
            events = {row.name for row in self._node.table if row.is_event}
            self._ask_all(format_tick({name: n for name, n in beat.published.items() if name in events}, False))
