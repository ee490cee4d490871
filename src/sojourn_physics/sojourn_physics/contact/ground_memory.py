"""A wheel and the ruts: what it meets of the ground's past, and what it leaves behind.

A wheel reads the memory of the ground (`terrain/memory.py`) ahead of its contact and writes it behind, at

    x_read = x + [D (l + c) -+ l] forward,   x_write = x - D (l + c) forward,   l = sqrt(2 r z)

with its lowest point x, the sense of travel D in -1..1 that the contact remembers, the length l from the lowest point
to where the rim enters the ground, and the cell c of the memory. A rigid wheel bridges what is shorter than its
contact: hence the mean over 2 l, which is also the way on which it rolls over the edge of a rut. So no wheel meets
what it is just pressing down itself; one that turns back meets its own rut, within about a contact length. It writes
only once it rolls, |D| >= 0.5, so that a parked wheel changes nothing, and rest stays a fixed point.

The rut lowers and tilts the contact plane as any other ground does, so that its sides take as much energy from a wheel
that climbs out as they gave when it rolled in; the soil below follows the law of `soil/repeated_loading.py`. Behind
the wheel that soil springs back by e = p_u/k_u, and so carries it up to an exit angle with lambda = e/h instead of the
soil's own one, as far as the depth z has been reached before: lambda = lambda_0 + (e/h - lambda_0) z_r/z. On virgin
soil the exit angle stays the one that goes with the soil's parameters.

Of the soil that is pressed down the share `compacted_share` of the soil is compacted; the rest is found beside the rut
(`terrain.memory`). No measured share is at hand. An upper bound: lunar soil of relative density 0.65, between 1.10 and
1.89 Mg/m3 (Carrier, Olhoeft & Mendell 1991, Lunar Sourcebook, ch. 9), can give way by 20 % in the layer that a wheel
feels, about as deep as it is wide: more than a rut is deep. So most of it goes there; dense sand and wet clay, which
keep their volume, go aside.

Assumptions: the rut is the mean over that length and the wheel's width (strips of ground that do not hold each other
up); depths along the normal count as vertical; a wheel that is itself compliant meets the law of the depth that a
rigid one would have.
"""

import math
from typing import NamedTuple

from sojourn_machine.kernels import small_kernel
from sojourn_machine.params import FloatArray
from sojourn_physics.contact.contact_law import StateColumn, WheelColumn
from sojourn_physics.contact.wheel_on_soil import pressure_modulus
from sojourn_physics.soil.params import FORM_BEKKER, SoilColumn
from sojourn_physics.soil.repeated_loading import equivalent_law, rut_depth
from sojourn_physics.terrain.memory_access import Patch, Trace, read_ground, write_ground
from sojourn_physics.terrain.memory_tiles import MemoryTables

ROLLING = 0.5
"""Least |D| at which a wheel leaves a rut."""

# What `look_ahead` keeps for `settle_soil` and `leave_rut`
GREATEST, RUT, MODULUS, EXPONENT, PLACE_X, PLACE_Y, REACH = range(7)
PAST_COLUMNS = 7


class Rim(NamedTuple):
    """The lowest point of a wheel's rim over the ground as it was once."""

    x: float
    """In map [m]."""
    y: float
    forward_x: float
    """Horizontal unit vector in the wheel's plane."""
    forward_y: float
    travel: float
    """D that the contact remembers [-]."""
    depth: float
    """Below that ground, at least 0 [m]."""


@small_kernel
def look_ahead(memory: MemoryTables, wheel: FloatArray, rim: Rim, past: FloatArray) -> tuple[float, float, float]:
    """Read what the ground ahead of a wheel has seen.

    Args:
        wheel: row of `WheelColumn`. past: (PAST_COLUMNS,), written.

    Returns:
        how far the ground lies below what it was, by ruts and digging [m], and the gradients of that by x and y [-].
    """
    radius = wheel[WheelColumn.RADIUS]
    length = min(math.sqrt(2.0 * radius * rim.depth), radius)
    reach = length + memory.place[2]
    ahead = rim.travel * reach
    greatest, rut, dug, slope_x, slope_y = read_ground(
        memory,
        Patch(
            rim.x + ahead * rim.forward_x,
            rim.y + ahead * rim.forward_y,
            rim.forward_x,
            rim.forward_y,
            2.0 * length,
            wheel[WheelColumn.WIDTH],
        ),
    )
    past[GREATEST] = greatest
    past[RUT] = rut
    past[PLACE_X] = rim.x
    past[PLACE_Y] = rim.y
    past[REACH] = reach
    return rut + dug, slope_x, slope_y


@small_kernel
def settle_soil(wheel: FloatArray, depth: float, soil: FloatArray, past: FloatArray) -> None:
    """Turn the virgin soil's row, (columns,), into that of the ground which a wheel `depth` [m] below the rut meets."""
    modulus, exponent = pressure_modulus(soil, wheel[WheelColumn.WIDTH]), soil[SoilColumn.N]
    past[MODULUS] = modulus
    past[EXPONENT] = exponent
    rut = past[RUT]
    if rut > 0.0:
        reached = rut + depth
        greatest = max(reached, past[GREATEST])
        springs_back = reached - rut_depth(
            modulus,
            exponent,
            greatest,
            soil[SoilColumn.UNLOADING_STIFFNESS],
            soil[SoilColumn.UNLOADING_STIFFNESS_PER_SINKAGE],
        )
        given = max(soil[SoilColumn.EXIT_LAMBDA], 0.0)
        recovered = min(max(springs_back / depth, given), 1.0)
        soil[SoilColumn.EXIT_LAMBDA] = given + (recovered - given) * rut / reached
        soil[SoilColumn.FORM] = FORM_BEKKER
        soil[SoilColumn.K_C] = 0.0
        soil[SoilColumn.K_PHI], soil[SoilColumn.N] = equivalent_law(modulus, exponent, past[GREATEST], past[RUT], depth)


@small_kernel
def leave_rut(
    memory: MemoryTables,
    wheel: FloatArray,
    soil: FloatArray,
    sinkage: float,
    forward: FloatArray,
    state: FloatArray,
    past: FloatArray,
) -> None:
    """Write behind a rolling wheel what it has done to the ground, down to `sinkage` [m] below what it met; other
    arguments as above and in `contact_law`.
    """
    travel = state[StateColumn.TRAVEL]
    if abs(travel) < ROLLING:
        return
    greatest = past[RUT] + sinkage
    rut = rut_depth(
        past[MODULUS],
        past[EXPONENT],
        greatest,
        soil[SoilColumn.UNLOADING_STIFFNESS],
        soil[SoilColumn.UNLOADING_STIFFNESS_PER_SINKAGE],
    )
    if rut <= 0.0:
        return
    sense = 1.0 if travel > 0.0 else -1.0
    behind = travel * past[REACH]
    shear = math.sqrt(
        state[StateColumn.SHEAR_ALONG] * state[StateColumn.SHEAR_ALONG]
        + state[StateColumn.SHEAR_SIDE] * state[StateColumn.SHEAR_SIDE]
    )
    line = Patch(
        past[PLACE_X] - behind * forward[0],
        past[PLACE_Y] - behind * forward[1],
        sense * forward[0],
        sense * forward[1],
        0.0,
        wheel[WheelColumn.WIDTH],
    )
    write_ground(memory, line, Trace(greatest, rut, shear, 1.0 - soil[SoilColumn.COMPACTED_SHARE]))
