"""Pressure and sinkage of plates and of a wheel at rest.

Both forms of the pressure-sinkage law are p = k z^n with a modulus k that depends on the width b:

    bekker   k = k_c / b + k_phi        reece   k = (k_c + b k_phi) / b^n

A towed rigid wheel of diameter D with load W (Bekker 1969, Introduction to Terrain-Vehicle Systems, sec.
2.7):

    z   = [3 W / ((3 - n) b k sqrt(D))]^(2 / (2 n + 1))
    R_c = b k z^(n + 1) / (n + 1)                            (compaction resistance)

Assumptions: no shear stress on the rim, stress at the rim as under a plate at the same depth, and the arc
replaced by a parabola expanded to first order. Good for z below about D / 6 and n up to about 1.3 (Bekker
states D > 0.5 m).
"""

import math

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.kernels import small_kernel
from sojourn_physics.soil.params import FORM_BEKKER, FORM_REECE, SoilParams


@small_kernel
def sinkage_modulus(form: float, n: float, k_c: float, k_phi: float, width: float) -> float:
    """Modulus k of p = k z^n [N/m^(n+2)] for a contact of a width [m], from the numbers of a kernel row."""
    if form == FORM_BEKKER:
        return float(k_c / width + k_phi)
    return float((k_c + width * k_phi) / width**n)


def modulus(soil: SoilParams, width: float) -> float:
    """Modulus k of p = k z^n for a plate of width `width` [m], in N/m^(n+2).

    Raises:
        InvalidValueError: a width that is not positive, or so small that a negative k_c makes k negative.
    """
    _require_positive("width", width)
    form = FORM_BEKKER if soil.form == "bekker" else FORM_REECE
    value = float(sinkage_modulus(form, soil.n, soil.k_c, soil.k_phi, float(width)))
    if value <= 0.0:
        allowed = f"more than {-soil.k_c / soil.k_phi:.4g} m for soil {soil.name}, whose k_c is negative"
        raise InvalidValueError("width", width, allowed)
    return value


def pressure(soil: SoilParams, width: float, sinkage: float) -> float:
    """Pressure under a plate [Pa] at a sinkage [m] of at least 0.

    Raises:
        InvalidValueError: negative sinkage, or as `modulus`.
    """
    _require_not_negative("sinkage", sinkage)
    return modulus(soil, width) * math.pow(sinkage, soil.n)


def plate_sinkage(soil: SoilParams, width: float, contact_pressure: float) -> float:
    """Sinkage [m] of a plate of a width [m] under a mean pressure [Pa] of at least 0: inverse of `pressure`.

    Raises:
        InvalidValueError: negative pressure, or as `modulus`.
    """
    _require_not_negative("contact_pressure", contact_pressure)
    return float((contact_pressure / modulus(soil, width)) ** (1.0 / soil.n))


def wheel_sinkage(soil: SoilParams, load: float, diameter: float, width: float) -> float:
    """Bekker's sinkage [m] of a towed rigid wheel under `load` [N].

    Raises:
        InvalidValueError: negative load, sizes that are not positive, or as `modulus`.
    """
    _require_not_negative("load", load)
    _require_positive("diameter", diameter)
    stiffness = (3.0 - soil.n) * width * modulus(soil, width) * math.sqrt(diameter)
    if stiffness <= 0.0:
        raise InvalidValueError("n", soil.n, "less than 3 for Bekker's wheel sinkage")
    return float((3.0 * load / stiffness) ** (2.0 / (2.0 * soil.n + 1.0)))


def compaction_resistance(soil: SoilParams, width: float, sinkage: float) -> float:
    """Force [N] that it takes to press a rut of this width and depth [m] into the soil.

    Raises:
        InvalidValueError: negative sinkage, or as `modulus`.
    """
    return width * pressure(soil, width, sinkage) * sinkage / (soil.n + 1.0)


def _require_positive(name: str, value: float) -> None:
    if not (math.isfinite(value) and value > 0.0):
        raise InvalidValueError(name, value, "a finite number more than 0")


def _require_not_negative(name: str, value: float) -> None:
    if not (math.isfinite(value) and value >= 0.0):
        raise InvalidValueError(name, value, "a finite number, at least 0")
