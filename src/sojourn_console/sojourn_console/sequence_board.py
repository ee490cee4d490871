"""A sequence of commands on the page: read, checked, carried out look by look, and what came of it.

It is carried out by the page's own process: a sequence ends with its console, and what is under way then goes on.
"""

import contextlib
import json
from collections.abc import Mapping, Sequence

from sojourn_config.errors import ConfigError
from sojourn_config.yaml_file import parse_yaml
from sojourn_console.errors import GoalError, SequenceError
from sojourn_console.feed import Feed, FeedMessage
from sojourn_console.world import World
from sojourn_contract.codecs import decode
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.named_fields import FieldValue
from sojourn_contract.values import Odometry
from sojourn_operator.report_queue import ReportQueue
from sojourn_operator.script import GoalToSend
from sojourn_operator.sequence.file import SequenceConfig, checked_sequence, scenario_text
from sojourn_operator.sequence.runner import WAITING, Answer, Entry, SequenceInput, SequenceRunner, SequenceState
from sojourn_operator.sequence.stream import dropped_s
from sojourn_operator.steps.step import RunFacts

REPORTS = {"/drive/status": "drive", "/arm/status": "arm", "/power/status": "power"}
TRUTH = "/truth/odom"
KEPT = 2000
"""Entries of sequences that are over."""


class SequenceBoard:
    """Of one run.

    Args:
        world: of the run. feed: to it. who: carries it out.

    Attributes:
        state: of the sequence that has begun last.
    """

    def __init__(self, world: World, feed: Feed, who: str) -> None:
        self._world, self._feed, self._who = world, feed, who
        self._runner: SequenceRunner | None = None
        self._past: tuple[Entry, ...] = ()
        self.state = SequenceState()
        self._reports: dict[str, ReportQueue] = {}
        self._known = SequenceInput({}, {}, None)
        self._values: dict[str, FieldValue] = {}
        self._truth: Odometry | None = None

    @property
    def topics(self) -> frozenset[str]:
        """That it goes by, every message of them; none while nothing is carried out."""
        runner = self._runner
        if runner is None or self.state.is_over:
            return frozenset()
        sees = any(step.action.looks_at_ground for step in runner.config.steps)
        return frozenset((*REPORTS, *runner.topics, *([TRUTH] if sees else [])))

    @property
    def is_under_way(self) -> bool:
        """Whether a sequence is being carried out."""
        return self._runner is not None and not self.state.is_over

    @property
    def history(self) -> tuple[Entry, ...]:
        """What has been done, by whom, and how it came out; of all sequences."""
        return (*self._past, *self.state.history)

    def check(self, text: str, name: str = "sequence") -> SequenceConfig:
        """The sequence of a text. Raises SequenceError with everything that is wrong with it."""
        try:
            return checked_sequence(parse_yaml(text, name), self._world.scenario, self._world.table)
        except ConfigError as error:
            raise SequenceError(str(error)) from error

    def as_scenario(self, text: str) -> str:
        """Its steps as a scenario has them. Raises SequenceError."""
        return scenario_text(self.check(text))

    def begin(self, text: str, name: str = "sequence") -> str:
        """Carry it out. Returns what begins, in words. Raises SequenceError."""
        if self.is_under_way:
            raise SequenceError("a sequence is under way: allowed is to abort it first")
        config = self.check(text, name)
        around = RunFacts(self._world.scenario.arm_joints, self._world.ground)
        self._past = self.history[-KEPT:]
        self._runner, self.state = (
            SequenceRunner(config, self._world.table, around, dropped_s(self._world.scenario)),
            SequenceState(),
        )
        self._reports, self._values = {}, {}
        self._known = SequenceInput({}, {}, None)
        return f"{len(config.steps)} steps begin"

    def hear(self, heard: Sequence[FeedMessage]) -> None:
        """Messages that have come; what follows from them is sent."""
        runner = self._runner
        if runner is None or self.state.is_over:
            return
        for one in heard:
            if one.row.name in self.topics:
                self._keep(runner, one)
        told = {role: told.report for role, queue in self._reports.items() if (told := queue.look()) is not None}
        self._known = SequenceInput(told, self._values, self._truth)
        self._take(runner.look(self.state, self._feed.now, self._known))

    def describe(self) -> str:
        """Where it is, in words."""
        runner = self._runner
        if runner is None:
            return "none has begun"
        words = runner.describe(self.state)
        why = runner.waits_for(self.state, self._feed.now, self._known) if self.state.phase == WAITING else ""
        return f"{words} (waits for {why})" if why else words

    def hold(self) -> str:
        """No further step begins."""
        self.state = self._going().hold(self.state, self._who, self._feed.now)
        return "held: the step under way goes on"

    def stop(self) -> str:
        """Somebody stops the machine: no further step begins, and no velocity is said again. Returns what has become of
        it, in words.
        """
        self.hold()
        self.interrupt()
        return f"the sequence is {self.state.phase if self.state.is_over else 'held'}"

    def interrupt(self) -> str:
        """Somebody ends what the machine is at: a step that keeps saying a velocity is over. Returns so, in words, ""
        where there is none.
        """
        runner, before = self._runner, self.state
        if runner is not None:
            self._take(runner.interrupt(self.state, self._who, self._feed.now))
        return "" if self.state is before else "the velocity of the sequence is not said again"

    def resume(self) -> str:
        """Steps begin again."""
        self.state = self._going().resume(self.state, self._who, self._feed.now)
        return "goes on"

    def skip(self) -> str:
        """The step is left, and stopped if it is under way."""
        self._take(self._going().skip(self.state, self._who, self._feed.now))
        return "step left"

    def abort(self, reason: str = "") -> str:
        """Everything stops."""
        self._take(self._going().abort(self.state, self._who, self._feed.now, reason))
        return "aborted: drive and arm stop"

    def as_json(self) -> str:
        """The history, as scripts/sequence --json writes it."""
        data = {"phase": self.state.phase, "history": [entry.as_data() for entry in self.history]}
        return json.dumps(data, indent=2, ensure_ascii=False) + "\n"

    def clear(self) -> None:
        """Another run has begun: what was under way belongs to the one before."""
        self._past, self._runner, self.state = self.history, None, SequenceState()

    def _going(self) -> SequenceRunner:
        if self._runner is None or self.state.is_over:
            raise SequenceError("no sequence is under way")
        return self._runner

    def _keep(self, runner: SequenceRunner, heard: FeedMessage) -> None:
        name = heard.row.name
        try:
            message = decode(heard.row, heard.data)
        except RefusedMessageError:  # the alarms' log says so
            return
        if name in REPORTS:
            self._reports.setdefault(REPORTS[name], ReportQueue()).hear(message)
        if name == TRUTH:
            self._truth = message
        self._values |= runner.values(name, message)

    def _take(self, answer: Answer) -> None:
        """The next state; what cannot be sent ends the sequence, for its step would wait for ever."""
        self.state, goals = answer
        try:
            self._send(goals)
        except GoalError as error:
            runner = self._runner
            if runner is not None and not self.state.is_over:
                self.state, stops = runner.abort(self.state, "console", self._feed.now, str(error))
                for stop in stops:
                    with contextlib.suppress(GoalError):  # of a role that does not listen
                        self._send([stop])

    def _send(self, goals: Sequence[GoalToSend]) -> None:
        for goal in goals:
            self._feed.send(goal.topic, goal.message)


def with_step(text: str, step: Mapping[str, object]) -> str:
    """A sequence's text with one step more at its end."""
    line = json.dumps(step, ensure_ascii=False)  # JSON is YAML, and one line
    before = text.rstrip() or "steps:"
    return f"{before}\n  - {line}\n"
