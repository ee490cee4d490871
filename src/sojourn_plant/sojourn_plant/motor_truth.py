"""Currents and voltages of motors as a message, for runs with a sensor of them."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from sojourn_contract import stamps
from sojourn_contract.barrier import is_due
from sojourn_contract.motors import MOTORS, motors_message
from sojourn_machine.params import FloatArray
from sojourn_physics.actuators.joint_drive import MOTOR_RATE, PASSIVE
from sojourn_physics.actuators.terminal_voltage import terminal_voltages
from sojourn_physics.plant.model import PlantModel
from sojourn_physics.plant.state import PlantState


class MotorTruth:
    """Of the motors of a machine whose laws are the plant's own."""

    def __init__(self, model: PlantModel) -> None:
        joints, self._conditions = model.joints, model.conditions
        self._rows = np.flatnonzero(joints.solved != PASSIVE)
        self._names = tuple(joints.names[row] for row in self._rows)
        self._parameters, self._columns = joints.parameters, joints.columns
        self._plays = joints.rotors > 0.0

    def messages(self, stamp: int, state: PlantState, currents: FloatArray) -> Iterator[tuple[str, Any]]:
        """Where it is due; currents: of all joints at the end of the period, (joints,) [A]."""
        if is_due(MOTORS, stamp // stamps.CONTROL_PERIOD_NS):
            rates = np.where(self._plays, state.joints[MOTOR_RATE], state.velocity[self._columns])
            parameters = self._parameters
            if self._conditions is not None and state.conditions is not None:
                parameters = self._conditions.now(state.conditions)  # of a motor as warm as it is
            voltages = terminal_voltages(parameters, currents, rates)
            told = {"current": currents[self._rows], "voltage": voltages[self._rows]}
            yield MOTORS.name, motors_message(stamp, self._names, told)
