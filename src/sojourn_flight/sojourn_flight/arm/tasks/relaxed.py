"""What is left of a motion that met something: the arm gives way until it presses no more, and stays yielding."""

from dataclasses import dataclass
from typing import Self

from sojourn_flight.arm.tasks.task import Doing, TaskView


@dataclass(frozen=True, slots=True)
class Relaxed:
    """Gives way to what is felt, see `contact_guard`."""

    reason: str

    def advance(self, view: TaskView, dt: float) -> tuple[Self, Doing]:
        """See `Task`."""
        return self, Doing(gives_way=True, state="failed", reason=self.reason)
