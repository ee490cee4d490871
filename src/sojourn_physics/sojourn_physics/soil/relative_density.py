"""Density and strength of a granular soil from its relative density.

    D_r = (rho_max / rho) (rho - rho_min) / (rho_max - rho_min)        (0 loosest, 1 densest; ASTM D4254)

Strength of lunar soil over relative density: means of Carrier, Olhoeft & Mendell 1991, in Lunar Sourcebook, ch. 9 (0-15
cm: D_r 0.65, c 520 Pa, phi 42 deg; 0-30 cm: 0.74, 900 Pa, 46 deg; 30-60 cm: 0.92, 3000 Pa, 54 deg), linear between them
and held beyond them.
"""

import math
from dataclasses import dataclass

from sojourn_machine.errors import InvalidValueError

LUNAR_RELATIVE_DENSITY = (0.65, 0.74, 0.92)
LUNAR_COHESION = (520.0, 900.0, 3000.0)
LUNAR_FRICTION_ANGLE_DEG = (42.0, 46.0, 54.0)


@dataclass(frozen=True, slots=True)
class Strength:
    """Cohesion [Pa] and friction angle [degree]."""

    cohesion: float
    friction_angle_deg: float


def density_at(relative_density: float, loosest: float, densest: float) -> float:
    """Bulk density [kg/m3] of a soil between its loosest and its densest state [kg/m3].

    Raises:
        InvalidValueError: a relative density outside 0 to 1, or densities that are no range.
    """
    _check_range(loosest, densest)
    if not 0.0 <= relative_density <= 1.0:
        raise InvalidValueError("relative_density", relative_density, "0 (loosest) to 1 (densest)")
    return loosest * densest / (densest - relative_density * (densest - loosest))


def relative_density_at(density: float, loosest: float, densest: float) -> float:
    """Relative density [-] of a bulk density [kg/m3]: inverse of `density_at`.

    Raises:
        InvalidValueError: a density outside the range, or densities that are no range.
    """
    _check_range(loosest, densest)
    if not loosest <= density <= densest:
        raise InvalidValueError("density", density, f"{loosest:g} to {densest:g} kg/m3")
    return densest / density * (density - loosest) / (densest - loosest)


def _check_range(loosest: float, densest: float) -> None:
    if not (math.isfinite(densest) and 0.0 < loosest < densest):
        raise InvalidValueError("density_range", (loosest, densest), "[loosest, densest] in kg/m3, rising, more than 0")
