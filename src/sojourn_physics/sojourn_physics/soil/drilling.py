"""Thrust and torque of a drill, from the energy that it takes to break the ground.

Detournay & Defourny 1992 (Int. J. Rock Mech. Min. Sci. 29:13), drag bit of radius a that cuts to the depth d a turn:

    thrust   W = ζ ε a d + W_f                 cutting, and the wear flats' share W_f
    torque   T = ε a² d/2 + μ g_b a W_f/2
    so that  E = (1 - β) ε + μ g_b S,          E = 2 T/(a² d) specific energy, S = W/(a d) drilling strength, β = g_b μ
    ζ

ε is the intrinsic specific energy of the ground [Pa = J/m3], ζ the ratio of thrust to drag of a sharp cutter, μ the
friction of its flats, g_b a number of the bit, 1 for a flat one. The work of a volume of hole is, with the thrust's
share,

    e = W/A + 2 π T/(A d)                     (Teale 1965, Int. J. Rock Mech. Min. Sci. 2:57),  A = π a²

Given a thrust, W_f is what the flats carry up to their limit (`flat_force`), and the rest cuts: a drill that is pressed
with less than that only rubs.

Range of validity: full-face drag bits in dry ground, chips cleared; ε of regolith some 0.1 to 2 MPa, of basalt 100 MPa.
"""

import math
from typing import NamedTuple

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.tools import DrillBitParams


class Drilling(NamedTuple):
    """How a drill gets on."""

    depth_per_turn: float
    """[m]"""
    torque: float
    """[N m]"""
    specific_energy: float
    """Work of thrust and torque for a volume of hole [J/m3]; infinite where it only rubs."""


def drill(bit: DrillBitParams, intrinsic_energy: float, thrust: float) -> Drilling:
    """A drill under a thrust [N] in ground of an intrinsic specific energy ε [J/m3].

    Raises:
        InvalidValueError: a thrust below zero, or an energy that is not above zero.
    """
    if not (math.isfinite(thrust) and thrust >= 0.0):
        raise InvalidValueError("thrust [N]", thrust, "0 or above")
    if not (math.isfinite(intrinsic_energy) and intrinsic_energy > 0.0):
        raise InvalidValueError("intrinsic specific energy [J/m3]", intrinsic_energy, "above 0")
    a = bit.radius
    on_flats = min(thrust, bit.flat_force)
    depth = (thrust - on_flats) / (bit.thrust_ratio * intrinsic_energy * a)
    rubbing = 0.5 * bit.flat_friction * bit.shape * a * on_flats
    torque = 0.5 * intrinsic_energy * a * a * depth + rubbing
    area = math.pi * a * a
    work = (thrust * depth + 2.0 * math.pi * torque) / (area * depth) if depth > 0.0 else math.inf
    return Drilling(depth, torque, work)
