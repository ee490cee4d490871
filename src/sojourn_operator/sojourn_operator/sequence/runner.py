"""Carries a sequence out: a state, a step, and the words of an operator. No ROS, and no clock.

    waiting     for the time, the comparisons or the operator that the next step waits for
    running     a step is under way
    ended       all steps are over; aborted: somebody, or a failure, has ended it before
`held` stands beside waiting and running: the step under way goes on, the next one does not begin.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from sojourn_contract.named_fields import FieldValue
from sojourn_contract.stamps import NANOSECONDS, seconds
from sojourn_contract.topic_table import TopicTable
from sojourn_contract.values import Message, Odometry
from sojourn_operator.goal_messages import stop_messages
from sojourn_operator.script import TIMED_OUT, GoalToSend
from sojourn_operator.sequence.condition import Condition, conditions
from sojourn_operator.sequence.file import SequenceConfig
from sojourn_operator.sequence.stream import DROPPED_S, stream_s, why_broken
from sojourn_operator.steps.step import DONE, GOOD_OUTCOMES, STOPPED, GoalReport, OperatorStep, RunFacts, View

WAITING, RUNNING, ENDED, ABORTED = "waiting", "running", "ended", "aborted"
SKIPPED, FAILED = "skipped", "failed"
HOLD, RESUME = WORDS = ("hold", "resume")
"""Of an operator, as they stand in the history."""
SEQUENCE = "sequence"
"""Who acts where no operator does."""
STOPS = {"drive": "/cmd_vel", "arm": "/arm/stop"}


@dataclass(frozen=True)
class Entry:
    """Of the history: when [ns], who, what, and how it came out."""

    stamp: int
    who: str
    what: str
    outcome: str
    reason: str = ""

    def line(self) -> str:
        """As a line."""
        why = f" ({self.reason})" if self.reason else ""
        return f"{seconds(self.stamp):9.2f} s  {self.who}: {self.what}: {self.outcome}{why}"

    def as_data(self) -> dict[str, Any]:
        """For JSON."""
        return {
            "time_s": seconds(self.stamp), "who": self.who, "what": self.what, "outcome": self.outcome,
            "reason": self.reason,
        }  # fmt: skip


@dataclass(frozen=True)
class SequenceState:
    """How far it is.

    Args:
        index: of the step under way, or of the next. phase: see above. held: by whom, "" by nobody.
        since: when the step began, or the one before it ended [ns]; None before the first look.
        released: the step whose `hold` an operator has answered. history: all entries.
        looked: when the step under way was looked at last [ns].
    """

    index: int = 0
    phase: str = WAITING
    held: str = ""
    since: int | None = None
    released: int = -1
    history: tuple[Entry, ...] = ()
    looked: int = 0

    @property
    def is_over(self) -> bool:
        """Whether nothing more happens."""
        return self.phase in (ENDED, ABORTED)


@dataclass(frozen=True)
class SequenceInput:
    """What is known at a look: reports of drive and arm, values of the fields by name, where the machine is."""

    reports: Mapping[str, GoalReport] = field(default_factory=dict)
    values: Mapping[str, FieldValue] = field(default_factory=dict)
    truth: Odometry | None = None


Answer = tuple[SequenceState, list[GoalToSend]]


class SequenceRunner:
    """Of one sequence.

    Args:
        config: it. table: the topics of the run. around: what its steps may look at.
        dropped: age at which drive and arm drop a velocity [s].

    Raises:
        UnknownFieldNameError: a comparison of a field that the run does not have.
    """

    def __init__(
        self, config: SequenceConfig, table: TopicTable, around: RunFacts, dropped: Mapping[str, float] = DROPPED_S
    ) -> None:
        self.config, self.around, self._dropped = config, around, dropped
        self.conditions: list[tuple[Condition, ...]] = [
            () if step.when is None else conditions(step.when, table) for step in config.steps
        ]

    @property
    def topics(self) -> tuple[str, ...]:
        """Whose fields are compared, each once."""
        return tuple(dict.fromkeys(one.field.row.name for each in self.conditions for one in each))

    def values(self, topic: str, message: Message) -> dict[str, FieldValue]:
        """Of the fields that are compared, by name; of several the last."""
        fields = {one.field for each in self.conditions for one in each if one.field.row.name == topic}
        return {one.name: value for one in fields for _, value in one.values(message)}

    def initial_state(self) -> SequenceState:
        """Before the first look."""
        return SequenceState()

    def describe(self, state: SequenceState) -> str:
        """Where it is, in words."""
        if state.is_over:
            return state.phase
        held = f", held by {state.held}" if state.held else ""
        step = self._action(state).describe()
        return f"step {state.index + 1} of {len(self.config.steps)}, {state.phase}{held}: {step}"

    def look(self, state: SequenceState, now: int, heard: SequenceInput) -> Answer:
        """Look at simulation time `now` [ns]; the next state, and what is to be sent."""
        if state.is_over:
            return state, []
        if state.since is None:
            state = replace(state, since=now)
        if state.phase == RUNNING:  # a second look at the time at which a step began would send its goal again
            if now <= _since(state):
                return state, []
            looked, goals = self._look_at_running(state, now, heard)
            return replace(looked, looked=now), goals
        why = self.waits_for(state, now, heard)
        limit = self.config.steps[state.index].within_s
        if why and limit is not None and now - _since(state) >= round(limit * NANOSECONDS) and not state.held:
            return self._over(state, now, (TIMED_OUT, f"could not begin within {limit:g} s: {why}"))
        if why:
            return state, []
        state = replace(state, phase=RUNNING, since=now, looked=now)
        return state, self._said(state, self._view(state, now, heard))

    def waits_for(self, state: SequenceState, now: int, heard: SequenceInput) -> str:
        """Why the next step does not begin, "" where it may."""
        step = self.config.steps[state.index]
        if state.held:
            return f"held by {state.held}"
        if self._asks(state):
            return "an operator's word"
        left = step.after_s - (now - _since(state)) / NANOSECONDS
        if left > 0.0:
            return f"{left:.1f} s more"
        return " and ".join(str(one) for one in self.conditions[state.index] if not one.holds(heard.values))

    def waits_for_person(self, state: SequenceState) -> bool:
        """Whether nothing but an operator's word can let it go on."""
        if state.phase != WAITING:
            return False
        return bool(state.held) or (self._asks(state) and self.config.steps[state.index].within_s is None)

    def streams(self, state: SequenceState) -> bool:
        """Whether a step is under way that has to be looked at as often as can be: it keeps saying a velocity."""
        return state.phase == RUNNING and stream_s(self._action(state)) > 0.0

    def hold(self, state: SequenceState, who: str, now: int) -> SequenceState:
        """No further step begins."""
        return state if state.is_over else self._noted(replace(state, held=who), now, who, HOLD, DONE)

    def resume(self, state: SequenceState, who: str, now: int) -> SequenceState:
        """Steps begin again, and one that waits for an operator does."""
        if state.is_over:
            return state
        return self._noted(replace(state, held="", released=state.index), now, who, RESUME, DONE)

    def skip(self, state: SequenceState, who: str, now: int) -> Answer:
        """The step is left, and stopped if it is under way; the next one is looked at."""
        if state.is_over:
            return state, []
        stop = self._stop((self._action(state).role,)) if state.phase == RUNNING else []
        state = self._noted(state, now, who, self._action(state).describe(), SKIPPED)
        return self._next(state, now), stop

    def interrupt(self, state: SequenceState, who: str, now: int) -> Answer:
        """Somebody stops the machine. A step that keeps saying a velocity is over with that: it would go on at the next
        look. Of a goal its role tells that it was stopped.
        """
        return self._over(state, now, (STOPPED, f"by {who}"), True) if self.streams(state) else (state, [])

    def abort(self, state: SequenceState, who: str, now: int, reason: str = "") -> Answer:
        """Everything stops."""
        if state.is_over:
            return state, []
        state = self._noted(state, now, who, self._action(state).describe(), ABORTED, reason)
        return replace(state, phase=ABORTED), self._stop(self.roles)

    def is_good(self, state: SequenceState) -> bool:
        """Whether it has come to its end, and every step did what it was to do or was skipped by somebody."""
        done = [
            entry for entry in state.history if entry.outcome in (*GOOD_OUTCOMES, SKIPPED) and entry.what not in WORDS
        ]
        return state.phase == ENDED and len(done) == len(self.config.steps)

    @property
    def roles(self) -> tuple[str, ...]:
        """That its steps ask something of."""
        return tuple(dict.fromkeys(step.action.role for step in self.config.steps if step.action.role))

    def _look_at_running(self, state: SequenceState, now: int, heard: SequenceInput) -> Answer:
        view, step, action = self._view(state, now, heard), self.config.steps[state.index], self._action(state)
        outcome = action.end(view)
        is_under_way = outcome is None
        broken = why_broken(action, view, state.looked, self._dropped) if stream_s(action) > 0.0 else ""
        if broken and (outcome is None or outcome[0] in GOOD_OUTCOMES):
            outcome = FAILED, broken
        if outcome is None and step.timeout_s is not None and view.is_over(step.timeout_s):
            outcome = TIMED_OUT, f"not done within {step.timeout_s:g} s"
        if outcome is None:
            return state, self._said(state, view)
        return self._over(state, now, outcome, is_under_way)

    def _over(self, state: SequenceState, now: int, ending: tuple[str, str], is_under_way: bool = False) -> Answer:
        """A step has come to its end, with outcome and reason; its role may still be at it."""
        action, after = self._action(state), self.config.steps[state.index].on_failure
        state = self._noted(state, now, SEQUENCE, action.describe(), *ending)
        if ending[0] in GOOD_OUTCOMES:
            return self._next(state, now), []
        stop = self._stop((action.role,)) if is_under_way else []
        if after == "abort":
            return replace(state, phase=ABORTED), self._stop(self.roles)
        state = self._next(state, now)
        return (state if after == "skip" or state.is_over else replace(state, held=SEQUENCE)), stop

    def _next(self, state: SequenceState, now: int) -> SequenceState:
        index = state.index + 1
        phase = WAITING if index < len(self.config.steps) else ENDED
        return replace(state, index=index, phase=phase, since=now)

    def _asks(self, state: SequenceState) -> bool:
        """Whether the next step has a `hold` that no operator has answered."""
        return self.config.steps[state.index].hold and state.released != state.index

    def _action(self, state: SequenceState) -> OperatorStep:
        action: OperatorStep = self.config.steps[state.index].action
        return action

    def _view(self, state: SequenceState, now: int, heard: SequenceInput) -> View:
        return View(_since(state), now, heard.reports, self.around, heard.truth)

    def _said(self, state: SequenceState, view: View) -> list[GoalToSend]:
        action = self._action(state)
        message = action.say(view)
        return [] if message is None else [GoalToSend(action.topic, message)]

    @staticmethod
    def _stop(roles: Sequence[str]) -> list[GoalToSend]:
        wanted = {STOPS[role] for role in roles if role in STOPS}
        return [GoalToSend(topic, message) for topic, message in stop_messages(0) if topic in wanted]

    @staticmethod
    def _noted(state: SequenceState, now: int, who: str, what: str, outcome: str, reason: str = "") -> SequenceState:
        return replace(state, history=(*state.history, Entry(now, who, what, outcome, reason)))


def _since(state: SequenceState) -> int:
    return 0 if state.since is None else state.since
