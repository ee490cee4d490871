"""A round pad on soil: a plate's bearing, and friction against a remembered displacement.

    N = π a² k z^n (b = a in k),   T = (c π a² + N tan φ)(1 - exp(-|u|/K)) against the displacement u,
    du/dt = -v - |v| u/(PAD_MEMORY K)

for a pad of radius a: the displacement is given up with the distance slid. Normal damping is of Hunt and
Crossley's form, N (1 + d dz/dt), never below zero (Hunt & Crossley 1975, J. Appl. Mech. 42:440). Pressure
after Bekker (1969), friction after Janosi & Hanamoto (1961). For a machine that lies on its belly or its
side: the ground is that under the pad's centre.

A pad that is the end of a scoop cuts the soil as deep as it has sunk: McKyes' force (`soil.digging`) for that depth
goes onto the friction and is mobilised with it, against the way of the tool. Each cut meets fresh ground: no soil is
taken.
"""

import math

import numpy as np
from numba import njit

from sojourn_mechanics.contact.contact_law import WheelColumn
from sojourn_mechanics.contact.shear_memory import MAX_DAMPING_GAIN, clip, shear_lead
from sojourn_mechanics.contact.wheel_on_soil import pressure_modulus
from sojourn_mechanics.params import FloatArray
from sojourn_mechanics.soil.params import SoilColumn
from sojourn_mechanics.terrain.height_field import HeightArray, SoilArray, sample_ground, sample_soil

CUT_COLUMNS = 3
"""Numbers for each soil in the row of a pad that cuts: the force is linear d + quadratic d² + cubic d³."""
PAD_MEMORY = 4.0
"""Distance after which a sliding pad forgets where it stood, in shear moduli."""

_RADIUS = int(WheelColumn.RADIUS)
_WIDTH = int(WheelColumn.WIDTH)
_OWN = int(WheelColumn.OWN)
_DAMPING = int(SoilColumn.CONTACT_DAMPING)
_N = int(SoilColumn.N)
_COHESION = int(SoilColumn.COHESION)
_TAN_PHI = int(SoilColumn.TAN_PHI)
_K_X = int(SoilColumn.SHEAR_MODULUS_LONGITUDINAL)


@njit(cache=True)
def pad_forces(
    pad: FloatArray,
    centre: FloatArray,
    velocity: FloatArray,
    heights: HeightArray,
    soil_index: SoilArray,
    grid: FloatArray,
    soils: FloatArray,
    dt: float,
    state: FloatArray,
    wrench: FloatArray,
    report: FloatArray,
) -> bool:
    """One pad: advances `state`, writes `wrench` and `report`. Returns False where it is off the map.

    Args:
        pad: its row, (WHEEL_COLUMNS,): radius, and the coefficients of its cut in each soil. centre, velocity: in map,
        (3,) [m], [m/s]. dt: [s]. heights, soil_index, grid, soils: as in `contact_forces`.
        state: (STATE_COLUMNS,); its first three are the displacement against the ground in map [m].
        wrench: (6,), force and moment at the centre.
        report: (REPORT_COLUMNS,), see `contact_set`.
    """
    wrench[:] = 0.0
    report[:] = 0.0
    report[0:3] = centre
    height, slope_x, slope_y, inside = sample_ground(heights, grid, centre[0], centre[1])
    norm = 1.0 / math.sqrt(1.0 + slope_x * slope_x + slope_y * slope_y)
    sinkage = (height - centre[2]) * norm
    if sinkage <= 0.0:
        state[:] = 0.0
        return True
    normal = np.array((-slope_x * norm, -slope_y * norm, norm))
    soil_number = sample_soil(soil_index, grid[0], grid[1], grid[2], centre[0], centre[1])
    soil = soils[soil_number]
    radius = float(pad[_RADIUS])
    area = math.pi * radius * radius
    v_normal = velocity[0] * normal[0] + velocity[1] * normal[1] + velocity[2] * normal[2]
    load = area * pressure_modulus(soil, radius) * sinkage ** soil[_N]
    load *= clip(1.0 - soil[_DAMPING] * v_normal, 0.0, MAX_DAMPING_GAIN)

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
    cut = 0.0
    if pad[_WIDTH] > 0.0:
        first = _OWN + CUT_COLUMNS * soil_number
        cut = sinkage * (pad[first] + sinkage * (pad[first + 1] + sinkage * pad[first + 2]))
    gain = -math.expm1(-shear / modulus)
    friction = (soil[_COHESION] * area + load * soil[_TAN_PHI] + cut) * gain
    for k in range(3):
        wrench[k] = load * normal[k] + (friction * lead[k] / shear if shear > 1e-12 else 0.0)
        report[6 + k] = wrench[k]
    report[3] = sinkage
    report[10] = soil_number
    report[14] = cut * gain
    on_map: bool = inside
    return on_map
