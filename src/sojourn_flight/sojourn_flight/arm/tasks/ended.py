"""What is left of a task that was given up: its last words, and, where the tool still touches, no force."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from sojourn_flight.arm.force_control import hybrid_velocity
from sojourn_flight.arm.tasks.activity import RunningTask
from sojourn_flight.arm.tasks.task import Doing, TaskView
from sojourn_machine.params import FloatArray


@dataclass(frozen=True, slots=True)
class Ended:
    """Holds still."""

    reason: str

    def advance(self, view: TaskView, dt: float) -> tuple[Self, Doing]:
        """See `Task`."""
        return self, Doing(state="failed", reason=self.reason)


@dataclass(frozen=True, slots=True)
class Released:
    """Gives way along the unit `direction` in which the tool pressed, until it presses no more."""

    reason: str
    direction: FloatArray

    def advance(self, view: TaskView, dt: float) -> tuple[Self, Doing]:
        """See `Task`."""
        velocity = hybrid_velocity(view.control, self.direction, 0.0, view.force, np.zeros(3))
        return self, Doing(velocity=velocity, state="failed", reason=self.reason)


def given_up(name: str, reason: str) -> RunningTask:
    """A task that was given up, and holds still."""
    return RunningTask(name, Ended(reason), Doing(state="failed", reason=reason))
