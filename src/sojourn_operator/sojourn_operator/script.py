"""The scripted operator: carries out the steps of a scenario one after another. No ROS in here, and no clock.

At each look it is given the simulation time and what drive and arm report; it answers with the goal to send, if any.
What is sent and when a step is over are the words of its kind (`steps`); the first step that fails ends the script.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace

from sojourn_contract.stamps import NANOSECONDS
from sojourn_contract.values import Message, Odometry
from sojourn_operator.steps.step import FINAL_STATES, GOOD_OUTCOMES, GoalReport, OperatorStep, RunFacts, View

TIMED_OUT = "timed out"
AT_REST = ("idle", *FINAL_STATES)
"""States of a drive or an arm that has nothing to do."""


@dataclass(frozen=True)
class GoalToSend:
    """A goal to send, and its topic."""

    topic: str
    message: Message


@dataclass(frozen=True)
class StepResult:
    """What became of a step. Times are simulation time [s]."""

    step: str
    outcome: str
    reason: str
    start_s: float
    end_s: float

    @property
    def good(self) -> bool:
        """Whether the step did what it was to do."""
        return self.outcome in GOOD_OUTCOMES


@dataclass(frozen=True)
class ScriptState:
    """How far it is."""

    results: tuple[StepResult, ...] = ()
    """Of the steps that are over."""
    since: int | None = None
    """When the present step began [ns]; None between two steps."""
    finished: bool = False


@dataclass(frozen=True)
class OperatorScript:
    """Carries out steps in order.

    Args:
        steps: what to do, each with its own limit [s] (None: only that of the run).
        limit_s: duration of the run after which the script ends, done or not [s].
        around: what the steps may look at.
    """

    steps: Sequence[tuple[OperatorStep, float | None]]
    limit_s: float
    around: RunFacts = field(default_factory=RunFacts)

    def begin(self, done: Sequence[StepResult] = ()) -> ScriptState:
        """At the start; `done`: results of steps that an earlier operator of this run has finished."""
        return ScriptState(tuple(done), finished=any(not result.good for result in done))

    def has_succeeded(self, state: ScriptState) -> bool:
        """Whether every step has been carried out."""
        return len(state.results) == len(self.steps) and all(result.good for result in state.results)

    def position(self, state: ScriptState) -> str:
        """Where in the script it is, in words."""
        if state.finished or len(state.results) >= len(self.steps):
            return "ended"
        index = len(state.results)
        return f"step {index + 1} of {len(self.steps)}: {self.steps[index][0].describe()}"

    def look(
        self, state: ScriptState, now: int, reports: Mapping[str, GoalReport], truth: Odometry | None = None
    ) -> tuple[ScriptState, GoalToSend | None]:
        """Look at the machine at simulation time `now` [ns]; the goal to send now, if any.

        Args:
            reports: latest report of "drive" and "arm", where there is one. truth: where the machine is, as
                far as it is known.
        """
        if state.finished:
            return state, None
        view = View(now if state.since is None else state.since, now, reports, self.around, truth)
        if state.since is not None:
            outcome = self._judge(state, view)
            if outcome is None:
                return state, self._said(state, view)
            state = self._record(state, now, *outcome)
        if state.finished or len(state.results) == len(self.steps):
            return replace(state, finished=True), None
        if now >= self.limit_s * NANOSECONDS:
            return self._record(state, now, TIMED_OUT, self._limit_text()), None
        if truth is None and self.steps[len(state.results)][0].looks_at_ground:
            return state, None  # begins once it is known where the machine stands
        return replace(state, since=now), self._said(state, replace(view, since=now))

    def rests_until(self, state: ScriptState, now: int, reports: Mapping[str, GoalReport]) -> int:
        """Whole second of simulation time until which nothing is on its way and nothing will be sent; 0 where that
        cannot be told. Arguments as of `look`, after it.
        """
        if state.finished or state.since is None or any(one.state not in AT_REST for one in reports.values()):
            return 0
        step, limit = self.steps[len(state.results)]
        until = step.rests_until(View(state.since, now, reports, self.around))
        if until is None:
            return 0
        ends = [until / NANOSECONDS, self.limit_s, *([] if limit is None else [state.since / NANOSECONDS + limit])]
        return math.floor(min(ends))

    def _said(self, state: ScriptState, view: View) -> GoalToSend | None:
        """What the present step says."""
        step = self.steps[len(state.results)][0]
        message = step.say(view)
        return None if message is None else GoalToSend(step.topic, message)

    def _judge(self, state: ScriptState, view: View) -> tuple[str, str] | None:
        """Outcome and reason of the present step, or None while it goes on."""
        step, limit = self.steps[len(state.results)]
        outcome = step.end(view)
        if outcome is not None:
            return outcome
        if view.now >= self.limit_s * NANOSECONDS:
            return TIMED_OUT, self._limit_text()
        return (TIMED_OUT, f"not done within {limit:g} s") if limit is not None and view.is_over(limit) else None

    def _limit_text(self) -> str:
        return f"the run's limit of {self.limit_s:g} s is over"

    def _record(self, state: ScriptState, now: int, outcome: str, reason: str) -> ScriptState:
        step = self.steps[len(state.results)][0].describe()
        start = now if state.since is None else state.since
        result = StepResult(step, outcome, reason, start / NANOSECONDS, now / NANOSECONDS)
        return ScriptState((*state.results, result), None, finished=not result.good)


def results_as_data(results: Sequence[StepResult]) -> list[dict[str, object]]:
    """Results as plain data, for JSON."""
    return [asdict(result) for result in results]


def results_from_data(data: Sequence[Mapping[str, object]]) -> list[StepResult]:
    """The reverse of `results_as_data`."""
    return [
        StepResult(
            step=str(entry["step"]),
            outcome=str(entry["outcome"]),
            reason=str(entry["reason"]),
            start_s=float(str(entry["start_s"])),
            end_s=float(str(entry["end_s"])),
        )
        for entry in data
    ]
