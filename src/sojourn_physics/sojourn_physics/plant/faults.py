"""Motors that fail during a run: what is done to the command on its way to the joints.

    locked   the servo holds its joint's angle, whatever is commanded: the one at which it was when it failed, or one
             that is given, to which it moves first (a steering that runs away and jams)
    dead     the motor takes no current: gear, friction and reflected inertia are left, and the ground may turn it

Assumptions: a locked joint is as strong as its servo. A brake or a jammed gear would hold more than that.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from sojourn_machine.params import FloatArray
from sojourn_physics.plant.model import PlantModel
from sojourn_physics.plant.params import FaultParams
from sojourn_physics.plant.state import PlantCommand

POSITION, RATE, EFFORT = range(3)
HeldAngles = Mapping[int, float]
"""Angle at which a joint has locked [rad], by its column; what is remembered of the faults."""


class MotorFaults:
    """The faults of a run.

    Args:
        model: the machine. faults: of its joints.

    Raises:
        InvalidValueError: a joint that the machine does not have.
    """

    def __init__(self, model: PlantModel, faults: Sequence[FaultParams]) -> None:
        columns = model.reference_rows([fault.joint for fault in faults])
        self._faults = list(zip(columns.tolist(), faults, strict=True))

    def acting(self, time: float) -> list[FaultParams]:
        """Those that have happened by now [s]."""
        return [fault for _, fault in self._faults if time >= fault.at_s]

    def on(
        self, command: PlantCommand, held: HeldAngles, angles: FloatArray, time: float
    ) -> tuple[PlantCommand, HeldAngles]:
        """The command as the joints get it, and the angles that are held from here on.

        Args:
            command: as it was sent; not changed. held: so far. angles: of the joints now, (joints,) [rad].
            time: simulated [s].
        """
        happened = [(column, fault) for column, fault in self._faults if time >= fault.at_s]
        if not happened:
            return command, held
        reference, health, holding = command.reference.copy(), np.ones(len(angles)), dict(held)
        for column, fault in happened:
            if fault.kind == "dead":
                health[column] = 0.0
                continue
            angle = float(angles[column]) if fault.angle_deg is None else float(np.radians(fault.angle_deg))
            reference[POSITION, column] = holding.setdefault(column, angle)
            reference[(RATE, EFFORT), column] = 0.0
        return replace(command, reference=reference, motor_health=health), holding
