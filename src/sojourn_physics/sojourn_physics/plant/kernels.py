"""The compiled part of a physics step: from the terms of the machine's dynamics to its new velocity (see `step`)."""

import math
from typing import NamedTuple

from sojourn_machine.contact_report import ReportColumn
from sojourn_machine.kernels import kernel, njit, structref, types
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
from sojourn_physics.contact.tables import Ground, Kinematics, Supports, SupportStates, Touch, Workspace
from sojourn_physics.plant.inertia import Factors, factorise, solve

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
    factors: Factors
    """Of M with the joints' inertia."""
    response: FloatArray
    """A M⁻¹, (couplings, nv)."""
    factor: FloatArray
    """(couplings, couplings): Cholesky's, of A M⁻¹ Aᵀ."""
    impulse: FloatArray
    """(couplings,): of the last step."""


class Motion(NamedTuple):
    """What moves in a period."""

    rates: FloatArray
    """(steps + 1, nv): velocity at the start, and after each step."""
    displacement: FloatArray
    """(nv,): of the last step, on the group [m], [rad]."""
    joints: FloatArray
    """(STATE_ROWS, joints), see `joint_drive`."""
    supports: SupportStates
    """Of all supports."""


class Forces(NamedTuple):
    """Generalised forces of a step, each (nv,)."""

    contacts: FloatArray
    net: FloatArray
    """All that act, less the bias; then the acceleration that they give without couplings."""


class Sums(NamedTuple):
    """Over the steps of a period."""

    contact_force: FloatArray
    """(supports, 3): in map [N]."""
    current_squares: FloatArray
    """(joints,) [A²]"""
    load_energy: FloatArray
    """(loads,): of the motors on each load [J]."""


class PlantTables(NamedTuple):
    """All that the kernels of a step work on."""

    joints: Joints
    supports: Supports
    ground: Ground
    multibody: Multibody
    command: JointCommand
    motion: Motion
    forces: Forces
    work: JointWork
    readings: JointReadings
    report: FloatArray
    """(supports, REPORT_COLUMNS)"""
    workspace: Workspace
    sums: Sums
    dt: float
    """[s]"""


@structref.register
class PeriodHandleType(types.StructRef):
    """What numba calls a `PeriodHandle`."""


class PeriodHandle(structref.StructRefProxy):
    """The tables of one control period, handed to compiled code once: each array costs as much to hand over as a
    wheel's law takes to prepare, and a step has some forty of them.
    """


structref.define_boxing(PeriodHandleType, PeriodHandle)
structref.define_constructor(PeriodHandle, PeriodHandleType, ["tables"])


@njit(cache=True)
def open_period(tables: PlantTables) -> PeriodHandle:
    """Hand over the tables of a period."""
    return PeriodHandle(tables)


@kernel
def _touch_ground(tables: PlantTables, step: int) -> bool:
    """Write the generalised force of the contacts. Returns whether all of them are on the map."""
    multibody, motion, forces = tables.multibody, tables.motion, tables.forces
    forces.contacts[:] = 0.0
    machine = Kinematics(multibody.placements, multibody.jacobian, motion.rates[step])
    touch = Touch(motion.supports, tables.report, forces.contacts, tables.workspace)
    on_map: bool = contact_forces(tables.supports, tables.ground, machine, tables.dt, touch)
    return on_map


@kernel
def _apply_forces(tables: PlantTables, step: int) -> bool:
    """Net force of contacts and joints; the joints' rotor inertia and implicit slopes go onto the mass matrix.

    Returns:
        whether all contacts are on the map.
    """
    multibody, motion, forces, work, dt = tables.multibody, tables.motion, tables.forces, tables.work, tables.dt
    velocity = motion.rates[step]
    on_map: bool = _touch_ground(tables, step)
    total = tables.sums.contact_force
    for i in range(total.shape[0]):
        for k in range(3):
            total[i, k] += tables.report[i, ReportColumn.FORCE_X + k]
    for k in range(velocity.shape[0]):
        work.force[k] = forces.contacts[k]
    joint_torques(tables.joints, tables.command, (step + 1) * dt, velocity, dt, motion.joints, work)
    for column in tables.joints.columns:
        multibody.mass_matrix[column, column] += work.armature[column]
    for k in range(velocity.shape[0]):
        forces.net[k] = work.force[k] - multibody.bias[k]
    return on_map


@kernel
def _solve_impulse(multibody: Multibody) -> None:
    """Impulses that take errors of rate away, in their place: (A M⁻¹ Aᵀ)⁻¹ e, by Cholesky's factors; not finite where
    it cannot be.

    In plain loops: a library would add up in an order of its own, by the processor and its cores.
    """
    coupling, response = multibody.coupling, multibody.response
    factor, impulse = multibody.factor, multibody.impulse
    count = impulse.shape[0]
    for i in range(count):
        for j in range(i + 1):
            entry = 0.0
            for k in range(coupling.shape[1]):
                entry += coupling[i, k] * response[j, k]
            for k in range(j):
                entry -= factor[i, k] * factor[j, k]
            factor[i, j] = entry / factor[j, j] if j < i else math.sqrt(entry)
        for k in range(i):
            impulse[i] -= factor[i, k] * impulse[k]
        impulse[i] /= factor[i, i]
    for i in range(count - 1, -1, -1):
        for k in range(i + 1, count):
            impulse[i] -= factor[k, i] * impulse[k]
        impulse[i] /= factor[i, i]


@kernel
def _close_loops(multibody: Multibody, columns: IntArray, angles: FloatArray, dt: float, velocity: FloatArray) -> None:
    """Take from a velocity, (nv,), what the couplings do not allow. angles: of the joints, (joints,) [rad]."""
    coupling, response, impulse = multibody.coupling, multibody.response, multibody.impulse
    count = coupling.shape[0]
    for i in range(count):
        drift = 0.0
        rate = 0.0
        for joint in range(columns.shape[0]):
            drift += coupling[i, columns[joint]] * angles[joint]
        for k in range(velocity.shape[0]):
            rate += coupling[i, k] * velocity[k]
        impulse[i] = rate + COUPLING_DRIFT_GAIN * drift / dt
    _solve_impulse(multibody)
    for i in range(count):
        for k in range(velocity.shape[0]):
            velocity[k] -= response[i, k] * impulse[i]


@kernel
def _advance_velocity(tables: PlantTables, step: int) -> None:
    """New velocity from the net force and the couplings; books the joints' part of the step."""
    multibody, motion, readings, sums, dt = tables.multibody, tables.motion, tables.readings, tables.sums, tables.dt
    acceleration, response = tables.forces.net, multibody.response
    factorise(multibody.mass_matrix, multibody.factors)
    solve(multibody.factors, acceleration)
    for i in range(response.shape[0]):
        for k in range(response.shape[1]):
            response[i, k] = multibody.coupling[i, k]
        solve(multibody.factors, response[i])
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


@kernel
def _advance(tables: PlantTables, step: int) -> bool:
    on_map: bool = _apply_forces(tables, step)
    _advance_velocity(tables, step)
    return on_map


@njit(cache=True)
def advance(period: PeriodHandle, step: int) -> bool:
    """One physics step, but for the configuration: `motion.rates` and `displacement`, and all that is told of it.

    Args:
        period: with the placements, Jacobian, mass matrix and bias of the machine as it stands.
        step: in the period, from 0.

    Returns:
        whether all contacts are on the map.
    """
    on_map: bool = _advance(period.tables, step)
    return on_map


@njit(cache=True)
def touch_ground(period: PeriodHandle, step: int) -> bool:
    """The contacts alone, as `advance` has them: what they cost can so be told."""
    on_map: bool = _touch_ground(period.tables, step)
    return on_map
