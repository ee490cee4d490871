"""A motor that takes no current: its gear, its friction and its inertia are left, and the load may turn it."""

import numpy as np

from sojourn_machine.evolution import replace
from sojourn_physics.faults.plant_fault import JointFault
from sojourn_physics.plant.model import PlantModel
from sojourn_physics.plant.state import PlantCommand


class MotorDead(JointFault):
    """See the module."""

    kind: str = "motor_dead"

    def command(self, model: PlantModel, command: PlantCommand, noted: float) -> PlantCommand:
        """See PlantFault."""
        return weakened(model, command, self.joint, 0.0)


def weakened(model: PlantModel, command: PlantCommand, joint: str, part: float) -> PlantCommand:
    """A command under which the motor of a joint can take but a part of its current [-]."""
    before = command.motor_health
    health = np.ones(len(model.joints.names)) if before is None else before.copy()
    health[model.joint_index[joint]] *= part
    return replace(command, motor_health=health)
