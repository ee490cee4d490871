"""Wheels on the ground: where they touch it and how they move there (`wheel_contact`), what the law that the row names
makes of that (`law_call`), and the force and moment in map, as a generalised force.
"""

from sojourn_machine.contact_report import ReportColumn
from sojourn_machine.kernels import kernel, small_kernel
from sojourn_machine.params import FloatArray
from sojourn_physics.contact.carrying import add_force, move_body, place_body, tell, wrench_in_map
from sojourn_physics.contact.contact_law import OutColumn, StateColumn, WheelColumn
from sojourn_physics.contact.ground_memory import leave_rut
from sojourn_physics.contact.law_call import apply_law
from sojourn_physics.contact.tables import Ground, Kinematics, Touch, WheelTable, Workspace
from sojourn_physics.contact.wheel_contact import find_contact


@small_kernel
def _wheel(row: FloatArray, ground: Ground, dt: float, state: FloatArray, report: FloatArray, work: Workspace) -> bool:
    """One wheel: its wrench, state and report. Returns whether what is under it is on the map."""
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
        wrench_in_map(out, frame, body, wrench)
        tell(out, wrench, soil_number, report)
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
def wheels_on_ground(wheels: WheelTable, ground: Ground, machine: Kinematics, dt: float, touch: Touch) -> bool:
    """Forces of all wheels, added to the generalised force. Returns whether all of them are on the map."""
    on_map = True
    carried, work = wheels.carried, touch.workspace
    for i in range(wheels.rows.shape[0]):
        place_body(carried, i, machine.placements, work.body)
        move_body(carried.chains[i], machine, work.twist, work.body)
        on_map &= _wheel(wheels.rows[i], ground, dt, touch.states.wheels[i], touch.report[carried.first + i], work)
        add_force(carried.chains[i], machine.jacobian, work.body.centre, work.wrench, touch.force)
    return on_map
