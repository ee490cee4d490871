"""All contacts of a machine with the ground, in one call: wheels by `wheel_on_soil`, pads by `pad_on_soil`.

Memory of a contact, so that rest is a fixed point and everything is continuous through zero speed (the
relaxation of a rolling contact; Pacejka 2012, Tire and Vehicle Dynamics, ch. 7, here with the contact length
L as relaxation length):

    du_x/dt = (r ω - v_x) - V u_x/L,   du_y/dt = -v_y - V u_y/L,   V = max(|r ω|, |v|)
    s = u_x/L,   s_y = u_y/L
    dD/dt = (w - |w| D)/L,   w = (v_x + r ω)/2

In steady rolling s is the usual slip ratio; at rest u is the shear displacement itself, and stays. Near rest
the rate of shear leads the displacement (see `shear_memory`).

Normal damping is of Hunt and Crossley's form, F_n (1 + d dz/dt), never below zero.
"""

import math

import numpy as np
from numba import njit

from sojourn_mechanics.contact.ground_plane import blend_soils, contact_plane
from sojourn_mechanics.contact.pad_on_soil import pad_forces
from sojourn_mechanics.contact.shear_memory import MAX_DAMPING_GAIN, clip, shear_lead
from sojourn_mechanics.contact.wheel_on_soil import rim_forces
from sojourn_mechanics.params import FloatArray, IntArray
from sojourn_mechanics.soil.params import SoilColumn

MIN_CONTACT_LENGTH = 0.04
"""Least contact length, as a fraction of the radius."""

# Columns of a contact's state and of its report
STATE_COLUMNS = 3
"""u_x [m], u_y [m], D of a wheel; displacement in map of a pad [m]."""
REPORT_COLUMNS = 11
"""x y z [m], sinkage [m], slip ratio, slip angle [rad], force x y z in map [N], torque [N m], soil index."""
SCRATCH_VECTORS = 6

_DAMPING = int(SoilColumn.CONTACT_DAMPING)
_EXIT_LAMBDA = int(SoilColumn.EXIT_LAMBDA)


@njit(cache=True)
def _wheel(
    shape: FloatArray,
    centre: FloatArray,
    axle: FloatArray,
    velocity: FloatArray,
    spin: float,
    heights: FloatArray,
    soil_index: IntArray,
    grid: FloatArray,
    soils: FloatArray,
    quadrature: FloatArray,
    rim: FloatArray,
    dt: float,
    state: FloatArray,
    wrench: FloatArray,
    report: FloatArray,
    vectors: FloatArray,
    shares: FloatArray,
    soil: FloatArray,
) -> bool:
    """One wheel: advances `state`, writes `wrench` (force and moment at the centre, in map) and `report`.

    vectors (SCRATCH_VECTORS, 3), shares (soils,) and soil (columns,) are working memory. Returns False where
    the wheel is off the map.
    """
    radius = float(shape[0])
    # Forward is horizontal and in the wheel's plane; with the axle upright any direction will do.
    fx = axle[1]
    fy = -axle[0]
    horizontal = math.sqrt(fx * fx + fy * fy)
    if horizontal < 1e-6:
        fx, fy, horizontal = 1.0, 0.0, 1.0
    forward, up, normal = vectors[0], vectors[1], vectors[2]
    in_plane, side, along = vectors[3], vectors[4], vectors[5]
    forward[0] = fx / horizontal
    forward[1] = fy / horizontal
    forward[2] = 0.0
    up[0] = forward[1] * axle[2]
    up[1] = -forward[0] * axle[2]
    up[2] = forward[0] * axle[1] - forward[1] * axle[0]
    on_map: bool
    found, px, py, pz, slope_x, slope_y, on_map = contact_plane(
        heights, soil_index, grid, centre, forward, up, radius, rim[0], rim[1], shares
    )
    report[:] = 0.0
    report[0] = centre[0]
    report[1] = centre[1]
    report[2] = centre[2] - radius
    wrench[:] = 0.0
    if not found:
        state[:] = 0.0
        return on_map
    norm = 1.0 / math.sqrt(1.0 + slope_x * slope_x + slope_y * slope_y)
    normal[0] = -slope_x * norm
    normal[1] = -slope_y * norm
    normal[2] = norm

    # in_plane: from the lowest point of the rim to the centre; side: the axle's direction along the ground
    camber = axle[0] * normal[0] + axle[1] * normal[1] + axle[2] * normal[2]
    for k in range(3):
        in_plane[k] = normal[k] - camber * axle[k]
        side[k] = axle[k] - camber * normal[k]
    cos_camber = math.sqrt(in_plane[0] ** 2 + in_plane[1] ** 2 + in_plane[2] ** 2)
    distance = normal[0] * (centre[0] - px) + normal[1] * (centre[1] - py) + normal[2] * (centre[2] - pz)
    sinkage = radius * cos_camber - distance
    if sinkage <= 0.0 or cos_camber < 1e-3:
        state[:] = 0.0
        return on_map
    for k in range(3):
        in_plane[k] /= cos_camber
        side[k] /= cos_camber
    along[0] = side[1] * normal[2] - side[2] * normal[1]
    along[1] = side[2] * normal[0] - side[0] * normal[2]
    along[2] = side[0] * normal[1] - side[1] * normal[0]

    soil_number = blend_soils(soils, shares, shape[2], soil)
    v_along = velocity[0] * along[0] + velocity[1] * along[1] + velocity[2] * along[2]
    v_side = velocity[0] * side[0] + velocity[1] * side[1] + velocity[2] * side[2]
    v_normal = velocity[0] * normal[0] + velocity[1] * normal[1] + velocity[2] * normal[2]
    rim_speed = radius * spin

    # The state is advanced implicitly: at any speed and step it stays bounded.
    length = max(contact_length(radius, sinkage, soil, state), MIN_CONTACT_LENGTH * radius)
    transport = max(abs(rim_speed), math.sqrt(v_along * v_along + v_side * v_side))
    relaxed = 1.0 + dt * transport / length
    state[0] = (state[0] + dt * (rim_speed - v_along)) / relaxed
    state[1] = (state[1] - dt * v_side) / relaxed
    travel = 0.5 * (v_along + rim_speed)
    state[2] = clip((state[2] + dt * travel / length) / (1.0 + dt * abs(travel) / length), -1.0, 1.0)

    sense = 1.0 if state[2] >= 0.0 else -1.0
    lead = shear_lead(transport)
    slip = clip(sense * (state[0] + lead * (rim_speed - v_along)) / length, -1.0, 1.0)
    side_slip = clip((state[1] - lead * v_side) / length, -1.0, 1.0)
    force_x, force_y, force_z, torque, moment_x, moment_z, _ = rim_forces(
        radius, shape[1], shape[2], sinkage, slip, side_slip, abs(state[2]), soil,
        quadrature[0], quadrature[1],
    )  # fmt: skip
    force_z *= clip(1.0 - soil[_DAMPING] * v_normal, 0.0, MAX_DAMPING_GAIN)
    # The normal force acts at the lowest point of the rim: a tilted wheel is turned upright or over by it,
    # and the pressure does no net work on a closed path.
    righting = radius * force_z * camber
    for k in range(3):
        wrench[k] = sense * force_x * along[k] + force_y * side[k] + force_z * normal[k]
        # moment_z turns about the normal with the sense of travel; the wheel's torque acts back on it
        wrench[3 + k] = (moment_x + righting) * along[k] + sense * moment_z * normal[k] - sense * torque * axle[k]
        report[k] = centre[k] - radius * in_plane[k]
        report[6 + k] = wrench[k]
    report[3] = sinkage
    if transport >= 1e-4:
        ratio = (rim_speed - v_along) / max(abs(rim_speed), abs(v_along), 1e-4)
        report[4] = clip(ratio if travel >= 0.0 else -ratio, -1.0, 1.0)
        report[5] = math.atan2(v_side, abs(v_along))
    report[9] = sense * torque
    report[10] = soil_number
    return on_map


@njit(cache=True)
def contact_length(radius: float, sinkage: float, soil: FloatArray, state: FloatArray) -> float:
    """Length of the wheel's contact along the ground [m], from entry to exit, for the relaxation."""
    entry = math.acos(clip(1.0 - sinkage / radius, -0.8, 1.0))
    exit_ratio = max(soil[_EXIT_LAMBDA], 0.0)
    rolling_exit = math.acos(clip(1.0 - exit_ratio * sinkage / radius, -0.8, 1.0))
    rolling = abs(float(state[2]))
    behind = rolling * math.sin(rolling_exit) + (1.0 - rolling) * math.sin(entry)
    return radius * (math.sin(entry) + behind)


@njit(cache=True)
def contact_forces(
    shapes: FloatArray,
    bodies: IntArray,
    supports: IntArray,
    offsets: FloatArray,
    wheel_count: int,
    placements: FloatArray,
    jacobian: FloatArray,
    velocity: FloatArray,
    heights: FloatArray,
    soil_index: IntArray,
    grid: FloatArray,
    soils: FloatArray,
    quadrature: FloatArray,
    rim: FloatArray,
    dt: float,
    states: FloatArray,
    report: FloatArray,
    generalised_force: FloatArray,
) -> bool:
    """Forces of all contacts, as one generalised force.

    Args:
        shapes: (contacts, 3): radius, shear radius, width of a wheel; radius of a pad [m].
        bodies: (contacts,): index of the joint that carries the contact.
        supports: (contacts, depth): columns of the Jacobian that move it, filled with -1.
        offsets: (contacts, 3): point in the joint's frame [m].
        wheel_count: the first so many contacts are wheels, whose axle is the y axis of their joint.
        placements: (joints, 12): rotation (columns one after another) and position of each joint in map.
        jacobian: (6, nv), of the machine at the map's origin, linear rows first. velocity: (nv,).
        heights, soil_index, grid: the ground; soils: kernel rows.
        quadrature: (2, m) nodes and weights; rim: (2, samples) sines and cosines.
        states: (contacts, 3), advanced in place. report: (contacts, 11), written.
        generalised_force: (nv,), added to.

    Returns:
        whether every contact is on the map.
    """
    on_map = True
    centre = np.empty(3)
    axle = np.empty(3)
    point_velocity = np.empty(3)
    wrench = np.empty(6)
    motion = np.empty(6)
    vectors = np.empty((SCRATCH_VECTORS, 3))
    shares = np.empty(soils.shape[0])
    soil = np.empty(soils.shape[1])
    for i in range(bodies.shape[0]):
        body = placements[bodies[i]]
        for k in range(3):
            centre[k] = body[9 + k]
            for j in range(3):
                centre[k] += body[3 * j + k] * offsets[i, j]
            axle[k] = body[3 + k]
        motion[:] = 0.0
        for column in supports[i]:
            if column < 0:
                break
            for k in range(6):
                motion[k] += jacobian[k, column] * velocity[column]
        point_velocity[0] = motion[0] + motion[4] * centre[2] - motion[5] * centre[1]
        point_velocity[1] = motion[1] + motion[5] * centre[0] - motion[3] * centre[2]
        point_velocity[2] = motion[2] + motion[3] * centre[1] - motion[4] * centre[0]
        if i < wheel_count:
            spin = motion[3] * axle[0] + motion[4] * axle[1] + motion[5] * axle[2]
            on_map &= _wheel(
                shapes[i], centre, axle, point_velocity, spin, heights, soil_index, grid, soils, quadrature,
                rim, dt, states[i], wrench, report[i], vectors, shares, soil,
            )  # fmt: skip
        else:
            on_map &= pad_forces(
                shapes[i, 0], centre, point_velocity, heights, soil_index, grid, soils, dt, states[i], wrench,
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
