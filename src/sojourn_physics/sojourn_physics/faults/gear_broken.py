"""A gear that is broken through: the motor turns, the joint does not follow it.

The machine gets a gear with play (`actuators.gear_play`) whose gap has no end: no flank is met, and the joint turns in
its bearing alone. Servo and friction of the gear act on the motor. The sensors keep their places: an encoder that was
on the joint stays there, one that was on the motor sees the motor.
"""

from typing import ClassVar

from pydantic import Field

from sojourn_physics.actuators.joint_drive import (
    ARMATURE,
    BEARING_FRICTION,
    BEARING_VISCOUS,
    HALF_GAP,
    SEES_JOINT,
    TOOTH_DAMPING,
    TOOTH_STIFFNESS,
)
from sojourn_physics.faults.plant_fault import JointFault
from sojourn_physics.plant.model import PlantModel

ENDLESS = 1e12
"""Half of the gap [rad]."""


class GearBroken(JointFault):
    """See the module."""

    heals: ClassVar[bool] = False
    kind: str = "gear_broken"
    friction: float = Field(default=0.1, ge=0.0, le=1e4, description="of the bearing that is left [N m or N]")

    def model(self, model: PlantModel) -> None:
        """See PlantFault."""
        index = model.joint_index[self.joint]
        row = model.joints.parameters[index]
        if row[TOOTH_STIFFNESS] == 0.0:  # motor and joint turned as one
            row[[TOOTH_STIFFNESS, TOOTH_DAMPING, SEES_JOINT, BEARING_VISCOUS]] = 1.0, 0.0, 0.0, 0.0
            row[BEARING_FRICTION] = self.friction
            model.joints.armature[model.joints.columns[index]] = 0.0
            model.joints.rotors[index] = row[ARMATURE]
        row[HALF_GAP] = ENDLESS
