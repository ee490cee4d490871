"""Carries a sequence out beside a running stack, and takes the words of whoever sits at the terminal."""

import select
import sys
import time
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, Self

from sojourn_config.command_errors import CommandError
from sojourn_config.command_line import say
from sojourn_contract.codecs import encode
from sojourn_contract.named_fields import FieldValue
from sojourn_contract.topic_table import TopicTable
from sojourn_contract.values import Message, Odometry, Path, PoseStamped
from sojourn_operator.clock_watch import ClockWatch
from sojourn_operator.foresight_words import foresight_lines
from sojourn_operator.goal_messages import QUESTION
from sojourn_operator.goal_sending import GoalClient
from sojourn_operator.script import GoalToSend
from sojourn_operator.sequence.runner import (
    ABORTED,
    SEQUENCE,
    STOPS,
    WAITING,
    Answer,
    SequenceInput,
    SequenceRunner,
    SequenceState,
)
from sojourn_operator.steps.step import View

HELP = "h: hold, r: resume, s: skip, a: abort, l: list, q: leave (what is under way goes on)"
TRUTH = "/truth/odom"
LOOK_S = 0.05
"""Wall time between two looks, at most."""
NOBODY_TYPES = "it waits for an operator's word, and the input has ended: nobody can type one"


class SequenceDesk(GoalClient):
    """A context manager.

    Args:
        domain, namespace: where the stack is. runner: of the sequence. table: topics of the run. who: gives its words.
    """

    def __init__(self, place: tuple[int, str], runner: SequenceRunner, table: TopicTable, who: str) -> None:
        super().__init__(*place, name="sequence")
        self.runner, self.table, self.who = runner, table, who
        self.state: SequenceState = runner.initial_state()
        self._values: dict[str, FieldValue] = {}
        self._truth: Odometry | None = None
        self._senders: dict[str, Any] = {}
        self._leaves = False

    def __enter__(self) -> Self:
        super().__enter__()
        for name in self.runner.topics:
            self._readers.append(self.listen(self.table.topic(name), partial(self._keep_values, name)))
        if any(step.action.looks_at_ground for step in self.runner.config.steps):
            self._readers.append(self.listen(self.table.topic(TRUTH), self._keep_truth))
        return self

    def prepare(self) -> None:
        """Find everybody who acts on what will be sent: a goal must not wait for that. Raises NoStackError."""
        topics = {step.action.topic: step.action.role for step in self.runner.config.steps if step.action.topic}
        topics |= {STOPS[role]: role for role in self.runner.roles}
        for topic, role in topics.items():
            self._senders[topic] = self.sender_to(role, self.table.topic(topic))
        if self.has_link():
            say("the run has a link to Earth: a sequence goes round it, as of somebody beside the machine")

    def run(self) -> bool:
        """Carry it out. Returns whether every step came to a good end, or was skipped by somebody."""
        self.prepare()
        say(f"{len(self.runner.config.steps)} steps; {HELP}")
        told, position, somebody_types = 0, "", True
        clock = ClockWatch(self.now)
        while not (self.state.is_over or self._leaves):
            before = self.now
            self._await_look()
            if self.stop.is_set:
                self._take(self.runner.abort(self.state, self.who, self.now, "Ctrl-C"))
            somebody_types = somebody_types and self._listen_to_person()
            if why := clock.look(self.now):
                self._give_up(why, is_another_stack=self.now < before)
            self._take(self.runner.look(self.state, self.now, self._heard()))
            if not somebody_types and self.runner.waits_for_person(self.state):
                self._give_up(NOBODY_TYPES)
            for entry in self.state.history[told:]:
                say(entry.line())
            told = len(self.state.history)
            if self.runner.describe(self.state) != position:
                position = self.runner.describe(self.state)
                say(f"{'':12} {position}")
        self.spin(LOOK_S)
        return self.state.phase != ABORTED and not self._leaves and self.runner.is_good(self.state)

    def forecast(self, timeout_s: float) -> int:
        """Ask of each drive what it would take, each from where the one before it ends. 0 if all are allowed."""
        poses: list[PoseStamped] = []
        before = {"asked_length_m": 0.0, "asked_time_s": 0.0, "asked_energy_wh": 0.0}
        allowed = True
        for number, step in enumerate(self.runner.config.steps, 1):
            goal = step.action.goal(View(0, 0, {}, self.runner.around)) if step.action.role == "drive" else None
            say(f"{number}. {step.action.describe()}")
            if not isinstance(goal, PoseStamped | Path):
                continue
            poses += goal.poses if isinstance(goal, Path) else (goal,)
            self.send("drive", QUESTION, Path(0, goal.frame, tuple(poses)))
            answer = self.answer(timeout_s)
            if answer is None:
                raise CommandError(f"the drive did not answer within {timeout_s:g} s of wall time")
            allowed = allowed and answer.get("asked_state") == "allowed"
            own = {key: str(float(answer[key]) - value) for key, value in before.items() if key in answer}
            before |= {key: float(answer[key]) for key in before if key in answer}
            for line in foresight_lines({**answer, **own}):
                say(f"   {line}")
        return 0 if allowed else 1

    def _await_look(self) -> None:
        """Take what comes until the next look is due. Where a velocity has to be said again in time, that is as soon as
        the time goes on: a stack may be much faster than the wall clock.
        """
        if not self.runner.streams(self.state):
            self.spin(LOOK_S)
            return
        now, end = self.now, time.monotonic() + LOOK_S
        while self.now == now and (left := end - time.monotonic()) > 0.0:
            self._executor.spin_once(timeout_sec=left)

    def _give_up(self, why: str, is_another_stack: bool = False) -> None:
        """End it. What moves is stopped, but not in a stack that was started anew, where it is somebody else's."""
        self.state, stops = self.runner.abort(self.state, SEQUENCE, self.now, why)
        if not is_another_stack:
            self._send_now(stops)

    def _heard(self) -> SequenceInput:
        reports = {who: told.report for who in self.statuses if (told := self.told(who)) is not None}
        return SequenceInput(reports, self._values, self._truth)

    def _take(self, answer: Answer) -> None:
        self.state, goals = answer
        self._send_now(goals)

    def _send_now(self, goals: Sequence[GoalToSend]) -> None:
        for goal in goals:
            self._senders[goal.topic].publish(encode(self.table.topic(goal.topic), goal.message))

    def _keep_values(self, topic: str, message: Message) -> None:
        self._values |= self.runner.values(topic, message)

    def _keep_truth(self, message: Odometry) -> None:
        self._truth = message

    def _listen_to_person(self) -> bool:
        """Obey what has been typed, if anything. False once nobody can type any more."""
        if sys.stdin is None:  # started with its input closed
            return False
        if not select.select([sys.stdin], [], [], 0.0)[0]:
            return True
        line = sys.stdin.readline()
        self.obey(line.strip())
        return bool(line)

    def obey(self, word: str) -> None:
        """What somebody has typed."""
        runner, who = self.runner, self.who
        words: dict[str, Callable[[], None]] = {
            "h": lambda: self._take((runner.hold(self.state, who, self.now), [])),
            "r": lambda: self._take((runner.resume(self.state, who, self.now), [])),
            "s": lambda: self._take(runner.skip(self.state, who, self.now)),
            "a": lambda: self._take(runner.abort(self.state, who, self.now)),
            "l": lambda: say("\n".join((*(entry.line() for entry in self.state.history), runner.describe(self.state),
                                        self._waits()))),
            "q": self._leave,
        }  # fmt: skip
        if word in words:
            words[word]()
        elif word:
            say(f"{word!r}: allowed is {HELP}")

    def _waits(self) -> str:
        if self.state.phase != WAITING:
            return ""
        return f"waits for {self.runner.waits_for(self.state, self.now, self._heard())}"

    def _leave(self) -> None:
        self._leaves = True
