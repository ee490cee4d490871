"""A brake that does not do what it is told: closed, so that the motor works against it, or open, so that it does not
hold the joint when the motor has no current.
"""

from collections.abc import Iterable
from dataclasses import replace
from typing import Literal

from pydantic import Field

from sojourn_machine.drives import JointDriveParams
from sojourn_machine.fault_choice import FaultableMachine, FaultProblem, unknown
from sojourn_physics.actuators.joint_drive import FRICTION, RATIO
from sojourn_physics.faults.joint_free import brakes_without
from sojourn_physics.faults.plant_fault import JointFault
from sojourn_physics.plant.model import PlantModel


class BrakeStuck(JointFault):
    """See the module."""

    kind: str = "brake_stuck"
    where: Literal["closed", "open"] = Field(default="closed", description="how it is stuck")

    def problems(self, machine: FaultableMachine) -> Iterable[FaultProblem]:
        """See FaultChoice."""
        drives = [drive for drive in machine.machine.drives if isinstance(drive, JointDriveParams) and drive.brake]
        return unknown("joint", self.joint, [joint for drive in drives for joint in drive.joints], "has no brake")

    def model(self, model: PlantModel) -> None:
        """See PlantFault."""
        if model.conditions is None:
            return
        index = model.joint_index[self.joint]
        brake = model.conditions.brakes[model.conditions.rows.tolist().index(index)]
        row = model.joints.parameters[index]
        if brake is not None and self.where == "closed":
            row[FRICTION] += brake.holding_torque * row[RATIO]
        model.conditions = replace(model.conditions, brakes=brakes_without(model, index))
