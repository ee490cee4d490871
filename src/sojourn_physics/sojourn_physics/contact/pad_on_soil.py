"""A round pad on soil: a plate's bearing, and friction against a remembered displacement.

    N = π a² k z^n (b = a in k),   T = (c π a² + N tan φ)(1 - exp(-|u|/K)) against the displacement u,
    du/dt = -v - |v| u/(PAD_MEMORY K)

for a pad of radius a: the displacement is given up with the distance slid. Normal damping is of Hunt and
Crossley's form, N (1 + d dz/dt), never below zero (Hunt & Crossley 1975, J. Appl. Mech. 42:440). Pressure
after Bekker (1969), friction after Janosi & Hanamoto (1961). For a machine that lies on its belly or its
side: the ground is that under the pad's centre.

A pad that is the end of a scoop cuts the soil as deep as it has sunk: McKyes' force (`soil.digging`) for that depth
goes onto the friction and is mobilised with it, against the way of the tool; so does the surcharge of the soil that the
scoop pushes ahead of it. Soil is taken away behind the cut, by the plant's tool (`plant.tools.scoop`), so that the cut
meets the ground as it is ahead: the pad remembers the way D on which it is dragged, dD/dt = (v - |v| D)/a along the
ground, and reads the ground's memory (`terrain/memory.py`) a lead of (a + 1.5 cells) D ahead of its centre.

Every pad meets the ground as ruts, holes and heaps have left it, under its centre, with the slope of the ground as it
was. Only the end of a tool carries a moment that the tool itself makes (a drill's); the bottom of the
hole that a drill has made lies `TAKEN` below the ground. The tool writes these into its row (`ToolColumn`) before each
period.
"""

import math
from enum import IntEnum
from typing import NamedTuple

from sojourn_machine.contact_report import ReportColumn
from sojourn_machine.kernels import kernel, small_kernel
from sojourn_machine.params import FloatArray
from sojourn_physics.contact.hysteresis import effective_shear
from sojourn_physics.contact.shear_memory import MAX_DAMPING_GAIN, clip, shear_lead
from sojourn_physics.contact.tables import Ground, Workspace
from sojourn_physics.contact.wheel_on_soil import pressure_modulus
from sojourn_physics.soil.params import SoilColumn
from sojourn_physics.terrain.height_field import sample_ground, sample_soil
from sojourn_physics.terrain.memory_access import read_lowered


class ToolColumn(IntEnum):
    """What a tool on a pad does; all zero for a pad without one."""

    IS_TOOL = 0
    """1 for a tool."""
    TAKEN = 1
    """Depth of the hole below it [m]."""
    PILE = 2
    """Weight of the soil that it pushes ahead [N]."""
    MOMENT_X = 3
    """That it makes on the body, in map [N m]."""
    MOMENT_Y = 4
    MOMENT_Z = 5


TOOL_COLUMNS = len(ToolColumn)
TOOL_MOMENT = slice(ToolColumn.MOMENT_X, ToolColumn.MOMENT_Z + 1)
CUT_COLUMNS = 5
"""Numbers for each soil of a pad that cuts: the force is linear d + quadratic d² + cubic d³, and a weight W
pushed ahead adds W (of_pile + of_pile_by_depth d)."""
DRAG_X, DRAG_Y = 3, 4
"""Columns of a tool's state: D, along the map."""
HIGHEST_HEAP, HIGHEST_HEAP_OF_TOOL = 0.1, 0.5
"""A pad, or a tool, so far above the ground as it was meets no heap of soil [m]."""
TOOL_LEAD = 0.002
"""Longest time by which a tool's rate leads its displacement [s]: an arm's last link is light, and the lead that damps
a parked rover would be a damper stiffer than the step can follow; this one damps its swing on rock by half of critical.
"""
PAD_MEMORY = 4.0
"""Distance after which a sliding pad forgets where it stood, in shear moduli."""


class Pad(NamedTuple):
    """One pad, as `PadTable` has it."""

    radius: float
    """[m]"""
    cuts: FloatArray
    """(soils, CUT_COLUMNS)"""
    tool: FloatArray
    """(TOOL_COLUMNS,)"""


@kernel
def lead_length(radius: float, cell: float) -> float:
    """How far ahead of a tool that is dragged the ground is read [m]: beyond what its cut has taken away."""
    return radius + 1.5 * cell


@small_kernel
def is_clear(pad: Pad, centre: FloatArray, ground: Ground) -> bool:
    """Whether a pad is above the ground and does nothing there; a tool, which may do more, never is."""
    height, _, _, _ = sample_ground(ground.heights, ground.grid, centre[0], centre[1])
    highest = HIGHEST_HEAP if ground.memory.place[2] > 0.0 else 0.0
    clear: bool = pad.tool[ToolColumn.IS_TOOL] <= 0.0 and height + highest <= centre[2]
    return clear


@kernel
def pad_forces(pad: Pad, ground: Ground, dt: float, state: FloatArray, report: FloatArray, work: Workspace) -> bool:
    """One pad: advances `state`, writes its wrench and `report`. Returns False where it is off the map.

    Args:
        dt: [s].
        state: (STATE_COLUMNS,); its first three are the displacement against the ground in map [m], then a tool's D.
        report: row of `ReportColumn`. work: its body is given, its wrench written: force and moment at the centre.
    """
    centre, velocity, wrench, grid = work.body.centre, work.body.velocity, work.wrench, ground.grid
    normal, slide, towards = work.vectors[0], work.vectors[1], work.vectors[2]
    wrench[:] = 0.0
    report[:] = 0.0
    for k in range(3):
        report[ReportColumn.X + k] = centre[k]
    height, slope_x, slope_y, inside = sample_ground(ground.heights, grid, centre[0], centre[1])
    norm = 1.0 / math.sqrt(1.0 + slope_x * slope_x + slope_y * slope_y)
    radius, tool = pad.radius, pad.tool
    is_tool = tool[ToolColumn.IS_TOOL] > 0.0
    if is_tool:
        for k in range(3):
            wrench[3 + k] = tool[ToolColumn.MOMENT_X + k]
        height -= tool[ToolColumn.TAKEN]
    place = ground.memory.place
    if place[2] > 0.0 and centre[2] < height + (HIGHEST_HEAP_OF_TOOL if is_tool else HIGHEST_HEAP):
        lead = lead_length(radius, place[2]) if is_tool else 0.0
        ahead_x, ahead_y = centre[0] + lead * state[DRAG_X], centre[1] + lead * state[DRAG_Y]
        height -= read_lowered(ground.memory, ahead_x, ahead_y)
    sinkage = (height - centre[2]) * norm
    if sinkage <= 0.0:
        state[:] = 0.0
        return True
    normal[0], normal[1], normal[2] = -slope_x * norm, -slope_y * norm, norm
    soil_number = sample_soil(ground.soil_index, grid[0], grid[1], grid[2], centre[0], centre[1])
    soil = ground.soils[soil_number]
    area = math.pi * radius * radius
    v_normal = velocity[0] * normal[0] + velocity[1] * normal[1] + velocity[2] * normal[2]
    load = area * pressure_modulus(soil, radius) * sinkage ** soil[SoilColumn.N]
    load *= clip(1.0 - soil[SoilColumn.CONTACT_DAMPING] * v_normal, 0.0, MAX_DAMPING_GAIN)

    modulus = soil[SoilColumn.SHEAR_MODULUS]
    for k in range(3):
        slide[k] = velocity[k] - v_normal * normal[k]
    speed = math.sqrt(slide[0] ** 2 + slide[1] ** 2 + slide[2] ** 2)
    kept = 1.0 / (1.0 + dt * speed / (PAD_MEMORY * modulus))
    for k in range(3):
        state[k] = (state[k] - dt * slide[k]) * kept
    out_of_plane = state[0] * normal[0] + state[1] * normal[1] + state[2] * normal[2]
    for k in range(3):
        state[k] -= out_of_plane * normal[k]
    displacement = math.sqrt(state[0] ** 2 + state[1] ** 2 + state[2] ** 2)
    towards[0], towards[1], towards[2] = effective_shear(
        -dt * slide[0], -dt * slide[1], -dt * slide[2], kept, displacement, state
    )
    if is_tool:
        forgotten = 1.0 + dt * math.sqrt(slide[0] ** 2 + slide[1] ** 2) / radius
        state[DRAG_X] = (state[DRAG_X] + dt * slide[0] / radius) / forgotten
        state[DRAG_Y] = (state[DRAG_Y] + dt * slide[1] / radius) / forgotten
    lead_time = shear_lead(speed)
    if is_tool:
        lead_time = min(lead_time, TOOL_LEAD)
    out_of_plane = towards[0] * normal[0] + towards[1] * normal[1] + towards[2] * normal[2]
    for k in range(3):
        towards[k] -= out_of_plane * normal[k] + lead_time * slide[k]
    shear = math.sqrt(towards[0] ** 2 + towards[1] ** 2 + towards[2] ** 2)
    by_depth = pad.cuts[soil_number]
    cut = sinkage * (by_depth[0] + sinkage * (by_depth[1] + sinkage * by_depth[2]))
    cut += tool[ToolColumn.PILE] * (by_depth[3] + by_depth[4] * sinkage)
    gain = -math.expm1(-shear / modulus)
    friction = (soil[SoilColumn.COHESION] * area + load * soil[SoilColumn.TAN_PHI] + cut) * gain
    for k in range(3):
        wrench[k] = load * normal[k] + (friction * towards[k] / shear if shear > 1e-12 else 0.0)
        report[ReportColumn.FORCE_X + k] = wrench[k]
    report[ReportColumn.SINKAGE] = sinkage
    report[ReportColumn.SOIL] = soil_number
    report[ReportColumn.BULLDOZING_RESISTANCE] = cut * gain
    on_map: bool = inside
    return on_map
