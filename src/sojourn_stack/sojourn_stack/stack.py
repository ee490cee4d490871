"""All roles of a run as one value: each control period every role acts on what is due, as in lock-step over topics.

A role acts at a period once all that is due for it has been said, in the order of the contract; the plant acts last,
and tells the truth of the next period. What a node's shell does between messages and app is done here: messages are
checked on arrival, refused ones counted, goals wait for their period, and each role says its heartbeat once a second.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from sojourn_contract import stamps
from sojourn_contract.app import App, Period
from sojourn_contract.arrival import check_input
from sojourn_contract.barrier import Barrier, awaited_inputs, is_due, stamp_due
from sojourn_contract.errors import RefusedMessageError, unreadable
from sojourn_contract.events import EventQueue
from sojourn_contract.heartbeat import ENDED, RUNNING, Counters, beats, heartbeat_message
from sojourn_contract.topic_types import Topic
from sojourn_contract.topics import inputs_of, outputs_of, topic
from sojourn_contract.values import DiagnosticArray, Message
from sojourn_machine.evolution import replace
from sojourn_stack.errors import WaitingError

PLANT = "plant"
HEARTBEATS = "/diagnostics"
Said = tuple[Topic, Message]
"""A row and its message."""
Due = tuple[Topic, int]
"""A row, and the stamp of its message that a role waits for [ns]."""
Heard = tuple[Message, str]
"""A message, and why nobody may take it; empty where all may."""


@dataclass(frozen=True, slots=True)
class RoleState:
    """Of one role."""

    app: Any
    """State of its app."""
    goals: EventQueue = field(default_factory=EventQueue)
    published: Mapping[str, int] = field(default_factory=dict)
    refused: Mapping[str, int] = field(default_factory=dict)
    """Messages by topic."""
    last_refusal: str = ""
    now: int = 0
    """Stamp of the last period that it acted on [ns]."""

    @property
    def counters(self) -> Counters:
        """For a heartbeat."""
        return Counters(dict(self.published), dict(self.refused), self.last_refusal)

    def refusing(self, name: str, reason: str) -> "RoleState":
        """One more message on a topic was refused."""
        refused = {**self.refused, name: self.refused.get(name, 0) + 1}
        return replace(self, refused=refused, last_refusal=reason)


@dataclass(frozen=True, slots=True)
class StackState:
    """Of the whole run."""

    period: int
    """The control period that is acted on next: 1, 2, ..."""
    roles: Mapping[str, RoleState]
    messages: Mapping[str, Mapping[int, Heard]]
    """Last messages of each topic by stamp [ns], as far back as somebody waits for them, with why the contract refuses
    them."""
    finished: bool = False

    @property
    def now(self) -> int:
        """Stamp of the last period that is over [ns]."""
        return (self.period - 1) * stamps.CONTROL_PERIOD_NS


class Stack:
    """The apps of a run, and who waits for what.

    Args:
        apps: by role, in the order of the contract; the plant among them.
        participants: all roles, the recorder included if there is one.
    """

    def __init__(self, apps: Mapping[str, App[Any]], participants: Sequence[str]) -> None:
        self.apps = dict(apps)
        acting = [role for role in self.apps if role != PLANT] + [PLANT]
        present = [role for role in participants if role != "recorder"]
        self._awaited = {role: awaited_inputs(role, present) for role in acting}
        self._strides = {role: Barrier(rows, role == PLANT).stride for role, rows in self._awaited.items()}
        self.outputs = {role: {row.name: row for row in outputs_of(role, {*participants, role})} for role in acting}
        events = {role: [row.name for row in inputs_of(role, {*present, role}) if row.is_event] for role in acting}
        self.takers = {
            row.name: [role for role in acting if row.name in events[role]]
            for rows in self.outputs.values()
            for row in rows.values()
            if row.is_event
        }
        self.lags = {row.name: row.lag for rows in self._awaited.values() for row in rows}

    def begin(self) -> tuple[StackState, list[Said]]:
        """The first state, and the truth with which the run begins."""
        roles = {role: RoleState(app.initial_state()) for role, app in self.apps.items()}
        truth = self.apps[PLANT].first_messages(roles[PLANT].app, stamps.CONTROL_PERIOD_NS)
        period = _Period(self, StackState(1, roles, {}))
        period.say(PLANT, truth)
        return period.state(1), period.said

    def step(self, state: StackState) -> tuple[StackState, list[Said]]:
        """One control period: the state after it, and all that was said in it.

        Raises:
            WaitingError: a role waits for what nobody sends.
        """
        period = _Period(self, state)
        waiting = {role: self._due(role, state.period) for role in self.acting_at(state.period)}
        while waiting:
            ready = next((role for role, due in waiting.items() if not period.missing(due)), None)
            if ready is None:
                role, due = next(iter(waiting.items()))
                row, stamp = period.missing(due)[0]
                raise WaitingError(role, row.name, stamps.seconds(stamp))
            period.act(ready, waiting.pop(ready))
        return period.state(state.period + 1), period.said

    def farewells(self, state: StackState) -> list[Said]:
        """Last heartbeats, with what each role has said in all."""
        return [(topic(HEARTBEATS), self.heartbeat(role, ENDED, one)) for role, one in state.roles.items() if one.now]

    def acting_at(self, period: int) -> list[str]:
        """Roles that act in a period."""
        return [role for role, stride in self._strides.items() if period % stride == 0]

    def heartbeat(self, role: str, kind: str, one: RoleState) -> DiagnosticArray:
        """What a role says of itself."""
        values = self.apps[role].heartbeat_values(one.app, one.now)
        return heartbeat_message(role, kind, one.now, one.counters, "", values)

    def _due(self, role: str, period: int) -> list[Due]:
        return [(row, stamp_due(row, period)) for row in self._awaited[role] if is_due(row, period)]


class _Period:
    """A control period while roles act in it: from the state at its beginning to that at its end.

    Args:
        stack: whose period it is. state: at the beginning; not changed.
    """

    def __init__(self, stack: Stack, state: StackState) -> None:
        self.said: list[Said] = []
        self._stack = stack
        self._stamp = state.period * stamps.CONTROL_PERIOD_NS
        self._roles = dict(state.roles)
        self._messages = {name: dict(kept) for name, kept in state.messages.items()}
        self._finished = state.finished

    def state(self, period: int) -> StackState:
        """At the end, with the number of the next one."""
        return StackState(period, self._roles, self._messages, self._finished)

    def missing(self, due: Sequence[Due]) -> list[Due]:
        """What has not been said yet."""
        return [(row, stamp) for row, stamp in due if stamp not in self._messages.get(row.name, ())]

    def act(self, role: str, due: Sequence[Due]) -> None:
        """Let a role act on what is due for it."""
        app, one = self._stack.apps[role], self._roles[role]
        inputs: dict[str, Any] = {}
        for row, stamp in due:
            message, refusal = self._messages[row.name][stamp]
            refusal = refusal or _refusal(app.check, row, message)
            inputs[row.name] = None if refusal else message
            one = one.refusing(row.name, refusal) if refusal else one
        goals, taken = one.goals.taken(self._stamp)
        memory, answer = app.step(one.app, Period(self._stamp, inputs, taken, one.last_refusal))
        before, one = one.now, replace(one, app=memory, goals=goals, now=self._stamp)
        for name, refused in answer.refusals:
            one = one.refusing(name, str(refused))
        self._roles[role] = one
        self._finished = self._finished or answer.finished
        self.say(role, answer.messages)
        if beats(before, self._stamp):
            self._roles[role] = one = _counting(self._roles[role], [HEARTBEATS])
            self.said.append((topic(HEARTBEATS), self._stack.heartbeat(role, RUNNING, one)))

    def say(self, role: str, messages: Iterable[tuple[str, Message]]) -> None:
        """Keep what a role says for those who wait for it, and give it to those whose goal it is."""
        outputs = self._stack.outputs[role]
        said = [(outputs[name], message) for name, message in messages if name in outputs]
        self._roles[role] = _counting(self._roles[role], [row.name for row, _ in said])
        for row, message in said:
            if row.is_event:
                for taker in self._stack.takers[row.name]:
                    self._offer(taker, row, message)
            elif row.name in self._stack.lags:
                stamp = message.stamp
                oldest = stamp - self._stack.lags[row.name] * stamps.CONTROL_PERIOD_NS
                kept = {at: older for at, older in self._messages.get(row.name, {}).items() if at >= oldest}
                self._messages[row.name] = kept | {stamp: (message, _refusal(check_input, row, message))}
        self.said += said

    def _offer(self, role: str, row: Topic, message: Message) -> None:
        one = self._roles[role]
        one = replace(one, goals=one.goals.counted(row))
        refusal = _refusal(check_input, row, message) or _refusal(self._stack.apps[role].check, row, message)
        if not refusal:
            try:
                one = replace(one, goals=one.goals.offered(row, message.stamp, one.now, message))
            except RefusedMessageError as late:
                refusal = str(late)
        self._roles[role] = one.refusing(row.name, refusal) if refusal else one


def _refusal(check: Callable[[Topic, Message], None], row: Topic, message: Message) -> str:
    """Why a message does not pass a check, empty where it does; whatever the check raises is the message's fault."""
    try:
        check(row, message)
    except RefusedMessageError as refusal:
        return str(refusal)
    except Exception as error:
        return str(unreadable(row.name, f"a {row.type} that can be read", error))
    return ""


def _counting(one: RoleState, names: Iterable[str]) -> RoleState:
    published = dict(one.published)
    for name in names:
        published[name] = published.get(name, 0) + 1
    return replace(one, published=published)
