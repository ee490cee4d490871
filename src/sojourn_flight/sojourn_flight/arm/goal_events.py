"""What becomes of a goal, as events: each is told once, in the period in which it happens."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

Outcome: TypeAlias = Literal["accepted", "refused", "paused", "reached", "stopped", "failed"]


@dataclass(frozen=True, slots=True)
class GoalEvent:
    """Of the last goal, a task or a jog as well."""

    outcome: Outcome
    reason: str = ""
    """In words, for the operator."""

    @property
    def is_answer(self) -> bool:
        """Whether it says that a goal was taken, or not; the others say how one has ended."""
        return self.outcome in ("accepted", "refused")


ACCEPTED = GoalEvent("accepted")


def was(outcome: Outcome, events: Sequence[GoalEvent]) -> bool:
    """Whether this is among what has happened."""
    return any(event.outcome == outcome for event in events)
