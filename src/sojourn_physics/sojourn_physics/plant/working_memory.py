"""What the kernels of a control period work on: made once for a machine, filled from a state and a command.

Compiled code gets the tables through one handle (`kernels.PeriodHandle`), which stands until the ground's memory moves:
to hand them over anew costs as much as half a physics step.
"""

from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from sojourn_machine.params import FloatArray
from sojourn_physics.actuators.joint_drive import STATE_ROWS, WORK_ROWS, JointCommand, JointReadings, JointWork
from sojourn_physics.contact.tables import Ground, make_workspace
from sojourn_physics.plant.inertia import Factors
from sojourn_physics.plant.kernels import (
    ENERGY_SUMS,
    Forces,
    Motion,
    Multibody,
    PlantTables,
    Sums,
    open_period,
)
from sojourn_physics.plant.state import PlantState

if TYPE_CHECKING:
    from sojourn_physics.plant.model import PlantModel


class WorkingMemory:
    """Of one machine.

    Attributes:
        tables: what the kernels work on. period: the same, as compiled code takes it.
    """

    def __init__(self, model: "PlantModel") -> None:
        self._board = model.memory
        loops, nv, joints = len(model.coupling), model.multibody.nv, len(model.joints.names)
        supports, loads = len(model.supports.names), len(model.loads)
        # with conditions the parameters change from period to period
        parameters = model.joints.parameters if model.conditions is None else model.joints.parameters.copy()
        terrain = model.terrain
        self.tables = PlantTables(
            joints=model.joints.tables(parameters),
            supports=model.supports.tables,
            ground=Ground(terrain.heights, terrain.soil_index, model.grid, model.soils, self._board.tables),
            multibody=Multibody(
                model.placements,
                model.jacobian,
                model.mass_matrix,
                model.bias,
                model.coupling,
                factors=_factors(model.data),
                response=np.zeros_like(model.coupling),
                factor=np.zeros((loops, loops)),
                impulse=np.zeros(loops),
            ),
            command=JointCommand(np.zeros((3, joints)), np.zeros(joints), np.zeros(joints)),
            motion=Motion(
                np.zeros((model.simulation.substeps + 1, nv)),
                np.zeros(nv),
                np.zeros((STATE_ROWS, joints)),
                model.supports.first_states(),
            ),
            forces=Forces(np.zeros(nv), np.zeros(nv)),
            work=JointWork(np.zeros((WORK_ROWS, joints)), np.zeros(nv), np.zeros(nv)),
            readings=JointReadings(model.efforts, model.currents, model.load_power, np.zeros(ENERGY_SUMS)),
            report=model.report,
            workspace=make_workspace(model.soils),
            sums=Sums(np.zeros((supports, 3)), np.zeros(joints), np.zeros(loads)),
            dt=model.simulation.physics_step,
        )
        self.period = open_period(self.tables)
        self._joint_bus = model.power.load_bus[model.joints.loads]
        self.rates = list(self.tables.motion.rates)
        """Rows of the motion's rates, (nv,) each."""

    def begin(self, state: PlantState, reference: FloatArray, limits: FloatArray, parameters: FloatArray) -> None:
        """Fill in what a period starts from; arguments as in `PlantCommand`, `JointCommand` and `Joints`."""
        tables = self.tables
        if tables.ground.memory.pool is not self._board.pool:
            tables = self.tables = tables._replace(ground=tables.ground._replace(memory=self._board.tables))
            self.period = open_period(tables)
        motion, command, sums = tables.motion, tables.command, tables.sums
        motion.rates[0] = state.velocity
        motion.joints[:] = state.joints
        for own, given in zip(motion.supports, state.supports, strict=True):
            own[:] = given
        command.reference[:] = reference
        command.limits[:] = limits
        voltages = state.power.voltages
        command.bus_voltage[:] = voltages[0] if len(voltages) == 1 else np.array(voltages)[self._joint_bus]
        if tables.joints.parameters is not parameters:
            tables.joints.parameters[:] = parameters
        tables.readings.energy[:] = 0.0
        for total in sums:
            total[:] = 0.0


def _factors(data: pin.Data) -> Factors:
    parents = np.array(data.parents_fromRow, dtype=np.int64)
    sizes = np.array(data.nvSubtree_fromRow, dtype=np.int64)
    nv = len(parents)
    return Factors(parents, sizes, np.eye(nv), np.zeros(nv), np.zeros(nv))
