"""Tracks on the ground: where each plate lies and moves (`track_on_soil` has what the soil makes of that).

A plate meets the plane through the ground under its edges: four points, half a plate ahead and behind and half the
width to either side, so that on a plane, tilted or not, all is exact, and on rough ground a plate rests on the mean.
Its depth is counted along that plane's normal; the belt runs along the plate, laid onto the plane. All forces of a
track are told as one contact, at the middle of its pressure.
"""

import math
from typing import NamedTuple

from sojourn_machine.contact_report import ReportColumn
from sojourn_machine.kernels import kernel, small_kernel
from sojourn_machine.params import FloatArray
from sojourn_physics.contact.carrying import add_force, move_body, move_point, place_body
from sojourn_physics.contact.contact_law import REST_SPEED, StateColumn
from sojourn_physics.contact.shear_memory import clip
from sojourn_physics.contact.tables import Ground, Kinematics, Touch, TrackTable, Workspace
from sojourn_physics.contact.track_on_soil import (
    GREATEST,
    RUT,
    LinkSliding,
    Plate,
    PlateColumn,
    TrackColumn,
    pass_ground,
    plate_force,
    shift,
)
from sojourn_physics.contact.wheel_on_soil import pressure_modulus
from sojourn_physics.soil.params import SoilColumn
from sojourn_physics.soil.repeated_loading import rut_depth
from sojourn_physics.terrain.height_field import sample_ground, sample_soil
from sojourn_physics.terrain.memory_access import Patch, Trace, read_ground, write_ground

HIGHEST_HEAP = 0.1
"""A plate so far above the ground as it was lies on no heap of soil [m]."""
ROLLING = 0.5
"""Least |H| at which a track leaves a rut: a parked one changes nothing."""
LEAST_LEVEL = 1e-6
"""A plate that stands so nearly upright has no direction over the ground [-]."""


class TrackSums(NamedTuple):
    """A track's forces as they are summed up, plate after plate."""

    frame: FloatArray
    """(FRAME_VECTORS, 3): the plate's centre, direction and velocity, then along, side and normal of the ground."""
    middle: FloatArray
    """(3,): the point that the moment is about [m]."""
    wrench: FloatArray
    """(6,)"""
    report: FloatArray
    """Row of `ReportColumn`, in which what is a mean is still a sum over the loads."""
    arm: FloatArray
    force: FloatArray
    """(3,), (3,): room to work in."""


@small_kernel
def _place_plate(plate: FloatArray, joint: FloatArray, centre: FloatArray, ahead: FloatArray) -> None:
    """Centre and direction of a plate in map, from the placement of its joint."""
    for k in range(3):
        centre[k] = joint[9 + k]
        ahead[k] = 0.0
        for j in range(3):
            centre[k] += joint[3 * j + k] * plate[PlateColumn.X + j]
            ahead[k] += joint[3 * j + k] * plate[PlateColumn.AHEAD_X + j]


@small_kernel
def _plane(ground: Ground, track: FloatArray, frame: FloatArray) -> tuple[float, bool]:
    """Plane under a plate, whose centre and direction are the first rows of `frame`: its along, side and normal into
    the last three.

    Returns:
        its height under the plate's centre [m], and whether it is on the map. A plate that is upright or upside down
        meets none: minus infinity.
    """
    centre, ahead = frame[0], frame[1]
    along, side, normal = frame[3], frame[4], frame[5]
    level = math.sqrt(ahead[0] * ahead[0] + ahead[1] * ahead[1])
    if level < LEAST_LEVEL:
        return -math.inf, True
    x, y = ahead[0] / level, ahead[1] / level
    half, edge = 0.5 * track[TrackColumn.PITCH], 0.5 * track[TrackColumn.WIDTH]
    heights, grid = ground.heights, ground.grid
    front, _, _, on_map = sample_ground(heights, grid, centre[0] + half * x, centre[1] + half * y)
    rear, _, _, on_map_too = sample_ground(heights, grid, centre[0] - half * x, centre[1] - half * y)
    left, _, _, _ = sample_ground(heights, grid, centre[0] - edge * y, centre[1] + edge * x)
    right, _, _, _ = sample_ground(heights, grid, centre[0] + edge * y, centre[1] - edge * x)
    slope, lateral = 0.5 * (front - rear) / half, 0.5 * (left - right) / edge
    slope_x, slope_y = slope * x - lateral * y, slope * y + lateral * x
    norm = 1.0 / math.sqrt(1.0 + slope_x * slope_x + slope_y * slope_y)
    normal[0], normal[1], normal[2] = -slope_x * norm, -slope_y * norm, norm
    length = math.sqrt(1.0 + slope * slope)
    along[0], along[1], along[2] = x / length, y / length, slope / length
    side[0] = normal[1] * along[2] - normal[2] * along[1]
    side[1] = normal[2] * along[0] - normal[0] * along[2]
    side[2] = normal[0] * along[1] - normal[1] * along[0]
    height: float = 0.25 * (front + rear + left + right)
    return height, on_map and on_map_too


@small_kernel
def _lift(state: FloatArray) -> None:
    """A plate that leaves the ground forgets its shear; the ground under it keeps its past."""
    greatest, rut = state[GREATEST], state[RUT]
    state[:] = 0.0
    state[GREATEST], state[RUT] = greatest, rut


@small_kernel
def _press(
    track: FloatArray, plate: Plate, belt: float, soil: FloatArray, dt: float, state: FloatArray, sums: TrackSums
) -> float:
    """One plate that lies on the ground: its force goes to the sums. Returns the load on it [N].

    Args:
        belt: speed of the belt over the hull [m/s]. soil: row of `SoilColumn` under it.
        sums: its frame and velocity are given, its force, moment and report added to.
    """
    frame, wrench, report = sums.frame, sums.wrench, sums.report
    centre, ahead, velocity = frame[0], frame[1], frame[2]
    along, side, normal = frame[3], frame[4], frame[5]
    v_along = v_side = v_normal = runs = 0.0
    for k in range(3):
        v_along += velocity[k] * along[k]
        v_side += velocity[k] * side[k]
        v_normal += velocity[k] * normal[k]
        runs += ahead[k] * along[k]
    found = plate_force(track, plate, soil, LinkSliding(belt * runs - v_along, -v_side, v_along, v_normal), dt, state)
    resisting = found.shear_along - (found.compaction + found.bulldozing) * found.headway
    arm, force = sums.arm, sums.force
    for k in range(3):
        force[k] = resisting * along[k] + found.shear_side * side[k] + found.normal * normal[k]
        arm[k] = centre[k] - sums.middle[k]
        wrench[k] += force[k]
        report[ReportColumn.X + k] += found.normal * centre[k]
        report[ReportColumn.POWER] -= force[k] * velocity[k]
    wrench[3] += arm[1] * force[2] - arm[2] * force[1]
    wrench[4] += arm[2] * force[0] - arm[0] * force[2]
    wrench[5] += arm[0] * force[1] - arm[1] * force[0]
    report[ReportColumn.TORQUE] += track[TrackColumn.RADIUS] * found.shear_along * runs
    report[ReportColumn.POWER] += belt * found.shear_along * runs
    report[ReportColumn.SINKAGE] += found.normal * plate.depth
    report[ReportColumn.COMPACTION_RESISTANCE] += found.compaction * abs(found.headway)
    report[ReportColumn.BULLDOZING_RESISTANCE] += found.bulldozing * abs(found.headway)
    return float(found.normal)


@small_kernel
def _leave_rut(ground: Ground, track: FloatArray, state: FloatArray, depth: float, sums: TrackSums) -> None:
    """Write behind the last plate what the track has done to the ground, down to a depth below what it met [m]."""
    headway = state[StateColumn.HEADWAY]
    if abs(headway) < ROLLING:
        return
    centre, along = sums.frame[0], sums.frame[3]
    grid, memory = ground.grid, ground.memory
    soil = ground.soils[sample_soil(ground.soil_index, grid[0], grid[1], grid[2], centre[0], centre[1])]
    greatest = max(state[RUT] + depth, state[GREATEST])
    rut = rut_depth(
        pressure_modulus(soil, track[TrackColumn.WIDTH]), soil[SoilColumn.N], greatest,
        soil[SoilColumn.UNLOADING_STIFFNESS], soil[SoilColumn.UNLOADING_STIFFNESS_PER_SINKAGE],
    )  # fmt: skip
    if rut <= 0.0:
        return
    sense = 1.0 if headway > 0.0 else -1.0
    level = math.sqrt(along[0] * along[0] + along[1] * along[1])
    x, y = sense * along[0] / level, sense * along[1] / level
    behind = 0.5 * track[TrackColumn.PITCH] + memory.place[2]
    shear = math.sqrt(state[StateColumn.SHEAR_ALONG] ** 2 + state[StateColumn.SHEAR_SIDE] ** 2)
    line = Patch(centre[0] - behind * x, centre[1] - behind * y, x, y, 0.0, track[TrackColumn.WIDTH])
    write_ground(memory, line, Trace(greatest, rut, shear, 1.0 - soil[SoilColumn.COMPACTED_SHARE]))


@small_kernel
def _look_ahead(
    ground: Ground, track: FloatArray, middle: FloatArray, ahead: FloatArray, hull: float
) -> tuple[float, float]:
    """What the ground ahead of a track has borne at most, and the depth of the rut there [m]."""
    cell = ground.memory.place[2]
    level = math.sqrt(ahead[0] * ahead[0] + ahead[1] * ahead[1])
    if cell <= 0.0 or level < LEAST_LEVEL:
        return 0.0, 0.0
    sense = 1.0 if hull > 0.0 else -1.0
    x, y = sense * ahead[0] / level, sense * ahead[1] / level
    reach = 0.5 * track[TrackColumn.LENGTH] + cell
    place = Patch(middle[0] + reach * x, middle[1] + reach * y, x, y, 0.0, track[TrackColumn.WIDTH])
    greatest, rut, _, _, _ = read_ground(ground.memory, place)
    return greatest, rut


@small_kernel
def _track(
    tracks: TrackTable, number: int, joint: FloatArray, belt: float, ground: Ground, dt: float, states: FloatArray,
    report: FloatArray, work: Workspace,
) -> bool:  # fmt: skip
    """One track, its middle placed and moved: its wrench, states and report. Returns whether it is on the map."""
    track, first, count = tracks.rows[number], tracks.belts[number, 1], tracks.belts[number, 2]
    frame, wrench, grid, middle = work.meeting.frame, work.wrench, ground.grid, work.body.centre
    sums = TrackSums(frame, middle, wrench, report, work.vectors[0], work.vectors[1])
    ahead = frame[1]
    wrench[:] = 0.0
    report[:] = 0.0
    _place_plate(tracks.plates[first + count // 2], joint, frame[0], ahead)
    hull = 0.0
    for k in range(3):
        hull += work.body.velocity[k] * ahead[k]
    shift(states, belt, track[TrackColumn.PITCH], dt)
    greatest, rut = _look_ahead(ground, track, middle, ahead, hull)
    pass_ground(states, hull, track[TrackColumn.PITCH], dt, greatest, rut)
    forwards = states[count // 2, StateColumn.HEADWAY] >= 0.0
    on_map, load, deepest, most, last, depth_of_last = True, 0.0, 0.0, 0.0, -1, 0.0
    for step in range(count):
        i = step if forwards else count - 1 - step
        _place_plate(tracks.plates[first + i], joint, frame[0], ahead)
        height, inside = _plane(ground, track, frame)
        depth = (height - states[i, RUT] - frame[0, 2]) * frame[5, 2]
        if depth <= 0.0:
            _lift(states[i])
            continue
        on_map &= inside
        move_point(work.twist, frame[0], frame[2])
        soil_number = sample_soil(ground.soil_index, grid[0], grid[1], grid[2], frame[0, 0], frame[0, 1])
        plate = Plate(tracks.plates[first + i, PlateColumn.SHARE], depth, deepest)
        pressed = _press(track, plate, belt, ground.soils[soil_number], dt, states[i], sums)
        load += pressed
        if pressed >= most:
            most, report[ReportColumn.SOIL] = pressed, soil_number
        deepest, last, depth_of_last = max(deepest, depth), i, depth
    if last >= 0 and ground.memory.place[2] > 0.0:
        _place_plate(tracks.plates[first + last], joint, frame[0], ahead)
        _plane(ground, track, frame)
        _leave_rut(ground, track, states[last], depth_of_last, sums)
    _sum_up(load, hull, belt, work, report)
    return on_map


@small_kernel
def _sum_up(load: float, hull: float, belt: float, work: Workspace, report: FloatArray) -> None:
    """Means and slip of a track's report, whose sums are in it."""
    body = work.body
    for k in range(3):
        report[ReportColumn.FORCE_X + k] = work.wrench[k]
        report[ReportColumn.X + k] = report[ReportColumn.X + k] / load if load > 0.0 else body.centre[k]
    if load <= 0.0:
        return
    report[ReportColumn.SINKAGE] /= load
    speed = math.sqrt(body.velocity[0] ** 2 + body.velocity[1] ** 2 + body.velocity[2] ** 2)
    if max(abs(belt), speed) >= REST_SPEED:
        ratio = (belt - hull) / max(abs(belt), abs(hull), REST_SPEED)
        report[ReportColumn.SLIP_RATIO] = clip(ratio if hull + belt >= 0.0 else -ratio, -1.0, 1.0)
        aside = 0.0
        for k in range(3):
            aside += body.velocity[k] * work.meeting.frame[4, k]
        report[ReportColumn.SLIP_ANGLE] = math.atan2(aside, abs(hull))


@kernel
def tracks_on_ground(tracks: TrackTable, ground: Ground, machine: Kinematics, dt: float, touch: Touch) -> bool:
    """Forces of all tracks, added to the generalised force. Returns whether all of them are on the map."""
    on_map = True
    carried, work = tracks.carried, touch.workspace
    for i in range(tracks.rows.shape[0]):
        column, first, count = tracks.belts[i, 0], tracks.belts[i, 1], tracks.belts[i, 2]
        report = touch.report[carried.first + i]
        states = touch.states.tracks[first : first + count]
        belt = tracks.rows[i, TrackColumn.RADIUS] * machine.velocity[column]
        place_body(carried, i, machine.placements, work.body)
        move_body(carried.chains[i], machine, work.twist, work.body)
        joint = machine.placements[carried.bodies[i]]
        on_map &= _track(tracks, i, joint, belt, ground, dt, states, report, work)
        add_force(carried.chains[i], machine.jacobian, work.body.centre, work.wrench, touch.force)
        touch.force[column] -= report[ReportColumn.TORQUE]
    return on_map
