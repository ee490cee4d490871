"""Makes the one log of what nodes, goals and the contract say: events from their messages, each change once."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from sojourn_contract.heartbeat import ENDED, STALLED, Heartbeat, read_heartbeats, status_values
from sojourn_contract.stamps import NANOSECONDS
from sojourn_contract.topic_table import TopicTable
from sojourn_contract.values import (
    DiagnosticArray,
    Header,
    JointState,
    JointTrajectory,
    Message,
    Path,
    PoseStamped,
    PoseWithCovarianceStamped,
    TwistStamped,
)
from sojourn_operator.alarms.beats import Beats
from sojourn_operator.alarms.events import Event
from sojourn_operator.alarms.params import Severity

HEARTBEATS = "/diagnostics"
STATUSES: Mapping[str, tuple[tuple[str, str], ...]] = {
    "/drive/status": (("state", "reason"), ("placed_state", "placed_reason")),
    "/arm/status": (("state", "reason"),),
    "/power/status": (("mode", "mode_reason"), ("state", "reason"), ("request_state", "request_reason")),
}
"""Of each status: keys whose changes are told, each with that of its reason."""
TOLD = ("faults", "rolled over", "off the terrain", "lost commands")
"""Keys of heartbeats whose changes are told, where they say anything."""
QUIET = ("", "false", "none", "idle")
MISSED = 3
"""Heartbeats that a role has missed which is silent; there is one a second."""
STREAM_S = 2.0
"""Velocities that come more often than this are one command [s]."""
NODE, GOAL, CONTRACT = "node", "goal", "contract"


class Velocity(NamedTuple):
    """The last of a stream of velocities: when [ns], and whether it moves anything."""

    stamp: int
    moves: bool


@dataclass(frozen=True)
class NarratorState:
    """What has been told.

    Args:
        said: last words by (topic or role, key). beats: last heartbeat of each role. heard: when that was.
        silent: roles that are. commanded: the last velocity of each stream of them.
    """

    said: Mapping[tuple[str, str], str] = field(default_factory=dict)
    beats: Mapping[str, Heartbeat] = field(default_factory=dict)
    heard: Beats = field(default_factory=Beats)
    silent: frozenset[str] = frozenset()
    commanded: Mapping[str, Velocity] = field(default_factory=dict)


class Narrator:
    """Of a run with these topics."""

    def __init__(self, table: TopicTable) -> None:
        self.goals = {row.name for row in table if row.publisher == "operator" and row.is_event and row.subscribers}

    @property
    def topics(self) -> tuple[str, ...]:
        """That it listens to."""
        return (HEARTBEATS, *STATUSES, *sorted(self.goals))

    def initial_state(self) -> NarratorState:
        """Before the first message."""
        return NarratorState()

    def step(self, state: NarratorState, topic: str, message: Message) -> tuple[NarratorState, list[Event]]:
        """Hear a message; the next state, and what is new."""
        if topic == HEARTBEATS:
            return self._hear_beats(state, message)
        if topic in STATUSES:
            said, events = dict(state.said), list(_changes(state, topic, message))
            said |= {(topic, key): status_values(message).get(key, "") for key, _ in STATUSES[topic]}
            return replace(state, said=said), events
        if topic in self.goals:
            event = Event(message.stamp, "operator", GOAL, Severity.NONE, f"{topic}: {goal_words(message)}")
            if not isinstance(message, TwistStamped):  # a velocity after it is a new command
                return replace(state, commanded={}), [event]
            before, now = state.commanded.get(topic), _velocity(message)
            state = replace(state, commanded={**state.commanded, topic: now})
            return state, [] if before is not None and _goes_on(before, now) else [event]
        return state, []

    def _hear_beats(self, state: NarratorState, message: DiagnosticArray) -> tuple[NarratorState, list[Event]]:
        beats, heard, silent = dict(state.beats), state.heard, set(state.silent)
        events: list[Event] = []
        for beat in read_heartbeats(message):
            events += _beat_events(beats.get(beat.role), beat)
            beats[beat.role], heard = beat, heard.after(beat)
            if beat.role in silent:
                silent.discard(beat.role)
                events.append(Event(beat.stamp, beat.role, NODE, Severity.NONE, "is heard again"))
        for role, gone in heard.silent(MISSED).items():
            if role not in silent and beats[role].state != ENDED:
                silent.add(role)
                events.append(Event(message.stamp, role, NODE, Severity.WARNING, f"has been silent for {gone:.0f} s"))
        return replace(state, beats=beats, heard=heard, silent=frozenset(silent)), events


def goal_words(message: Message) -> str:
    """A goal in a few words."""
    if isinstance(message, DiagnosticArray):
        return "; ".join(
            " ".join((one.name, *(f"{key}={value}" for key, value in one.values))) for one in message.status
        )
    if isinstance(message, Path):
        if not message.poses:
            return "no points"
        x, y, _ = message.poses[-1].position
        return f"{len(message.poses)} points to ({x:.2f}, {y:.2f})"
    if isinstance(message, Header):
        return message.frame or "sent"
    if isinstance(message, JointState | JointTrajectory):
        return message.frame or f"{len(message.names)} joints"
    if isinstance(message, TwistStamped):
        return f"{message.linear[0]:.2f} m/s, {message.angular[2]:.2f} rad/s"
    if isinstance(message, PoseStamped | PoseWithCovarianceStamped):
        return ", ".join(f"{value:.2f}" for value in message.position) + f" in {message.frame or 'map'}"
    return "sent"


def _velocity(message: TwistStamped) -> Velocity:
    return Velocity(message.stamp, bool(np.any(message.linear) or np.any(message.angular)))


def _goes_on(before: Velocity, now: Velocity) -> bool:
    """Whether a velocity belongs to the command of the one before it. A stop after a motion never does, nor does what
    comes after a jump of time.
    """
    return now.moves == before.moves and abs(now.stamp - before.stamp) < STREAM_S * NANOSECONDS


def _changes(state: NarratorState, topic: str, message: DiagnosticArray) -> Iterator[Event]:
    """Of the words of a status."""
    values = status_values(message)
    who = message.status[0].name if message.status else topic
    for key, reason in STATUSES[topic]:
        now = values.get(key, "")
        before = state.said.get((topic, key), "")
        if now != before and now not in QUIET:
            why = values.get(reason, "")
            kind = NODE if topic.startswith("/power") else GOAL
            yield Event(message.stamp, who, kind, Severity.NONE, f"{now}: {why}" if why else now)


def _beat_events(before: Heartbeat | None, beat: Heartbeat) -> Iterator[Event]:
    """What is new in a heartbeat of a role."""
    if beat.state != (before.state if before else ""):
        severity = Severity.CRITICAL if beat.state == STALLED else Severity.NONE
        detail = f": {beat.detail}" if beat.detail not in ("", beat.state) else ""
        yield Event(beat.stamp, beat.role, NODE, severity, beat.state + detail)
    for key in TOLD:
        now, old = beat.values.get(key, ""), before.values.get(key, "") if before else ""
        if now != old and now not in QUIET:
            yield Event(beat.stamp, beat.role, NODE, Severity.NONE, f"{key}: {now}")
    for topic, count in beat.refused.items():
        more = count - (before.refused.get(topic, 0) if before else 0)
        if more > 0:
            text = f"refused {more} on {topic}: {beat.values.get('last refusal', '')}"
            yield Event(beat.stamp, beat.role, CONTRACT, Severity.NONE, text)
