"""Listens to a running stack for one role: what the role hears, period by period, and what its node says.

It waits for nobody and nobody waits for it: its queues are deep, so that it loses nothing while it lags behind. In
lock-step it gives a goal that somebody sent by hand on in the period in which our node took it, as that tells in its
next heartbeat, a second later at most.
"""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from rclpy.node import Node
from rclpy.qos import QoSProfile

from sojourn_bags.definitions import full_type
from sojourn_bags.errors import UnansweredError
from sojourn_bags.messages import Messages
from sojourn_bags.replay_script import CLOCK, HEARTBEATS, ReplayPeriod
from sojourn_bags.role_beats import beats_of
from sojourn_contract import qos, stamps
from sojourn_contract.barrier import Barrier, awaited_inputs
from sojourn_contract.decoding import STAMP_BYTES
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.heard import took_in
from sojourn_contract.topic_table import TopicTable
from sojourn_contract.topic_types import Topic
from sojourn_contract.types import message_class

DEPTH = 20_000
"""Messages of a topic that may wait: minutes of a run."""
MOST_MISSED = 250
"""Periods that the stack may be ahead of one of which a message has not come: more, and it was lost."""
BEHIND = 2
"""Periods that the newest must be ahead: of what is younger, our node may hear a goal before the rest and we after."""
UNTOLD_NS = 2 * stamps.NANOSECONDS
"""After a goal came by hand, heartbeats this much younger that do not tell of it never will: it was refused, or the
node is one that does not tell [ns]."""


@dataclass
class HeardGoal:
    """A goal that has come from the stack.

    Args:
        topic, data: of the message. stamp: of the message. newest: latest stamp heard before it.
        at: of the period in which our node took it, 0 as long as it has not told. All [ns].
    """

    topic: str
    data: bytes
    stamp: int
    newest: int
    at: int = 0

    @property
    def by_hand(self) -> bool:
        """Whether its stamp does not say when it takes effect: it is for now."""
        return self.stamp <= self.newest

    def is_due(self, stamp: int) -> bool:
        """Whether it comes before the inputs of a period [ns]: when our node took it, or after what came before it."""
        return (self.at or self.newest + 1) <= stamp


class Tap:
    """What a role of a running stack hears and says.

    Args:
        role: the role. participants, table: of the run. lockstep: mode of time.
        node: in the stack's namespace; the subscriptions are made on it.
    """

    def __init__(self, role: str, participants: Sequence[str], table: TopicTable, lockstep: bool, node: Node) -> None:
        self.role, self.lockstep = role, lockstep
        self.newest = 0
        """Latest stamp heard on what the role waits for [ns]."""
        self.heard = 0
        """Messages taken."""
        self.ours: dict[str, Messages] = {}
        """What our node has said, by topic, without heartbeats."""
        awaited = awaited_inputs(role, participants, table)
        self._awaited = {row.name: row for row in awaited}
        self._barrier: Barrier[bytes] = Barrier(awaited)
        self._goals: list[HeardGoal] = []
        self._told, self._over = 0, False
        self._waiting: deque[tuple[str, bytes]] = deque()
        heard = (row for row in table.inputs_of(role) if row.name in self._awaited or row.is_event)
        self.inputs = (table.topic(CLOCK), *heard)
        for row in self.inputs:
            self._listen(node, row, self._hear)
        for row in table.outputs_of(role):
            if row.on_demand:
                continue  # nothing to compare, and to listen would be the demand
            if row.name != HEARTBEATS:
                self.ours[row.name] = Messages(row.name, full_type(row.type))
                self._listen(node, row, self._hear_ours)
            elif lockstep:
                self._listen(node, row, self._hear_heartbeat)

    def close(self) -> None:
        """The run is over: what has come is all that there will be."""
        self._over = True

    def next_step(self) -> ReplayPeriod | None:
        """The next period whose inputs are all here, with the goals that came before it; in real time what has come.

        Raises:
            UnansweredError: a message of the stack was lost on its way here.
        """
        if not self.lockstep:
            return self._all_that_waits()
        if not self._barrier.is_complete():
            ahead = (self.newest - self._barrier.stamp) // stamps.CONTROL_PERIOD_NS
            if ahead > MOST_MISSED:
                row = self._barrier.missing()[0]
                raise UnansweredError(
                    f"{row.name} stamped {stamps.seconds(self._barrier.stamp):.2f} s has not come from the stack: "
                    "the shadow cannot go on"
                )
            return None
        if not self._over and not self._settled():
            return None
        step = ReplayPeriod(self._barrier.period)
        due = [goal for goal in self._goals if goal.is_due(self._barrier.stamp)]
        for goal in due:
            self._goals.remove(goal)
            step.goals.append((goal.topic, goal.data))
            if goal.by_hand:
                step.add_by_hand(goal.topic, goal.data, bool(goal.at))
        step.inputs = list(self._barrier.take().items())
        return step

    def _settled(self) -> bool:
        """Whether nothing more can come that belongs before the period that is due."""
        due, period = self._barrier.stamp, stamps.CONTROL_PERIOD_NS
        if self.newest < due + BEHIND * period:
            return False
        waiting = (goal for goal in self._goals if goal.by_hand and not goal.at)
        return not any(self._told < goal.newest + UNTOLD_NS and due >= goal.newest - period for goal in waiting)

    def _all_that_waits(self) -> ReplayPeriod | None:
        if not self._waiting:
            return None
        step = ReplayPeriod(self.newest // stamps.CONTROL_PERIOD_NS, inputs=list(self._waiting))
        self._waiting.clear()
        return step

    def _listen(self, node: Node, row: Topic, take: Any) -> None:
        offered = qos.profile(row, self.lockstep)
        profile = QoSProfile(history=offered.history, depth=DEPTH, reliability=offered.reliability)
        name = row.name.lstrip("/")
        node.create_subscription(message_class(row.type), name, lambda data: take(row, data), profile, raw=True)

    def _hear(self, row: Topic, data: bytes) -> None:
        self.heard += 1
        if len(data) < STAMP_BYTES:  # the node refuses it, and the candidate has nothing to answer
            return
        stamp = stamps.from_cdr(data)
        if not self.lockstep:
            self.newest = max(self.newest, stamp if row.name in self._awaited else 0)
            self._waiting.append((row.name, data))
        elif row.is_event:
            # one that is stamped ahead takes effect at its stamp; one for now, when our node tells
            self._goals.append(HeardGoal(row.name, data, stamp, self.newest))
        elif row.name in self._awaited:
            self.newest = max(self.newest, stamp)
            if stamp + row.lag * stamps.CONTROL_PERIOD_NS >= self._barrier.stamp:  # the candidate may be far behind
                self._barrier.offer(row, stamp, data)

    def _hear_heartbeat(self, row: Topic, data: bytes) -> None:
        """When our node has taken goals that came by hand; a heartbeat that cannot be read tells nothing."""
        try:
            beats = beats_of(self.role, row, data)
            took = [told for beat in beats for told in took_in(beat.values)]
        except RefusedMessageError:
            return
        for told in took:
            same = (each for each in self._goals if (each.topic, each.stamp, each.at) == (told.topic, told.stamp, 0))
            if (goal := next(same, None)) is not None:
                goal.at = told.at
        self._told = max(self._told, *(beat.stamp for beat in beats), 0)

    def _hear_ours(self, row: Topic, data: bytes) -> None:
        self.heard += 1
        if len(data) < STAMP_BYTES:
            return
        stamp = stamps.from_cdr(data)
        self.ours[row.name].log_times.append(stamp)
        self.ours[row.name].data.append(data)
