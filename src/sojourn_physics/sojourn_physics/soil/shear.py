"""Shear stress of a soil over its shear displacement j, under a normal stress p.

    limit    tau_max = c + p tan phi                                            (Mohr-Coulomb)
    Janosi   tau = tau_max (1 - e^(-j/K))                                       (Janosi & Hanamoto 1961)
    Wong     tau = tau_max R {1 + [1/(R (1 - 1/e)) - 1] e^(1 - j/K)} (1 - e^(-j/K))
                                        (Wong 2008, Theory of Ground Vehicles, 4th ed., eq. 2.57)

Wong's form is for dense or cemented soil: the stress rises to about tau_max at j = K and falls to the residual, R
tau_max. Its peak is tau_max for R near 0.66, and up to 6 % more for R up to 1. With x = e^(-j/K) both forms are
tau_max (1 - x)(A + B x), with A = R, B = e/(1 - 1/e) - e R for Wong's and A = 1, B = 0 for Janosi's.

K is read off a shear-ring or shear-box record: for Janosi's form the displacement at 95 % of the limit is 3 K.
Assumes one direction of shear and a constant normal stress.
"""

import math

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.kernels import kernel


def hump_coefficients(residual_ratio: float | None) -> tuple[float, float]:
    """A and B of the form above [-]; Janosi's for None.

    Raises:
        InvalidValueError: a ratio outside 0 to 1.
    """
    if residual_ratio is None:
        return 1.0, 0.0
    if not 0.0 < residual_ratio <= 1.0:
        raise InvalidValueError("residual_ratio", residual_ratio, "more than 0 and at most 1")
    return residual_ratio, math.e * (1.0 / (1.0 - math.exp(-1.0)) - residual_ratio)


@kernel
def mobilised(ratio: float, residual: float, hump: float) -> float:
    """Share of the limit that is mobilised after a displacement of `ratio` = j/K, for the coefficients A and B."""
    rest = math.exp(-ratio)
    return float(-math.expm1(-ratio) * (residual + hump * rest))


def shear_limit(cohesion: float, friction_angle: float, pressure: float) -> float:
    """Greatest shear stress [Pa] of a soil under a normal stress [Pa]; cohesion [Pa], friction_angle [rad].

    Raises:
        InvalidValueError: a negative pressure or cohesion, or an angle outside 0 to pi/2.
    """
    for name, value in (("pressure", pressure), ("cohesion", cohesion)):
        if not (math.isfinite(value) and value >= 0.0):
            raise InvalidValueError(name, value, "a finite number, at least 0 Pa")
    if not 0.0 <= friction_angle < 0.5 * math.pi:
        raise InvalidValueError("friction_angle", friction_angle, "0 to pi/2 rad")
    return cohesion + pressure * math.tan(friction_angle)


def shear_stress(limit: float, displacement: float, modulus: float, residual_ratio: float | None = None) -> float:
    """Shear stress [Pa] after a displacement.

    Args:
        limit: greatest shear stress, as `shear_limit` [Pa].
        displacement: at least 0 [m]. modulus: K [m].
        residual_ratio: residual over greatest stress of Wong's form [-]; None for Janosi's.

    Raises:
        InvalidValueError: an argument outside its range.
    """
    if not (math.isfinite(displacement) and displacement >= 0.0):
        raise InvalidValueError("displacement", displacement, "a finite number, at least 0 m")
    if not (math.isfinite(modulus) and modulus > 0.0):
        raise InvalidValueError("modulus", modulus, "a finite number more than 0 m")
    residual, hump = hump_coefficients(residual_ratio)
    return limit * float(mobilised(displacement / modulus, residual, hump))


def contact_thrust(limit_force: float, length: float, slip: float, modulus: float) -> float:
    """Thrust [N] of a flat contact that slips, its shear displacement growing from 0 to s l along it.

        F = F_max (1 - K/(s l) (1 - e^(-s l / K)))          (Janosi & Hanamoto 1961)

    Args:
        limit_force: A c + W tan phi [N]. length: of the contact [m]. slip: 0..1. modulus: K [m].

    Raises:
        InvalidValueError: a slip outside 0 to 1, or sizes that are not positive.
    """
    if not 0.0 <= slip <= 1.0:
        raise InvalidValueError("slip", slip, "0 to 1")
    for name, value in (("length", length), ("modulus", modulus)):
        if not (math.isfinite(value) and value > 0.0):
            raise InvalidValueError(name, value, "a finite number more than 0 m")
    ratio = slip * length / modulus
    if ratio < 1e-6:  # the closed form loses its digits; this is exact to double precision
        return limit_force * 0.5 * ratio
    return limit_force * (1.0 + math.expm1(-ratio) / ratio)
