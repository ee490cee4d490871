"""Pads on bodies: points where a chassis, a mast or an arm's tip would touch the ground (see `pad_on_soil`)."""

from sojourn_machine.contact_report import ReportColumn
from sojourn_machine.kernels import kernel
from sojourn_physics.contact.carrying import add_force, move_body, place_body
from sojourn_physics.contact.pad_on_soil import Pad, is_clear, pad_forces
from sojourn_physics.contact.tables import Ground, Kinematics, PadTable, Touch


@kernel
def pads_on_ground(pads: PadTable, ground: Ground, machine: Kinematics, dt: float, touch: Touch) -> bool:
    """Forces of all pads, added to the generalised force. Returns whether all of them are on the map."""
    on_map = True
    carried, work = pads.carried, touch.workspace
    centre = work.body.centre
    for i in range(pads.radii.shape[0]):
        state, report = touch.states.pads[i], touch.report[carried.first + i]
        pad = Pad(pads.radii[i], pads.cuts[i], pads.tools[i])
        place_body(carried, i, machine.placements, work.body)
        if is_clear(pad, centre, ground):  # nearly all, nearly always
            state[:] = 0.0
            report[:] = 0.0
            for k in range(3):
                report[ReportColumn.X + k] = centre[k]
            continue
        move_body(carried.chains[i], machine, work.twist, work.body)
        on_map &= pad_forces(pad, ground, dt, state, report, work)
        add_force(carried.chains[i], machine.jacobian, centre, work.wrench, touch.force)
    return on_map
