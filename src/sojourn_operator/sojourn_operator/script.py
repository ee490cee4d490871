"""The scripted operator: carries out the steps of a scenario one after another. No ROS in here, and no clock.

At each look it is given the simulation time and what drive and arm report; it answers with the goal to send, if any. A
step is over when the report whose goal_stamp is that of its goal is final; the first step that fails ends the script.
A jog is sent again at each look, and zero from its end on until the arm says that it rests.
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace

from sojourn_contract.stamps import CONTROL_PERIOD_NS, NANOSECONDS
from sojourn_contract.topics import OPERATOR_LAG
from sojourn_operator.actions import TOPICS, Action, ArmJog, Wait, describe

REACHED = "reached"
WAITED = "waited"
JOGGED = "jogged"
TIMED_OUT = "timed out"
FINAL_STATES = (REACHED, "refused", "stopped", "failed")
GOOD_OUTCOMES = (REACHED, WAITED, JOGGED)
LEAD_NS = OPERATOR_LAG * CONTROL_PERIOD_NS
"""A goal takes effect so much after the look that led to it [ns]."""


@dataclass(frozen=True)
class GoalReport:
    """What drive or arm says of its goal.

    Args:
        state: word of the status. goal_stamp: stamp of the goal that it is about [ns], 0 for none. reason: in words.
    """

    state: str
    goal_stamp: int
    reason: str = ""


@dataclass(frozen=True)
class GoalToSend:
    """A goal to send: its topic, its stamp [ns] and what it asks for."""

    topic: str
    stamp: int
    action: Action


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
    """

    steps: Sequence[tuple[Action, float | None]]
    limit_s: float

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
        return f"step {index + 1} of {len(self.steps)}: {describe(self.steps[index][0])}"

    def look(
        self, state: ScriptState, now: int, reports: Mapping[str, GoalReport]
    ) -> tuple[ScriptState, GoalToSend | None]:
        """Look at the machine at simulation time `now` [ns]; the goal to send now, if any.

        Args:
            reports: latest report of "drive" and "arm", where there is one.
        """
        if state.finished:
            return state, None
        if state.since is not None:
            outcome = self._judge(state, now, reports)
            if outcome is None:
                return state, self._kept_up(state.since, now, self.steps[len(state.results)][0])
            state = self._record(state, now, *outcome)
        if state.finished or len(state.results) == len(self.steps):
            return replace(state, finished=True), None
        return self._begin_step(replace(state, since=now), now)

    def _begin_step(self, state: ScriptState, now: int) -> tuple[ScriptState, GoalToSend | None]:
        if now >= self.limit_s * NANOSECONDS:
            return self._record(state, now, TIMED_OUT, self._limit_text()), None
        action = self.steps[len(state.results)][0]
        return state, None if isinstance(action, Wait) else GoalToSend(TOPICS[type(action)][0], now + LEAD_NS, action)

    def _judge(self, state: ScriptState, now: int, reports: Mapping[str, GoalReport]) -> tuple[str, str] | None:
        """Outcome and reason of the present step, or None while it goes on."""
        action, limit = self.steps[len(state.results)]
        since = state.since or 0
        if isinstance(action, Wait):
            if now >= since + round(action.seconds * NANOSECONDS):
                return WAITED, ""
        elif isinstance(action, ArmJog):
            outcome = _judge_jog(action, since, reports.get(TOPICS[ArmJog][1]))
            if outcome is not None:
                return outcome
        else:
            report = reports.get(TOPICS[type(action)][1])
            if report is not None and report.goal_stamp == since + LEAD_NS and report.state in FINAL_STATES:
                return report.state, report.reason
        if now >= self.limit_s * NANOSECONDS:
            return TIMED_OUT, self._limit_text()
        if limit is not None and now >= since + round(limit * NANOSECONDS):
            return TIMED_OUT, f"not done within {limit:g} s"
        return None

    @staticmethod
    def _kept_up(since: int, now: int, action: Action) -> GoalToSend | None:
        """What is sent again while a step goes on."""
        if not isinstance(action, ArmJog):
            return None
        over = now >= since + round(action.seconds * NANOSECONDS)
        return GoalToSend(TOPICS[ArmJog][0], now + LEAD_NS, action.over if over else action)

    def _limit_text(self) -> str:
        return f"the run's limit of {self.limit_s:g} s is over"

    def _record(self, state: ScriptState, now: int, outcome: str, reason: str) -> ScriptState:
        step = describe(self.steps[len(state.results)][0])
        start = now if state.since is None else state.since
        result = StepResult(step, outcome, reason, start / NANOSECONDS, now / NANOSECONDS)
        return ScriptState((*state.results, result), None, finished=not result.good)


def _judge_jog(jog: ArmJog, since: int, report: GoalReport | None) -> tuple[str, str] | None:
    """Outcome and reason of a jog that began at `since` [ns]; None while it goes on. It ends at rest, or refused."""
    if report is None or report.goal_stamp < since + LEAD_NS or report.state not in FINAL_STATES:
        return None
    if report.state != "stopped":
        return report.state, report.reason
    over = report.goal_stamp >= since + round(jog.seconds * NANOSECONDS) + LEAD_NS
    return (JOGGED, report.reason) if over else None


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
