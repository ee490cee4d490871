"""Feet of legs on the ground: flat pads that stand on the z axis of their frame, with the law that their row names.

A foot meets the plane through the ground under its centre, as ruts and holes have left it. Along is the foot's own x
axis, laid onto that plane; the foot turns about the plane's normal as its leg does. What tilts a foot against the
ground is left to its ankle: the contact has no moment about the axes of the plane.
"""

import math

from sojourn_machine.contact_report import ReportColumn
from sojourn_machine.kernels import kernel, small_kernel
from sojourn_machine.params import FloatArray
from sojourn_physics.contact.carrying import add_force, move_body, place_body, tell, wrench_in_map
from sojourn_physics.contact.contact_law import MotionColumn
from sojourn_physics.contact.law_call import apply_law
from sojourn_physics.contact.tables import FootTable, Ground, Kinematics, Touch, Workspace
from sojourn_physics.terrain.height_field import sample_ground, sample_soil
from sojourn_physics.terrain.memory_access import read_lowered

HIGHEST_HEAP = 0.1
"""A foot so far above the ground as it was meets no heap of soil [m]."""
LEAST_AHEAD = 1e-6
"""A foot that points so nearly along the normal has no direction along the ground: any will do."""


@small_kernel
def _lay_frame(joint: FloatArray, axes: FloatArray, slope_x: float, slope_y: float, frame: FloatArray) -> None:
    """Along, side and normal of a foot's contact into the last three rows of a meeting's frame."""
    along, side, normal = frame[3], frame[4], frame[5]
    norm = 1.0 / math.sqrt(1.0 + slope_x * slope_x + slope_y * slope_y)
    normal[0], normal[1], normal[2] = -slope_x * norm, -slope_y * norm, norm
    for k in range(3):
        along[k] = joint[k] * axes[0, 0] + joint[3 + k] * axes[0, 1] + joint[6 + k] * axes[0, 2]
    out_of_plane = along[0] * normal[0] + along[1] * normal[1] + along[2] * normal[2]
    for k in range(3):
        along[k] -= out_of_plane * normal[k]
    length = math.sqrt(along[0] ** 2 + along[1] ** 2 + along[2] ** 2)
    if length < LEAST_AHEAD:
        along[0], along[1], along[2] = norm, 0.0, slope_x * norm
        length = math.sqrt(along[0] ** 2 + along[2] ** 2)
    for k in range(3):
        along[k] /= length
    side[0] = normal[1] * along[2] - normal[2] * along[1]
    side[1] = normal[2] * along[0] - normal[0] * along[2]
    side[2] = normal[0] * along[1] - normal[1] * along[0]


@small_kernel
def _foot(
    row: FloatArray, ground: Ground, dt: float, state: FloatArray, report: FloatArray, work: Workspace, height: float
) -> None:
    """One foot on the ground at a height: its wrench, state and report."""
    body, meeting, out = work.body, work.meeting, work.out
    centre, velocity, turning, motion = body.centre, body.velocity, body.angular_velocity, meeting.motion
    along, side, normal = meeting.frame[3], meeting.frame[4], meeting.frame[5]
    grid = ground.grid
    soil_number = sample_soil(ground.soil_index, grid[0], grid[1], grid[2], centre[0], centre[1])
    for k in range(meeting.soil.shape[0]):
        meeting.soil[k] = ground.soils[soil_number, k]
    motion[:] = 0.0
    motion[MotionColumn.PENETRATION] = (height - centre[2]) * normal[2]
    for k in range(3):
        motion[MotionColumn.V_ALONG] += velocity[k] * along[k]
        motion[MotionColumn.V_SIDE] += velocity[k] * side[k]
        motion[MotionColumn.V_NORMAL] += velocity[k] * normal[k]
        motion[MotionColumn.YAW_RATE] += turning[k] * normal[k]
    out[:] = 0.0
    apply_law(row, meeting.soil, motion, dt, state, out)
    body.axle[:] = 0.0
    wrench_in_map(out, meeting.frame, body, work.wrench)
    tell(out, work.wrench, soil_number, report)


@kernel
def feet_on_ground(feet: FootTable, ground: Ground, machine: Kinematics, dt: float, touch: Touch) -> bool:
    """Forces of all feet, added to the generalised force. Returns whether all of them are on the map."""
    on_map = True
    carried, work = feet.carried, touch.workspace
    centre = work.body.centre
    for i in range(feet.rows.shape[0]):
        state, report = touch.states.feet[i], touch.report[carried.first + i]
        place_body(carried, i, machine.placements, work.body)
        report[:] = 0.0
        for k in range(3):
            report[ReportColumn.X + k] = centre[k]
        height, slope_x, slope_y, inside = sample_ground(ground.heights, ground.grid, centre[0], centre[1])
        if ground.memory.place[2] > 0.0 and centre[2] < height + HIGHEST_HEAP:
            height -= read_lowered(ground.memory, centre[0], centre[1])
        if height <= centre[2]:
            state[:] = 0.0
            continue
        on_map &= inside
        move_body(carried.chains[i], machine, work.twist, work.body)
        _lay_frame(machine.placements[carried.bodies[i]], feet.frames[i], slope_x, slope_y, work.meeting.frame)
        _foot(feet.rows[i], ground, dt, state, report, work, height)
        add_force(carried.chains[i], machine.jacobian, centre, work.wrench, touch.force)
    return on_map
