"""A joint that is free: nothing of its drive holds it, neither motor nor gear nor brake; a bearing is left."""

from dataclasses import replace

from pydantic import Field

from sojourn_machine.drives import BrakeParams
from sojourn_physics.actuators.joint_drive import BACK_LOSS, BEARING_FRICTION, FRICTION, TOOTH_STIFFNESS, VISCOUS
from sojourn_physics.faults.motor_dead import weakened
from sojourn_physics.faults.plant_fault import JointFault
from sojourn_physics.plant.model import PlantModel
from sojourn_physics.plant.state import PlantCommand


class JointFree(JointFault):
    """See the module."""

    kind: str = "joint_free"
    friction: float = Field(default=0.1, ge=0.0, le=1e4, description="of the bearing that is left [N m or N]")

    def model(self, model: PlantModel) -> None:
        """See PlantFault."""
        index = model.joint_index[self.joint]
        row = model.joints.parameters[index]
        row[[FRICTION, VISCOUS, BACK_LOSS]] = 0.0
        row[BEARING_FRICTION if row[TOOTH_STIFFNESS] > 0.0 else FRICTION] = self.friction
        if model.conditions is not None:
            model.conditions = replace(model.conditions, brakes=brakes_without(model, index))

    def command(self, model: PlantModel, command: PlantCommand, noted: float) -> PlantCommand:
        """See PlantFault."""
        return weakened(model, command, self.joint, 0.0)


def brakes_without(model: PlantModel, index: int) -> tuple[BrakeParams | None, ...]:
    """The brakes of a machine's drives without that of a joint by its row: what it does is in the joint's table."""
    if model.conditions is None:
        return ()
    rows = model.conditions.rows.tolist()
    return tuple(None if row == index else brake for row, brake in zip(rows, model.conditions.brakes, strict=True))
