"""Normal force of a wheel that gives way on ground that gives way: two springs in series.

Ground: a round rim of radius r and width b, pressed by z into ground of pressure p = k z^n, each strip on its
own (Winkler's foundation; Johnson 1985, Contact Mechanics, sec. 4.3), arc replaced by a parabola:

    F = b k ∫ (z - x²/2r)^n dx = A z^m,   A = b k sqrt(2 r) B(1/2, n + 1),   m = n + 1/2

with Euler's beta function B. Wheel: its load against its deflection δ, stiffer with δ, with a bump stop at δ_s

    F = c_1 δ + c_2 δ² + c_s max(δ - δ_s, 0)

Series: δ + z is the penetration h, and both carry the same load. The solution is found between its bounds by
Newton's method and, where that leaves them, by halving. A wheel with c_1 = c_2 = 0 is rigid: δ = 0.

Assumptions: quasi-static; the rim in the ground keeps its radius. Range: z and δ below about r/4; beyond, the
laws go on as they are written.
"""

import math
from typing import NamedTuple

from sojourn_machine.kernels import kernel
from sojourn_machine.params import FloatArray
from sojourn_physics.contact.wheel_on_soil import pressure_modulus
from sojourn_physics.soil.params import SoilColumn

MAX_ITERATIONS = 60
TOLERANCE = 1e-13
"""Of the sinkage, as a fraction of the penetration."""


class Carcass(NamedTuple):
    """Load of a wheel [N], or its pressure [Pa], over its deflection δ [m]: see `sinkage_in_series`."""

    offset: float
    """At no deflection; more than 0 where the wheel is stressed already (a carcass with pressure in it)."""
    linear: float
    """Of δ."""
    square: float
    """Of δ²."""
    stop: float
    """δ at which an inner frame or a bump stop bears, too [m]."""
    stop_stiffness: float
    """Of max(δ - stop, 0)."""


@kernel
def round_rim_on_ground(radius: float, width: float, soil: FloatArray) -> tuple[float, float]:
    """A [N/m^m] and m of the load F = A z^m of a rigid rim."""
    n = soil[SoilColumn.N]
    beta = math.sqrt(math.pi) * math.gamma(n + 1.0) / math.gamma(n + 1.5)
    return width * pressure_modulus(soil, width) * math.sqrt(2.0 * radius) * beta, n + 0.5


@kernel
def sinkage_in_series(amount: float, exponent: float, penetration: float, carcass: Carcass) -> float:
    """z in 0..h of  amount z^exponent = offset + linear δ + square δ² + stop_stiffness max(δ - stop, 0),  δ = h - z.

    Returns h where the ground yields all the way, and where linear and square are both 0.
    """
    offset, linear, square = carcass.offset, carcass.linear, carcass.square
    stop, stop_stiffness = carcass.stop, carcass.stop_stiffness
    if amount * penetration**exponent <= offset or linear + square + offset <= 0.0:
        return penetration
    low, high = 0.0, penetration
    z = 0.5 * penetration
    if amount > 0.0:
        # where ground much stiffer than the wheel would stand
        full = offset + (linear + square * penetration) * penetration
        full += stop_stiffness * max(penetration - stop, 0.0)
        z = min((full / amount) ** (1.0 / exponent), z)
    for _ in range(MAX_ITERATIONS):
        deflection = penetration - z
        beyond = max(deflection - stop, 0.0)
        power = amount * z**exponent
        excess = power - offset - (linear + square * deflection) * deflection - stop_stiffness * beyond
        if excess > 0.0:
            high = z
        else:
            low = z
        slope = linear + 2.0 * square * deflection
        if beyond > 0.0:
            slope += stop_stiffness
        if z > 0.0:
            slope += exponent * power / z
        new = z - excess / slope if slope > 0.0 else low
        if not low < new < high:
            new = 0.5 * (low + high)
        change = abs(new - z)
        z = new
        if change <= TOLERANCE * penetration:
            break
    return z
