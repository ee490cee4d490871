"""Task: drill a hole: touch the ground, spin up, press with a force until it is deep enough, and come out again.

    touch   the guarded advance along the direction, the spindle at rest, down to a force of `TOUCH`
    spin    the spindle to its rate, the tip held
    drill   the force loop of `force_control` keeps the weight on the bit along the direction, with an integral that
            takes over the headway; the tip is held across
    check   at the depth: unload to `TOUCH`; where what gave way under the weight was counted as depth, drill on
    out     back to where the advance began, the spindle turning; then it stops

The depth is that of the tip below the touch under the same force. It ends early, comes out and says why when the
spindle stalls (below `STALLED` of its rate for `STALL_TIME`), when it gets on by less than `LITTLE` in the task's
patience, and when the bit gets too hot. The bit has no thermometer: its temperature is estimated from the power that
the spindle gives, torque times rate as measured, by the heat balance of the tool's file (`BitHeatParams`).
"""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from sojourn_flight.arm.force_control import hybrid_velocity, pressing
from sojourn_flight.arm.tasks.task import Doing, DoingState, TaskView, ToolCommand, ToolReading
from sojourn_machine.params import FloatArray
from sojourn_machine.tools import DrillToolParams

TOUCH = 4.0
"""Pressing force at which the ground is found [N]."""
STALLED, STALL_TIME, SPIN_TIME = 0.3, 0.5, 5.0
"""Part of the commanded rate; times [s]."""
LITTLE = 2e-4
"""Way in the task's patience that counts as getting on [m]."""
FEED_TIME, FASTEST_FEED, FEED_FROM = 3.0, 3e-3, 0.8
"""Of the integral of the force loop [s], its limit [m/s], and the part of the weight on the bit from which it works."""
EXACT = 2e-4
"""By how much a hole may be too shallow [m]."""
ZERO = np.zeros(3)


@dataclass(frozen=True, slots=True)
class DrillTask:
    """Phases touch, spin, drill, check, out, done."""

    tool: DrillToolParams
    direction: FloatArray
    depth: float
    force: float
    rate: float
    """Of the spindle [rad/s]."""
    speed: float
    """Of the tip until it touches, and on the way out [m/s]."""
    patience: float
    reach: float
    first: FloatArray
    """Tip where the advance begins (3,) [m]."""
    touched: FloatArray
    """Tip where the ground was felt; before that as `first`."""
    temperature: float
    """Of the bit, estimated [K]."""
    phase: str = "touch"
    elapsed: float = 0.0
    """In this phase [s]."""
    slow: float = 0.0
    """For which the spindle has been too slow [s]."""
    mark: tuple[float, float] = (0.0, 0.0)
    """Time and depth of the last headway [s], [m]."""
    feed: float = 0.0
    """Headway that the force loop has found [m/s]."""
    deepest: float = 0.0
    """Under the weight on the bit [m]."""
    given: float = 0.0
    """Way that bit, arm and ground give under it, as far as known [m]."""
    hole: float = 0.0
    """Depth without that [m]."""
    torque: float = 0.0
    """Largest so far [N m]."""
    energy: float = 0.0
    """That the spindle has given [J]."""
    why: str = ""
    """It has ended early."""
    failed: str = ""

    def advance(self, view: TaskView, dt: float) -> tuple[Self, Doing]:
        """See `Task`."""
        if not view.feels:
            return self, Doing(state="failed", reason="the wrist's sensor says nothing", tool=ToolCommand())
        if view.tool is None:
            return self, Doing(state="failed", reason="the spindle says nothing", tool=ToolCommand())
        force = pressing(self.direction, view.force)
        if self.failed or self.phase == "done":
            return self, self._doing(ZERO, force, 1.0)
        task = self._account(view, view.tool, dt)
        if task.phase == "touch":
            return task._touch(view.tip.position, force)
        if task.phase == "spin":
            return task._spin(view.tool, force)
        if task.phase == "drill":
            return task._drill(view, view.tool, force, dt)
        if task.phase == "check":
            return task._check(view, force)
        if -float(task.direction @ (view.tip.position - task.first)) >= -1e-3:
            task = replace(task, phase="done")
        return task, task._doing(-2.0 * task.speed * task.direction, force, 0.9)

    def _account(self, view: TaskView, tool: ToolReading, dt: float) -> Self:
        power = max(tool.effort * tool.rate, 0.0)
        gone = float(self.direction @ (view.tip.position - self.touched)) if self.phase != "touch" else 0.0
        return replace(
            self,
            elapsed=self.elapsed + dt,
            temperature=self.tool.heat.step(self.temperature, power, dt),
            deepest=max(self.deepest, gone),
            torque=max(self.torque, tool.effort),
            energy=self.energy + power * dt,
        )

    def _touch(self, tip: FloatArray, force: float) -> tuple[Self, Doing]:
        if force >= TOUCH:
            task = replace(self, phase="spin", touched=tip, elapsed=0.0)
            return task, task._doing(ZERO, force, 0.05)
        if float(self.direction @ (tip - self.first)) >= self.reach:
            task = replace(self, failed=f"no ground within {self.reach * 1e3:.0f} mm")
            return task, task._doing(ZERO, force, 0.0)
        return self, self._doing(self.speed * self.direction, force, 0.0)

    def _spin(self, tool: ToolReading, force: float) -> tuple[Self, Doing]:
        if tool.rate >= 0.9 * self.rate:
            task = replace(self, phase="drill", elapsed=0.0)
            return task, task._doing(ZERO, force, 0.1)
        if self.elapsed > SPIN_TIME:
            task = replace(self, phase="out", why=f"the spindle turns at {tool.rate:.1f} of {self.rate:.1f} rad/s")
            return task, task._doing(ZERO, force, 0.1)
        return self, self._doing(ZERO, force, 0.05)

    def _drill(self, view: TaskView, tool: ToolReading, force: float, dt: float) -> tuple[Self, Doing]:
        task = replace(self, slow=self.slow + dt if tool.rate < STALLED * self.rate else 0.0)
        if task.deepest - task.mark[1] >= LITTLE:
            task = replace(task, mark=(task.elapsed, task.deepest))
        why, waited = "", task.elapsed - task.mark[0]
        if task.slow > STALL_TIME:
            why = f"stalled with {tool.effort:.2f} N m under {force:.1f} N"
        elif task.temperature > task.tool.max_temperature:
            why = f"the bit is at {task.temperature:.0f} K: allowed is {task.tool.max_temperature:g} K"
        elif waited > task.patience:
            gone = (task.deepest - task.mark[1]) * 1e3
            why = f"no progress: {max(gone, 0.0):.2f} mm in {waited:.0f} s under {force:.1f} N"
        if why or task.deepest >= task.depth + task.given:
            task = replace(task, phase="check", why=why, feed=0.0)
            return task, task._doing(ZERO, force, 0.9)
        gain = dt / (view.control.damping * FEED_TIME) if force > FEED_FROM * task.force else 0.0
        feed = min(max(task.feed + gain * (task.force - force), 0.0), FASTEST_FEED)
        task = replace(task, feed=feed)
        velocity = hybrid_velocity(view.control, task.direction, task.force, view.force, ZERO)
        progress = max(task.deepest, 0.0) / (task.depth + task.given)
        return task, task._doing(velocity + feed * task.direction, force, 0.1 + 0.8 * min(progress, 1.0))

    def _check(self, view: TaskView, force: float) -> tuple[Self, Doing]:
        if force > TOUCH:
            return self, self._doing(-0.2 * self.speed * self.direction, force, 0.9)
        hole = max(float(self.direction @ (view.tip.position - self.touched)), 0.0)
        task = replace(self, hole=hole)
        short = task.depth - hole
        if task.why or short <= EXACT:
            task = replace(task, phase="out")
        else:  # further by what it lacks, now that it is known what gives way
            known = task.deepest - hole if task.given == 0.0 else task.given + short
            task = replace(task, phase="drill", given=known, mark=(task.elapsed, task.deepest))
        return task, task._doing(ZERO, force, 0.9)

    def _doing(self, velocity: FloatArray, force: float, progress: float) -> Doing:
        done = self.phase == "done"
        state: DoingState = "failed" if self.failed or (done and self.why) else "reached" if done else "moving"
        energy = self.energy / (np.pi * self.tool.bit.radius**2 * self.hole) if self.hole > 0.0 else 0.0
        words = f"drilled {self.hole * 1e3:.1f} mm: at most {self.torque:.2f} N m, {self.energy:.0f} J of the spindle, "
        words += f"{energy * 1e-6:.1f} J/cm3, bit at {self.temperature:.0f} K"
        reason = self.failed or (f"{self.why}; {words}" if self.why else words)
        speed = self.deepest / self.elapsed if self.phase == "drill" and self.elapsed > 1.0 else 0.0
        return Doing(
            velocity=velocity,
            state=state,
            reason="" if state == "moving" else reason,
            progress=1.0 if state == "reached" else min(progress, 1.0),
            time_to_go=max(self.depth + self.given - self.deepest, 0.0) / speed if speed > 0.0 else 0.0,
            figures={
                "contact_force_n": force,
                "depth_m": self.hole if self.hole > 0.0 else self.deepest,
                "torque_nm": self.torque,
                "work_j": self.energy,
                "specific_energy_j_m3": energy,
                "bit_temperature_k": self.temperature,
            },
            tool=ToolCommand(
                rate=self.rate if self.phase in ("spin", "drill", "check", "out") and not self.failed else 0.0
            ),
        )
