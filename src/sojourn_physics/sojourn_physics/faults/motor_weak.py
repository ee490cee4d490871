"""A motor that can take but a part of its current: a phase of its amplifier lost, magnets that have grown weak."""

from pydantic import Field

from sojourn_physics.faults.motor_dead import weakened
from sojourn_physics.faults.plant_fault import JointFault
from sojourn_physics.plant.model import PlantModel
from sojourn_physics.plant.state import PlantCommand


class MotorWeak(JointFault):
    """See the module."""

    kind: str = "motor_weak"
    part: float = Field(ge=0.0, lt=1.0, description="of its largest current that it can still take [-]")

    def command(self, model: PlantModel, command: PlantCommand, noted: float) -> PlantCommand:
        """See PlantFault."""
        return weakened(model, command, self.joint, self.part)
