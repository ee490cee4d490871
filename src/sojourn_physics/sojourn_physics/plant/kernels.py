"""The two compiled halves of a physics step.

Pinocchio's terms and the solution stand between them (see `step`).
"""

import numpy as np

from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray, IntArray
from sojourn_physics.actuators.joint_drive import joint_torques, settle_joints
from sojourn_physics.contact.contact_set import contact_forces
from sojourn_physics.terrain.height_field import HeightArray, SoilArray
from sojourn_physics.terrain.memory_tiles import MemoryTables

COUPLING_DRIFT_GAIN = 0.1
"""Part of a coupling's drift that is taken back in one step."""
SOIL_WORK = 4
"""Place of the work on the soil in the energy sums, after `joint_drive.ENERGY_TERMS`."""
ENERGY_SUMS = 5


@njit(cache=True)
def applied_forces(
    joint_parameters: FloatArray,
    kinds: IntArray,
    columns: IntArray,
    wheels: FloatArray,
    bodies: IntArray,
    supports: IntArray,
    offsets: FloatArray,
    wheel_count: int,
    placements: FloatArray,
    jacobian: FloatArray,
    velocity: FloatArray,
    heights: HeightArray,
    soil_index: SoilArray,
    grid: FloatArray,
    soils: FloatArray,
    rim: FloatArray,
    memory: MemoryTables,
    joint_states: FloatArray,
    contact_states: FloatArray,
    reference: FloatArray,
    limits: FloatArray,
    lead: float,
    bus_voltage: float,
    dt: float,
    report: FloatArray,
    work: FloatArray,
    contact_force: FloatArray,
    force: FloatArray,
    armature: FloatArray,
    mass_matrix: FloatArray,
) -> bool:
    """Generalised force of contacts and joints; the joints' rotor inertia and implicit slopes go onto the
    mass matrix.

    Arguments as in `contact_forces` and `joint_torques`; `contact_force` and `force`, both (nv,), are
    written: that of the contacts alone, and all. `mass_matrix`, (nv, nv), is that of the links; its diagonal
        is added to. Returns whether all contacts are on the map.
    """
    contact_force[:] = 0.0
    on_map: bool = contact_forces(
        wheels, bodies, supports, offsets, wheel_count, placements, jacobian, velocity, heights, soil_index,
        grid, soils, rim, memory, dt, contact_states, report, contact_force,
    )  # fmt: skip
    force[:] = contact_force
    joint_torques(
        joint_parameters, kinds, columns, velocity, joint_states, reference, lead, limits, bus_voltage, dt, work,
        force, armature,
    )  # fmt: skip
    for column in columns:
        mass_matrix[column, column] += armature[column]
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
def advance_velocity(
    joint_parameters: FloatArray,
    kinds: IntArray,
    columns: IntArray,
    loads: IntArray,
    velocity: FloatArray,
    acceleration: FloatArray,
    coupling: FloatArray,
    coupling_response: FloatArray,
    contact_force: FloatArray,
    dt: float,
    work: FloatArray,
    joint_states: FloatArray,
    efforts: FloatArray,
    currents: FloatArray,
    load_power: FloatArray,
    load_energy: FloatArray,
    energy: FloatArray,
) -> FloatArray:
    """New velocity, (nv,), from the free acceleration and the couplings; books the joints' part of the step.

    Args:
        acceleration: (nv,) without couplings. coupling: A, (couplings, nv). coupling_response: A M⁻¹,
            (couplings, nv).
    """
    new_velocity = velocity + dt * acceleration
    count = coupling.shape[0]
    if count:
        error = np.empty(count)
        for i in range(count):
            drift = 0.0
            rate = 0.0
            for joint in range(columns.shape[0]):
                drift += coupling[i, columns[joint]] * joint_states[0, joint]
            for k in range(new_velocity.shape[0]):
                rate += coupling[i, k] * new_velocity[k]
            error[i] = rate + COUPLING_DRIFT_GAIN * drift / dt
        impulse = _coupling_impulse(coupling, coupling_response, error)
        for i in range(count):
            for k in range(new_velocity.shape[0]):
                new_velocity[k] -= coupling_response[i, k] * impulse[i]
    for k in range(new_velocity.shape[0]):
        energy[SOIL_WORK] -= contact_force[k] * 0.5 * (velocity[k] + new_velocity[k]) * dt
    settle_joints(
        joint_parameters, kinds, columns, loads, velocity, new_velocity, dt, work, joint_states, efforts,
        currents, load_power, energy,
    )  # fmt: skip
    for i in range(load_power.shape[0]):
        load_energy[i] += load_power[i] * dt
    return new_velocity
