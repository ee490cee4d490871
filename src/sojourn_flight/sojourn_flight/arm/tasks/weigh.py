"""Task: weigh what the arm carries at its tip: stand still in several postures, and explain the joint torques.

The postures are the present one and such from which the wrist and the joint before it are turned by `TURN`; each is
reached by a goal of the arm, which plans and checks the way. Torques are averaged over `seconds` after a rest of
`REST`. See `payload` for the law. The wrist's force sensor, where there is one, weighs by itself as a check: the mean
of its force along gravity, less the tool's own weight.
"""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from sojourn_flight.arm.goals import JointGoal
from sojourn_flight.arm.model import ArmModel
from sojourn_flight.arm.payload import StillPosture, identify_payload
from sojourn_flight.arm.tasks.task import Doing, TaskView
from sojourn_machine.params import FloatArray

TURN = 0.5
"""Between two postures [rad]."""
MISFIT = 0.1
"""Root mean square of unexplained torque above which something else than a payload acts [N m]."""
REST = 1.0
"""Time for the arm to calm down [s]."""


@dataclass(frozen=True, slots=True)
class WeighTask:
    """Postures to go to, and what was seen in those that were."""

    model: ArmModel
    postures: tuple[FloatArray, ...]
    seconds: float
    seen: tuple[StillPosture, ...] = ()
    sent: bool = False
    waited: float = 0.0
    total: FloatArray | None = None
    by_wrist: float = 0.0
    readings: int = 0
    """Of the wrist, in all postures."""
    counted: int = 0
    """Of the joints, in the present posture."""
    result: Doing | None = None

    def advance(self, view: TaskView, dt: float) -> tuple[Self, Doing]:
        """See `Task`."""
        if self.result is not None:
            return self, self.result
        if view.efforts is None:
            return self, Doing(state="failed", reason="the joints do not tell their torques")
        share = len(self.seen) / len(self.postures)
        if not self.sent:
            goal = JointGoal(self.model.joint_names, tuple(float(q) for q in self.postures[len(self.seen)]))
            return replace(self, sent=True, waited=0.0, counted=0, total=None), Doing(goal=goal, progress=share)
        if view.status == "moving":
            return self, Doing(progress=share)
        if view.status != "reached":
            return self, Doing(state="failed", reason=view.reason)
        task = replace(self, waited=self.waited + dt)
        if task.waited <= REST:
            return task, Doing(progress=share)
        total = view.efforts if task.total is None else task.total + view.efforts
        weight = float(np.linalg.norm(view.gravity))
        felt = float(view.force @ view.gravity) / weight**2 if view.feels and weight > 0.0 else 0.0
        task = replace(
            task, total=total, by_wrist=task.by_wrist + felt, readings=task.readings + 1, counted=task.counted + 1
        )
        if task.waited < REST + task.seconds:
            return task, Doing(progress=share)
        seen = (*task.seen, StillPosture(view.positions, total / task.counted, view.gravity))
        task = replace(task, seen=seen, sent=False)
        if len(seen) < len(task.postures):
            return task, Doing(progress=len(seen) / len(task.postures))
        result = task._weighed(view)
        return replace(task, result=result), result

    def _weighed(self, view: TaskView) -> Doing:
        payload = identify_payload(self.model, self.seen)
        figures = {"payload_kg": payload.mass, "payload_deviation_kg": payload.mass_deviation}
        words = f"payload {payload.mass:.3f} kg ± {payload.mass_deviation:.3f} kg by the joints' torques"
        if view.feels:
            figures["payload_by_wrist_kg"] = self.by_wrist / self.readings
            words += f", {figures['payload_by_wrist_kg']:.3f} kg by the wrist"
        if payload.residual > MISFIT:
            words = f"{payload.residual:.2f} N m of the torques fit no payload: the tool touches something"
            return Doing(state="failed", reason=words, progress=1.0, figures=figures)
        return Doing(state="reached", reason=words, progress=1.0, figures=figures)
