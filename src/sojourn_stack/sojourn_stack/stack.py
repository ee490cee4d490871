"""All roles of a run as one value: each control period every role acts on what is due, as in lock-step over topics.

A role acts at a period once all that is due for it has been said, in the order of the contract; the plant acts last,
and tells the truth of the next period. What a node's shell does between messages and app is done here: messages are
checked on arrival, refused ones counted, goals wait for their period, and each role says its heartbeat once a second.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import lcm
from typing import Any

from sojourn_contract import stamps
from sojourn_contract.app import App, Period
from sojourn_contract.arrival import check_input, refusal_of
from sojourn_contract.barrier import Barrier, awaited_inputs, is_due, stamp_due
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.heard import late, took_values
from sojourn_contract.heartbeat import ENDED, RUNNING, beats, heartbeat_message
from sojourn_contract.leaps import NO_LEAPS, Leaps
from sojourn_contract.role_state import Heard, RoleState
from sojourn_contract.topic_table import TopicTable
from sojourn_contract.topic_types import Topic
from sojourn_contract.topics import STANDARD, topic
from sojourn_contract.values import DiagnosticArray, Message
from sojourn_contract.words import keep, kept_for
from sojourn_machine.evolution import replace
from sojourn_stack.errors import MisfitError, WaitingError

PLANT = "plant"
HEARTBEATS = "/diagnostics"
Said = tuple[Topic, Message]
"""A row and its message."""
Due = tuple[Topic, int]
"""A row, and by how much the stamp of its message that a role waits for is behind that of the period [ns]."""


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
    ahead: tuple[tuple[str, Message], ...] = ()
    """What has been said and belongs to a period to come, by topic: the plant tells the truth of the next one."""
    leaps: Leaps = NO_LEAPS
    """Of the clock, so far."""

    @property
    def now(self) -> int:
        """Stamp of the last period that is over [ns]."""
        return self.leaps.before(self.period) * stamps.CONTROL_PERIOD_NS


class Stack:
    """The apps of a run, and who waits for what.

    Args:
        apps: by role, in the order of the contract; the plant among them.
        participants: all roles, the recorder included if there is one. table: the topics of the run.
    """

    def __init__(self, apps: Mapping[str, App[Any]], participants: Sequence[str], table: TopicTable = STANDARD) -> None:
        self.apps = dict(apps)
        acting = [role for role in self.apps if role != PLANT] + [PLANT]
        present = [role for role in participants if role != "recorder"]
        self.checks = {role: app.check for role, app in self.apps.items() if not _is_none(app.check)}
        """Of the roles that refuse more than the contract does."""
        self._awaited = {role: awaited_inputs(role, present, table) for role in acting}
        self._strides = {role: Barrier(rows, role == PLANT).stride for role, rows in self._awaited.items()}
        outputs = {role: table.outputs_of(role, {*participants, role}) for role in acting}
        self.outputs = {role: {row.name: row for row in rows} for role, rows in outputs.items()}
        self.rows = {name: row for rows in self.outputs.values() for name, row in rows.items()}
        self.rows[HEARTBEATS] = topic(HEARTBEATS)
        inputs = {role: table.inputs_of(role, {*present, role}) for role in acting}
        events = {role: [row.name for row in rows if row.is_event] for role, rows in inputs.items()}
        self.takers = {
            row.name: [role for role in acting if row.name in events[role]]
            for rows in self.outputs.values()
            for row in rows.values()
            if row.is_event
        }
        self.kept_for = {row.name: kept_for(row) for rows in self._awaited.values() for row in rows}
        """How long a message of a topic is waited for after its stamp [ns]."""
        rows = [row for awaited in self._awaited.values() for row in awaited]
        self._cycle = lcm(*self._strides.values(), *(row.every for row in rows))
        self._latest = max((row.lag for row in rows), default=0)
        self._repeats = all(row.delivery is None for row in rows)
        self._agendas: dict[int, Mapping[str, Sequence[Due]]] = {}

    def begin(self) -> tuple[StackState, list[Said]]:
        """The first state, and the truth with which the run begins."""
        roles = {role: RoleState(app.initial_state()) for role, app in self.apps.items()}
        truth = self.apps[PLANT].first_messages(roles[PLANT].app, stamps.CONTROL_PERIOD_NS)
        period = _Period(self, StackState(1, roles, {}))
        period.begin(PLANT, truth)
        return period.state(1), period.said

    def resume(self, state: StackState) -> list[Said]:
        """What had been said of periods to come when a run stood at a state, for a record that begins there.

        Raises:
            MisfitError: the state is of other roles.
        """
        if set(state.roles) != set(self.apps):
            raise MisfitError("roles", f"the checkpoint has {', '.join(state.roles)}, this run {', '.join(self.apps)}")
        return [(self.rows[name], message) for name, message in state.ahead]

    def step(self, state: StackState) -> tuple[StackState, list[Said]]:
        """One control period: the state after it, and all that was said in it.

        Raises:
            WaitingError: a role waits for what nobody sends.
        """
        period = _Period(self, state)
        waiting = dict(self.agenda(state.period, state.leaps))
        while waiting:
            ready = next((role for role, due in waiting.items() if period.missing(due) is None), None)
            if ready is None:
                role, due = next(iter(waiting.items()))
                row, behind = period.missing(due) or due[0]
                raise WaitingError(role, row.name, stamps.seconds(period.stamp - behind))
            period.act(ready, waiting.pop(ready))
        return period.state(period.landing or state.period + 1), period.said

    def hearing(self, state: StackState, role: str, goals: Iterable[tuple[Topic, Message]]) -> StackState:
        """The state in which a role has also got goals that none of the others says, before the period to come."""
        period = _Period(self, state)
        for row, message in goals:
            period.offer(role, row, message)
        return period.state(state.period)

    def farewells(self, state: StackState) -> list[Said]:
        """Last heartbeats, with what each role has said in all."""
        return [(topic(HEARTBEATS), self.heartbeat(role, ENDED, one)) for role, one in state.roles.items() if one.now]

    def agenda(self, period: int, leaps: Leaps = NO_LEAPS) -> Mapping[str, Sequence[Due]]:
        """Roles that act in a period, and what each waits for. It repeats, once all is waited for that ever is and
        where the clock has not leapt just now.
        """
        after_leap = leaps.gaps and period < leaps.gaps[-1][1] + self._latest
        if period <= self._latest or not self._repeats or after_leap:
            return self._agenda(period, leaps)
        place = period % self._cycle
        agenda = self._agendas.get(place)
        if agenda is None:
            agenda = self._agendas[place] = self._agenda(period, NO_LEAPS)
        return agenda

    def heartbeat(self, role: str, kind: str, one: RoleState) -> DiagnosticArray:
        """What a role says of itself."""
        values = self.apps[role].heartbeat_values(one.app, one.now) | took_values(one.took)
        return heartbeat_message(role, kind, one.now, one.counters, "", values)

    def _agenda(self, period: int, leaps: Leaps) -> Mapping[str, Sequence[Due]]:
        now = period * stamps.CONTROL_PERIOD_NS
        return {
            role: [(row, now - stamp_due(row, period, leaps)) for row in self._awaited[role] if is_due(row, period)]
            for role, stride in self._strides.items()
            if period % stride == 0
        }


class _Period:
    """A control period while roles act in it: from the state at its beginning to that at its end.

    Args:
        stack: whose period it is. state: at the beginning; not changed.
    """

    def __init__(self, stack: Stack, state: StackState) -> None:
        self.said: list[Said] = []
        self._stack = stack
        self.stamp = state.period * stamps.CONTROL_PERIOD_NS
        self._roles = dict(state.roles)
        self._messages = dict(state.messages)
        self._finished = state.finished
        self._ahead = state.ahead
        self._leaps = state.leaps
        self.landing = 0
        """The period that comes next, where the clock leaps; else 0."""

    def state(self, period: int) -> StackState:
        """At the end, with the number of the next one."""
        now = (period - 1) * stamps.CONTROL_PERIOD_NS
        ahead = [one for one in self._ahead if self._stack.rows[one[0]].heard_at(one[1].stamp) > now]
        ahead += [(row.name, message) for row, message in self.said if row.heard_at(message.stamp) > now]
        return StackState(period, self._roles, self._messages, self._finished, tuple(ahead), self._leaps)

    def missing(self, due: Sequence[Due]) -> Due | None:
        """The first that has not been said yet."""
        for awaited in due:
            row, behind = awaited
            if self.stamp - behind not in self._messages.get(row.name, ()):
                return awaited
        return None

    def act(self, role: str, due: Sequence[Due]) -> None:
        """Let a role act on what is due for it."""
        app, check, one = self._stack.apps[role], self._stack.checks.get(role), self._roles[role]
        inputs: dict[str, Any] = {}
        for row, behind in due:
            message, refusal = self._messages[row.name][self.stamp - behind]
            if check is not None and not refusal:
                refusal = refusal_of(check, row, message)
            if refusal:
                one = one.refusing(row.name, refusal)
            inputs[row.name] = None if refusal else message
        goals, taken = one.goals.taken(self.stamp)
        memory, answer = app.step(one.app, Period(self.stamp, inputs, taken, one.last_refusal))
        said = self._of(role, answer.messages)
        before, published = one.now, _counted(one.published, said)
        took = one.took + late([(name, goal.stamp) for name, goal in taken], before, self.stamp)
        one = replace(one, app=memory, goals=goals, now=self.stamp, published=published, took=took)
        for name, refused in answer.refusals:
            one = one.refusing(name, refused)
        self._roles[role] = one
        self._finished = self._finished or answer.finished
        if answer.landing:
            self._leap(answer.landing // stamps.CONTROL_PERIOD_NS)
        self._say(said)
        if beats(before, self.stamp):
            heartbeat = topic(HEARTBEATS)
            one = self._roles[role]
            self._roles[role] = one = replace(one, published=_counted(one.published, [(heartbeat, None)]))
            self.said.append((heartbeat, self._stack.heartbeat(role, RUNNING, one)))
            self._roles[role] = replace(one, took=()) if one.took else one

    def _leap(self, landing: int) -> None:
        self.landing = landing
        self._leaps = self._leaps.with_leap(self.stamp // stamps.CONTROL_PERIOD_NS, landing)

    def begin(self, role: str, messages: Iterable[tuple[str, Message]]) -> None:
        """What a role says before its first period."""
        said, one = self._of(role, messages), self._roles[role]
        self._roles[role] = replace(one, published=_counted(one.published, said))
        self._say(said)

    def _of(self, role: str, messages: Iterable[tuple[str, Message]]) -> list[Said]:
        """Those of a role's messages that this run has."""
        outputs = self._stack.outputs[role]
        return [(outputs[name], message) for name, message in messages if name in outputs]

    def _say(self, said: list[Said]) -> None:
        """Keep what is said for those who wait for it, and give it to those whose goal it is."""
        for row, message in said:
            if row.is_event:
                for taker in self._stack.takers[row.name]:
                    self.offer(taker, row, message)
                continue
            if row.name in self._stack.kept_for:
                keep(self._messages, row, message, self._stack.kept_for[row.name], self._leaps)
        self.said += said

    def offer(self, role: str, row: Topic, message: Message) -> None:
        """Give a role a goal; one that is refused is counted."""
        one = self._roles[role]
        one = replace(one, goals=one.goals.counted(row))
        refusal = refusal_of(check_input, row, message) or refusal_of(self._stack.apps[role].check, row, message)
        if not refusal:
            try:
                one = replace(one, goals=one.goals.offered(row, message.stamp, one.now, message))
            except RefusedMessageError as late:
                refusal = str(late)
        self._roles[role] = one.refusing(row.name, refusal) if refusal else one


def _is_none(check: Callable[[Topic, Message], None]) -> bool:
    """Whether a role's check is that of an app without one of its own."""
    return getattr(check, "__func__", None) is App.check


def _counted(published: Mapping[str, int], said: Iterable[tuple[Topic, Message | None]]) -> Mapping[str, int]:
    """Messages by topic, with those that are said now."""
    counts = dict(published)
    for row, _ in said:
        counts[row.name] = counts.get(row.name, 0) + 1
    return counts
