"""A track in plates: what the soil does to each of the links that lie on it, and what they remember.

The track of the law 12 (`track`: even or peaked pressure, Janosi's shear over the length, compaction, bulldozing) is
cut across into plates of length Δ, so that it may lie on any ground, pitch, climb and turn. For a plate at a depth z:

    N = p_m(z) w b Δ (1 - d dz/dt),   p_m = k z^n/(1 + a)     w = 1 - a cos(2π N_w (x/l + 1/2)) under N_w road wheels
    T = (c b Δ + N tan φ)(1 - e^-j) along (e_x/K, e_y/K_y),   j = |(e_x/K, e_y/K_y)|
    dR_c = b k (z^(n+1) - z_f^(n+1))/(n+1),  dR_b = b (w(z) - w(z_f)),  w = c z K_c + γ z² K_γ/2

with z_f the greatest depth of the plates that went before it, so that a level track has the resistances of the law 12.
The shear displacement u lies on the links and goes with them, from the plate that is first on the ground to the last:

    ∂u/∂t + |V| ∂u/∂x' = (V - v_x, -v_y),   V the speed of the belt, x' from where the links come down

(Wong 2008, Theory of Ground Vehicles, sec. 6.3; plates as in his NTVPM: the shear of a point grows from where it
enters; sideways and in turns Wong & Chiang 2001, Proc. IMechE D 215:343). Finite
volumes of the plates' length carry it, exact in steady rolling, j = σ x'. e is u by the hysteresis of
`hysteresis`; no link remembers more than MEMORY shear moduli.

The force on a link of the inclined runs acts along the normal of the ground, as under the flat one; the belt takes the
shear, the hull what is normal to the ground and the resistances. Ground that others have rolled over: the depth of the
rut and what it has borne pass under the track with the ground, read ahead of it (`terrain.memory_access`); it leaves
its own behind.

Assumptions: stiff links, an unstretched belt; soil does not flow from plate to plate. Range: ground smooth over a
plate; sinkage to a quarter of the width.
"""

import math
from enum import IntEnum
from typing import NamedTuple

from sojourn_machine.kernels import kernel, small_kernel
from sojourn_machine.params import FloatArray
from sojourn_physics.contact.contact_law import STATE_COLUMNS, StateColumn
from sojourn_physics.contact.hysteresis import effective_shear
from sojourn_physics.contact.passive_pressure import wall_resistance
from sojourn_physics.contact.resistance_memory import advance_headway
from sojourn_physics.contact.shear_memory import MAX_DAMPING_GAIN, clip, shear_lead
from sojourn_physics.contact.wheel_on_soil import pressure_modulus
from sojourn_physics.soil.params import SoilColumn
from sojourn_physics.soil.repeated_loading import equivalent_law

MEMORY = 8.0
"""Largest displacement that a link remembers, in shear moduli: e^-8 short of full shear."""

LARGEST_SHIFT = 0.5
"""In a step, over the pitch of the plates: a belt that runs faster is taken to run so fast."""


class TrackColumn(IntEnum):
    """Row of a track."""

    RADIUS = 0
    """Of the sprocket's pitch circle [m]."""
    WIDTH = 1
    PITCH = 2
    """Length of a plate [m]."""
    LENGTH = 3
    """Of the flat run [m]."""
    PEAKEDNESS = 4
    """a [-]."""
    GRAVITY = 5
    """[m/s^2]"""


TRACK_COLUMNS = len(TrackColumn)


class PlateColumn(IntEnum):
    """Row of a plate, in the frame of the joint that carries the track."""

    X = 0
    """Of its centre [m]."""
    Y = 1
    Z = 2
    AHEAD_X = 3
    """Unit vector along the track, forwards."""
    AHEAD_Y = 4
    AHEAD_Z = 5
    SHARE = 6
    """w of the mean pressure that it bears [-]."""


PLATE_COLUMNS = len(PlateColumn)
GREATEST, RUT = int(StateColumn.TWIST), int(StateColumn.TRAVEL)
"""Of a plate's state, in place of what rolling contacts keep there: what the ground under it has been pressed to by
others, and the depth of their rut [m]."""


class LinkSliding(NamedTuple):
    """How the links of a plate move over the ground under it [m/s]."""

    along: float
    """Of the belt over the ground: positive drives ahead."""
    side: float
    """Likewise to the left."""
    hull: float
    """Of the hull along the ground."""
    normal: float
    """Of the hull, out of the ground."""


class Plate(NamedTuple):
    """One plate on the ground."""

    share: float
    """w [-]."""
    depth: float
    """z, more than 0 [m]."""
    before: float
    """z_f, at least 0 [m]."""


class PlateForce(NamedTuple):
    """On the machine [N]."""

    normal: float
    shear_along: float
    """Through the belt."""
    shear_side: float
    compaction: float
    """Resistances, at least 0."""
    bulldozing: float
    headway: float
    """H in -1..1: the sense in which they act (see `resistance_memory`)."""


@small_kernel
def _carry(states: FloatArray, column: int, backwards: bool, part: float) -> None:
    """One quantity that lies on the links goes on by a part of a pitch, from the end where they come down with none.

    Finite volumes with van Leer's slopes (1974, J. Comput. Phys. 14:361): exact where it grows evenly along the track.
    """
    count = states.shape[0]
    before = inflow = 0.0
    for step in range(count):
        i = count - 1 - step if backwards else step
        here = states[i, column]
        rise = here - before if before != 0.0 else 2.0 * here  # none where the links come down
        last = step == count - 1
        further = rise if last else states[i - 1 if backwards else i + 1, column] - here
        product = rise * further
        slope = 2.0 * product / (rise + further) if product > 0.0 else 0.0
        outflow = here + 0.5 * slope
        states[i, column] = here - part * (outflow - inflow)
        before, inflow = here, outflow


@small_kernel
def shift(states: FloatArray, belt: float, pitch: float, dt: float) -> None:
    """What lies on the links goes on with the belt, over dt [s].

    Args:
        states: (plates, STATE_COLUMNS) of one track, from its front to its rear; zero where a plate is off the ground.
        belt: speed of the belt, positive drives ahead [m/s]. pitch: of the plates [m].
    """
    part = min(dt * abs(belt) / pitch, LARGEST_SHIFT)
    if part == 0.0:
        return
    for column in range(STATE_COLUMNS):
        if column != GREATEST and column != RUT and column != StateColumn.HEADWAY:
            _carry(states, column, belt < 0.0, part)


@small_kernel
def pass_ground(
    states: FloatArray, hull: float, pitch: float, dt: float, ahead_greatest: float, ahead_rut: float
) -> None:
    """The past of the ground passes under the track with the hull's speed [m/s]; arguments as in `shift`.

    Args:
        ahead_greatest, ahead_rut: what the ground ahead has borne, and the depth of the rut there [m].
    """
    count = states.shape[0]
    part = dt * abs(hull) / pitch
    for step in range(count):
        i = step if hull > 0.0 else count - 1 - step
        before = i - 1 if hull > 0.0 else i + 1
        first = before < 0 or before >= count
        greatest = ahead_greatest if first else states[before, GREATEST]
        rut = ahead_rut if first else states[before, RUT]
        states[i, GREATEST] = (states[i, GREATEST] + part * greatest) / (1.0 + part)
        states[i, RUT] = (states[i, RUT] + part * rut) / (1.0 + part)


@kernel
def plate_force(
    track: FloatArray, plate: Plate, soil: FloatArray, sliding: LinkSliding, dt: float, state: FloatArray
) -> PlateForce:
    """One plate on the ground, after `shift`.

    Args:
        track: row of `TrackColumn`. soil: row of `SoilColumn`. state: (STATE_COLUMNS,), advanced.
    """
    depth, before = plate.depth, plate.before
    width, pitch = track[TrackColumn.WIDTH], track[TrackColumn.PITCH]
    modulus, n = pressure_modulus(soil, min(width, track[TrackColumn.LENGTH])), soil[SoilColumn.N]
    if state[RUT] > 0.0:
        modulus, n = equivalent_law(modulus, n, state[GREATEST], state[RUT], depth)
    pressure = modulus * depth**n / (1.0 + track[TrackColumn.PEAKEDNESS]) * plate.share
    area = width * pitch
    normal = area * pressure * clip(1.0 - soil[SoilColumn.CONTACT_DAMPING] * sliding.normal, 0.0, MAX_DAMPING_GAIN)

    u_x = state[StateColumn.SHEAR_ALONG] + dt * sliding.along
    u_y = state[StateColumn.SHEAR_SIDE] + dt * sliding.side
    displacement = math.sqrt(u_x * u_x + u_y * u_y)
    largest = MEMORY * soil[SoilColumn.SHEAR_MODULUS]
    kept = largest / displacement if displacement > largest else 1.0
    displacement *= kept
    state[StateColumn.SHEAR_ALONG], state[StateColumn.SHEAR_SIDE] = u_x * kept, u_y * kept
    e_x, e_y, _ = effective_shear(dt * sliding.along, dt * sliding.side, 0.0, kept, displacement, state)
    speed = math.sqrt(sliding.along * sliding.along + sliding.side * sliding.side)
    lead = shear_lead(max(abs(sliding.hull), speed))
    j_x = (e_x + lead * sliding.along) / soil[SoilColumn.SHEAR_MODULUS]
    j_y = (e_y + lead * sliding.side) / soil[SoilColumn.SHEAR_MODULUS_LATERAL]
    j = math.sqrt(j_x * j_x + j_y * j_y)
    gain = -math.expm1(-j) / j if j > 1e-9 else 1.0
    limit = (soil[SoilColumn.COHESION] * area + normal * soil[SoilColumn.TAN_PHI]) * gain

    headway = advance_headway(sliding.hull, track[TrackColumn.LENGTH], dt, state)
    compaction = bulldozing = 0.0
    if depth > before:
        compaction = width * modulus * (depth ** (n + 1.0) - before ** (n + 1.0)) / (n + 1.0)
        unit_weight = soil[SoilColumn.DENSITY] * track[TrackColumn.GRAVITY]
        cohesion, tan_phi = soil[SoilColumn.COHESION], soil[SoilColumn.TAN_PHI]
        bulldozing = width * (
            wall_resistance(depth, cohesion, tan_phi, unit_weight)
            - wall_resistance(before, cohesion, tan_phi, unit_weight)
        )
    return PlateForce(normal, limit * j_x, limit * j_y, compaction, bulldozing, headway)
