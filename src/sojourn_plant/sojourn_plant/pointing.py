"""Joints that an operator points, as a mast's pan and tilt: /mast/joint_goal.

No node of the flight side commands them. The controller of such a motor is told where the joint is to be, and takes its
reference there at PACE of the joint's greatest rate; then it holds it.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from sojourn_contract import stamps
from sojourn_contract.checks import check_names, check_ranges
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.topic_types import Topic
from sojourn_machine.params import FloatArray
from sojourn_physics.actuators.joint_drive import LOWER, MAX_RATE, UPPER
from sojourn_physics.plant.model import PlantModel

TOPIC = "/mast/joint_goal"
PACE = 0.75
"""Of the limit of the URDF, for a servo asks for no more than that and could not make up for what it is late [-]."""
Targets = Mapping[int, float]
"""Where joints are to be, by their columns of a command [rad]."""


class Pointing:
    """Of one machine.

    Args:
        model: the machine. joints: that an operator may point.
    """

    def __init__(self, model: PlantModel, joints: Sequence[str]) -> None:
        self._columns = {name: model.joint_index[name] for name in joints}
        parameters = model.joints.parameters
        self._limits = {name: parameters[column, [LOWER, UPPER]] for name, column in self._columns.items()}
        self._speeds = {column: PACE * float(parameters[column, MAX_RATE]) for column in self._columns.values()}

    def check(self, row: Topic, message: Any) -> None:
        """Raise RefusedMessageError for a joint that is none of these, or an angle that it cannot have."""
        check_names(row.name, message.names, self._columns)
        check_ranges(row, message)
        if len(message.position) != len(message.names) or not message.names:
            raise RefusedMessageError(row.name, "position", f"{len(message.position)} numbers", "one for each joint")
        for name, angle in zip(message.names, message.position.tolist(), strict=True):
            lower, upper = self._limits[name].tolist()
            if not lower <= angle <= upper:
                raise RefusedMessageError(row.name, f"position of {name}", angle, f"{lower:g} to {upper:g} rad")

    def asked(self, targets: Targets, goals: Sequence[tuple[str, Any]]) -> Targets:
        """Where joints are to be after the goals of a period."""
        for name, message in goals:
            if name == TOPIC:
                found = zip(message.names, message.position.tolist(), strict=True)
                targets = {**targets, **{self._columns[joint]: angle for joint, angle in found}}
        return targets

    def moved(self, targets: Targets, position: FloatArray, rate: FloatArray) -> None:
        """Write the references of a period, (joints,) each, that begin where those of the period before end."""
        for column, target in targets.items():
            begin = position[column] + rate[column] * stamps.CONTROL_PERIOD_S
            speed = self._speeds[column]
            position[column] = begin
            rate[column] = np.clip((target - begin) / stamps.CONTROL_PERIOD_S, -speed, speed)
