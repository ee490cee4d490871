"""Tasks that are one goal of the arm: unfold, stow, place the turret."""

from dataclasses import dataclass, replace
from typing import Self

from sojourn_flight.arm.goals import ArmGoal
from sojourn_flight.arm.phases import ArmStatus
from sojourn_flight.arm.tasks.task import Doing, DoingState, TaskView

_STATES: dict[ArmStatus, DoingState] = {
    "holding": "failed",
    "stopped": "failed",
    "refused": "failed",
    "reached": "reached",
}


@dataclass(frozen=True, slots=True)
class Go:
    """Send the goal, then wait for what becomes of it."""

    goal: ArmGoal
    sent: bool = False

    def advance(self, view: TaskView, dt: float) -> tuple[Self, Doing]:
        """See `Task`."""
        if not self.sent:
            return replace(self, sent=True), Doing(goal=self.goal)
        return self, Doing(state=_STATES.get(view.status, "moving"), reason=view.reason)
