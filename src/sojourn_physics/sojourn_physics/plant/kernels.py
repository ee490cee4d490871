"""The two compiled halves of a physics step.

Pinocchio's terms and the solution stand between them (see `step`).
"""

from typing import NamedTuple

import numpy as np

from sojourn_machine.contact_report import ReportColumn
from sojourn_machine.kernels import njit, structref, types
from sojourn_machine.params import FloatArray, IntArray
from sojourn_physics.actuators.joint_drive import (
    ANGLE,
    ENERGY_TERMS,
    JointCommand,
    JointReadings,
    Joints,
    JointWork,
    joint_torques,
    settle_joints,
)
from sojourn_physics.contact.contact_set import contact_forces
from sojourn_physics.contact.tables import Contacts, Ground, Kinematics

COUPLING_DRIFT_GAIN = 0.1
"""Part of a coupling's drift that is taken back in one step."""
SOIL_WORK = ENERGY_TERMS
"""Place of the work on the soil in the energy sums, after those of the joints."""
ENERGY_SUMS = ENERGY_TERMS + 1


class Multibody(NamedTuple):
    """The machine's dynamics: Pinocchio's own memory, and what goes with it."""

    placements: FloatArray
    """(joints, 12) and (6, nv), as in `Kinematics`."""
    jacobian: FloatArray
    mass_matrix: FloatArray
    """M of the links, (nv, nv); the joints' inertia is added to its diagonal."""
    bias: FloatArray
    """(nv,): forces of gravity and of the motion."""
    coupling: FloatArray
    """A, (couplings, nv)."""
    response: FloatArray
    """A M⁻¹, (couplings, nv)."""


class Motion(NamedTuple):
    """What moves in a period."""

    rates: FloatArray
    """(steps + 1, nv): velocity at the start, and after each step."""
    displacement: FloatArray
    """(nv,): of the last step, on the group [m], [rad]."""
    joints: FloatArray
    """(STATE_ROWS, joints), see `joint_drive`."""
    contacts: FloatArray
    """(contacts, STATE_COLUMNS), see `contact_law`."""


class Forces(NamedTuple):
    """Generalised forces of a step, each (nv,)."""

    contacts: FloatArray
    net: FloatArray
    """All that act, less the bias."""


class Sums(NamedTuple):
    """Over the steps of a period."""

    contact_force: FloatArray
    """(contacts, 3): in map [N]."""
    current_squares: FloatArray
    """(joints,) [A²]"""
    load_energy: FloatArray
    """(loads,): of the motors on each load [J]."""


class PlantTables(NamedTuple):
    """All that the kernels of a step work on."""

    joints: Joints
    contacts: Contacts
    ground: Ground
    multibody: Multibody
    command: JointCommand
    motion: Motion
    forces: Forces
    work: JointWork
    readings: JointReadings
    report: FloatArray
    """(contacts, REPORT_COLUMNS)"""
    sums: Sums
    dt: float
    """[s]"""


@structref.register
class PeriodType(types.StructRef):
    """What numba calls a `Period`."""


class Period(structref.StructRefProxy):
    """The tables of one control period, handed to compiled code once: each array costs as much to hand over as a
    wheel's law takes to prepare, and a step has some forty of them.
    """


structref.define_boxing(PeriodType, Period)
structref.define_constructor(Period, PeriodType, ["tables"])


@njit(cache=True)
def open_period(tables: PlantTables) -> Period:
    """Hand over the tables of a period."""
    return Period(tables)


@njit(cache=True)
def apply_forces(period: Period, step: int) -> bool:
    """Generalised force of contacts and joints; the joints' rotor inertia and implicit slopes go onto the
    mass matrix.

    Args:
        step: in the period, from 0.

    Returns:
        whether all contacts are on the map.
    """
    tables: PlantTables = period.tables
    multibody, motion, forces, work, dt = tables.multibody, tables.motion, tables.forces, tables.work, tables.dt
    velocity = motion.rates[step]
    forces.contacts[:] = 0.0
    machine = Kinematics(multibody.placements, multibody.jacobian, velocity)
    on_map: bool = contact_forces(
        tables.contacts, tables.ground, machine, dt, motion.contacts, tables.report, forces.contacts
    )
    total = tables.sums.contact_force
    for i in range(total.shape[0]):
        for k in range(3):
            total[i, k] += tables.report[i, ReportColumn.FORCE_X + k]
    work.force[:] = forces.contacts
    joint_torques(tables.joints, tables.command, (step + 1) * dt, velocity, dt, motion.joints, work)
    for column in tables.joints.columns:
        multibody.mass_matrix[column, column] += work.armature[column]
    for k in range(velocity.shape[0]):
        forces.net[k] = work.force[k] - multibody.bias[k]
    return on_map


@njit(cache=True)
def _coupling_impulse(coupling: FloatArray, response: FloatArray, error: FloatArray) -> FloatArray:
    """Impulses that take the errors of rate away: (A M⁻¹ Aᵀ)⁻¹ e, by Cholesky's factors; not finite where it cannot be.

    In plain loops: a library would add up in an order of its own, by the processor and its cores.

    Args:
        coupling: A, (couplings, nv). response: A M⁻¹, (couplings, nv). error: e, (couplings,).
    """
    count = error.shape[0]
    factor = np.zeros((count, count))
    impulse = error.copy()
    for i in range(count):
        for j in range(i + 1):
            entry = 0.0
            for k in range(coupling.shape[1]):
                entry += coupling[i, k] * response[j, k]
            for k in range(j):
                entry -= factor[i, k] * factor[j, k]
            factor[i, j] = entry / factor[j, j] if j < i else np.sqrt(entry)
        for k in range(i):
            impulse[i] -= factor[i, k] * impulse[k]
        impulse[i] /= factor[i, i]
    for i in range(count - 1, -1, -1):
        for k in range(i + 1, count):
            impulse[i] -= factor[k, i] * impulse[k]
        impulse[i] /= factor[i, i]
    return impulse


@njit(cache=True)
def _close_loops(multibody: Multibody, columns: IntArray, angles: FloatArray, dt: float, velocity: FloatArray) -> None:
    """Take from a velocity, (nv,), what the couplings do not allow. angles: of the joints, (joints,) [rad]."""
    coupling, response = multibody.coupling, multibody.response
    count = coupling.shape[0]
    error = np.empty(count)
    for i in range(count):
        drift = 0.0
        rate = 0.0
        for joint in range(columns.shape[0]):
            drift += coupling[i, columns[joint]] * angles[joint]
        for k in range(velocity.shape[0]):
            rate += coupling[i, k] * velocity[k]
        error[i] = rate + COUPLING_DRIFT_GAIN * drift / dt
    impulse = _coupling_impulse(coupling, response, error)
    for i in range(count):
        for k in range(velocity.shape[0]):
            velocity[k] -= response[i, k] * impulse[i]


@njit(cache=True)
def advance_velocity(period: Period, step: int, acceleration: FloatArray) -> None:
    """New velocity from the free acceleration and the couplings; books the joints' part of the step.

    Args:
        step: in the period, from 0. acceleration: (nv,) without couplings.
    """
    tables: PlantTables = period.tables
    multibody, motion, readings, sums, dt = tables.multibody, tables.motion, tables.readings, tables.sums, tables.dt
    velocity, new_velocity = motion.rates[step], motion.rates[step + 1]
    for k in range(velocity.shape[0]):
        new_velocity[k] = velocity[k] + dt * acceleration[k]
    if multibody.coupling.shape[0]:
        _close_loops(multibody, tables.joints.columns, motion.joints[ANGLE], dt, new_velocity)
    for k in range(velocity.shape[0]):
        motion.displacement[k] = new_velocity[k] * dt
        readings.energy[SOIL_WORK] -= tables.forces.contacts[k] * 0.5 * (velocity[k] + new_velocity[k]) * dt
    settle_joints(tables.joints, velocity, new_velocity, dt, tables.work.rows, motion.joints, readings)
    for i in range(readings.load_power.shape[0]):
        sums.load_energy[i] += readings.load_power[i] * dt
    for i in range(readings.currents.shape[0]):
        sums.current_squares[i] += readings.currents[i] * readings.currents[i]
