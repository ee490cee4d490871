"""Task: press along a direction with a force for a time, and go on pressing until the next goal.

The force loop of `force_control` along the direction, nothing across it. A tool that does not touch yet moves towards
the ground with `max_speed` at most, for no more than the distance that the task allows. Time counts while the force is
within the tolerance. Told: the largest error and the mean square error of the force since it was first within the
tolerance.
"""

import math
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from sojourn_flight.arm.force_control import hybrid_velocity, pressing
from sojourn_flight.arm.tasks.task import Doing, TaskView
from sojourn_machine.params import FloatArray

PATIENCE = 40.0
"""Time out of the tolerance after which the force cannot be held [s]."""
ZERO = np.zeros(3)


@dataclass(frozen=True, slots=True)
class HoldForceTask:
    """Force loop with a clock."""

    direction: FloatArray
    start: FloatArray
    force: float
    seconds: float
    tolerance: float
    distance: float
    held: float = 0.0
    off: float = 0.0
    square: float = 0.0
    worst: float = 0.0
    watched: float = 0.0
    failed: str = ""

    def advance(self, view: TaskView, dt: float) -> tuple[Self, Doing]:
        """See `Task`."""
        if not view.feels:
            return self, Doing(state="failed", reason="the wrist's sensor says nothing")
        if self.failed:
            return self, Doing(velocity=ZERO, state="failed", reason=self.failed)
        present = pressing(self.direction, view.force)
        error = present - self.force
        within = abs(error) <= self.tolerance
        task = replace(self, held=self.held + dt if within else self.held, off=0.0 if within else self.off + dt)
        if task.held > 0.0:
            square, worst = task.square + error * error * dt, max(task.worst, abs(error))
            task = replace(task, square=square, worst=worst, watched=task.watched + dt)
        gone = float(task.direction @ (view.tip.position - task.start))
        if abs(gone) > task.distance:
            task = replace(task, failed=f"no force of {task.force:g} N within {task.distance * 1e3:.0f} mm")
        elif task.off > PATIENCE:
            task = replace(task, failed=f"{present:.1f} N instead of {task.force:g} N for {PATIENCE:g} s")
        figures = {
            "contact_force_n": present,
            "worst_error_n": task.worst,
            "rms_error_n": math.sqrt(task.square / task.watched) if task.watched else 0.0,
        }
        if task.failed:
            return task, Doing(velocity=ZERO, state="failed", reason=task.failed, figures=figures)
        left = max(task.seconds - task.held, 0.0)
        done = left == 0.0 and task.held > 0.0
        return task, Doing(
            velocity=hybrid_velocity(view.control, task.direction, task.force, view.force, ZERO),
            state="reached" if done else "moving",
            progress=1.0 if done or task.seconds == 0.0 else task.held / task.seconds,
            time_to_go=left,
            figures=figures,
        )
