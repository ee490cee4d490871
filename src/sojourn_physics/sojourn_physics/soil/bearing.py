"""Bearing capacity factors (Terzaghi 1943, Theoretical Soil Mechanics, ch. 8) and bulldozing resistance.

    N_q = e^((3 pi / 2 - phi) tan phi) / (2 cos^2(45 deg + phi / 2)),   N_c = (N_q - 1) cot phi
    N_gamma = 2 (N_q + 1) tan phi / (1 + 0.4 sin 4 phi)
                                (closed fit to Terzaghi's graph: Coduto, Foundation Design, 2nd ed., sec. 6.3)
    K_c = (N_c - tan phi) cos^2 phi,   K_gamma = (2 N_gamma / tan phi + 1) cos^2 phi

Strip footing of width b with a surcharge q: p = c N_c + q N_q + gamma b N_gamma / 2.

Bulldozing of a rigid wheel of diameter D and width b at sinkage z (Bekker 1969, sec. 2.8; Hegedus 1960):

    alpha = acos(1 - 2 z / D),  l0 = z tan^2(45 deg - phi / 2)
    R_b = b sin(alpha + phi) / (2 sin alpha cos phi) (2 z c K_c + gamma z^2 K_gamma)
          + l0^3 gamma / 3 (pi / 2 - phi) + c l0^2 [1 + tan(45 deg + phi / 2)]

Assumptions: general shear failure, shallow, level ground. Range: phi from 0 to about 50 degrees; z up to D
/ 2.
"""

import math
from dataclasses import dataclass

from sojourn_machine.errors import InvalidValueError

MAX_FRICTION_ANGLE = math.radians(60.0)
"""Beyond this the factors have no meaning for a soil [rad]."""

COHESION_FACTOR_WITHOUT_FRICTION = 1.5 * math.pi + 1.0
"""Limit of N_c at phi = 0 (Terzaghi's 5.7); compiled into kernels."""


@dataclass(frozen=True, slots=True)
class BearingFactors:
    """Terzaghi's factors for one friction angle [-]."""

    n_q: float
    n_c: float
    n_gamma: float
    k_c: float
    k_gamma: float


def bearing_factors(friction_angle: float) -> BearingFactors:
    """Factors at a friction angle [rad].

    Raises:
        InvalidValueError: an angle outside 0 to 60 degrees.
    """
    if not 0.0 <= friction_angle <= MAX_FRICTION_ANGLE:
        raise InvalidValueError("friction_angle", friction_angle, f"0 to {MAX_FRICTION_ANGLE:.4f} rad")
    tangent = math.tan(friction_angle)
    cosine_squared = math.cos(friction_angle) ** 2
    half_wedge = math.cos(math.pi / 4.0 + friction_angle / 2.0)
    n_q = math.exp((1.5 * math.pi - friction_angle) * tangent) / (2.0 * half_wedge**2)
    # Below a microradian the quotient loses its digits, and the limit is exact to more than double precision.
    n_c = (n_q - 1.0) / tangent if tangent > 1e-6 else COHESION_FACTOR_WITHOUT_FRICTION
    n_gamma_over_tangent = 2.0 * (n_q + 1.0) / (1.0 + 0.4 * math.sin(4.0 * friction_angle))
    return BearingFactors(
        n_q=n_q,
        n_c=n_c,
        n_gamma=n_gamma_over_tangent * tangent,
        k_c=(n_c - tangent) * cosine_squared,
        k_gamma=(2.0 * n_gamma_over_tangent + 1.0) * cosine_squared,
    )


@dataclass(frozen=True, slots=True)
class FailureStrength:
    """Strength with which a soil fails under a footing or before a blade."""

    cohesion: float
    """[Pa]"""
    friction_angle: float
    """[rad]"""
    factors: BearingFactors


def failure_strength(cohesion: float, friction_angle: float, local: bool) -> FailureStrength:
    """Strength to fail with: the soil's own in general shear failure, 2/3 of it in local (Terzaghi 1943, sec. 47).

    A friction angle beyond MAX_FRICTION_ANGLE (rock) counts as that.

    Args:
        cohesion: [Pa]. friction_angle: [rad].
        local: whether the soil is loose, so that it gives way before a slip surface has formed throughout.
    """
    angle = min(friction_angle, MAX_FRICTION_ANGLE)
    if local:
        angle = math.atan(2.0 / 3.0 * math.tan(angle))
        cohesion *= 2.0 / 3.0
    return FailureStrength(cohesion, angle, bearing_factors(angle))


def bulldozing_resistance(
    friction_angle: float, cohesion: float, unit_weight: float, width: float, diameter: float, sinkage: float
) -> float:
    """Force [N] of the soil that a rigid wheel pushes ahead of itself.

    Args:
        friction_angle: [rad].
        cohesion: [Pa].
        unit_weight: weight of the soil on that body [N/m3].
        width, diameter: of the wheel, more than 0 [m].
        sinkage: 0 to half the diameter [m].

    Raises:
        InvalidValueError: an argument outside the stated range, or as `bearing_factors`.
    """
    factors = bearing_factors(friction_angle)
    _require_not_negative("cohesion", cohesion)
    _require_not_negative("unit_weight", unit_weight)
    for name, value in (("width", width), ("diameter", diameter)):
        if not (math.isfinite(value) and value > 0.0):
            raise InvalidValueError(name, value, "a finite number more than 0 m")
    if not 0.0 <= sinkage <= 0.5 * diameter:
        raise InvalidValueError("sinkage", sinkage, f"0 to half the diameter, {0.5 * diameter:g} m")
    if sinkage == 0.0:
        return 0.0
    approach = math.acos(1.0 - 2.0 * sinkage / diameter)
    wedge = sinkage * math.tan(math.pi / 4.0 - friction_angle / 2.0) ** 2
    shape = math.sin(approach + friction_angle) / (2.0 * math.sin(approach) * math.cos(friction_angle))
    passive = 2.0 * sinkage * cohesion * factors.k_c + unit_weight * sinkage**2 * factors.k_gamma
    side = wedge**3 * unit_weight / 3.0 * (math.pi / 2.0 - friction_angle)
    side += cohesion * wedge**2 * (1.0 + math.tan(math.pi / 4.0 + friction_angle / 2.0))
    return width * shape * passive + side


def _require_not_negative(name: str, value: float) -> None:
    if not (math.isfinite(value) and value >= 0.0):
        raise InvalidValueError(name, value, "a finite number, at least 0")
