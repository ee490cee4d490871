"""Plays all other participants of a run for one candidate, over real topics, in lock-step, from a bag.

It publishes every input of the role as recorded, has a listener on each output for each participant that would
listen, says that they are ready, and goes on to the next period when the candidate has answered.
"""

import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import rclpy
from rclpy.context import Context
from rclpy.experimental import EventsExecutor
from rclpy.qos import QoSProfile

from sojourn_bags.candidate import Candidate
from sojourn_bags.comparison import stamps_of
from sojourn_bags.completeness import OUTSIDE_THE_RECORD
from sojourn_bags.errors import UnansweredError
from sojourn_bags.messages import Messages
from sojourn_bags.replay_answers import Answers
from sojourn_bags.replay_choices import DEFAULT_TIMEOUT_S
from sojourn_bags.replay_script import HEARTBEATS, ReplayPeriod, Script
from sojourn_bags.role_beats import beats_of
from sojourn_contract import qos, stamps
from sojourn_contract.closed_node import ClosedNode
from sojourn_contract.codecs import encode
from sojourn_contract.conformance.endpoints import Endpoint, endpoint_findings
from sojourn_contract.conformance.findings import value_text
from sojourn_contract.decoding import stamp_of
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.heartbeat import READY, Counters, heartbeat_message
from sojourn_contract.topic_types import Topic
from sojourn_contract.topics import topic
from sojourn_contract.types import message_class
from sojourn_contract.values import Header

GRACE_S = 0.25
"""Wall time without a message after which a topic that is missing may lag by a period more."""
POLL_S = 0.02
"""Wall time between two looks at the candidate's process."""
READY_REPEAT_S = 0.2
DRAIN_S = 2.0
"""Wall time without a message after which what is still missing at the end is not waited for."""
ACKNOWLEDGE_S = 5.0
RECORDER_TICK = "/recorder/tick"


class Listener(Protocol):
    """Gets all that is said in a replay, in the order in which it is said."""

    def sent(self, step: ReplayPeriod) -> None:
        """All messages of a period, just before they are sent."""

    def heard(self, row: Topic, stamp: int, data: bytes) -> None:
        """A message of the candidate, also from before the run: row, stamp [ns], CDR."""


@dataclass(frozen=True, slots=True)
class ReplaySettings:
    """Where a replay takes place, and how long it waits.

    Args:
        domain, namespace: where candidate and harness meet; nobody else may be there.
        timeout_s: wall time after which a missing answer is an error.
        ready_timeout_s: wall time within which the candidate must be ready.
    """

    domain: int
    namespace: str = ""
    timeout_s: float = DEFAULT_TIMEOUT_S
    ready_timeout_s: float = 60.0


class ReplayHarness:
    """One replay. A context manager; nothing is left behind.

    Args:
        script: what to play. settings: where, and how long to wait. listener: gets all that is said.
    """

    def __init__(self, script: Script, settings: ReplaySettings, listener: Listener | None = None) -> None:
        self.script = script
        self.namespace = settings.namespace
        self._domain = settings.domain
        self._timeout_s, self._ready_timeout_s = settings.timeout_s, settings.ready_timeout_s
        self._listener = listener
        self.answers = Answers(script.due, script.lead, script.table)
        self._heartbeats = Answers({}, 0)
        self._ready_state, self._ready_detail = "", ""
        self._candidate: Candidate | None = None
        self._polled_at = self._said_ready_at = 0.0

    def __enter__(self) -> "ReplayHarness":
        self.context = Context()
        rclpy.init(args=[], context=self.context, domain_id=self._domain)
        self._executor = EventsExecutor(context=self.context)
        self._node = self._make_node("participants")
        self._others = self._make_node("listeners")
        """Never spun: its subscriptions are only counted by the candidate."""
        self._executor.add_node(self._node)
        self._senders = {row.name: self._sender(row) for row in self.script.inputs}
        self._outputs = [row for row in self.script.table.outputs_of(self.script.role) if not row.on_demand]
        for row in self._outputs:
            self._listen(row)
        return self

    def __exit__(self, *_error: object) -> None:
        try:
            if self._candidate is not None:
                self._candidate.stop()
        finally:
            self._executor.remove_node(self._node)
            self._executor.shutdown()
            self._node.destroy_node()
            self._others.destroy_node()
            rclpy.try_shutdown(context=self.context)

    def run(self, candidate: Candidate, parameters: Mapping[str, Any]) -> dict[str, Messages]:
        """Replay all of the script. Returns everything that the candidate has said during the run, by topic.

        Args:
            candidate: not started yet. parameters: ROS parameters of its node.

        Raises:
            UnansweredError: it was never ready, does not answer any more, or has ended.
        """
        self._candidate = candidate
        candidate.start(self.context, self._executor, parameters)
        self._get_ready()
        for step in self.script.steps:
            self._play(step)
            self._wait_for_answers(step.period)
        self._drain()
        return self.answers.messages() | self._heartbeats.messages()

    # Before the run

    def _get_ready(self) -> None:
        """Until candidate and harness have found each other and it says that it is ready, or (the plant) begins."""
        begun = time.monotonic()
        while not self._is_ready():
            self._spin(POLL_S)
            waited = time.monotonic() - begun
            self._say_ready()
            if ended := self._ended():
                raise UnansweredError(f"{self.script.role} {ended} (it was not ready yet)")
            if unfit := self._unfit():
                raise UnansweredError(f"{self.script.role} cannot take part: {unfit}")
            if waited > self._ready_timeout_s:
                raise UnansweredError(
                    f"{self.script.role} is not ready after {waited:.0f} s of wall time: {self._why_not_ready()}"
                )

    def _is_ready(self) -> bool:
        if self.script.role == "plant":
            return self.answers.newest > 0
        return self._ready_state == READY and not self._unheard()

    def _say_ready(self) -> None:
        """The plant waits for everybody's word; the harness speaks for all."""
        if self.script.role != "plant" or time.monotonic() - self._said_ready_at < READY_REPEAT_S:
            return
        self._said_ready_at = time.monotonic()
        for role in self.script.participants:
            if role != self.script.role:
                said = heartbeat_message(role, READY, 0, Counters())
                self._senders[HEARTBEATS].publish(encode(topic(HEARTBEATS), said))

    def _unheard(self) -> list[str]:
        """Inputs that the candidate must listen to and does not. The clock is there for whoever wants it."""
        return [
            row.name
            for row in self.script.inputs
            if row.needs_listener
            and row.name != "/clock"
            and self._senders[row.name].get_subscription_count() <= (row.name == HEARTBEATS)
        ]

    def _why_not_ready(self) -> str:
        """The first reason that can be seen from outside."""
        for row in self._outputs:
            if not self._offers(row):
                return f"it does not publish {row.name}"
        if unheard := self._unheard():
            return f"it does not listen to {unheard[0]}"
        if not self._ready_state:
            return f"no heartbeat of {self.script.role} with stamp zero has come on {HEARTBEATS}"
        detail = f" ({self._ready_detail})" if self._ready_detail else ""
        return f"its heartbeat says {self._ready_state!r}{detail}"

    def _unfit(self) -> str:
        """An endpoint of the candidate that never meets the others' endpoints, in words; "" without one."""
        for row in (*self._outputs, *self.script.inputs):
            for endpoint in self._endpoints(row):
                for found in endpoint_findings(row, endpoint, True):
                    why = "it never reaches the listeners" if endpoint.publishes else "it never hears the publishers"
                    return f"{row.name}: {found.field} = {value_text(found)}: {why} of the contract"
        return ""

    def _offers(self, row: Topic) -> bool:
        """Whether the candidate publishes a topic."""
        return any(endpoint.publishes for endpoint in self._endpoints(row))

    def _endpoints(self, row: Topic) -> Iterator[Endpoint]:
        """The candidate's endpoints of a topic: those that are not the harness's own."""
        name = self._node.resolve_topic_name(row.name.lstrip("/"))
        own = (self._node.get_name(), self._others.get_name())
        for infos, publishes in (
            (self._node.get_publishers_info_by_topic(name), True),
            (self._node.get_subscriptions_info_by_topic(name), False),
        ):
            yield from (Endpoint.of_graph(info, publishes) for info in infos if info.node_name not in own)

    # During the run

    def _play(self, step: ReplayPeriod) -> None:
        """Send all of a period: goals first. The candidate waits for those that a tick announces; others must arrive
        before the rest, which the middleware confirms only after seconds.
        """
        if self._listener is not None:
            self._listener.sent(step)
        for name, data in step.goals:
            self._senders[name].publish(data)
        for name in step.unannounced:
            self._senders[name].wait_for_all_acked(rclpy.duration.Duration(seconds=ACKNOWLEDGE_S))
        for name, data in step.inputs:
            self._senders[name].publish(data)
        if RECORDER_TICK in self._senders and step.period % topic(RECORDER_TICK).every == 0:
            tick = Header(step.period * stamps.CONTROL_PERIOD_NS)
            self._senders[RECORDER_TICK].publish(encode(topic(RECORDER_TICK), tick))

    def _wait_for_answers(self, period: int) -> None:
        begun, idle_s = time.monotonic(), 0.0
        newest = self.answers.newest
        while missing := self.answers.missing(period):
            before = time.monotonic()
            self._spin(POLL_S)
            now = time.monotonic()
            if self.answers.newest > newest:
                newest, begun = self.answers.newest, now
            # An answer may stand in the queue behind others: what counts is time in which nothing came at all.
            idle_s += POLL_S if now - before > 0.9 * POLL_S else 0.0
            if idle_s < GRACE_S:
                continue
            if ended := self._ended():
                raise UnansweredError(f"{self.script.role} {ended} (it had not answered {_named(missing[0])})")
            idle_s = 0.0
            if not self.answers.be_patient(period) and now - begun > self._timeout_s:
                waited = f"{self._timeout_s:g} s of wall time"
                raise UnansweredError(
                    f"{self.script.role} does not answer: {_named(missing[0])} is missing after {waited}"
                )

    def _drain(self) -> None:
        """Take what is still on its way, until all is there or nothing has come for a while."""
        beats = self.script.recorded.get(HEARTBEATS)
        last_beat = stamps_of(beats)[-1] if beats else 0
        count, quiet_since = -1, time.monotonic()
        while self.answers.unsettled() or self._heartbeats.newest < last_beat:
            self._spin(POLL_S)
            now = time.monotonic()
            if self.answers.count + self._heartbeats.count != count:
                count, quiet_since = self.answers.count + self._heartbeats.count, now
            if now - quiet_since > DRAIN_S:
                break
        self._spin(POLL_S)

    def _ended(self) -> str:
        return self._candidate.how_it_ended() if self._candidate is not None else ""

    # Endpoints

    def _make_node(self, name: str) -> ClosedNode:
        return ClosedNode(name, context=self.context, namespace=self.namespace)

    def _sender(self, row: Topic) -> Any:
        return self._node.create_publisher(message_class(row.type), self.input_name(row), qos.profile(row, True))

    def input_name(self, row: Topic) -> str:
        """Name under which the candidate hears a topic, relative to the namespace."""
        return row.name.lstrip("/")

    def _listen(self, row: Topic) -> None:
        """One subscription that takes the messages, and as many more as participants would listen."""
        listeners = [role for role in row.subscribers if role in self.script.participants]
        listeners += ["recorder"] if row.logged and "recorder" in self.script.participants else []
        listeners = [role for role in listeners if role != self.script.role or row.publisher == "all"]
        kind, name = message_class(row.type), row.name.lstrip("/")
        self._node.create_subscription(
            kind, name, lambda data: self._take(row, data), qos.profile(row, True, "recorder"), raw=True
        )
        wanted = qos.profile(row, True)
        silent = QoSProfile(history=wanted.history, depth=1, reliability=wanted.reliability)
        for _ in listeners[1:]:
            self._others.create_subscription(kind, name, _ignore, silent, raw=True)

    def _take(self, row: Topic, data: bytes) -> None:
        try:
            stamp = stamp_of(row.name, data)
            if row.name == HEARTBEATS:
                self._take_heartbeat(row, stamp, data)
                return
        except RefusedMessageError as refusal:  # as any node would do
            self._node.get_logger().warning(f"refused: {refusal}", throttle_duration_sec=1.0)
            return
        if self._listener is not None:
            self._listener.heard(row, stamp, data)
        self.answers.take(row.name, stamp, data)

    def _take_heartbeat(self, row: Topic, stamp: int, data: bytes) -> None:
        """Of the candidate only: the harness hears its own, too."""
        beats = beats_of(self.script.role, row, data)
        if not beats:
            return
        if self._listener is not None:
            self._listener.heard(row, stamp, data)
        if stamp == 0:
            self._ready_state, self._ready_detail = beats[0].state, beats[0].detail
        elif beats[0].state not in OUTSIDE_THE_RECORD:
            self._heartbeats.take(row.name, stamp, data)

    def _spin(self, seconds: float) -> None:
        """Take what comes, at most for so long, and look after the candidate."""
        self._executor.spin_once(timeout_sec=seconds)
        now = time.monotonic()
        if self._candidate is not None and now - self._polled_at > POLL_S:
            self._polled_at = now
            self._candidate.poll()


def _named(answer: tuple[str, int]) -> str:
    name, stamp = answer
    return f"{name} stamped {stamps.seconds(stamp):.2f} s"


def _ignore(_data: bytes) -> None:
    """For a subscription that is only counted."""
