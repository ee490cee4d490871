"""The joints of a machine as the kernels take them: drives, springs, limits, row by row."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from sojourn_machine.drives import JointDriveParams, SeriesMotorParams
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.machine import MachineParams
from sojourn_machine.params import FloatArray, IntArray
from sojourn_machine.power.loads import LoadParams
from sojourn_physics.actuators import joint_drive
from sojourn_physics.plant.outside_drives import DrivenJoint, OutsideDrives


@dataclass(frozen=True, slots=True)
class JointTables:
    """Joints with one degree of freedom, as arrays for the kernels; (joints, ...)."""

    names: tuple[str, ...]
    parameters: FloatArray
    kinds: IntArray
    columns: IntArray
    loads: IntArray
    armature: FloatArray
    """(nv,) reflected rotor inertia of motors that turn as one with their joints [kg m^2]."""
    rotors: FloatArray
    """(joints,) reflected rotor inertia of motors behind a gear with play [kg m^2]."""
    solved: IntArray
    """(joints,) kinds as the kernels take them: passive where the drive's law is its own."""

    def tables(self, parameters: FloatArray) -> joint_drive.Joints:
        """For the kernels, with the parameters as they are now."""
        return joint_drive.Joints(parameters, self.solved, self.columns, self.loads)


def joint_tables(
    multibody: pin.Model, machine: MachineParams, loads: Sequence[LoadParams]
) -> tuple[JointTables, OutsideDrives]:
    """The joints of a machine, and those of them whose drives have laws of their own.

    Raises:
        InvalidValueError: a joint that the URDF does not have or that has not one degree of freedom, a drive whose load
            is none of `loads`, a screw on a joint that does not slide.
    """
    drives = {joint: drive for drive in machine.drives for joint in drive.joints}
    springs = {joint: suspension for suspension in machine.suspensions for joint in suspension.joints}
    load_names = [load.name for load in loads]
    names = tuple(multibody.names[i] for i in range(2, multibody.njoints))
    for name in (*drives, *springs):
        if name not in names:
            raise InvalidValueError("joint of a drive or a spring", name, "one of " + ", ".join(names))
    count = len(names)
    table = JointTables(
        names,
        parameters=np.zeros((count, joint_drive.JOINT_COLUMNS)),
        kinds=np.zeros(count, dtype=np.int64),
        columns=np.zeros(count, dtype=np.int64),
        loads=np.zeros(count, dtype=np.int64),
        armature=np.zeros(multibody.nv),
        rotors=np.zeros(count),
        solved=np.zeros(count, dtype=np.int64),
    )
    outside = []
    for i, name in enumerate(names):
        joint = multibody.joints[i + 2]
        if joint.nv != 1:
            raise InvalidValueError(f"degrees of freedom of {name}", joint.nv, "1")
        column = joint.idx_v
        table.columns[i] = column
        row = table.parameters[i]
        turns = joint.nq == 2  # a continuous joint is a point on a circle, and has no stops
        row[joint_drive.LOWER] = -np.inf if turns else multibody.lowerPositionLimit[joint.idx_q]
        row[joint_drive.UPPER] = np.inf if turns else multibody.upperPositionLimit[joint.idx_q]
        row[joint_drive.STOP_STIFFNESS] = machine.stop_stiffness
        row[joint_drive.STOP_DAMPING] = machine.stop_damping
        row[joint_drive.EFFICIENCY] = 1.0
        row[joint_drive.FRICTION] = machine.passive_joint.friction_torque
        row[joint_drive.VISCOUS] = machine.passive_joint.viscous_friction
        spring = springs.get(name)
        if spring is not None:
            row[joint_drive.SPRING_STIFFNESS] = spring.stiffness
            row[joint_drive.SPRING_REST] = spring.rest
            row[joint_drive.VISCOUS] += spring.damping
        drive = drives.get(name)
        if drive is None:
            continue
        if drive.load not in load_names:
            raise InvalidValueError(f"load of the drive of {name}", drive.load, "one of " + ", ".join(load_names))
        table.loads[i] = load_names.index(drive.load)
        table.kinds[i] = joint_drive.RATE if drive.mode == "rate" else joint_drive.POSITION
        row[joint_drive.ARMATURE] = drive.reflected_inertia
        if not isinstance(drive, JointDriveParams):
            table.armature[column] = drive.reflected_inertia
            outside.append(DrivenJoint(name, i, column, int(table.loads[i]), drive.actuator(name)))
            continue
        table.solved[i] = table.kinds[i]
        row[joint_drive.MAX_EFFORT] = multibody.effortLimit[column] or np.inf
        row[joint_drive.MAX_RATE] = multibody.velocityLimit[column] or np.inf
        if drive.screw is not None and not joint.shortname().startswith("JointModelP"):
            raise InvalidValueError(f"screw of the drive of {name}", joint.shortname(), "a joint that slides")
        _fill(row, drive)
        if drive.play is None:
            table.armature[column] = drive.reflected_inertia
        else:
            table.rotors[i] = drive.reflected_inertia
    return table, OutsideDrives(outside)


def _fill(row: FloatArray, drive: JointDriveParams) -> None:
    """Motor, gear, servo and play into a joint's row of parameters."""
    motor, gear = drive.electric, drive.transmission
    row[joint_drive.RATIO] = gear.ratio
    if isinstance(motor, SeriesMotorParams):
        row[joint_drive.TORQUE_CONSTANT] = motor.field_constant
        row[joint_drive.RESISTANCE] = motor.series_resistance
        row[joint_drive.SATURATION] = motor.saturation_current
    else:
        row[joint_drive.TORQUE_CONSTANT] = motor.torque_constant
        row[joint_drive.RESISTANCE] = motor.resistance
    row[joint_drive.MAX_CURRENT] = motor.max_current
    row[joint_drive.EFFICIENCY] = gear.efficiency
    if gear.back_efficiency is not None:
        row[joint_drive.BACK_LOSS] = 1.0 / gear.back_efficiency - 1.0 - (1.0 - gear.efficiency)
    row[joint_drive.FRICTION] = drive.friction_torque
    row[joint_drive.VISCOUS] = drive.viscous_friction
    row[joint_drive.PROPORTIONAL] = drive.servo.proportional
    row[joint_drive.INTEGRAL] = drive.servo.integral
    row[joint_drive.DERIVATIVE] = drive.servo.derivative
    row[joint_drive.MAX_TORQUE] = drive.servo.max_torque
    if drive.play is not None:
        row[joint_drive.HALF_GAP] = 0.5 * drive.play.backlash
        row[joint_drive.TOOTH_STIFFNESS] = drive.play.stiffness
        row[joint_drive.TOOTH_DAMPING] = drive.play.damping
        row[joint_drive.BEARING_FRICTION] = drive.play.bearing_friction
        row[joint_drive.BEARING_VISCOUS] = drive.play.bearing_viscous
        row[joint_drive.SEES_JOINT] = float(drive.servo.encoder == "joint")
