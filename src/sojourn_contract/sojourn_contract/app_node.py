"""The shell round an app: gives it the messages of a period, and sends what it answers. No memory of its own."""

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, ClassVar

from rclpy.context import Context

from sojourn_config.known_machine import KnownMachine
from sojourn_contract.app import App, Period
from sojourn_contract.barrier import stamp_due
from sojourn_contract.checkpoint_topic import RESUMED
from sojourn_contract.disturbed_app import disturbed
from sojourn_contract.handing_over import HandingBack, HandingOver
from sojourn_contract.kept_data import Kept, KeptData, KeptDataError
from sojourn_contract.kept_goal import newly_kept
from sojourn_contract.node import ContractNode
from sojourn_contract.role_state import RoleAtCheckpoint, RoleState
from sojourn_contract.stamps import CONTROL_PERIOD_NS
from sojourn_contract.topic_types import Topic
from sojourn_contract.words import Words, lasting

CLOCK_OWNER = "plant"
"""The role with whose words a run goes on."""


class AppNode(ContractNode):
    """A node that runs the app of its role.

    ROS parameters, besides those of every node: `kept` (file of what its app must not lose, empty for none), `restarts`
    (how often its role has been started again), `checkpoint_every_s` (simulation time from one checkpoint of the run to
    the next [s], 0 for none; the plant asks for them), `resumed_at` (stamp of the state from which the run goes on
    [ns], 0 for its start; the state comes by a topic, see `handing_over`).

    Args:
        context: rclpy context. overrides: parameter values, as the composed start gives them.
        namespace: ROS namespace, None for the one given on the command line.
        every_period: act at every period (the plant).
    """

    app_class: ClassVar[type[App[Any]]]
    """Made of the scenario that the node's parameters name."""

    def __init__(
        self,
        *,
        context: Context | None = None,
        overrides: Mapping[str, Any] | None = None,
        namespace: str | None = None,
        every_period: bool = False,
    ) -> None:
        kind = self.app_class
        super().__init__(
            kind.role,
            context=context,
            overrides=overrides,
            namespace=namespace,
            every_period=every_period,
        )
        self.acts_in_silence = kind.acts_in_silence
        self.app: App[Any] = disturbed(kind(self.scenario), self.table, self.scenario.disturbances)
        self.app.warm_up()
        self.state = self.app.initial_state()
        kept = self.declare_parameter("kept", "").value
        self._kept = KeptData(Path(kept)) if kept else None
        self._kept_last: Kept | None = None
        self._starts_again = int(self.declare_parameter("restarts", 0).value) > 0
        self.checkpoint_every_s = float(self.declare_parameter("checkpoint_every_s", 0.0).value)
        self.handing_over: HandingOver | None = None
        if self.checkpoint_every_s:
            self.words = Words(lasting(self.participants, self.table))
            self.handing_over = None if self.role == CLOCK_OWNER else HandingOver(self)
        self.resumed_at = int(self.declare_parameter("resumed_at", 0).value)
        self._handing_back = HandingBack(self, self.resumed_at) if self.resumed_at else None

    def read_scenario(self, name: str, overrides: Sequence[str]) -> KnownMachine:
        """What its app goes by."""
        return self.app_class.read(name, overrides)

    def check(self, row: Topic, message: Any) -> None:
        """The contract's checks, then the app's own."""
        super().check(row, message)
        self.app.check(row, message)

    def poll(self) -> None:
        """Wall-clock chores, and a state that is handed over or back."""
        if self._handing_back is not None:
            self._handing_back.look()
        if self.handing_over is not None:
            self.handing_over.look()
        super().poll()

    def unmatched(self) -> list[str]:
        """What is not connected yet, and a state that has not come."""
        waits = self._handing_back is not None and not self._handing_back.is_here
        return ["the state from which it goes on has not come", *super().unmatched()] if waits else super().unmatched()

    def role_state(self) -> RoleState:
        """At the end of the period on which it has acted."""
        counts = self.counters
        published, refused = dict(counts.published), dict(counts.refused)
        return RoleState(self.state, self.events, published, refused, counts.last_refusal, self.now, self.hearing.took)

    def go_on(self, begin: RoleAtCheckpoint) -> None:
        """Stand where its role stood, before the node acts for the first time."""
        one = begin.role
        self.state, self.events = one.app, one.goals
        self.counters = one.counters
        self.hearing.took, self.goes_on_from = one.took, one.now
        self.barrier.go_on(one.now // CONTROL_PERIOD_NS, begin.leaps)
        now = begin.leaps.before(begin.period) * CONTROL_PERIOD_NS
        for row in self.awaited:
            oldest = 0 if row.delivery is not None else stamp_due(row, self.barrier.period, begin.leaps)
            for stamp, (message, refusal) in begin.messages.get(row.name, {}).items():
                is_said_again = row.publisher == CLOCK_OWNER and stamp > now
                if stamp >= oldest and not is_said_again:
                    self.barrier.offer(row, stamp, None if refusal else message)
        if self.words is not None:
            rows = {row.name: row for row in (*self.awaited, *self.endpoints.outputs.values())}
            known = {name: each for name, each in begin.messages.items() if name in rows and self._keeps(rows[name])}
            ahead = () if self.role == CLOCK_OWNER else begin.ahead  # it says them again
            self.words = Words(
                lasting(self.participants, self.table), known, [(rows[name], each) for name, each in ahead], begin.leaps
            )

    def _keeps(self, row: Topic) -> bool:
        """Whether its words have a row: what it says itself, or hears of a node that may keep nothing."""
        return row.publisher == self.role or row.publisher not in self.companions

    def on_period(self, stamp: int, inputs: Mapping[str, Any], goals: list[tuple[str, Any]]) -> None:
        """One step of the app."""
        if self._starts_again:
            self._starts_again = False
            self.state = self.app.started_again(self.state, stamp, self._read_kept())
        period = Period(stamp, inputs, goals, self.counters.last_refusal, self.endpoints.wanted)
        self.state, answer = self.app.step(self.state, period)
        for topic, reason in answer.refusals:
            self.refuse(topic, reason)
        for text in answer.errors:
            self.get_logger().error(f"{text} at {stamp / 1e9:.2f} s")
        self.finished = self.finished or answer.finished
        if answer.landing:
            self.barrier.leap(*(each // CONTROL_PERIOD_NS for each in (stamp, answer.landing)))
        if self.words is not None:
            self.words.leaps = self.barrier.leaps
        self.publish_all(answer.messages)
        if self.words is not None:
            self.words.end(stamp)
        if self._kept is not None:
            self._keep(stamp)

    def publish_all(self, messages: Iterable[tuple[str, Any]]) -> None:
        """Publish those of (topic, message) that this run has."""
        for topic, message in messages:
            if self.gives(topic):
                self.publish(topic, message)

    def _read_kept(self) -> Kept | None:
        try:
            return None if self._kept is None else self._kept.read()
        except KeptDataError as error:
            self.get_logger().error(str(error))
            return None

    def _keep(self, stamp: int) -> None:
        """Keep what the app must not lose."""
        assert self._kept is not None
        kept = newly_kept(self._kept_last, stamp, lambda: self.app.to_keep(self.state))
        if kept is None:
            return
        self._kept_last = kept
        try:
            self._kept.write(kept.stamp, kept.values)
        except OSError as error:
            self.get_logger().error(f"nothing can be kept: {error}", throttle_duration_sec=10.0)

    def on_new_time(self) -> None:
        """The clock was wrong."""
        self.state = self.app.on_new_time(self.state)

    def heartbeat_values(self) -> dict[str, str]:
        """What the app tells of itself; before a run that goes on, also whether its state is here."""
        values = self.app.heartbeat_values(self.state, self.now)
        is_here = self._handing_back is not None and self._handing_back.is_here
        return {**values, RESUMED: str(self.resumed_at)} if is_here and not self.now else values
