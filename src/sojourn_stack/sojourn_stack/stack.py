"""All roles of a run as one value: each control period every role acts on what is due, as in lock-step over topics.

A role acts at a period once all that is due for it has been said, in the order of the contract; the plant acts last,
and tells the truth of the next period. What a node's shell does between messages and app is done here: messages are
checked on arrival, refused ones counted, goals wait for their period, and each role says its heartbeat once a second.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from sojourn_contract import stamps
from sojourn_contract.app import App, Period
from sojourn_contract.arrival import check_input
from sojourn_contract.barrier import Barrier, awaited_inputs, is_due, stamp_due
from sojourn_contract.decoding import refusing
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.events import EventQueue
from sojourn_contract.heartbeat import ENDED, RUNNING, Counters, beats, heartbeat_message
from sojourn_contract.topic_types import Topic
from sojourn_contract.topics import inputs_of, outputs_of, topic
from sojourn_contract.values import Message
from sojourn_stack.errors import WaitingError

PLANT = "plant"
HEARTBEATS = "/diagnostics"
Said = tuple[Topic, Message]
"""A row and its message."""


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

    def refusing(self, name: str, refusal: Exception) -> "RoleState":
        """One more message on a topic was refused."""
        refused = {**self.refused, name: self.refused.get(name, 0) + 1}
        return replace(self, refused=refused, last_refusal=str(refusal))


@dataclass(frozen=True, slots=True)
class StackState:
    """Of the whole run."""

    period: int
    """The control period that is acted on next: 1, 2, ..."""
    roles: Mapping[str, RoleState]
    messages: Mapping[str, Mapping[int, Message]]
    """Last messages of each topic by stamp [ns], as far back as somebody waits for them."""
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
        self._outputs = {role: {row.name: row for row in outputs_of(role, {*participants, role})} for role in acting}
        events = {role: [row.name for row in inputs_of(role, {*present, role}) if row.is_event] for role in acting}
        self._takers = {
            row.name: [role for role in acting if row.name in events[role]]
            for rows in self._outputs.values()
            for row in rows.values()
            if row.is_event
        }
        self._lags = {row.name: row.lag for rows in self._awaited.values() for row in rows}

    def begin(self) -> tuple[StackState, list[Said]]:
        """The first state, and the truth with which the run begins."""
        roles = {role: RoleState(app.initial_state()) for role, app in self.apps.items()}
        state = StackState(1, roles, {})
        truth = self.apps[PLANT].first_messages(roles[PLANT].app, stamps.CONTROL_PERIOD_NS)
        return self._say(state, PLANT, truth)

    def step(self, state: StackState) -> tuple[StackState, list[Said]]:
        """One control period: the state after it, and all that was said in it.

        Raises:
            WaitingError: a role waits for what nobody sends.
        """
        said: list[Said] = []
        acting = [role for role, stride in self._strides.items() if state.period % stride == 0]
        while acting:
            ready = next((role for role in acting if not self._missing(role, state)), None)
            if ready is None:
                row = self._missing(acting[0], state)[0]
                raise WaitingError(acting[0], row.name, stamps.seconds(stamp_due(row, state.period)))
            acting.remove(ready)
            state, new = self._act(ready, state)
            said += new
        return replace(state, period=state.period + 1), said

    def farewells(self, state: StackState) -> list[Said]:
        """Last heartbeats, with what each role has said in all."""
        return [(topic(HEARTBEATS), self._heartbeat(role, ENDED, one)) for role, one in state.roles.items() if one.now]

    def _missing(self, role: str, state: StackState) -> list[Topic]:
        return [
            row
            for row in self._awaited[role]
            if is_due(row, state.period) and stamp_due(row, state.period) not in state.messages.get(row.name, {})
        ]

    def _act(self, role: str, state: StackState) -> tuple[StackState, list[Said]]:
        app, one, stamp = self.apps[role], state.roles[role], state.period * stamps.CONTROL_PERIOD_NS
        inputs: dict[str, Any] = {}
        for row in self._awaited[role]:
            if is_due(row, state.period):
                message = state.messages[row.name][stamp_due(row, state.period)]
                refusal = _refusal(app, row, message)
                inputs[row.name] = message if refusal is None else None
                one = one if refusal is None else one.refusing(row.name, refusal)
        goals, taken = one.goals.taken(stamp)
        memory, answer = app.step(one.app, Period(stamp, inputs, taken, one.last_refusal))
        before, one = one.now, replace(one, app=memory, goals=goals, now=stamp)
        for name, refused in answer.refusals:
            one = one.refusing(name, refused)
        state = replace(state, roles={**state.roles, role: one}, finished=state.finished or answer.finished)
        state, said = self._say(state, role, answer.messages)
        if beats(before, stamp):
            one = _counting(state.roles[role], [HEARTBEATS])
            state = replace(state, roles={**state.roles, role: one})
            said.append((topic(HEARTBEATS), self._heartbeat(role, RUNNING, one)))
        return state, said

    def _heartbeat(self, role: str, kind: str, one: RoleState) -> Any:
        values = self.apps[role].heartbeat_values(one.app, one.now)
        return heartbeat_message(role, kind, one.now, one.counters, "", values)

    def _say(self, state: StackState, role: str, messages: Iterable[tuple[str, Any]]) -> tuple[StackState, list[Said]]:
        """With what a role says: kept for those who wait for it, given to those whose goal it is."""
        outputs = self._outputs[role]
        said = [(outputs[name], message) for name, message in messages if name in outputs]
        roles = {**state.roles, role: _counting(state.roles[role], [row.name for row, _ in said])}
        kept = dict(state.messages)
        for row, message in said:
            if row.is_event:
                for taker in self._takers[row.name]:
                    roles[taker] = self._offered(roles[taker], taker, row, message)
            elif row.name in self._lags:
                stamp = message.stamp
                oldest = stamp - self._lags[row.name] * stamps.CONTROL_PERIOD_NS
                known = kept.get(row.name, {})
                kept[row.name] = {at: older for at, older in known.items() if at >= oldest} | {stamp: message}
        return replace(state, roles=roles, messages=kept), said

    def _offered(self, one: RoleState, role: str, row: Topic, message: Any) -> RoleState:
        one = replace(one, goals=one.goals.counted(row))
        refusal = _refusal(self.apps[role], row, message)
        if refusal is None:
            try:
                return replace(one, goals=one.goals.offered(row, message.stamp, one.now, message))
            except RefusedMessageError as late:
                refusal = late
        return one.refusing(row.name, refusal)


def _refusal(app: App[Any], row: Topic, message: Any) -> RefusedMessageError | None:
    """Why a message is not taken, by the contract or the role itself."""
    try:
        with refusing(row.name, f"a {row.type} that can be read"):
            check_input(row, message)
            app.check(row, message)
    except RefusedMessageError as refusal:
        return refusal
    return None


def _counting(one: RoleState, names: Iterable[str]) -> RoleState:
    published = dict(one.published)
    for name in names:
        published[name] = published.get(name, 0) + 1
    return replace(one, published=published)
