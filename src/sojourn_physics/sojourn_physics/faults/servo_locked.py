"""A servo that holds one angle whatever it is told: where it is, or one to which it moves first (a steering that runs
away and jams).

Assumption: it is as strong as its motor, and holds while that has power. What holds by itself is `joint_seized`.
"""

import math
from collections.abc import Iterable

from pydantic import Field

from sojourn_machine.evolution import replace
from sojourn_machine.fault_choice import FaultableMachine, FaultProblem
from sojourn_physics.actuators.joint_drive import ANGLE, WANTED_EFFORT, WANTED_POSITION, WANTED_RATE
from sojourn_physics.faults.plant_fault import JointFault
from sojourn_physics.plant.model import PlantModel
from sojourn_physics.plant.state import PlantCommand, PlantState


class ServoLocked(JointFault):
    """See the module."""

    kind: str = "servo_locked"
    angle_deg: float | None = Field(
        default=None, ge=-360.0, le=360.0, description="angle at which it locks; left out: where it is [degree]"
    )

    def problems(self, machine: FaultableMachine) -> Iterable[FaultProblem]:
        """See FaultChoice."""
        yield from (found := list(super().problems(machine)))
        if found or self.angle_deg is None:
            return
        drive = next(drive for drive in machine.machine.drives if self.joint in drive.joints)
        low, high = (math.degrees(angle) for angle in machine.travel[self.joint])
        if drive.mode != "position":
            yield "angle_deg", self.angle_deg, "its motor is commanded by rate: allowed is no angle"
        elif not low <= self.angle_deg <= high:
            yield "angle_deg", self.angle_deg, f"allowed is {low:g} to {high:g} degrees, the limits of {self.joint}"

    def noted(self, model: PlantModel, state: PlantState) -> float:
        """The angle that it holds [rad]."""
        here = float(state.joints[ANGLE, model.joint_index[self.joint]])
        return here if self.angle_deg is None else math.radians(self.angle_deg)

    def command(self, model: PlantModel, command: PlantCommand, noted: float) -> PlantCommand:
        """See PlantFault."""
        column, reference = model.joint_index[self.joint], command.reference.copy()
        reference[WANTED_POSITION, column] = noted
        reference[(WANTED_RATE, WANTED_EFFORT), column] = 0.0
        return replace(command, reference=reference)
