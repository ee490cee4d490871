"""Task: empty the scoop where it is: open its lid, wait until all has fallen out, and shut it."""

from dataclasses import dataclass, replace
from typing import Self

from sojourn_flight.arm.tasks.dig import LID_PATIENCE, LID_TOLERANCE
from sojourn_flight.arm.tasks.task import Doing, TaskView, ToolCommand

TOUCH = 4.0
"""Force at which the scoop stands in the ground, and would empty itself into its own hole [N]."""


@dataclass(frozen=True, slots=True)
class DumpTask:
    """Phases open, shut, done."""

    lid: float
    """Its opening [rad]."""
    seconds: float
    phase: str = "open"
    waited: float = 0.0
    """In this phase [s]."""
    held: float = 0.0
    """For which it has been open [s]."""

    def advance(self, view: TaskView, dt: float) -> tuple[Self, Doing]:
        """See `Task`."""
        if self.phase == "done":
            return self, Doing(state="reached", progress=1.0)
        force = float(view.force @ view.force) ** 0.5
        if self.phase == "open" and self.held == 0.0 and force > TOUCH:
            return self, Doing(state="failed", reason=f"the scoop touches the ground with {force:.1f} N: lift it first")
        wanted = self.lid if self.phase == "open" else 0.0
        there = view.tool is not None and abs(view.tool.position - wanted) < LID_TOLERANCE
        task = replace(self, waited=self.waited + dt)
        command = ToolCommand(wanted)
        if there and self.phase == "open":
            task = replace(task, held=self.held + dt, waited=0.0)
            if task.held >= self.seconds:
                task = replace(task, phase="shut")
        elif there:
            return replace(task, phase="done"), Doing(state="reached", progress=1.0, tool=command)
        elif task.waited > LID_PATIENCE:
            return task, Doing(state="failed", reason=f"the lid does not move: told was {wanted:.2f} rad", tool=command)
        progress = 0.5 * min(self.held / self.seconds, 1.0) if self.phase == "open" else 0.5
        return task, Doing(progress=progress, time_to_go=max(self.seconds - self.held, 0.0), tool=command)
