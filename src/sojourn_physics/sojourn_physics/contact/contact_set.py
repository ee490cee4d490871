"""All contacts of a machine with the ground, in one call: geometry, law, generalised force.

For each wheel: where it touches the ground and how it moves there (`wheel_contact`), what the law that its
row names makes of that (`dispatch`), and the force and moment in map, as a generalised force through the
Jacobian. Pads on bodies have a law and a geometry of their own (`pad_on_soil`).
"""

from sojourn_machine.contact_report import ReportColumn
from sojourn_machine.kernels import kernel, small_kernel
from sojourn_machine.params import FloatArray, IntArray
from sojourn_physics.contact.contact_law import (
    OutColumn,
    StateColumn,
    WheelColumn,
)
from sojourn_physics.contact.ground_memory import leave_rut
from sojourn_physics.contact.law_call import apply_law
from sojourn_physics.contact.pad_on_soil import is_clear, pad_forces
from sojourn_physics.contact.tables import Body, Contacts, Ground, Kinematics, Touch
from sojourn_physics.contact.wheel_contact import find_contact


@small_kernel
def _to_map(out: FloatArray, frame: FloatArray, body: Body, wrench: FloatArray) -> None:
    """Force and moment at the wheel's centre in map, and the power that they take from the wheel."""
    along, side, normal = frame[3], frame[4], frame[5]
    power = 0.0
    for k in range(3):
        wrench[k] = (
            out[OutColumn.FORCE_X] * along[k] + out[OutColumn.FORCE_Y] * side[k] + out[OutColumn.FORCE_Z] * normal[k]
        )
        moment = (
            out[OutColumn.MOMENT_X] * along[k] + out[OutColumn.MOMENT_Y] * side[k] + out[OutColumn.MOMENT_Z] * normal[k]
        )
        wrench[3 + k] = moment - out[OutColumn.TORQUE] * body.axle[k]
        power -= wrench[k] * body.velocity[k] + wrench[3 + k] * body.angular_velocity[k]
    out[OutColumn.POWER] = power


@small_kernel
def _tell(out: FloatArray, wrench: FloatArray, soil_number: int, report: FloatArray) -> None:
    """What a contact does, from its law's answer; the place is told already."""
    report[ReportColumn.SINKAGE] = out[OutColumn.SINKAGE]
    report[ReportColumn.SLIP_RATIO] = out[OutColumn.SLIP_RATIO]
    report[ReportColumn.SLIP_ANGLE] = out[OutColumn.SLIP_ANGLE]
    for k in range(3):
        report[ReportColumn.FORCE_X + k] = wrench[k]
    report[ReportColumn.TORQUE] = out[OutColumn.TORQUE]
    report[ReportColumn.SOIL] = soil_number
    report[ReportColumn.DEFLECTION] = out[OutColumn.DEFLECTION]
    report[ReportColumn.ROLLING_RESISTANCE] = out[OutColumn.ROLLING_RESISTANCE]
    report[ReportColumn.COMPACTION_RESISTANCE] = out[OutColumn.COMPACTION_RESISTANCE]
    report[ReportColumn.BULLDOZING_RESISTANCE] = out[OutColumn.BULLDOZING_RESISTANCE]
    report[ReportColumn.POWER] = out[OutColumn.POWER]


@small_kernel
def _place_body(contacts: Contacts, i: int, placements: FloatArray, body: Body) -> None:
    """Centre and axle of a contact's body, from the placement of the joint that carries it."""
    joint = placements[contacts.bodies[i]]
    for k in range(3):
        body.centre[k] = joint[9 + k]
        for j in range(3):
            body.centre[k] += joint[3 * j + k] * contacts.offsets[i, j]
        body.axle[k] = joint[3 + k]


@small_kernel
def _move_body(support: IntArray, machine: Kinematics, twist: FloatArray, body: Body) -> None:
    """Velocities of a contact's body. twist: (6,), written: those of the point of the body at the map's origin."""
    twist[:] = 0.0
    for column in support:
        if column < 0:
            break
        for k in range(6):
            twist[k] += machine.jacobian[k, column] * machine.velocity[column]
    centre, velocity = body.centre, body.velocity
    velocity[0] = twist[0] + twist[4] * centre[2] - twist[5] * centre[1]
    velocity[1] = twist[1] + twist[5] * centre[0] - twist[3] * centre[2]
    velocity[2] = twist[2] + twist[3] * centre[1] - twist[4] * centre[0]


@small_kernel
def _add_force(
    support: IntArray, jacobian: FloatArray, centre: FloatArray, wrench: FloatArray, force: FloatArray
) -> None:
    """Add a wrench at a point to the generalised force; `wrench` is left with its moment about the map's origin."""
    wrench[3] += centre[1] * wrench[2] - centre[2] * wrench[1]
    wrench[4] += centre[2] * wrench[0] - centre[0] * wrench[2]
    wrench[5] += centre[0] * wrench[1] - centre[1] * wrench[0]
    for column in support:
        if column < 0:
            break
        for k in range(6):
            force[column] += jacobian[k, column] * wrench[k]


@small_kernel
def _wheel(i: int, contacts: Contacts, ground: Ground, dt: float, touch: Touch) -> bool:
    """One wheel: its wrench, state and report. Returns whether what is under it is on the map."""
    row, state, report, work = contacts.rows[i], touch.states[i], touch.report[i], touch.workspace
    body, meeting, wrench, out = work.body, work.meeting, work.wrench, work.out
    centre, frame = body.centre, meeting.frame
    radius = row[WheelColumn.RADIUS]
    wrench[:] = 0.0
    report[:] = 0.0
    on_map: bool
    touches, soil_number, on_map = find_contact(row, body, ground, state[StateColumn.TRAVEL], meeting)
    if touches:
        out[:] = 0.0
        apply_law(row, meeting.soil, meeting.motion, dt, state, out)
        _to_map(out, frame, body, wrench)
        _tell(out, wrench, soil_number, report)
        if ground.memory.place[2] > 0.0:
            leave_rut(ground.memory, row, meeting.soil, out[OutColumn.SINKAGE], frame[0], state, meeting.past)
        for k in range(3):
            report[ReportColumn.X + k] = centre[k] - radius * frame[2, k]
    else:
        state[:] = 0.0
        report[ReportColumn.X] = centre[0]
        report[ReportColumn.Y] = centre[1]
        report[ReportColumn.Z] = centre[2] - radius
    return on_map


@kernel
def contact_forces(contacts: Contacts, ground: Ground, machine: Kinematics, dt: float, touch: Touch) -> bool:
    """Forces of all contacts, as one generalised force.

    Returns:
        whether every contact is on the map.
    """
    on_map = True
    work = touch.workspace
    centre = work.body.centre
    for i in range(contacts.bodies.shape[0]):
        _place_body(contacts, i, machine.placements, work.body)
        if i >= contacts.wheel_count and is_clear(contacts.rows[i], centre, ground):  # nearly all pads, nearly always
            touch.states[i, :] = 0.0
            touch.report[i, :] = 0.0
            for k in range(3):
                touch.report[i, ReportColumn.X + k] = centre[k]
            continue
        support = contacts.supports[i]
        _move_body(support, machine, work.twist, work.body)
        if i < contacts.wheel_count:
            on_map &= _wheel(i, contacts, ground, dt, touch)
        else:
            on_map &= pad_forces(contacts.rows[i], ground, dt, touch.states[i], touch.report[i], work)
        _add_force(support, machine.jacobian, centre, work.wrench, touch.force)
    return on_map
