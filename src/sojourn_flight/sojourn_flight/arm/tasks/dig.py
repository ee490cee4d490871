"""Task: dig a furrow with a scoop: open it, touch the ground, push it in, drag it, shut it, and lift it out.

    open    the lid, before anything moves; what the scoop still held falls out
    touch   the guarded advance along the direction, down to a force of `TOUCH`
    sink    on along the direction until the tip is `depth` below the place of the touch
    drag    along the ground; along the direction the reference keeps the depth like a spring and a damper whose force
            is never above `most`: it gives way as  M a + D v + K (x - x0) = f - min(f, most)  (impedance control, see
            `force_control`), so that a stone is ridden over and not broken
    shut    the lid, the tool standing in the ground
    lift    back out to where the advance began

A tool that does not get to its depth with the force that it may use drags at the depth that it has got. Told: depth
below the touch, the largest force along and across the direction, and the work that the tool has done on the ground.
"""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from sojourn_flight.arm.force_control import impedance_velocity, pressing
from sojourn_flight.arm.tasks.task import Doing, DoingState, TaskView, ToolCommand, ToolReading
from sojourn_machine.params import FloatArray

TOUCH = 4.0
"""Pressing force at which the ground is found [N]."""
MASS, DAMPING, STIFFNESS = 20.0, 6000.0, 3000.0
"""Of the reference that gives way while the tool is dragged [kg], [N s/m], [N/m]."""
LID_TOLERANCE, LID_PATIENCE = 0.05, 10.0
"""[rad], [s]"""


@dataclass(frozen=True, slots=True)
class DigTask:
    """Phases open, touch, sink, drag, shut, lift, done."""

    direction: FloatArray
    along: FloatArray
    depth: float
    length: float
    speed: float
    most: float
    reach: float
    first: FloatArray
    """Tip where the advance begins (3,) [m]."""
    touched: FloatArray
    """Tip where the ground was felt; before that as `first`."""
    begun: FloatArray
    """Tip where the drag begins; before that as `first`."""
    lid: float
    """Opening of the scoop's lid [rad]."""
    phase: str = "open"
    waited: float = 0.0
    """For the lid [s]."""
    yielded: float = 0.0
    """Speed of the reference out of the ground [m/s]."""
    offset: float = 0.0
    """Of the reference out of the ground [m]."""
    last: FloatArray | None = None
    down: float = 0.0
    across: float = 0.0
    deepest: float = 0.0
    work: float = 0.0
    failed: str = ""

    def advance(self, view: TaskView, dt: float) -> tuple[Self, Doing]:
        """See `Task`."""
        tip, force = view.tip.position, pressing(self.direction, view.force)
        if not view.feels:
            return self, Doing(state="failed", reason="the wrist's sensor says nothing")
        task = self._account(tip, view.force, force)
        if task.failed or task.phase == "done":
            return task, task._doing(np.zeros(3), force, 1.0)
        if task.phase in ("open", "shut"):
            return task._wait_for_lid(view.tool, force, dt)
        if task.phase == "touch":
            return task._touch(tip, force)
        if task.phase == "sink":
            return task._sink(tip, force)
        if task.phase == "drag":
            return task._drag(tip, force, dt)
        out = -float(task.direction @ (tip - task.first))
        if out >= -1e-3:
            task = replace(task, phase="done")
        return task, task._doing(-2.0 * task.speed * task.direction, force, 0.9)

    def _account(self, tip: FloatArray, force: FloatArray, down: float) -> Self:
        """Largest forces, depth and work so far."""
        if self.phase in ("open", "touch"):
            return replace(self, last=tip)
        across = force + down * self.direction
        step = np.zeros(3) if self.last is None else tip - self.last
        return replace(
            self,
            last=tip,
            down=max(self.down, down),
            across=max(self.across, float(np.linalg.norm(across))),
            deepest=max(self.deepest, float(self.direction @ (tip - self.touched))),
            work=self.work - float(force @ step),
        )

    def _wait_for_lid(self, tool: ToolReading | None, force: float, dt: float) -> tuple[Self, Doing]:
        wanted = self.lid if self.phase == "open" else 0.0
        task = replace(self, waited=self.waited + dt)
        if tool is not None and abs(tool.position - wanted) < LID_TOLERANCE:
            task = replace(task, phase="touch" if self.phase == "open" else "lift", waited=0.0)
        elif task.waited > LID_PATIENCE:
            stands = "does not tell its place" if tool is None else f"stands at {tool.position:.2f} rad"
            task = replace(task, failed=f"the lid {stands} after {LID_PATIENCE:g} s: told was {wanted:.2f} rad")
        doing = task._doing(np.zeros(3), force, 0.0 if self.phase == "open" else 0.9)
        return task, replace(doing, tool=ToolCommand(wanted))

    def _touch(self, tip: FloatArray, force: float) -> tuple[Self, Doing]:
        if force >= TOUCH:
            task = replace(self, phase="sink", touched=tip)
            return task, task._doing(self.speed * self.direction, force, 0.1)
        if float(self.direction @ (tip - self.first)) >= self.reach:
            task = replace(self, failed=f"no ground within {self.reach * 1e3:.0f} mm")
            return task, task._doing(np.zeros(3), force, 0.0)
        return self, self._doing(self.speed * self.direction, force, 0.0)

    def _sink(self, tip: FloatArray, force: float) -> tuple[Self, Doing]:
        gone = float(self.direction @ (tip - self.touched))
        if gone >= self.depth or force >= self.most:
            task = replace(self, phase="drag", begun=tip)
            return task, task._doing(self.speed * self.along, force, 0.3)
        return self, self._doing(self.speed * self.direction, force, 0.1 + 0.2 * max(gone, 0.0) / self.depth)

    def _drag(self, tip: FloatArray, force: float, dt: float) -> tuple[Self, Doing]:
        gone = float(self.along @ (tip - self.begun))
        if gone >= self.length:
            task = replace(self, phase="shut")
            return task, task._doing(np.zeros(3), force, 0.9)
        excess = max(force - self.most, 0.0)
        out = impedance_velocity(MASS, DAMPING, STIFFNESS, self.offset, self.yielded, excess, dt)
        if self.offset + out * dt < 0.0:
            out = -self.offset / dt
        task = replace(self, yielded=out, offset=self.offset + out * dt)
        velocity = self.speed * self.along - out * self.direction
        return task, task._doing(velocity, force, 0.3 + 0.6 * max(gone, 0.0) / self.length)

    def _doing(self, velocity: FloatArray, force: float, progress: float) -> Doing:
        left = {"touch": self.depth + self.length, "sink": self.depth + self.length, "drag": self.length}
        state: DoingState = "failed" if self.failed else "reached" if self.phase == "done" else "moving"
        words = (
            f"dug {self.deepest * 1e3:.0f} mm deep over {self.length * 1e3:.0f} mm: at most {self.down:.1f} N down and "
            f"{self.across:.1f} N along, {self.work:.2f} J"
        )
        return Doing(
            velocity=velocity,
            state=state,
            reason=self.failed or (words if state == "reached" else ""),
            progress=1.0 if state == "reached" else min(progress, 1.0),
            time_to_go=0.0 if state != "moving" else (1.0 - progress) * left.get(self.phase, self.depth) / self.speed,
            figures={
                "contact_force_n": force,
                "depth_m": self.deepest,
                "peak_force_n": self.down,
                "peak_drag_n": self.across,
                "work_j": self.work,
            },
        )
