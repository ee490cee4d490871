"""What a role of a run is at the end of a control period, and what of it goes on from there."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from sojourn_contract.events import EventQueue
from sojourn_contract.heard import Took
from sojourn_contract.heartbeat import Counters
from sojourn_contract.leaps import NO_LEAPS, Leaps
from sojourn_contract.values import Message
from sojourn_machine.evolution import replace

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
    took: tuple[Took, ...] = ()
    """Goals whose stamp does not say when they took effect, since its last heartbeat."""

    @property
    def counters(self) -> Counters:
        """For a heartbeat."""
        return Counters(dict(self.published), dict(self.refused), self.last_refusal)

    def refusing(self, name: str, reason: str) -> "RoleState":
        """One more message on a topic was refused."""
        refused = {**self.refused, name: self.refused.get(name, 0) + 1}
        return replace(self, refused=refused, last_refusal=reason)


@dataclass(frozen=True, slots=True)
class RoleAtCheckpoint:
    """What a role hands over at a checkpoint, and is handed back where the run goes on.

    Args:
        role: its state. period: the control period that is acted on next, by all. leaps: of the clock, so far.
        messages: by topic and stamp [ns]. Handed over: what the role has said, as far as somebody waits for it, and
            what it has heard of nodes that are not ours. Handed back: what it has said and what it waits for.
        ahead: what it has said and belongs to a period to come, by topic.
    """

    role: RoleState
    period: int
    messages: Mapping[str, Mapping[int, Heard]] = field(default_factory=dict)
    ahead: tuple[tuple[str, Message], ...] = ()
    leaps: Leaps = NO_LEAPS


@dataclass(frozen=True, slots=True)
class ForeignState:
    """Of a node that is not ours: the text that it has handed over; nobody else can read it."""

    text: str
