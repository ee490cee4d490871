"""Lunar regolith over depth (Carrier, Olhoeft & Mendell 1991, in Lunar Sourcebook, ch. 9).

    rho(z) = 1920 (z + 12.2)/(z + 18) kg/m3, z in cm;   mean of 0..z:  1920 [1 - (5.8/z) ln(1 + z/18)]

Cohesion and friction angle are means of layers: 0-15 cm 520 Pa, 42 deg; 0-30 cm 900 Pa, 46 deg; 30-60 cm 3000 Pa, 54
deg. They stand for the middle of their layer, linear between the middles and held beyond them. A footing feels the soil
down to about its own width (Terzaghi 1943: depth of the slip surface), a wheel to about its width below the rim.

Range: intercrater areas, down to 3 m for the density and 60 cm for the strength.
"""

import math

import numpy as np

from sojourn_machine.errors import InvalidValueError
from sojourn_physics.soil.params import SoilParams
from sojourn_physics.soil.relative_density import LUNAR_COHESION, LUNAR_FRICTION_ANGLE_DEG, Strength

_DENSE = 1920.0
_A, _B = 0.122, 0.18
"""[m]"""
LAYER_MIDDLES = (0.075, 0.15, 0.45)
"""[m]"""
DEEPEST = 3.0


def density(depth: float) -> float:
    """Bulk density [kg/m3] at a depth [m].

    Raises:
        InvalidValueError: a depth outside 0 to 3 m.
    """
    _check(depth)
    return _DENSE * (depth + _A) / (depth + _B)


def mean_density(depth: float) -> float:
    """Mean bulk density [kg/m3] from the surface to a depth [m].

    Raises:
        InvalidValueError: a depth outside 0 to 3 m.
    """
    _check(depth)
    if depth < 1e-6:  # the quotient loses its digits, and the limit is near enough
        return density(depth)
    return _DENSE * (1.0 - (_B - _A) / depth * math.log1p(depth / _B))


def strength(depth: float) -> Strength:
    """Cohesion and friction angle at a depth [m].

    Raises:
        InvalidValueError: a depth outside 0 to 3 m.
    """
    _check(depth)
    return Strength(
        float(np.interp(depth, LAYER_MIDDLES, LUNAR_COHESION)),
        float(np.interp(depth, LAYER_MIDDLES, LUNAR_FRICTION_ANGLE_DEG)),
    )


def soil_at(base: SoilParams, depth: float) -> SoilParams:
    """The soil `base` with the density and strength of regolith whose middle lies at a depth [m].

    Args:
        base: gives what does not change with depth, as `lunar_nominal`.

    Raises:
        InvalidValueError: a depth outside 0 to 3 m.
    """
    found = strength(depth)
    changes = {
        "density": density(depth),
        "cohesion": found.cohesion,
        "friction_angle_deg": found.friction_angle_deg,
    }
    return SoilParams.model_validate({**base.model_dump(), **changes})


def _check(depth: float) -> None:
    if not 0.0 <= depth <= DEEPEST:
        raise InvalidValueError("depth", depth, f"0 to {DEEPEST:g} m")
