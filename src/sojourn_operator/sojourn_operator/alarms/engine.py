"""Judges messages by limits, and remembers what is wrong: a state, and a step that makes the next one of it.

An alarm of a field that there is several times (joints, wheels, roles) is one for each of them. It rises to a level
whose limit has held for `persistence_s` of the stamps, falls as soon as no limit holds (each wider by the hysteresis
while the alarm is at its level or above), and is shown
    active          while it is not over
    latched         after that, until it has been acknowledged, at the worst level that it has had since it was last
An acknowledged alarm that rises higher has to be acknowledged again. (States as in IEC 62682:2014, sec. 5.4.)
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

from sojourn_contract.named_fields import FieldValue, NamedField, named_field, unknown_key
from sojourn_contract.stamps import NANOSECONDS
from sojourn_contract.topic_table import TopicTable
from sojourn_contract.values import Message
from sojourn_operator.alarms.events import Event
from sojourn_operator.alarms.params import AlarmParams, Severity

ALARM, OPERATOR = "alarm", "operator"


@dataclass(frozen=True)
class Alarm:
    """One alarm that has been looked at.

    Args:
        name: of its limits. label: of which of several, "" for one. value: last one. stamp: of it [ns].
        active: level now. worst: since it was last acknowledged and over. since: when it rose to `worst` [ns].
        acknowledged: by whom, "" by nobody. holding: since when each level's limit has held [ns].
    """

    name: str
    label: str
    value: FieldValue = 0.0
    stamp: int = 0
    active: Severity = Severity.NONE
    worst: Severity = Severity.NONE
    since: int = 0
    acknowledged: str = ""
    holding: Mapping[Severity, int] = field(default_factory=dict)

    @property
    def key(self) -> str:
        """By which an operator names it."""
        return f"{self.name}[{self.label}]" if self.label else self.name

    @property
    def is_shown(self) -> bool:
        """Whether anything is the matter, or has been and nobody has acknowledged it."""
        return self.worst > Severity.NONE

    @property
    def word(self) -> str:
        """Of its state."""
        if not self.is_shown:
            return "normal"
        state = "active" if self.active else "over"
        return f"{state}, acknowledged by {self.acknowledged}" if self.acknowledged else f"{state}, not acknowledged"


@dataclass(frozen=True)
class AlarmState:
    """All alarms that have been looked at, by key; and fields that their topics do not have, told once each."""

    alarms: Mapping[str, Alarm] = field(default_factory=dict)
    missing: frozenset[str] = frozenset()

    @property
    def shown(self) -> list[Alarm]:
        """Those that are to be seen, the worst first, of these the latest."""
        found = [alarm for alarm in self.alarms.values() if alarm.is_shown]
        return sorted(found, key=lambda alarm: (bool(alarm.acknowledged), -alarm.worst, -alarm.since, alarm.key))

    @property
    def worst(self) -> Severity:
        """Of all that nobody has acknowledged."""
        return max((alarm.worst for alarm in self.shown if not alarm.acknowledged), default=Severity.NONE)


class AlarmEngine:
    """Of a set of limits.

    Args:
        limits: alarms by name. table: the topics of the run.

    Raises:
        UnknownFieldNameError: a field that no message of the run has.
    """

    def __init__(self, limits: Mapping[str, AlarmParams], table: TopicTable) -> None:
        self.limits = dict(limits)
        self.fields: dict[str, NamedField] = {
            name: named_field(params.field, table) for name, params in self.limits.items()
        }
        self._by_topic: dict[str, list[str]] = {}
        for name, one in self.fields.items():
            self._by_topic.setdefault(one.row.name, []).append(name)

    @property
    def topics(self) -> tuple[str, ...]:
        """That it goes by."""
        return tuple(self._by_topic)

    def initial_state(self) -> AlarmState:
        """Before the first message."""
        return AlarmState()

    def step(self, state: AlarmState, topic: str, message: Message) -> tuple[AlarmState, list[Event]]:
        """Look at a message; the next state, and what has happened. A topic of which no alarm is leaves it as it is."""
        changed: dict[str, Alarm] = {}
        events: list[Event] = []
        missing = set(state.missing)
        for name in self._by_topic.get(topic, ()):
            one, found = self.fields[name], False
            for label, value in one.values(message):
                found = True
                alarm = state.alarms.get(f"{name}[{label}]" if label else name) or Alarm(name, label)
                after = self._judged(alarm, value, message.stamp)
                changed[after.key] = after
                events += self._told(alarm, after)
            if (
                not found
                and not one.which  # another message of the topic may have it
                and name not in missing
                and (wrong := unknown_key(one, message)) is not None
            ):
                missing.add(name)
                events.append(Event(message.stamp, name, ALARM, Severity.NONE, f"cannot be judged: {wrong}"))
        if not changed and len(missing) == len(state.missing):
            return state, events
        return AlarmState({**state.alarms, **changed}, frozenset(missing)), events

    def acknowledge(
        self, state: AlarmState, stamp: int, who: str, keys: Iterable[str] = ()
    ) -> tuple[AlarmState, list[Event]]:
        """An operator has seen these alarms, all that are shown where none is named; what is over is so forgotten.

        Raises KeyError for one that is not shown.
        """
        shown = {alarm.key: alarm for alarm in state.shown}
        changed, events = dict(state.alarms), []
        for key in list(keys) or list(shown):
            alarm = shown[key]
            if alarm.acknowledged:
                continue
            events.append(Event(stamp, who, OPERATOR, Severity.NONE, f"acknowledged {alarm.worst.word} {key}"))
            changed[key] = replace(alarm, acknowledged=who) if alarm.active else _cleared(alarm)
        return replace(state, alarms=changed), events

    def _judged(self, alarm: Alarm, value: FieldValue, stamp: int) -> Alarm:
        """After a value."""
        params = self.limits[alarm.name]
        holding: dict[Severity, int] = {}
        active = Severity.NONE
        for severity, limit in params.levels.items():
            slack = params.hysteresis if alarm.active >= severity else 0.0
            if not limit.holds(value, slack):
                continue
            holding[severity] = alarm.holding.get(severity, stamp)
            lasted = stamp - holding[severity] >= round(params.persistence_s * NANOSECONDS)
            if lasted or alarm.active >= severity:
                active = max(active, severity)
        after = replace(alarm, value=value, stamp=stamp, active=active, holding=holding)
        if active > alarm.worst:
            return replace(after, worst=active, since=stamp, acknowledged="")
        if active is Severity.NONE and alarm.is_shown and (alarm.acknowledged or not params.latched):
            return _cleared(after)
        return after

    def _told(self, before: Alarm, after: Alarm) -> Sequence[Event]:
        """What has happened to an alarm."""
        if after.active == before.active:
            return ()
        params = self.limits[after.name]
        what = f"{params.field}{f'[{after.label}]' if after.label else ''} = {shown_value(after.value)}"
        if after.active > before.active:
            text = f"{what}, {params.levels[after.active]}" + (f": {params.help}" if params.help else "")
            return (Event(after.stamp, after.key, ALARM, after.active, text),)
        over = "over" if after.active is Severity.NONE else f"down to {after.active.word}"
        return (Event(after.stamp, after.key, ALARM, Severity.NONE, f"{over}: {what}"),)


def shown_value(value: FieldValue) -> str:
    """A value as a person reads it."""
    return f"{value:.4g}" if isinstance(value, float) else repr(value)


def _cleared(alarm: Alarm) -> Alarm:
    return replace(alarm, worst=Severity.NONE, since=0, acknowledged="")
