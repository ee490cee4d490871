"""A joint that has seized: a bearing or a gear that jams holds it where it is, and the motor works against it.

The friction of its bearing grows to `torque`; as it is of Dahl's kind (`actuators.joint_drive`), the joint rests at a
fixed point and its heat is booked. Without a number it is four times the largest effort of the joint: more than motor
and load can bring to it, so that it does not turn at all. A smaller one is a joint that turns hard.
"""

import math
from collections.abc import Iterable

from pydantic import Field

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.fault_choice import FaultableMachine, FaultProblem
from sojourn_physics.actuators.joint_drive import BEARING_FRICTION, FRICTION, TOOTH_STIFFNESS
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

    def problems(self, machine: FaultableMachine) -> Iterable[FaultProblem]:
        """See FaultChoice."""
        yield from (found := list(super().problems(machine)))
        if not found:
            try:
                self._friction(machine.efforts[self.joint])
            except InvalidValueError as error:
                yield error.name, error.value, f"allowed is {error.allowed}"

    def model(self, model: PlantModel) -> None:
        """See PlantFault."""
        index = model.joint_index[self.joint]
        friction = self._friction(float(model.multibody.effortLimit[model.joints.columns[index]]))
        row = model.joints.parameters[index]
        column = BEARING_FRICTION if row[TOOTH_STIFFNESS] > 0.0 else FRICTION
        row[column] = max(row[column], friction)

    def _friction(self, effort: float) -> float:
        """With which a joint of this largest effort is held, both in [N m or N]."""
        if self.torque is not None:
            return self.torque
        friction = STRONGER * effort
        if not 0.0 < friction < math.inf:
            raise InvalidValueError("torque", self.torque, f"a number: {self.joint} has no largest effort in the URDF")
        return friction
