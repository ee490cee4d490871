"""A task that leads the tip begins with the arm at rest: its line is looked at, and its way counted, from there."""

from dataclasses import dataclass

import numpy as np

from sojourn_flight.arm.model import ArmModel
from sojourn_flight.arm.phases import Stopping
from sojourn_flight.arm.state import ArmState
from sojourn_flight.arm.tasks.task import Doing, Task, TaskView
from sojourn_flight.arm.trajectory import stop
from sojourn_machine.params import FloatArray

_STILL = 0.005
"""Rate below which a joint rests: stopped from there, the tip goes on by a fraction of a millimetre [rad/s or m/s]."""
_ASTRAY = 0.02
"""Distance from where the line was looked at, at which it is not the one that was allowed [m]."""


@dataclass(frozen=True, slots=True)
class AtRest:
    """Waits until the arm, which is told to stop by giving it nothing to do, rests; then `task` begins."""

    task: Task
    place: FloatArray
    """Of the tip then (3,) [m]."""

    def advance(self, view: TaskView, dt: float) -> tuple[Task, Doing]:
        """See `Task`."""
        if view.status == "moving":
            return self, Doing(reason="the arm comes to rest first")
        astray = float(np.linalg.norm(view.tip.position - self.place))
        if astray > _ASTRAY:
            return self, Doing(state="failed", reason=f"the arm rests {astray * 1e3:.0f} mm from where it was to begin")
        return self.task.advance(view, dt)


def moves(arm: ArmState) -> bool:
    """Whether the reference of the joints moves."""
    return arm.started and float(np.max(np.abs(arm.reference.velocity))) > _STILL


def posture_at_rest(model: ArmModel, arm: ArmState) -> FloatArray:
    """Joint positions (n,) [rad or m] in which an arm that has started rests, or will, if it is stopped now."""
    if not moves(arm):
        return arm.reference.position
    if isinstance(arm.phase, Stopping):
        return arm.target.joints
    path = stop(model, arm.reference)
    return path.sample(path.duration)[0]
