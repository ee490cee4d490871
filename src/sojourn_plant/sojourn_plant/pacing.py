"""Node that owns /clock: it begins the run, keeps its pace, and ends it where somebody is silent.

The start: it waits until all participants say that they are ready, then publishes the first period. In lock-step it
acts on a period when all that is due for it has come; in real time by the wall clock.
"""

import math
import time
from collections.abc import Iterable, Mapping
from typing import Any

from rclpy.context import Context

from sojourn_contract import stamps
from sojourn_contract.errors import DomainInUseError, SilentNodeError
from sojourn_contract.heartbeat import read_heartbeats
from sojourn_contract.node import ContractNode
from sojourn_contract.topic_types import Topic
from sojourn_plant.roster import Roster

DISCOVERY_S = 0.5
"""Wall time after its creation before which a plant does not begin: another one on its domain may not be
seen yet.
"""
AHEAD_S = 1.0
"""In real time a command stamped further ahead of the plant's own clock than this is refused: it would
never age.
"""
FREE_RUN_S = 0.02
"""Wall time for which a plant that nobody answers runs between two looks at its messages."""


class PacingNode(ContractNode):
    """A role whose periods are those of everybody; what it publishes in them is its heirs' affair."""

    def __init__(
        self,
        role: str,
        *,
        context: Context | None = None,
        overrides: Mapping[str, Any] | None = None,
        namespace: str | None = None,
    ) -> None:
        self._created = time.monotonic()
        super().__init__(role, context=context, overrides=overrides, namespace=namespace, every_period=True)
        self.ends_the_run = True
        self._trigger = ""  # in real time it acts by the wall clock, whatever comes
        self.roster = Roster(role, self.participants, self.timeout_s)
        self._begun = False
        self._waiting_since = math.inf
        """Wall time since which the others are waited for: from the first look at them, as plants take long to make."""
        self._timer: Any = None

    def first_messages(self, stamp: int) -> Iterable[tuple[str, Any]]:
        """What begins the run, as (topic, message) with this stamp [ns]."""
        raise NotImplementedError

    def on_heartbeat(self, message: Any) -> None:
        """Keep who is ready, and who says that it waits for whom."""
        self.roster.hear(read_heartbeats(message))

    def poll(self) -> None:
        """Begin the run when everybody is ready; say who is silent when somebody is."""
        super().poll()
        if self.finished:
            return
        if not self._begun:
            self._begin_when_ready()
        elif self.lockstep and not self._awaited:
            until = time.monotonic() + FREE_RUN_S
            while time.monotonic() < until:
                self.act(self.now + stamps.CONTROL_PERIOD_NS, {})
        elif self.lockstep and time.monotonic() - self._waiting_since > self.timeout_s:
            self._stop_for_silence()

    def act(self, stamp: int, inputs: Mapping[str, Any]) -> None:
        """Run one period, and wait anew."""
        self._waiting_since = time.monotonic()
        super().act(stamp, inputs)

    def publish_all(self, messages: Iterable[tuple[str, Any]]) -> None:
        """Publish those of (topic, message) that this run has."""
        for topic, message in messages:
            if self.gives(topic):
                self.publish(topic, message)

    def _begin_when_ready(self) -> None:
        if self.count_publishers(self._senders["/clock"].topic_name) > 1:
            self._fail(DomainInUseError(str(self.context.get_domain_id()), self._senders["/clock"].topic_name))
            return
        self._waiting_since = min(self._waiting_since, time.monotonic())
        waited = time.monotonic() - self._waiting_since
        unmatched = self.unmatched()
        if unmatched or self.roster.missing():
            if waited > 3 * self.timeout_s:
                self._fail(self.roster.not_ready(unmatched, waited))
            return
        if time.monotonic() - self._created < DISCOVERY_S:
            return
        self._begun = True
        self._waiting_since = self._last_progress = time.monotonic()
        self.publish_all(self.first_messages(stamps.CONTROL_PERIOD_NS))
        if not self.lockstep:
            self._timer = self.create_timer(stamps.CONTROL_PERIOD_S, self._act_in_real_time)
        self._advance()  # where nobody answers in the first period, no message would begin the run

    def _act_in_real_time(self) -> None:
        stamp = self.now + stamps.CONTROL_PERIOD_NS
        self.act(stamp, self._inputs_realtime(stamp))

    def _stop_for_silence(self) -> None:
        """Name the node at the root: the one that is missing and does not say that it waits for another."""
        row = self.barrier.missing()[0]
        role = self.roster.root_of_silence(row.publisher)
        self._fail(SilentNodeError(role, row.name, stamps.seconds(self.barrier.stamp), self.timeout_s))

    def _refusal_realtime(self, row: Topic, stamp: int) -> str | None:
        latest = self.now + int(AHEAD_S * stamps.NANOSECONDS)
        if stamp > latest:
            return f"simulation time, {stamps.seconds(latest):.3f} s at most"
        return super()._refusal_realtime(row, stamp)

    def _advance(self) -> None:
        if self._begun:
            super()._advance()

    def _fail(self, error: Exception) -> None:
        self.get_logger().error(str(error))
        self.exit_status = 1
        self.finished = True
        self.failure = str(error)
