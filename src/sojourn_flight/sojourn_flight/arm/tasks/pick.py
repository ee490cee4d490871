"""Tasks of a gripper: pick an object, and let it go.

    over    by a goal of the arm, to `CLEAR` before the object along the approach, the fingers opening
    down    along the approach, until the object's middle is where the gripper takes things; a contact with something
            else than the object on the way down, felt as `BUMP`, ends it there
    close   the fingers with the force asked for, until they press with it
    lift    back along the approach
    check   whether the fingers still press on something

The force that an object needs is known before it is touched where its mass and friction are: two opposite soft fingers
of `arm.grasp`, its weight and the acceleration limit of the tip, across the fingers.
"""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from sojourn_flight.arm.force_control import pressing
from sojourn_flight.arm.goals import PoseGoal
from sojourn_flight.arm.grasp import Finger, needed_force
from sojourn_flight.arm.tasks.task import Doing, DoingState, TaskView, ToolCommand, ToolReading
from sojourn_machine.params import FloatArray
from sojourn_machine.tools import GripperToolParams

CLEAR = 0.08
"""Of the tip before the object's middle, where the last way begins [m]."""
BUMP = 10.0
"""[N]"""
PRESSES, SHUT = 0.8, 1e-3
"""Part of the force from which the fingers hold; opening below which there is nothing between them [m]."""
PATIENCE = 10.0
"""For the fingers [s]."""
ZERO = np.zeros(3)


def grasp_needed(width: float, mass: float, friction: float, acceleration: float) -> float:
    """Force of two fingers `width` [m] apart that carries a mass [kg] with an acceleration [m/s2] beside them [N]."""
    half = 0.5 * width
    fingers = [
        Finger(np.array([0.0, side * half, 0.0]), np.array([0.0, -side, 0.0]), friction, torsion=0.1 * half)
        for side in (1.0, -1.0)
    ]
    return needed_force(fingers, np.zeros(3), np.array([0.0, 0.0, -mass * acceleration, 0.0, 0.0, 0.0]))


@dataclass(frozen=True, slots=True)
class PickTask:
    """Phases over, down, close, lift, done."""

    tool: GripperToolParams
    position: FloatArray
    direction: FloatArray
    force: float
    lift: float
    speed: float
    phase: str = "over"
    sent: bool = False
    waited: float = 0.0
    """For the fingers [s]."""
    grasped: FloatArray | None = None
    """Tip where the fingers closed (3,) [m]."""
    width: float = 0.0
    """Between the fingers then [m]."""
    failed: str = ""

    def advance(self, view: TaskView, dt: float) -> tuple[Self, Doing]:
        """See `Task`."""
        tool = view.tool
        if tool is None:
            return self, Doing(state="failed", reason="the gripper says nothing")
        if self.failed or self.phase == "done":
            return self, self._doing(tool, ZERO)
        if self.phase == "over":
            return self._over(view, tool, dt)
        if self.phase == "down":
            return self._down(view, tool)
        if self.phase == "close":
            return self._close(view, tool, dt)
        begun = self.position if self.grasped is None else self.grasped
        if float(self.direction @ (begun - view.tip.position)) < self.lift:
            return self, self._doing(tool, -self.speed * self.direction)
        if not self._holds(tool):
            return self._fail(f"it has slipped out: the fingers are {tool.position * 1e3:.1f} mm apart", tool)
        task = replace(self, phase="done")
        return task, task._doing(tool, ZERO)

    def _over(self, view: TaskView, tool: ToolReading, dt: float) -> tuple[Self, Doing]:
        start = self.position - CLEAR * self.direction
        opened = ToolCommand(self.tool.stroke)
        if not self.sent:
            x, y, z = (float(value) for value in start)
            along = (float(self.direction[0]), float(self.direction[1]), float(self.direction[2]))
            return replace(self, sent=True), Doing(goal=PoseGoal((x, y, z), along), tool=opened)
        if view.status == "moving":
            return self, Doing(tool=opened)
        if view.status != "reached":
            return self, Doing(state="failed", reason=view.reason, tool=opened)
        if tool.position < self.tool.stroke - 2.0 * SHUT:
            task = replace(self, waited=self.waited + dt)
            if task.waited > PATIENCE:
                return task._fail(f"the fingers open to {tool.position * 1e3:.1f} mm only", tool)
            return task, Doing(tool=opened)
        return replace(self, phase="down", waited=0.0), Doing(velocity=ZERO, tool=opened)

    def _down(self, view: TaskView, tool: ToolReading) -> tuple[Self, Doing]:
        left = float(self.direction @ (self.position - view.tip.position)) + self.tool.load_distance
        bumped = view.feels and pressing(self.direction, view.force) > BUMP
        if left <= 0.0 or bumped:
            task = replace(self, phase="close", grasped=view.tip.position)
            return task, task._doing(tool, ZERO)
        return self, self._doing(tool, self.speed * self.direction)

    def _close(self, view: TaskView, tool: ToolReading, dt: float) -> tuple[Self, Doing]:
        task = replace(self, waited=self.waited + dt, width=tool.position)
        if task._holds(tool):
            task = replace(task, phase="lift")
        elif tool.position < SHUT:
            return task._fail("the fingers have closed on nothing", tool)
        elif task.waited > PATIENCE:
            return task._fail(f"the fingers press with {tool.effort:.1f} N of {task.force:g} N", tool)
        return task, task._doing(tool, ZERO)

    def _holds(self, tool: ToolReading) -> bool:
        return tool.position > SHUT and tool.effort >= PRESSES * self.force

    def _fail(self, reason: str, tool: ToolReading) -> tuple[Self, Doing]:
        task = replace(self, failed=reason)
        return task, task._doing(tool, ZERO)

    def _doing(self, tool: ToolReading, velocity: FloatArray) -> Doing:
        state: DoingState = "failed" if self.failed else "reached" if self.phase == "done" else "moving"
        words = f"holds an object {self.width * 1e3:.1f} mm wide with {tool.effort:.1f} N"
        shut = self.phase in ("close", "lift", "done") or self.failed
        return Doing(
            velocity=velocity,
            state=state,
            reason=self.failed or (words if state == "reached" else ""),
            progress={"down": 0.5, "close": 0.7, "lift": 0.8}.get(self.phase, 1.0),
            figures={"grasp_n": tool.effort, "opening_m": tool.position},
            tool=ToolCommand(effort=self.force) if shut else ToolCommand(self.tool.stroke),
        )


@dataclass(frozen=True, slots=True)
class ReleaseTask:
    """Opens the fingers."""

    opening: float
    """Of the open gripper [m]."""
    waited: float = 0.0
    done: bool = False

    def advance(self, view: TaskView, dt: float) -> tuple[Self, Doing]:
        """See `Task`."""
        command = ToolCommand(self.opening)
        if self.done:
            return self, Doing(state="reached", progress=1.0, tool=command)
        task = replace(self, waited=self.waited + dt)
        if view.tool is not None and view.tool.position >= self.opening - 2.0 * SHUT:
            return replace(task, done=True), Doing(state="reached", progress=1.0, tool=command)
        if task.waited > PATIENCE:
            return task, Doing(state="failed", reason=f"the fingers do not open in {PATIENCE:g} s", tool=command)
        return task, Doing(progress=0.5, tool=command)
