"""All contacts of a machine with the ground, in one call: geometry, law, generalised force.

For each wheel: where it touches the ground and how it moves there (`wheel_contact`), what the law that its
row names makes of that (`dispatch`), and the force and moment in map, as a generalised force through the
Jacobian. Pads on bodies have a law and a geometry of their own (`pad_on_soil`).
"""

import numpy as np

from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray, IntArray
from sojourn_physics.contact.contact_law import (
    MOTION_COLUMNS,
    OUT_COLUMNS,
    OutColumn,
    StateColumn,
    WheelColumn,
)
from sojourn_physics.contact.dispatch import apply_law
from sojourn_physics.contact.ground_memory import PAST_COLUMNS, leave_rut
from sojourn_physics.contact.pad_on_soil import is_clear, pad_forces
from sojourn_physics.contact.wheel_contact import FRAME_VECTORS, find_contact
from sojourn_physics.terrain.height_field import HeightArray, SoilArray
from sojourn_physics.terrain.memory_tiles import MemoryTables

REPORT_COLUMNS = 16
"""x y z [m], sinkage [m], slip ratio, slip angle [rad], force x y z in map [N], torque [N m], soil index,
deflection of the wheel [m], rolling, compaction and bulldozing resistance [N], power into the contact [W]."""

_RADIUS = int(WheelColumn.RADIUS)
_TRAVEL = int(StateColumn.TRAVEL)
_FORCE_X = int(OutColumn.FORCE_X)
_FORCE_Y = int(OutColumn.FORCE_Y)
_FORCE_Z = int(OutColumn.FORCE_Z)
_MOMENT_X = int(OutColumn.MOMENT_X)
_MOMENT_Y = int(OutColumn.MOMENT_Y)
_MOMENT_Z = int(OutColumn.MOMENT_Z)
_TORQUE = int(OutColumn.TORQUE)
_SINKAGE = int(OutColumn.SINKAGE)
_DEFLECTION = int(OutColumn.DEFLECTION)
_SLIP_RATIO = int(OutColumn.SLIP_RATIO)
_SLIP_ANGLE = int(OutColumn.SLIP_ANGLE)
_ROLLING = int(OutColumn.ROLLING_RESISTANCE)
_COMPACTION = int(OutColumn.COMPACTION_RESISTANCE)
_BULLDOZING = int(OutColumn.BULLDOZING_RESISTANCE)
_POWER = int(OutColumn.POWER)


@njit(cache=True)
def _to_map(
    out: FloatArray, frame: FloatArray, axle: FloatArray, velocity: FloatArray, omega: FloatArray, wrench: FloatArray
) -> None:
    """Force and moment at the wheel's centre in map, and the power that they take from the wheel."""
    along, side, normal = frame[3], frame[4], frame[5]
    power = 0.0
    for k in range(3):
        wrench[k] = out[_FORCE_X] * along[k] + out[_FORCE_Y] * side[k] + out[_FORCE_Z] * normal[k]
        moment = out[_MOMENT_X] * along[k] + out[_MOMENT_Y] * side[k] + out[_MOMENT_Z] * normal[k]
        wrench[3 + k] = moment - out[_TORQUE] * axle[k]
        power -= wrench[k] * velocity[k] + wrench[3 + k] * omega[k]
    out[_POWER] = power


@njit(cache=True)
def _tell(out: FloatArray, wrench: FloatArray, soil_number: int, report: FloatArray) -> None:
    """What a contact does, from its law's answer; the place is told already."""
    report[3] = out[_SINKAGE]
    report[4] = out[_SLIP_RATIO]
    report[5] = out[_SLIP_ANGLE]
    report[6:9] = wrench[0:3]
    report[9] = out[_TORQUE]
    report[10] = soil_number
    report[11] = out[_DEFLECTION]
    report[12] = out[_ROLLING]
    report[13] = out[_COMPACTION]
    report[14] = out[_BULLDOZING]
    report[15] = out[_POWER]


@njit(cache=True)
def contact_forces(
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
    dt: float,
    states: FloatArray,
    report: FloatArray,
    generalised_force: FloatArray,
) -> bool:
    """Forces of all contacts, as one generalised force.

    Args:
        wheels: (contacts, WHEEL_COLUMNS): rows of wheels, then of pads (see `params.kernel_rows`).
        bodies: (contacts,): index of the joint that carries the contact.
        supports: (contacts, depth): columns of the Jacobian that move it, filled with -1.
        offsets: (contacts, 3): point in the joint's frame [m].
        wheel_count: the first so many contacts are wheels, whose axle is the y axis of their joint.
        placements: (joints, 12): rotation (columns one after another) and position of each joint in map.
        jacobian: (6, nv), of the machine at the map's origin, linear rows first. velocity: (nv,).
        heights, soil_index, grid: the ground; soils: kernel rows.
        rim: (2, samples) sines and cosines of the rim's angles that are looked at.
        memory: of the ground, tables of a MemoryBoard; advanced in place.
        states: (contacts, STATE_COLUMNS), advanced in place. report: (contacts, REPORT_COLUMNS), written.
        generalised_force: (nv,), added to.

    Returns:
        whether every contact is on the map.
    """
    on_map = True
    centre = np.empty(3)
    axle = np.empty(3)
    point_velocity = np.empty(3)
    wrench = np.empty(6)
    twist = np.empty(6)
    frame = np.empty((FRAME_VECTORS, 3))
    motion = np.empty(MOTION_COLUMNS)
    out = np.empty(OUT_COLUMNS)
    shares = np.empty(soils.shape[0])
    soil = np.empty(soils.shape[1])
    past = np.empty(PAST_COLUMNS)
    remembers = memory[3][2] > 0.0
    for i in range(bodies.shape[0]):
        body = placements[bodies[i]]
        for k in range(3):
            centre[k] = body[9 + k]
            for j in range(3):
                centre[k] += body[3 * j + k] * offsets[i, j]
            axle[k] = body[3 + k]
        if i >= wheel_count and is_clear(wheels[i], centre, heights, grid, memory):  # nearly all pads, nearly always
            states[i, :] = 0.0
            report[i, :] = 0.0
            report[i, 0:3] = centre
            continue
        twist[:] = 0.0
        for column in supports[i]:
            if column < 0:
                break
            for k in range(6):
                twist[k] += jacobian[k, column] * velocity[column]
        omega = twist[3:6]
        point_velocity[0] = twist[0] + twist[4] * centre[2] - twist[5] * centre[1]
        point_velocity[1] = twist[1] + twist[5] * centre[0] - twist[3] * centre[2]
        point_velocity[2] = twist[2] + twist[3] * centre[1] - twist[4] * centre[0]
        if i < wheel_count:
            radius = wheels[i, _RADIUS]
            wrench[:] = 0.0
            report[i, :] = 0.0
            touches, soil_number, inside = find_contact(
                wheels[i], centre, axle, point_velocity, omega, heights, soil_index, grid, soils, rim, memory,
                states[i, _TRAVEL], frame, motion, shares, soil, past,
            )  # fmt: skip
            on_map &= inside
            if touches:
                out[:] = 0.0
                apply_law(wheels[i], soil, motion, dt, states[i], out)
                _to_map(out, frame, axle, point_velocity, omega, wrench)
                _tell(out, wrench, soil_number, report[i])
                if remembers:
                    leave_rut(memory, wheels[i], soil, out[_SINKAGE], frame[0], states[i], past)
                for k in range(3):
                    report[i, k] = centre[k] - radius * frame[2, k]
            else:
                states[i, :] = 0.0
                report[i, 0] = centre[0]
                report[i, 1] = centre[1]
                report[i, 2] = centre[2] - radius
        else:
            on_map &= pad_forces(
                wheels[i], centre, point_velocity, heights, soil_index, grid, soils, memory, dt, states[i], wrench,
                report[i],
            )  # fmt: skip
        # moment about the map's origin
        wrench[3] += centre[1] * wrench[2] - centre[2] * wrench[1]
        wrench[4] += centre[2] * wrench[0] - centre[0] * wrench[2]
        wrench[5] += centre[0] * wrench[1] - centre[1] * wrench[0]
        for column in supports[i]:
            if column < 0:
                break
            for k in range(6):
                generalised_force[column] += jacobian[k, column] * wrench[k]
    return on_map
