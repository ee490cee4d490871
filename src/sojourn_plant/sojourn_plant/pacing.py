"""Node that owns /clock: it begins the run, keeps its pace, and ends it where somebody is silent.

The start: it waits until all participants say that they are ready, then publishes the first period. In lock-step it
acts on a period when all that is due for it has come; in real time by the wall clock.
"""

import time
from collections.abc import Mapping, Sequence
from typing import Any, Protocol

from rclpy.context import Context

from sojourn_contract import stamps
from sojourn_contract.app_node import AppNode
from sojourn_contract.barrier import is_due, stamp_due
from sojourn_contract.checkpoint_topic import CHECKPOINT, KEPT
from sojourn_contract.codecs import encode
from sojourn_contract.errors import DomainInUseError, RefusedMessageError, SilentNodeError
from sojourn_contract.handing_over import reader, sender
from sojourn_contract.heartbeat import read_heartbeats
from sojourn_contract.node import REFUSAL_LOG_S
from sojourn_contract.role_state import RoleAtCheckpoint
from sojourn_contract.silence import Silence
from sojourn_contract.topic_types import Topic
from sojourn_contract.values import Header, Message
from sojourn_plant.asking import AskingLimit
from sojourn_plant.checkpoints import AskingKeeper
from sojourn_plant.roster import Roster

DISCOVERY_S = 0.5
"""Wall time after its creation before which a plant does not begin: another one on its domain may not be
seen yet.
"""
CHECKPOINT_PART = 0.5
"""Of the time-out: for so long it waits for the states of a checkpoint."""
RECORD = "/recorder/tick"
FREE_RUN_S = 0.02
"""Wall time for which a plant that nobody answers runs between two looks at its messages."""


class Keeper(Protocol):
    """Who keeps the state of the run at some of its periods, see `composed_checkpoints` of sojourn_bringup."""

    def may_act(self, stamp: int) -> bool:
        """Before a period [ns]: whether it may be acted on now; else it is asked again soon."""

    def acted(self, stamp: int) -> None:
        """After it."""

    def ask(self) -> None:
        """Somebody wants it kept at the next period that can be."""

    @property
    def answered(self) -> int:
        """Stamp of the last state that was asked for [ns], 0 where none was."""


class PacingNode(AppNode):
    """A role whose periods are those of everybody. Its app has `first_messages`, with which a run begins."""

    def __init__(
        self,
        *,
        context: Context | None = None,
        overrides: Mapping[str, Any] | None = None,
        namespace: str | None = None,
    ) -> None:
        self._created = time.monotonic()
        super().__init__(context=context, overrides=overrides, namespace=namespace, every_period=True)
        self.ends_the_run = True
        self._trigger = ""  # in real time it acts by the wall clock, whatever comes
        self.roster = Roster(self.role, self.participants, self.timeout_s, self.resumed_at)
        self._begun = False
        self._silence_of_others = Silence(self._created)
        self._timer: Any = None
        self._acted_at = 0.0
        """Wall time of the last period in real time [s]."""
        self._asking_limit = AskingLimit()
        self.keeper: Keeper | None = None
        """None: nobody keeps anything."""
        self.first_words: Sequence[tuple[str, Message]] | None = None
        """Of a run that goes on: (topic, message) that had been said, and counted, when it stood."""
        if self.checkpoint_every_s:
            self.keep_with(AskingKeeper(self, self.checkpoint_every_s, self.timeout_s * CHECKPOINT_PART))

    def go_on(self, begin: RoleAtCheckpoint) -> None:
        """See AppNode; what it has said of the period to come it says again, and it knows of the record before."""
        super().go_on(begin)
        self.first_words = [(name, message) for name, message in begin.ahead if name in self.endpoints.outputs]
        now = begin.leaps.before(begin.period) * stamps.CONTROL_PERIOD_NS
        for row in self.awaited:
            if row.name == RECORD:
                periods = range(begin.period, begin.period + row.lag + 1)
                ticks = {stamp_due(row, period, begin.leaps) for period in periods if is_due(row, period)}
                for stamp in sorted(ticks):
                    if 0 < stamp <= now:
                        self.barrier.offer(row, stamp, Header(stamp))

    def keep_with(self, keeper: Keeper) -> None:
        """Have the state of the run kept, and listen to who asks for it."""
        self.keeper = keeper
        self._asking, self._answers = reader(self, CHECKPOINT, self._hear_asking), sender(self, KEPT)

    def on_heartbeat(self, message: Any) -> None:
        """Keep who is ready, and who says that it waits for whom."""
        self.roster.hear(read_heartbeats(message))

    def poll(self) -> None:
        """Begin the run when everybody is ready; say who is silent when somebody is."""
        super().poll()
        if self.finished:
            return
        waited = self._silence_of_others.until(time.monotonic())
        if not self._begun:
            self._begin_when_ready(waited)
        elif self.lockstep and not self.awaited:
            until = time.monotonic() + FREE_RUN_S
            while time.monotonic() < until:
                self.act(self.now + stamps.CONTROL_PERIOD_NS, {})
        elif self.lockstep and waited > self.timeout_s and self.barrier.missing():
            self._stop_for_silence()
        elif not self.lockstep and time.monotonic() - self._acted_at > 2.0 * stamps.CONTROL_PERIOD_S:
            self._act_in_real_time()  # its timer waits behind more messages than can be heard
        elif self.keeper is not None:
            self._advance()

    def act(self, stamp: int, inputs: Mapping[str, Any]) -> None:
        """Run one period, and wait anew."""
        self._silence_of_others.ends()
        super().act(stamp, inputs)
        if self.keeper is not None:
            before = self.keeper.answered
            self.keeper.acted(stamp)
            if self.keeper.answered != before:
                self._answers.publish(encode(KEPT, Header(self.keeper.answered)))

    def _hear_asking(self, request: Header) -> None:
        """What is asked of the keeper is none of the app's goals, and what comes of it is in no heartbeat: a run is the
        same whether or not it is kept.
        """
        try:
            if self.keeper is not None and self._asking_limit.is_new(self.now, self.keeper.answered):
                self.keeper.ask()
        except RefusedMessageError as refusal:
            self._answers.publish(encode(KEPT, Header(request.stamp, str(refusal))))
            self.get_logger().warning(f"refused: {refusal}", throttle_duration_sec=REFUSAL_LOG_S)

    def _goals_are_in(self) -> bool:
        return super()._goals_are_in() and (self.keeper is None or self.keeper.may_act(self.barrier.stamp))

    def _begin_when_ready(self, waited: float) -> None:
        if self.count_publishers(self.endpoints.senders["/clock"].topic_name) > 1:
            self._fail(DomainInUseError(str(self.context.get_domain_id()), self.endpoints.senders["/clock"].topic_name))
            return
        unmatched = self.unmatched()
        if unmatched or self.roster.missing():
            if waited > 3 * self.timeout_s:
                self._fail(self.roster.not_ready(unmatched, waited))
            return
        if time.monotonic() - self._created < DISCOVERY_S:
            return
        self._begun = True
        self._last_progress = time.monotonic()
        self._silence_of_others.ends()
        if self.first_words is None:
            self.publish_all(self.app.first_messages(self.state, stamps.CONTROL_PERIOD_NS))
        for name, message in self.first_words or ():
            self.endpoints.send(name, message)
        if not self.lockstep:
            self._acted_at = time.monotonic()
            self._timer = self.create_timer(stamps.CONTROL_PERIOD_S, self._act_in_real_time)
        self._advance()  # where nobody answers in the first period, no message would begin the run

    def _act_in_real_time(self) -> None:
        if self.finished:
            return
        self._acted_at = time.monotonic()
        stamp = self.now + stamps.CONTROL_PERIOD_NS
        self.act(stamp, self.latest.at(stamp))

    def _stop_for_silence(self) -> None:
        """Name the node at the root: the one that is missing and does not say that it waits for another."""
        row = self.barrier.missing()[0]
        role = self.roster.root_of_silence(row.publisher)
        self._fail(SilentNodeError(role, row.name, stamps.seconds(self.barrier.stamp), self.timeout_s))

    def _refusal_realtime(self, row: Topic, stamp: int) -> str | None:
        """By its own clock: nobody can answer a truth that is not told yet."""
        latest = self.now + stamps.CONTROL_PERIOD_NS
        if stamp > latest:
            return f"simulation time, {stamps.seconds(latest):.3f} s at most"
        oldest = stamps.seconds(self.now) - row.max_age_s
        if stamps.seconds(stamp) < oldest:
            return f"{oldest:.3f} s or later"
        return self.latest.repeats(row, stamp, self.now)

    def _advance(self) -> None:
        if self._begun:
            super()._advance()

    def _fail(self, error: Exception) -> None:
        self.get_logger().error(str(error))
        self.exit_status = 1
        self.finished = True
        self.failure = str(error)
