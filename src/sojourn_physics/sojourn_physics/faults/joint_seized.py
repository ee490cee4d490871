"""A joint that has seized: a bearing or a gear that jams holds it where it is, and the motor works against it.

The friction of its bearing grows to `torque`; as it is of Dahl's kind (`actuators.joint_drive`), the joint rests at a
fixed point and its heat is booked. Without a number it is four times the largest effort of the joint: more than motor
and load can bring to it, so that it does not turn at all. A smaller one is a joint that turns hard.
"""

import math

from pydantic import Field

from sojourn_machine.errors import InvalidValueError
from sojourn_physics.actuators.joint_drive import BEARING_FRICTION, FRICTION, MAX_EFFORT, TOOTH_STIFFNESS
from sojourn_physics.faults.plant_fault import JointFault
from sojourn_physics.plant.model import PlantModel

STRONGER = 4.0
"""Than the largest effort of the joint [-]."""


class JointSeized(JointFault):
    """See the module."""

    kind: str = "joint_seized"
    torque: float | None = Field(
        default=None, gt=0.0, le=1e6, description="friction that holds it; left out: more than can turn it [N m or N]"
    )

    def model(self, model: PlantModel) -> None:
        """See PlantFault."""
        row = model.joints.parameters[model.joint_index[self.joint]]
        torque = STRONGER * float(row[MAX_EFFORT]) if self.torque is None else self.torque
        if not math.isfinite(torque):
            raise InvalidValueError("torque", self.torque, f"a number: {self.joint} has no largest effort in the URDF")
        column = BEARING_FRICTION if row[TOOTH_STIFFNESS] > 0.0 else FRICTION
        row[column] = max(row[column], torque)
