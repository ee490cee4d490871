"""Task: advance along a line until the tool presses with a force, then stop and stay in touch.

    advance   the tip's reference runs at the speed asked for, slowed down over its first millimetres by the
              acceleration limit; the joints' servos and the wheels' soil are the spring that a contact presses against
    touch     from the period in which the pressing force is at the threshold the force loop of `force_control` holds
              the threshold, so that the servos' integrals do not go on pushing; after `SETTLE` within the deadband and
              its tolerance, or after `LONGEST`, the task has ended. The loop goes on until the next goal
    retract   if asked for: back along the line with the speed of the advance

Told: the largest pressing force above the threshold, and how far the measured tip went on after it was crossed.
"""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from sojourn_flight.arm.force_control import hybrid_velocity, pressing
from sojourn_flight.arm.tasks.task import Doing, DoingState, TaskView
from sojourn_machine.params import FloatArray

SETTLE = 0.4
"""Time within the tolerance before the contact counts as held [s]."""
LONGEST = 4.0
"""Time after the contact within which the force is to settle [s]."""
TOLERANCE = 2.0
"""Of the force, to count as settled [N]."""
BLIND = 0.06
"""Time at the start in which the inertia of the tool may be taken for a contact [s]."""
ZERO = np.zeros(3)


@dataclass(frozen=True, slots=True)
class GuardedMoveTask:
    """Phases advance, touch, retract, hold."""

    direction: FloatArray
    start: FloatArray
    speed: float
    threshold: float
    distance: float
    retract: float
    first: FloatArray
    """Tip where it began (3,) [m]; `start` is that of the present phase."""
    phase: str = "advance"
    contact: FloatArray | None = None
    elapsed: float = 0.0
    settled: float = 0.0
    peak: float = 0.0
    went_on: float = 0.0

    def advance(self, view: TaskView, dt: float) -> tuple[Self, Doing]:
        """See `Task`."""
        if not view.feels:
            return self, Doing(state="failed", reason="the wrist's sensor says nothing: no contact would be felt")
        force = pressing(self.direction, view.force)
        task = replace(self, elapsed=self.elapsed + dt)
        if task.contact is None:
            return task._advance(view, force)
        if task.phase == "retract":
            return task._retract(view, force)
        went_on = float(task.direction @ (view.tip.position - task.contact))
        task = replace(task, peak=max(task.peak, force), went_on=max(task.went_on, went_on))
        return task._touch(view, force, dt)

    def _advance(self, view: TaskView, force: float) -> tuple[Self, Doing]:
        gone = float(self.direction @ (view.tip.position - self.start))
        if force >= self.threshold:
            if gone < 1e-3 and self.elapsed <= BLIND:
                return self, self._ended("failed", "the tool presses already before it has moved", force)
            touched = replace(self, phase="touch", contact=view.tip.position, elapsed=0.0, peak=force)
            return touched, touched._doing(view, force, "moving")
        if gone >= self.distance:
            reason = f"no contact of {self.threshold:g} N within {self.distance * 1e3:.0f} mm"
            return self, self._ended("failed", reason, force)
        left = max(self.distance - gone, 0.0)
        return self, Doing(
            velocity=self.speed * self.direction,
            progress=min(max(gone / self.distance, 0.0), 1.0),
            time_to_go=left / self.speed,
            figures={"contact_force_n": force},
        )

    def _touch(self, view: TaskView, force: float, dt: float) -> tuple[Self, Doing]:
        near = abs(force - self.threshold) <= TOLERANCE
        task = replace(self, settled=self.settled + dt if near else 0.0)
        if task.phase == "hold":
            return task, task._doing(view, force, "reached")
        if task.settled < SETTLE and task.elapsed < LONGEST:
            return task, task._doing(view, force, "moving")
        if task.retract > 0.0:
            return replace(task, phase="retract", start=view.tip.position), task._doing(view, force, "moving")
        task = replace(task, phase="hold")
        return task, task._doing(view, force, "reached")

    def _retract(self, view: TaskView, force: float) -> tuple[Self, Doing]:
        back = -float(self.direction @ (view.tip.position - self.start))
        if back >= self.retract:
            return self, self._ended("reached", self._words(), force)
        doing = self._doing(view, force, "moving")
        return self, replace(
            doing, velocity=-self.speed * self.direction, time_to_go=(self.retract - back) / self.speed
        )

    def _doing(self, view: TaskView, force: float, state: DoingState) -> Doing:
        """In touch: the force loop works."""
        velocity = hybrid_velocity(view.control, self.direction, self.threshold, view.force, ZERO)
        reason = self._words() if state == "reached" else ""
        if state == "reached" and self.settled < SETTLE:
            reason += f"; in touch with {force:.1f} N instead of {self.threshold:g} N"
        return Doing(velocity=velocity, state=state, reason=reason, progress=1.0, figures=self._figures(force))

    def _ended(self, state: DoingState, reason: str, force: float) -> Doing:
        return Doing(velocity=ZERO, state=state, reason=reason, progress=1.0, figures=self._figures(force))

    def _words(self) -> str:
        """What was found, for the operator."""
        way = 0.0 if self.contact is None else float(self.direction @ (self.contact - self.first))
        beyond = max(self.peak - self.threshold, 0.0)
        went_on = max(self.went_on, 0.0) * 1e3
        return f"touched after {way * 1e3:.1f} mm, {beyond:.1f} N and {went_on:.2f} mm beyond {self.threshold:g} N"

    def _figures(self, force: float) -> dict[str, float]:
        figures = {"contact_force_n": force}
        if self.contact is not None:
            figures["peak_force_n"] = self.peak
            figures["overshoot_n"] = max(self.peak - self.threshold, 0.0)
            figures["overshoot_m"] = max(self.went_on, 0.0)
        return figures
