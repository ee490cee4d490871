"""Base of every node: endpoints from the topic table, lock-step or real time, heartbeats, refusals.

A node derives from ContractNode, says its role, and implements `on_period`. In lock-step `on_period` is called at each
stamp at which inputs are due, once they are all in. In real time it is called when the trigger input arrives (see
`latest_inputs`), with the latest message of every other input.
"""

import time
from collections.abc import Mapping, Sequence
from typing import Any

from rclpy.context import Context

from sojourn_config.known_machine import KnownMachine
from sojourn_config.scenario import load_scenario
from sojourn_contract import stamps
from sojourn_contract.arrival import TICK, check_input
from sojourn_contract.barrier import Barrier, awaited_inputs
from sojourn_contract.closed_node import ClosedNode
from sojourn_contract.codecs import decode
from sojourn_contract.decoding import refusing, stamp_of
from sojourn_contract.endpoints import Endpoints
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.events import EventQueue, parse_tick
from sojourn_contract.heard import Acted, Hearing
from sojourn_contract.heartbeat import (
    ENDED,
    MATCHED,
    READY,
    RUNNING,
    STALLED,
    WAITING_FOR,
    WAITING_TO_MATCH,
    Counters,
    beats,
    heartbeat_message,
)
from sojourn_contract.latest_inputs import LatestInputs, trigger_of
from sojourn_contract.run_table import table_of
from sojourn_contract.silence import LOST_S, SILENCE_S, Silence
from sojourn_contract.topic_table import CLOCK
from sojourn_contract.topic_types import Topic
from sojourn_contract.topics import ROLES
from sojourn_contract.values import Header, Message
from sojourn_contract.words import Words

OPERATOR = "operator"
REFUSAL_LOG_S = 1.0
"""Wall time between two lines of the log on refused messages of one topic; the heartbeat counts them all."""
FAREWELL_S = 1.0
"""Wall time that a farewell has to arrive: a listener that is gone does not hold up the end."""
READY_REPEAT_S = 0.2
"""Wall time between heartbeats before the run."""


class ContractNode(ClosedNode):
    """A node that keeps the contract of one role.

    ROS parameters: `scenario` (name or path), `overrides` (KEY=VALUE texts that go over it), `lockstep`
    (bool), `participants` (roles that take part in the run), `companions` (those of them that are nodes of this stack
    in processes of their own, see `bundles`), `lockstep_timeout_s` (wall time after which a missing answer is an
    error). The scenario's machine says which topics the run has.

    Args:
        role: row of the process table; also the node's name.
        context: rclpy context. overrides: parameter values, as the composed start gives them.
        namespace: ROS namespace, None for that of the command line. every_period: act at every period (the plant).
    """

    def __init__(
        self,
        role: str,
        *,
        context: Context | None = None,
        overrides: Mapping[str, Any] | None = None,
        namespace: str | None = None,
        every_period: bool = False,
    ) -> None:
        super().__init__(role, context=context, namespace=namespace, overrides=overrides)
        self.role = role
        self.scenario_name: str = self.declare_parameter("scenario", "lunar_sample").value
        self.lockstep: bool = self.declare_parameter("lockstep", True).value
        self.participants: tuple[str, ...] = tuple(self.declare_parameter("participants", list(ROLES)).value)
        self.companions = tuple(filter(None, self.declare_parameter("companions", [""]).value))
        self.timeout_s: float = self.declare_parameter("lockstep_timeout_s", 10.0).value
        self.scenario_overrides = tuple(filter(None, self.declare_parameter("overrides", [""]).value))
        self.scenario: Any = self.read_scenario(self.scenario_name, self.scenario_overrides)
        """As its role knows it."""
        self.table = table_of(self.scenario)
        """The topics of the run."""
        self.counters = Counters()
        self._warned: dict[str, float] = {}
        self.events = EventQueue()
        self.finished, self.exit_status = False, 0
        self.failure = ""
        """Why the node has ended the run, in words."""
        self.ends_the_run = False
        """Whether its process (or the composed run) ends when it has finished: the plant's."""
        self.now = 0
        """Stamp [ns] of the last period acted on; zero before the run."""
        self.goes_on_from = 0
        """Of a run that goes on: the same, of the run before."""
        self.awaited = awaited_inputs(role, self.participants, self.table)
        longest_leap = self.table.longest_leap if self.lockstep else 0
        self.barrier: Barrier[Any] = Barrier(self.awaited, every_period, longest_leap)
        self._awaited_by_name = {row.name: row for row in self.awaited}
        self._trigger = trigger_of(self.awaited)
        self._last_progress = time.monotonic()
        self._silence = Silence(self._last_progress)
        """Of the trigger."""
        self._last_ready, self._complained, self._advancing = 0.0, 0.0, False
        self.received = 0
        """Messages that have come over the middleware."""
        self.words: Words | None = None  # nobody keeps what it says
        self.endpoints = Endpoints(self, self._take)
        periodic = [row for row in self.endpoints.inputs if not row.is_event and row.publisher != "all"]
        self.latest = LatestInputs(periodic)
        """What real time acts on."""
        self.hearing = Hearing()

    acts_in_silence = False
    """Whether it acts once a second where its trigger stays away in real time, to say so in its status."""

    # What a node implements or calls

    def read_scenario(self, name: str, overrides: Sequence[str]) -> KnownMachine:
        """What the node goes by. Raises ConfigError."""
        return load_scenario(name, overrides)

    def on_period(self, stamp: int, inputs: Mapping[str, Any], goals: list[tuple[str, Any]]) -> None:
        """Act on one period.

        Args:
            stamp: simulation time [ns]; every output of the period carries it.
            inputs: messages by topic: those due at this stamp (lock-step), or the latest of every periodic
                input (real time). The value is None where a message came but was refused; in real time also
                where none has come, or none that is young enough.
            goals: (topic, message) that take effect now.
        """
        raise NotImplementedError

    def check(self, row: Topic, message: Any) -> None:
        """Refuse a message by raising RefusedMessageError; a node may add checks of its own."""
        check_input(row, message)

    def on_new_time(self) -> None:
        """In real time the node's clock was wrong and has been set anew: forget what was measured by the old one."""

    def heartbeat_values(self) -> dict[str, str]:
        """What a node adds to its heartbeat; must not depend on wall time in lock-step."""
        return {}

    def gives(self, topic: str) -> bool:
        """Whether this run has a topic of the role."""
        return topic in self.endpoints.outputs

    def publish(self, topic: str, message: Message) -> None:
        """Publish on a topic of the role and count it, unless it is on demand."""
        if not self.endpoints.outputs[topic].on_demand:
            self.counters.count_published(topic)
        self.endpoints.send(topic, message)

    # What the loop around the node calls

    def hear(self, row: Topic, message: Message) -> None:
        """Take what a neighbour says at a rate, in lock-step."""
        try:
            self._receive_periodic(row, message.stamp, message)
        except RefusedMessageError as refusal:
            self.refuse(row.name, str(refusal))

    def lacks(self, row: Topic, stamp: int) -> bool:
        """Whether a message of a row that is waited for is to come yet."""
        return self.barrier.lacks(row, stamp)

    def poll(self) -> None:
        """Wall-clock chores, called some times a second: readiness before the run, a word when stalled."""
        now = time.monotonic()
        self.endpoints.look(now)
        if self.now == 0:
            if now - self._last_ready >= READY_REPEAT_S:
                self._last_ready = now
                missing = self.unmatched()
                state = WAITING_TO_MATCH if missing else READY
                # with whom it waits for already now: a run may stall in its very first period
                whom, _ = self._waits_for()
                self._send_heartbeat(state, 0, "; ".join(missing), {WAITING_FOR: whom} if whom else {})
        elif not self.lockstep:
            self._bear_silence(now)
        elif now - self._last_progress > self.timeout_s / 2:
            whom, what = self._waits_for()
            if whom:
                self._last_progress = now
                self._send_heartbeat(STALLED, self.now, f"waiting for {what} from {whom}", {WAITING_FOR: whom})

    def is_drained(self) -> bool:
        """Whether nothing that it must still take is on its way; the recorder waits here."""
        return True

    def close(self) -> None:
        """Act no more, and say farewell; called once before the node is destroyed."""
        self.finished = True
        if self.now:
            self._send_heartbeat(ENDED, self.now)
            # or the end of the node may overtake its last words, and the recorder's account lacks its counters
            self.endpoints.await_arrival(FAREWELL_S)

    def unmatched(self) -> list[str]:
        """Endpoints of other participants that are not connected yet, in words."""
        return self.endpoints.unmatched()

    def _waits_for(self) -> tuple[str, str]:
        """Role and topic that this node waits for in lock-step; empty where it waits for nobody."""
        if not self.lockstep or not self.awaited:
            return "", ""
        missing = self.barrier.missing()
        if missing:
            return missing[0].publisher, missing[0].name
        return ("", "") if self._goals_are_in() else (OPERATOR, "the goals that its tick announces")

    def _take(self, row: Topic, data: bytes) -> None:
        self.received += 1
        self._receive(row, data)

    def _receive(self, row: Topic, data: bytes) -> None:
        """Take one message: refuse it, queue it as a goal, or give it to the barrier."""
        try:
            if row.is_event:
                self._receive_event(row, data)
            elif row.publisher == "all":
                message = self._content(row, data)
                with refusing(row.name, f"a {row.type} that can be read"):
                    self.on_heartbeat(message)
            elif self.lockstep:
                self._receive_periodic(row, stamp_of(row.name, data), data)
            else:
                self._receive_realtime(row, stamp_of(row.name, data), data)
        except RefusedMessageError as refusal:
            self.refuse(row.name, str(refusal))

    def _content(self, row: Topic, data: bytes | Message) -> Any:
        """What the message holds, checked. Raises RefusedMessageError."""
        message = self._message(row, data)
        self._check(row, message)
        return message

    def _message(self, row: Topic, data: bytes | Message) -> Any:
        return decode(row, data) if isinstance(data, bytes) else data

    def _check(self, row: Topic, message: Any) -> None:
        with refusing(row.name, f"a {row.type} that can be read"):
            self.check(row, message)

    def on_heartbeat(self, message: Any) -> None:
        """A message on /diagnostics; only the plant and the recorder listen."""

    def refuse(self, topic: str, reason: str) -> None:
        """Count a refused message and log it; of a topic that goes on like that, one line a second."""
        self.counters.count_refused(topic, reason)
        now = time.monotonic()
        if now - self._warned.get(topic, -REFUSAL_LOG_S) >= REFUSAL_LOG_S:
            self._warned[topic] = now
            self.get_logger().warning(f"refused: {reason}")

    def _receive_event(self, row: Topic, data: bytes) -> None:
        self.events = self.events.counted(row)
        try:
            stamp, goal = stamp_of(row.name, data), self._content(row, data)
            self.events = self.events.offered(row, stamp, self.now, goal)
        except RefusedMessageError as refusal:
            self.refuse(row.name, str(refusal))
        self._advance()  # a tick may have waited for this goal, good or bad

    def _receive_periodic(self, row: Topic, stamp: int, data: bytes | Message) -> None:
        row = self._awaited_by_name[row.name]
        if self.barrier.repeats(row, stamp):  # as if it were lost: its count in a heartbeat would depend on its way
            return
        allowed = self.barrier.refusal(row, stamp)
        if allowed is not None:
            raise RefusedMessageError(row.name, "header.stamp", f"{stamp / 1e9:.3f} s", allowed)
        content = self._content_or_none(row, data)
        self.barrier.offer(row, stamp, content)
        if self.words is not None and row.publisher not in self.companions:  # who may keep nothing of what he says
            self.words.hear(row, Header(stamp) if content is None else content)
        self._advance()

    def _content_or_none(self, row: Topic, data: bytes | Message) -> Any:
        """As `_content`; None for a message that is refused, which is counted."""
        try:
            return self._content(row, data)
        except RefusedMessageError as refusal:
            self.refuse(row.name, str(refusal))
            return None

    def _receive_realtime(self, row: Topic, stamp: int, data: bytes) -> None:
        message = self._message(row, data)  # or nothing of it is believed: its stamp neither
        allowed = self._refusal_realtime(row, stamp)
        if allowed is not None:
            raise RefusedMessageError(row.name, "header.stamp", f"{stamp / 1e9:.3f} s", allowed)
        try:
            self._check(row, message)
        except RefusedMessageError as refusal:
            self.refuse(row.name, str(refusal))
            message = None
        self.latest.keep(row, stamp, message)
        if row.name != self._trigger:
            return
        self._silence.ends()
        if row.name == CLOCK and stamp % (self.barrier.stride * stamps.CONTROL_PERIOD_NS):
            return  # it beats more often than the node acts
        if stamp <= self.now and self.now > self.latest.timeline.now + stamps.CONTROL_PERIOD_NS:
            self._begin_anew(stamp)  # it has acted on a stamp that nobody else has reached
        if stamp > self.now:
            self.act(stamp, self.latest.at(stamp))

    def _refusal_realtime(self, row: Topic, stamp: int) -> str | None:
        """Why a message with this stamp cannot be taken in real time, or None."""
        refusal, is_new_time = self.latest.hear(row, stamp, time.monotonic())
        if is_new_time:
            self._begin_anew(stamp)
        return refusal or self.latest.repeats(row, stamp, self.latest.timeline.now)

    def _begin_anew(self, stamp: int) -> None:
        """The time was wrong: go on from `stamp` [ns]."""
        self.now = stamp - stamps.CONTROL_PERIOD_NS
        self.latest.begin_anew(stamp)
        self.events = self.events.begun_anew(self.now)
        self.on_new_time()

    def _bear_silence(self, now: float) -> None:
        """In real time, where the trigger stays away: say once a second for whom it waits, and act if that is wanted,
        at whole seconds. One that a stranger's clock has set off before the run says that it could begin.
        """
        silent = self._silence.until(now)
        if self.finished or not self._trigger or silent < SILENCE_S or now - self._complained < SILENCE_S:
            return
        self._complained = now
        stamp = (self.latest.timeline.now + int(silent * stamps.NANOSECONDS)) // stamps.NANOSECONDS * stamps.NANOSECONDS
        if self.acts_in_silence and silent > LOST_S and stamp > self.now:
            self.act(stamp, self.latest.at(stamp))
        whom, met = self.table.topic(self._trigger).publisher, {} if self.unmatched() else {MATCHED: "yes"}
        self._send_heartbeat(STALLED, self.now, f"waiting for {self._trigger} from {whom}", {WAITING_FOR: whom} | met)

    def _advance(self) -> None:
        """Act on every period whose inputs are in."""
        if not self.lockstep or self._advancing or not self.awaited:
            return
        self._advancing = True
        try:
            while not self.finished and self.barrier.is_complete() and self._goals_are_in():
                stamp = self.barrier.stamp
                self.act(stamp, self.barrier.take())
        finally:
            self._advancing = False

    def _goals_are_in(self) -> bool:
        """Whether all goals that the operator's tick of this period announces have arrived."""
        row = self._awaited_by_name.get(TICK)
        tick = None if row is None else self.barrier.peek(row)
        if tick is None:
            return True
        counts, _ = parse_tick(tick.frame)
        known = {name: count for name, count in counts.items() if name in self.endpoints.readers}
        return self.events.has_received(known)

    def act(self, stamp: int, inputs: Mapping[str, Any]) -> None:
        """Run one period and send the heartbeat when one is due."""
        self._last_progress = time.monotonic()
        if not self.now:
            self.endpoints.look(self._last_progress)  # who listens from the beginning misses nothing
        previous, self.now = self.now or self.goes_on_from, stamp
        self.events, goals = self.events.taken(stamp)
        if self.lockstep:
            self.hearing.take_goals(goals, previous, stamp)
        else:  # no stamp says what it acts on
            self.hearing.take_goals(goals, stamp, stamp)
            heard = {name: None if kept is None else self.latest.stamp_of(name) for name, kept in inputs.items()}
            self.hearing.acted.append(Acted(stamp, heard))
        self.endpoints.bundles.hold()
        self.on_period(stamp, inputs, goals)
        if beats(previous, stamp):
            self._send_heartbeat(RUNNING, stamp)
        self.endpoints.bundles.release()

    def _send_heartbeat(self, state: str, stamp: int, detail: str = "", extra: dict[str, str] | None = None) -> None:
        values = self.heartbeat_values() | (extra or {})
        if state in (RUNNING, ENDED):
            values |= self.hearing.tell()
        if state == RUNNING:  # the others depend on wall time, and are no part of the record
            self.counters.count_published("/diagnostics")
        message = heartbeat_message(self.role, state, stamp, self.counters, detail, values)
        self.endpoints.send("/diagnostics", message)
