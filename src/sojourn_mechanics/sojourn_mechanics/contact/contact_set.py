"""All contacts of a machine with the ground, in one call: wheels by `wheel_on_soil`, pads by a plate's bearing.

Ground under a wheel. The rim is sampled in the wheel's plane; each sample under the terrain (or within a small margin
of it) has a weight that grows with the square of its depth, and the contact plane is the weighted mean of the terrain's
points and gradients. On a plane, tilted or not, that plane is exact; over a rock or a step it turns continuously
towards what the rim presses on. Where the samples lie on different soils, their parameters are blended by the same
weights (the pressure modulus geometrically, since it differs by orders of magnitude between sand and rock), so that a
wheel is lifted onto a rock and not shot off it.

Memory of a contact, so that rest is a fixed point and everything is continuous through zero speed (the relaxation of a
rolling contact; Pacejka 2012, Tire and Vehicle Dynamics, ch. 7, here with the contact length L as relaxation length):

    du_x/dt = (r ω - v_x) - V u_x/L,   du_y/dt = -v_y - V u_y/L,   V = max(|r ω|, |v|);   s = u_x/L, s_y = u_y/L
    dD/dt = (w - |w| D)/L,  w = (v_x + r ω)/2

In steady rolling s is the usual slip ratio; at rest u is the shear displacement itself, and stays. Near rest the rate of
shear leads the displacement, by SHEAR_LEAD/(1 + (V/LEAD_SPEED)²), which damps the swing of a parked machine on its soil
(soil loses most of the energy of such a swing; the numbers are estimates) and is gone at driving speed.

Normal damping is of Hunt and Crossley's form, F_n (1 + d dz/dt), never below zero.

A pad of radius a: N = π a² k z^n (b = a in k), friction (c π a² + N tan φ)(1 - exp(-|u|/K)) against its displacement u,
which is given up with the distance slid, du/dt = -v - |v| u/(PAD_MEMORY K).
"""

import math

import numpy as np
from numba import njit

from sojourn_mechanics.contact.wheel_on_soil import pressure_modulus, rim_forces
from sojourn_mechanics.params import FloatArray, IntArray
from sojourn_mechanics.soil.params import FORM_BEKKER, SoilColumn
from sojourn_mechanics.terrain.height_field import sample_height, sample_soil

RIM_SAMPLES = 13
RIM_SAMPLE_RANGE = 1.35
"""Rim angles sampled for the contact plane [rad], to both sides of straight down."""
SAMPLE_MARGIN = 0.03
"""Margin over the ground within which a sample still counts, as a fraction of the radius."""
SHEAR_LEAD = 0.1
"""Time by which the rate of shear leads the shear displacement at rest [s]."""
LEAD_SPEED = 0.01
"""Speed at which the lead has halved [m/s]."""
MIN_CONTACT_LENGTH = 0.04
"""Least contact length, as a fraction of the radius."""
PAD_MEMORY = 4.0
"""Distance after which a sliding pad forgets where it stood, in shear moduli."""
MAX_DAMPING_GAIN = 3.0

# Columns of a contact's state and of its report
STATE_COLUMNS = 3
"""u_x, u_y, D of a wheel; u_x, u_y in map and nothing for a pad."""
REPORT_COLUMNS = 11
"""x y z [m], sinkage [m], slip ratio, slip angle [rad], force x y z in map [N], torque [N m], soil index."""

_ANGLES = np.linspace(-RIM_SAMPLE_RANGE, RIM_SAMPLE_RANGE, RIM_SAMPLES)
RIM_SIN: FloatArray = np.ascontiguousarray(np.sin(_ANGLES))
RIM_COS: FloatArray = np.ascontiguousarray(np.cos(_ANGLES))

_DAMPING = int(SoilColumn.CONTACT_DAMPING)
_FORM = int(SoilColumn.FORM)
_K_C = int(SoilColumn.K_C)
_K_PHI = int(SoilColumn.K_PHI)
_N = int(SoilColumn.N)
_COHESION = int(SoilColumn.COHESION)
_TAN_PHI = int(SoilColumn.TAN_PHI)
_EXIT_LAMBDA = int(SoilColumn.EXIT_LAMBDA)
_K_X = int(SoilColumn.SHEAR_MODULUS_LONGITUDINAL)


@njit(cache=True)
def _clip(value: float, low: float, high: float) -> float:
    return min(max(value, low), high)


@njit(cache=True)
def shear_lead(speed: float) -> float:
    """Time by which the rate of shear leads the shear displacement [s] at a speed over the ground [m/s]."""
    ratio = speed / LEAD_SPEED
    return SHEAR_LEAD / (1.0 + ratio * ratio)


@njit(cache=True)
def blend_soils(soils: FloatArray, shares: FloatArray, width: float, blended: FloatArray) -> int:
    """Parameters of the ground under a wheel that touches several soils, written to `blended`, (soil columns,).

    Args:
        soils: kernel rows, (soils, columns). shares: weight of each soil, (soils,), not all zero. width: of the wheel [m].

    Returns:
        index of the soil with the largest share.
    """
    total = 0.0
    first = 0
    for i in range(shares.shape[0]):
        total += shares[i]
        if shares[i] > shares[first]:
            first = i
    if shares[first] == total:
        blended[:] = soils[first]
        return first
    blended[:] = 0.0
    log_modulus = 0.0
    for i in range(shares.shape[0]):
        share = shares[i] / total
        if share > 0.0:
            log_modulus += share * math.log(max(pressure_modulus(soils[i], width), 1.0))
            for k in range(blended.shape[0]):
                blended[k] += share * soils[i, k]
    blended[_FORM] = FORM_BEKKER
    blended[_K_C] = 0.0
    blended[_K_PHI] = math.exp(log_modulus)
    # "exit angle zero" is marked by a negative ratio, for which zero stands as well
    blended[_EXIT_LAMBDA] = max(blended[_EXIT_LAMBDA], 0.0)
    return first


@njit(cache=True)
def contact_plane(
    heights: FloatArray,
    soil_index: IntArray,
    grid: FloatArray,
    centre: FloatArray,
    forward: FloatArray,
    up: FloatArray,
    radius: float,
    rim_sin: FloatArray,
    rim_cos: FloatArray,
    shares: FloatArray,
) -> tuple[bool, float, float, float, float, float, bool]:
    """Plane that stands for the ground under one wheel.

    Args:
        heights, soil_index, grid: of the height field; grid = (origin_x, origin_y, resolution) [m].
        centre: of the wheel in map, shape (3,) [m]. forward, up: unit vectors in the wheel's plane, shape (3,).
        shares: (soils,), written: weight of each soil in the contact.

    Returns:
        whether there is ground within reach, a point of the plane x, y, z [m], its gradients dz/dx, dz/dy, and whether
        all of it is on the map.
    """
    total = 0.0
    x_mean = 0.0
    y_mean = 0.0
    z_mean = 0.0
    x_slope = 0.0
    y_slope = 0.0
    on_map = True
    margin = SAMPLE_MARGIN * radius
    shares[:] = 0.0
    for i in range(rim_sin.shape[0]):
        ahead = radius * rim_sin[i]
        below = radius * rim_cos[i]
        x = centre[0] + ahead * forward[0] - below * up[0]
        y = centre[1] + ahead * forward[1] - below * up[1]
        z = centre[2] + ahead * forward[2] - below * up[2]
        height, dh_dx, dh_dy, inside = sample_height(heights, grid[0], grid[1], grid[2], x, y)
        depth = height - z + margin
        if depth > 0.0:
            weight = depth * depth
            total += weight
            shares[sample_soil(soil_index, grid[0], grid[1], grid[2], x, y)] += weight
            x_mean += weight * x
            y_mean += weight * y
            z_mean += weight * height
            x_slope += weight * dh_dx
            y_slope += weight * dh_dy
            on_map = on_map and inside
    if total <= 0.0:
        return False, 0.0, 0.0, 0.0, 0.0, 0.0, True
    return True, x_mean / total, y_mean / total, z_mean / total, x_slope / total, y_slope / total, on_map


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
) -> bool:
    """One wheel: advances `state`, writes `wrench` (force and moment at the centre, in map) and `report`.

    Returns False where the wheel is off the map.
    """
    radius = shape[0]
    # Forward is horizontal and in the wheel's plane; with the axle upright any direction will do, so it is regularised.
    fx = axle[1]
    fy = -axle[0]
    horizontal = math.sqrt(fx * fx + fy * fy)
    if horizontal < 1e-6:
        fx, fy, horizontal = 1.0, 0.0, 1.0
    forward = np.array((fx / horizontal, fy / horizontal, 0.0))
    up = np.array(
        (
            forward[1] * axle[2],
            -forward[0] * axle[2],
            forward[0] * axle[1] - forward[1] * axle[0],
        )
    )
    shares = np.empty(soils.shape[0])
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
    normal = np.array((-slope_x * norm, -slope_y * norm, norm))

    # in_plane: from the lowest point of the rim to the centre; side: the axle's direction along the ground
    camber = axle[0] * normal[0] + axle[1] * normal[1] + axle[2] * normal[2]
    in_plane = np.empty(3)
    side = np.empty(3)
    for k in range(3):
        in_plane[k] = normal[k] - camber * axle[k]
        side[k] = axle[k] - camber * normal[k]
    cos_camber = math.sqrt(in_plane[0] ** 2 + in_plane[1] ** 2 + in_plane[2] ** 2)
    distance = (
        normal[0] * (centre[0] - px) + normal[1] * (centre[1] - py) + normal[2] * (centre[2] - pz)
    )
    sinkage = radius * cos_camber - distance
    if sinkage <= 0.0 or cos_camber < 1e-3:
        state[:] = 0.0
        return on_map
    for k in range(3):
        in_plane[k] /= cos_camber
        side[k] /= cos_camber
    along = np.array(
        (
            side[1] * normal[2] - side[2] * normal[1],
            side[2] * normal[0] - side[0] * normal[2],
            side[0] * normal[1] - side[1] * normal[0],
        )
    )

    soil = np.empty(soils.shape[1])
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
    state[2] = _clip((state[2] + dt * travel / length) / (1.0 + dt * abs(travel) / length), -1.0, 1.0)

    sense = 1.0 if state[2] >= 0.0 else -1.0
    lead = shear_lead(transport)
    slip = _clip(sense * (state[0] + lead * (rim_speed - v_along)) / length, -1.0, 1.0)
    side_slip = _clip((state[1] - lead * v_side) / length, -1.0, 1.0)
    force_x, force_y, force_z, torque, moment_x, moment_z, _ = rim_forces(
        radius, shape[1], shape[2], sinkage, slip, side_slip, abs(state[2]), soil, quadrature[0], quadrature[1]
    )
    force_z *= _clip(1.0 - soil[_DAMPING] * v_normal, 0.0, MAX_DAMPING_GAIN)
    # The normal force acts at the lowest point of the rim: a tilted wheel is turned upright or over by it, and the
    # pressure does no net work on a closed path.
    righting = radius * force_z * camber
    for k in range(3):
        wrench[k] = sense * force_x * along[k] + force_y * side[k] + force_z * normal[k]
        # moment_z turns about the normal with the sense of travel; the wheel's torque acts back on it
        wrench[3 + k] = (moment_x + righting) * along[k] + sense * moment_z * normal[k] - sense * torque * axle[k]
        report[k] = centre[k] - radius * in_plane[k]
        report[6 + k] = wrench[k]
    report[3] = sinkage
    report[4] = 0.0 if transport < 1e-4 else _clip(
        (rim_speed - v_along) / max(abs(rim_speed), abs(v_along), 1e-4) * (1.0 if travel >= 0.0 else -1.0), -1.0, 1.0
    )
    report[5] = 0.0 if transport < 1e-4 else math.atan2(v_side, abs(v_along))
    report[9] = sense * torque
    report[10] = soil_number
    return on_map


@njit(cache=True)
def contact_length(radius: float, sinkage: float, soil: FloatArray, state: FloatArray) -> float:
    """Length of the wheel's contact along the ground [m], from entry to exit, for the relaxation."""
    entry = math.acos(_clip(1.0 - sinkage / radius, -0.8, 1.0))
    exit_ratio = max(soil[_EXIT_LAMBDA], 0.0)
    rolling_exit = math.acos(_clip(1.0 - exit_ratio * sinkage / radius, -0.8, 1.0))
    rolling = abs(state[2])
    return radius * (math.sin(entry) + rolling * math.sin(rolling_exit) + (1.0 - rolling) * math.sin(entry))


@njit(cache=True)
def _pad(
    radius: float,
    centre: FloatArray,
    velocity: FloatArray,
    heights: FloatArray,
    soil_index: IntArray,
    grid: FloatArray,
    soils: FloatArray,
    dt: float,
    state: FloatArray,
    wrench: FloatArray,
    report: FloatArray,
) -> bool:
    """One pad: advances `state`, writes `wrench` and `report`. Returns False where it is off the map."""
    wrench[:] = 0.0
    report[:] = 0.0
    report[0:3] = centre
    height, slope_x, slope_y, inside = sample_height(heights, grid[0], grid[1], grid[2], centre[0], centre[1])
    norm = 1.0 / math.sqrt(1.0 + slope_x * slope_x + slope_y * slope_y)
    sinkage = (height - centre[2]) * norm
    if sinkage <= 0.0:
        state[:] = 0.0
        return True
    normal = np.array((-slope_x * norm, -slope_y * norm, norm))
    soil_number = sample_soil(soil_index, grid[0], grid[1], grid[2], centre[0], centre[1])
    soil = soils[soil_number]
    area = math.pi * radius * radius
    v_normal = velocity[0] * normal[0] + velocity[1] * normal[1] + velocity[2] * normal[2]
    load = area * pressure_modulus(soil, radius) * sinkage ** soil[_N]
    load *= _clip(1.0 - soil[_DAMPING] * v_normal, 0.0, MAX_DAMPING_GAIN)

    modulus = soil[_K_X]
    slide = np.empty(3)
    for k in range(3):
        slide[k] = velocity[k] - v_normal * normal[k]
    speed = math.sqrt(slide[0] ** 2 + slide[1] ** 2 + slide[2] ** 2)
    relaxed = 1.0 + dt * speed / (PAD_MEMORY * modulus)
    for k in range(3):
        state[k] = (state[k] - dt * slide[k]) / relaxed
    lead = np.empty(3)
    lead_time = shear_lead(speed)
    out_of_plane = state[0] * normal[0] + state[1] * normal[1] + state[2] * normal[2]
    for k in range(3):
        state[k] -= out_of_plane * normal[k]
        lead[k] = state[k] - lead_time * slide[k]
    shear = math.sqrt(lead[0] ** 2 + lead[1] ** 2 + lead[2] ** 2)
    friction = (soil[_COHESION] * area + load * soil[_TAN_PHI]) * -math.expm1(-shear / modulus)
    for k in range(3):
        wrench[k] = load * normal[k] + (friction * lead[k] / shear if shear > 1e-12 else 0.0)
        report[6 + k] = wrench[k]
    report[3] = sinkage
    report[10] = soil_number
    return inside


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
        bodies: (contacts,): index of the joint that carries the contact. supports: (contacts, depth): columns of the
            Jacobian that move it, filled with -1. offsets: (contacts, 3): point in the joint's frame [m].
        wheel_count: the first so many contacts are wheels, whose axle is the y axis of their joint.
        placements: (joints, 12): rotation (columns one after another) and position of each joint in map.
        jacobian: (6, nv), of the machine at the map's origin, linear rows first. velocity: (nv,).
        heights, soil_index, grid: the ground; soils: kernel rows.
        quadrature: (2, m) nodes and weights; rim: (2, samples) sines and cosines.
        states: (contacts, 3), advanced in place. report: (contacts, 11), written. generalised_force: (nv,), added to.

    Returns:
        whether every contact is on the map.
    """
    on_map = True
    centre = np.empty(3)
    axle = np.empty(3)
    point_velocity = np.empty(3)
    wrench = np.empty(6)
    motion = np.empty(6)
    for i in range(bodies.shape[0]):
        body = placements[bodies[i]]
        for k in range(3):
            centre[k] = (
                body[9 + k] + body[k] * offsets[i, 0] + body[3 + k] * offsets[i, 1] + body[6 + k] * offsets[i, 2]
            )
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
                shapes[i], centre, axle, point_velocity, spin, heights, soil_index, grid, soils, quadrature, rim, dt,
                states[i], wrench, report[i],
            )  # fmt: skip
        else:
            on_map &= _pad(
                shapes[i, 0], centre, point_velocity, heights, soil_index, grid, soils, dt, states[i], wrench, report[i]
            )
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
