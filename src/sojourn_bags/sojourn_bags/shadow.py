"""Runs a candidate beside a running stack: it hears what our node hears, and what it says is compared, not acted upon.

The candidate lives in the namespace `shadow` below that of the stack, so its outputs are /shadow/odom and so on. Its
inputs are given on to it period by period, at the pace at which it answers, as /shadow/to_drive/joint_states and so on;
the stack does not wait for it.
"""

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from sojourn_bags.candidate import Candidate
from sojourn_bags.comparison import compare, stamps_of
from sojourn_bags.comparison_result import Comparison, Divergence
from sojourn_bags.definitions import typestore
from sojourn_bags.errors import UnansweredError
from sojourn_bags.messages import Messages
from sojourn_bags.replay_harness import DRAIN_S, POLL_S, ReplayHarness, ReplaySettings
from sojourn_bags.replay_script import CLOCK, HEARTBEATS, ReplayPeriod
from sojourn_bags.shadow_tap import Tap
from sojourn_contract.closed_node import ClosedNode
from sojourn_contract.stamps import CONTROL_PERIOD_NS
from sojourn_contract.topic_table import TopicTable
from sojourn_contract.topic_types import Topic

NAMESPACE = "/shadow"
LOOK_S = 0.25
"""Wall time between two comparisons while the run goes on."""
ON_THE_WAY = 50
"""Periods of the newest answers that a look leaves out."""
CATCH_UP_S = 20.0
"""Wall time that the candidate has after the end of the run, for what it has not answered yet."""
_FOR_EVER = 1 << 62


@dataclass
class LiveScript:
    """What the harness plays: it is not known beforehand, and has no end.

    Args:
        role: whom the candidate stands in for. participants, table: of the run. inputs: rows that it hears.
    """

    role: str
    participants: tuple[str, ...]
    table: TopicTable
    inputs: tuple[Topic, ...]
    lead: int = 0
    recorded: Mapping[str, Messages] = field(default_factory=dict)
    steps: tuple[ReplayPeriod, ...] = ()

    @property
    def due(self) -> dict[str, range]:
        """Stamps [ns] at which an answer is due, by topic."""
        periods = {
            row.name: row.every * CONTROL_PERIOD_NS
            for row in self.table.outputs_of(self.role, self.participants)
            if row.name != HEARTBEATS
        }
        return {name: range(period, _FOR_EVER, period) for name, period in periods.items()}


@dataclass(frozen=True)
class ShadowState:
    """The state of things while the run goes on.

    Args:
        stamp: up to which answers are compared [ns]. behind: periods that the candidate has not answered yet.
        divergence: the first beyond the contract's tolerance, None where there is none so far.
    """

    stamp: int
    behind: int
    divergence: Divergence | None


class Shadow(ReplayHarness):
    """One candidate beside one node. A context manager; nothing is left behind.

    Args:
        role: whom it shadows. participants, table: of the run. lockstep: mode of time. settings: of the stack.
    """

    def __init__(
        self, role: str, participants: Sequence[str], table: TopicTable, lockstep: bool, settings: ReplaySettings
    ) -> None:
        heard = (row for row in table.inputs_of(role, participants) if row.publisher in participants)
        script = LiveScript(role, tuple(participants), table, tuple(dict.fromkeys((table.topic(CLOCK), *heard))))
        super().__init__(script, replace(settings, namespace=settings.namespace + NAMESPACE))
        self._lockstep, self._stack = lockstep, settings.namespace
        self._divergence: Divergence | None = None
        self._compared = 0
        """Latest stamp that has been looked at [ns]."""

    def __enter__(self) -> "Shadow":
        super().__enter__()
        self._tap_node = ClosedNode(f"shadow_of_{self.script.role}", context=self.context, namespace=self._stack)
        self.tap = Tap(self.script.role, self.script.participants, self.script.table, self._lockstep, self._tap_node)
        self._executor.add_node(self._tap_node)
        return self

    def __exit__(self, *error: object) -> None:
        self._executor.remove_node(self._tap_node)
        super().__exit__(*error)
        self._tap_node.destroy_node()

    def input_name(self, row: Topic) -> str:
        """Apart for each role: of two shadows one may be ahead, and their inputs must not mix."""
        return f"to_{self.script.role}{row.name}"

    def renamed_inputs(self) -> dict[str, str]:
        """Names that the candidate's inputs have here, by those that it knows."""
        return {row.name.lstrip("/"): self.input_name(row) for row in self.script.inputs}

    def begin(self, candidate: Candidate, parameters: Mapping[str, Any]) -> None:
        """Start the candidate and wait until it is ready. Raises UnansweredError if it never is."""
        typestore()  # takes a moment when it is first asked for: now, and not in the run's first second
        self._candidate = candidate
        candidate.start(self.context, self._executor, parameters)
        self._get_ready()

    def follow(self, ended: Callable[[], bool], look: Callable[[ShadowState], None]) -> Comparison:
        """Follow the stack until it has ended, and the candidate after it.

        Args:
            ended: whether the run is over. look: called with the state of things every LOOK_S.

        Returns:
            the comparison of our node's answers with the candidate's.

        Raises:
            UnansweredError: the candidate has ended, or does not answer any more.
        """
        looked_at, over_since = time.monotonic(), 0.0
        while True:
            worked = self._give_on()
            now = time.monotonic()
            if now - looked_at > LOOK_S:
                looked_at = now
                look(self._look())
            if over_since and (not worked or now - over_since > CATCH_UP_S):
                break
            if not over_since and ended():
                over_since = now
                self.tap.close()  # which frees the last periods
        self._catch_up()
        look(self._look())
        return self.comparison()

    def comparison(self) -> Comparison:
        """Of everything up to the last period that the candidate has answered."""
        return compare(self._up_to(self.tap.ours), self._up_to(self.answers.messages()))

    def sides(self) -> tuple[dict[str, Messages], dict[str, Messages]]:
        """What our node and the candidate have said."""
        return dict(self.tap.ours), self.answers.messages()

    def _give_on(self) -> bool:
        """Give the candidate what has come. Whether anything has."""
        step = self.tap.next_step()
        if step is None:
            if ended := self._ended():
                raise UnansweredError(f"{self.script.role} {ended}")
            self._spin(POLL_S)
            self._take_all()
            step = self.tap.next_step()
            if step is None:
                return False
        self._play(step)
        if self._lockstep:
            self._wait_for_answers(step.period)
        self._take_all()
        return True

    def _take_all(self) -> None:
        """Take all that has come. A queue that is not emptied loses what is oldest, waited for or not."""
        before = -1
        while before != self.answers.count + self.tap.heard:
            before = self.answers.count + self.tap.heard
            self._spin(0.0)

    def _catch_up(self) -> None:
        """Wait for the last answers, as long as any come."""
        count, quiet_since = -1, time.monotonic()
        while self.answers.newest < self.tap.newest and time.monotonic() - quiet_since < DRAIN_S and not self._ended():
            self._spin(POLL_S)
            if self.answers.count != count:
                count, quiet_since = self.answers.count, time.monotonic()

    def _look(self) -> ShadowState:
        """Compare what has come since the last look."""
        # what is younger may still be on its way here from one of the two
        horizon = max(0, min(self.answers.newest, self.tap.newest) - ON_THE_WAY * CONTROL_PERIOD_NS)
        if self._divergence is None and horizon > self._compared:
            sides = (self._between(self.tap.ours, horizon), self._between(self.answers.messages(), horizon))
            self._divergence = compare(*sides).divergence(beyond_tolerance=True)
            self._compared = horizon
        behind = max(0, (self.tap.newest - self.answers.newest) // CONTROL_PERIOD_NS)
        return ShadowState(horizon, behind, self._divergence)

    def _between(self, messages: Mapping[str, Messages], horizon: int) -> dict[str, Messages]:
        return _chosen(messages, self._compared + 1, horizon)

    def _up_to(self, messages: Mapping[str, Messages]) -> dict[str, Messages]:
        return _chosen(messages, 0, min(self.answers.newest, self.tap.newest))


def _chosen(messages: Mapping[str, Messages], first: int, last: int) -> dict[str, Messages]:
    """Messages stamped from `first` to `last` [ns], both included; in order of arrival, which is that of the stamps."""
    found = {}
    for name, each in messages.items():
        kept = [index for index, stamp in enumerate(stamps_of(each)) if first <= stamp <= last] if len(each) else []
        times = [each.log_times[index] for index in kept]
        found[name] = Messages(each.topic, each.type, times, [each.data[index] for index in kept])
    return {name: each for name, each in found.items() if len(each)}


__all__ = ["NAMESPACE", "Shadow", "ShadowState"]
