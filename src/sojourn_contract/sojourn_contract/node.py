"""Base of every node: endpoints from the topic table, lock-step or real time, heartbeats, refusals.

A node derives from ContractNode, says its role, and implements `on_period`. In lock-step `on_period` is called at each
stamp at which inputs are due, once they are all in. In real time it is called when the trigger input arrives (the last
of the fastest inputs in the table's order), with the latest message of every other input.
"""

import time
from collections.abc import Mapping
from typing import Any

from rclpy.context import Context
from rclpy.node import Node
from rclpy.parameter import Parameter

from sojourn_contract import qos, stamps
from sojourn_contract.barrier import Barrier, awaited_inputs
from sojourn_contract.checks import check_message
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.events import EventQueue, parse_tick
from sojourn_contract.heartbeat import (
    ENDED,
    READY,
    RUNNING,
    STALLED,
    WAITING_TO_MATCH,
    Counters,
    heartbeat_message,
)
from sojourn_contract.topics import ROLES, Topic, inputs_of, outputs_of
from sojourn_contract.types import message_class

HEARTBEAT_PERIODS = 50
READY_REPEAT_S = 0.2
"""Wall time between heartbeats before the run."""


class ContractNode(Node):  # type: ignore[misc]
    """A node that keeps the contract of one role.

    ROS parameters: `scenario` (name or path), `overrides` (KEY=VALUE texts that go over it), `lockstep` (bool), `participants` (roles that take part in the run),
    `lockstep_timeout_s` (wall time after which a missing answer is an error).

    Args:
        role: row of the process table; also the node's name.
        context: rclpy context. overrides: parameter values, as the composed start gives them.
        namespace: ROS namespace, None for the one given on the command line.
        raw: take messages as serialised bytes (the recorder). every_period: act at every period (the plant).
    """

    def __init__(
        self,
        role: str,
        *,
        context: Context | None = None,
        overrides: Mapping[str, Any] | None = None,
        namespace: str | None = None,
        raw: bool = False,
        every_period: bool = False,
    ) -> None:
        super().__init__(
            role,
            context=context,
            namespace=namespace,
            parameter_overrides=[Parameter(name, value=value) for name, value in (overrides or {}).items()],
            enable_rosout=False,
            start_parameter_services=False,
        )
        self.role = role
        self.scenario_name: str = self.declare_parameter("scenario", "lunar_sample").value
        self.lockstep: bool = self.declare_parameter("lockstep", True).value
        self.participants: tuple[str, ...] = tuple(self.declare_parameter("participants", list(ROLES)).value)
        self.timeout_s: float = self.declare_parameter("lockstep_timeout_s", 10.0).value
        overrides_given = self.declare_parameter("overrides", [""]).value
        self.scenario_overrides = tuple(text for text in overrides_given if text)
        self.counters = Counters()
        self.events = EventQueue()
        self.finished = False
        self.exit_status = 0
        self.ends_the_run = False
        """Whether its process (or the composed run) ends when it has finished: the plant's."""
        self.now = 0
        """Stamp [ns] of the last period acted on; zero before the run."""
        self._awaited = awaited_inputs(role, self.participants)
        self.barrier: Barrier[Any] = Barrier(self._awaited, every_period)
        self._awaited_by_name = {row.name: row for row in self._awaited}
        self._latest: dict[str, Any] = {}
        self._trigger = self._trigger_input()
        self._last_progress = time.monotonic()
        self._last_ready = 0.0
        self._advancing = False
        self._raw = raw
        self._outputs = {row.name: row for row in outputs_of(role)}
        self._senders = {row.name: self._create_output(row) for row in self._outputs.values()}
        self._readers = {row.name: self._create_input(row) for row in self._inputs()}

    # What a node implements or calls

    def on_period(self, stamp: int, inputs: Mapping[str, Any], goals: list[tuple[str, Any]]) -> None:
        """Act on one period.

        Args:
            stamp: simulation time [ns]; every output of the period carries it.
            inputs: messages by topic: those due at this stamp (lock-step) or the latest (real time). The value is None
                where a message came but was refused.
            goals: (topic, message) that take effect now.
        """
        raise NotImplementedError

    def check(self, row: Topic, message: Any) -> None:
        """Refuse a message by raising RefusedMessageError; a node may add checks of its own."""
        check_message(row.name, message)

    def heartbeat_values(self) -> dict[str, str]:
        """What a node adds to its heartbeat; must not depend on wall time in lock-step."""
        return {}

    def publish(self, topic: str, message: Any) -> None:
        """Publish on a topic of the role and count it."""
        self.counters.count_published(topic)
        self._senders[topic].publish(message)

    # What the loop around the node calls

    def poll(self) -> None:
        """Wall-clock chores, called some times a second: readiness before the run, a word when stalled."""
        now = time.monotonic()
        if self.now == 0:
            if now - self._last_ready >= READY_REPEAT_S:
                self._last_ready = now
                missing = self.unmatched()
                state = WAITING_TO_MATCH if missing else READY
                self._send_heartbeat(state, 0, detail="; ".join(missing))
        elif self.lockstep and self._awaited and now - self._last_progress > self.timeout_s / 2:
            self._last_progress = now
            missing_rows = self.barrier.missing()
            if missing_rows:
                row = missing_rows[0]
                detail = f"waiting for {row.name} from {row.publisher}"
                self._send_heartbeat(STALLED, self.now, detail, {"waiting for role": row.publisher})

    def is_drained(self) -> bool:
        """Whether nothing that it must still take is on its way; the recorder waits here."""
        return True

    def close(self) -> None:
        """Say farewell; called once before the node is destroyed."""
        if self.now:
            self._send_heartbeat(ENDED, self.now)

    def unmatched(self) -> list[str]:
        """Endpoints of other participants that are not connected yet, in words."""
        missing = []
        for row in self._awaited:
            if self._readers[row.name].get_publisher_count() == 0:
                missing.append(f"no publisher of {row.name} ({row.publisher})")
        for name, sender in self._senders.items():
            listeners = self._listeners(self._outputs[name])
            if sender.get_subscription_count() < len(listeners):
                missing.append(f"{name} is not heard by all of {', '.join(listeners)}")
        return missing

    # Inside

    def _inputs(self) -> list[Topic]:
        """Rows to subscribe: in lock-step what is awaited, in real time whoever may publish it; goals always."""
        return [
            row
            for row in inputs_of(self.role)
            if row.is_event or row.publisher == "all" or not self.lockstep or row.name in self._awaited_by_name
        ]

    def _listeners(self, row: Topic) -> list[str]:
        roles = [role for role in row.subscribers if role in self.participants]
        if row.logged and "recorder" in self.participants:
            roles.append("recorder")
        return [role for role in roles if role != self.role or row.publisher == "all"]

    def _create_output(self, row: Topic) -> Any:
        return self.create_publisher(
            message_class(row.type), row.name.lstrip("/"), qos.profile(row, self.lockstep, self.role)
        )

    def _create_input(self, row: Topic) -> Any:
        def receive(message: Any) -> None:
            self._receive(row, message)

        return self.create_subscription(
            message_class(row.type), row.name.lstrip("/"), receive, qos.profile(row, self.lockstep, self.role), raw=self._raw
        )

    def _trigger_input(self) -> str:
        if not self._awaited:
            return ""
        fastest = min(row.every for row in self._awaited)
        return [row.name for row in self._awaited if row.every == fastest][-1]

    def _stamp_of(self, row: Topic, message: Any) -> int:
        if self._raw:
            return stamps.from_cdr(message)
        if row.type == "std_msgs/Header":
            return stamps.from_message(message.stamp)
        return stamps.from_message(message.header.stamp)

    def _receive(self, row: Topic, message: Any) -> None:
        """Take one message: refuse it, queue it as a goal, or give it to the barrier."""
        try:
            stamp = self._stamp_of(row, message)
            if row.publisher == "all":
                self.on_heartbeat(message)
            elif row.is_event:
                self._receive_event(row, stamp, message)
            else:
                self._receive_periodic(row, stamp, message)
        except RefusedMessageError as refusal:
            self.refuse(row.name, refusal)

    def on_heartbeat(self, message: Any) -> None:
        """A message on /diagnostics; only the plant and the recorder listen."""

    def refuse(self, topic: str, refusal: Exception) -> None:
        """Count a refused message and log it."""
        self.counters.count_refused(topic, str(refusal))
        self.get_logger().warning(f"refused: {refusal}")

    def _receive_event(self, row: Topic, stamp: int, message: Any) -> None:
        self.events.count(row)
        self.check(row, message)
        self.events.offer(row, stamp, self.now, message)
        self._advance()

    def _receive_periodic(self, row: Topic, stamp: int, message: Any) -> None:
        if not self.lockstep:
            self._receive_realtime(row, stamp, message)
            return
        row = self._awaited_by_name[row.name]
        allowed = self.barrier.refusal(row, stamp)
        if allowed is not None:
            raise RefusedMessageError(row.name, "header.stamp", f"{stamp / 1e9:.3f} s", allowed)
        try:
            self.check(row, message)
        except RefusedMessageError as refusal:
            self.refuse(row.name, refusal)
            message = None
        self.barrier.offer(row, stamp, message)
        self._advance()

    def _receive_realtime(self, row: Topic, stamp: int, message: Any) -> None:
        self.check(row, message)
        self._latest[row.name] = message
        if row.name == self._trigger:
            if stamp <= self.now:
                raise RefusedMessageError(row.name, "header.stamp", f"{stamp / 1e9:.3f} s", f"after {self.now / 1e9:.3f} s")
            self.act(stamp, self._latest)

    def _advance(self) -> None:
        """Act on every period whose inputs are in."""
        if not self.lockstep or self._advancing or not self._awaited:
            return
        self._advancing = True
        try:
            while not self.finished and not self.barrier.missing() and self._goals_are_in():
                stamp = self.barrier.stamp
                self.act(stamp, self.barrier.take())
        finally:
            self._advancing = False

    def _goals_are_in(self) -> bool:
        """Whether all goals that the operator's tick of this period announces have arrived."""
        row = self._awaited_by_name.get("/operator/tick")
        tick = None if row is None else self.barrier.peek(row)
        if tick is None:
            return True
        counts, _ = parse_tick(tick.frame_id)
        known = {name: count for name, count in counts.items() if name in self._readers}
        return self.events.has_received(known)

    def act(self, stamp: int, inputs: Mapping[str, Any]) -> None:
        """Run one period and send the heartbeat when one is due."""
        self._last_progress = time.monotonic()
        previous, self.now = self.now, stamp
        self.on_period(stamp, inputs, self.events.take(stamp))
        beat = HEARTBEAT_PERIODS * stamps.CONTROL_PERIOD_NS
        if stamp // beat != previous // beat:
            self._send_heartbeat(RUNNING, stamp)

    def _send_heartbeat(self, state: str, stamp: int, detail: str = "", extra: dict[str, str] | None = None) -> None:
        values = self.heartbeat_values() | (extra or {})
        if stamp:  # those before the run are as many as the start-up took, and no part of the record
            self.counters.count_published("/diagnostics")
        message = heartbeat_message(self.role, state, stamp, self.counters, detail, values)
        self._senders["/diagnostics"].publish(message)
