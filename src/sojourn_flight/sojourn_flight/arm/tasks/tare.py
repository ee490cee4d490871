"""Task: find the bias of the wrist's sensor, the tool hanging free and the arm at rest.

The bias of each axis is the mean of what is left of the readings when the known weight of the tool is taken off; noise
of one reading over the square root of their number stays in it. An arm that still moves comes to rest first.
"""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from sojourn_flight.arm.tasks.task import Doing, TaskView
from sojourn_machine.params import FloatArray


@dataclass(frozen=True, slots=True)
class TareTask:
    """Mean of the readings over `seconds`."""

    seconds: float
    total: FloatArray
    readings: int = 0
    elapsed: float = 0.0
    done: bool = False

    def advance(self, view: TaskView, dt: float) -> tuple[Self, Doing]:
        """See `Task`."""
        if self.done:
            return self, Doing(state="reached", progress=1.0)
        if not view.feels:
            return self, Doing(state="failed", reason="the wrist's sensor says nothing")
        if view.status == "moving" and not self.readings:
            return self, Doing(time_to_go=self.seconds)
        after = replace(self, total=self.total + view.wrench, readings=self.readings + 1, elapsed=self.elapsed + dt)
        left = self.seconds - after.elapsed
        if left > 1e-9:
            return after, Doing(progress=after.elapsed / self.seconds, time_to_go=left)
        bias = after.total / after.readings
        figures = {"bias_force_n": float(np.linalg.norm(bias[:3])), "bias_moment_nm": float(np.linalg.norm(bias[3:]))}
        return replace(after, done=True), Doing(state="reached", progress=1.0, bias=bias, figures=figures)
