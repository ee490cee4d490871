"""Pads, plates and wheels at rest on soil: what they can carry, how hard they press, how deep they sink.

Ultimate pressure of a footing of width b under a surcharge p_0 (Terzaghi 1943, ch. 8, with his shape factors):

    p_u = s_c c N_c + p_0 N_q + s_gamma gamma b N_gamma / 2
    strip s_c 1, s_gamma 1;   square 1.3, 0.8;   round (b the diameter) 1.3, 0.6

Without sinkage p_0 is zero (p_s, what the surface bears before anything sinks); a pad sunk by z has p_0 = gamma z more.
In loose soil, local shear failure takes two thirds of c and tan phi (Terzaghi).

A rigid wheel at rest presses symmetrically about its lowest point, with the pressure of a plate at the same depth:

    W = 2 b r integral_0^theta1 k r^n (cos theta - cos theta1)^n cos theta dtheta

without the first-order parabola of Bekker's closed form (`pressure_sinkage.wheel_sinkage`, a towed wheel: front only).
"""

import math
from typing import Literal, TypeAlias

from scipy.integrate import quad
from scipy.optimize import brentq

from sojourn_machine.errors import InvalidValueError
from sojourn_physics.soil.bearing import failure_strength
from sojourn_physics.soil.params import SoilParams
from sojourn_physics.soil.pressure_sinkage import modulus, plate_sinkage

Shape: TypeAlias = Literal["strip", "square", "round"]
SHAPE_FACTORS: dict[str, tuple[float, float]] = {"strip": (1.0, 1.0), "square": (1.3, 0.8), "round": (1.3, 0.6)}
"""s_c and s_gamma."""


def ultimate_pressure(
    soil: SoilParams, width: float, gravity: float, shape: Shape = "strip", surcharge: float = 0.0
) -> float:
    """Pressure at which the soil under a footing fails [Pa].

    Args:
        width: smaller side, or diameter [m]. gravity: [m/s^2]. surcharge: p_0 on the soil beside it [Pa].

    Raises:
        InvalidValueError: an argument outside its range.
    """
    if shape not in SHAPE_FACTORS:
        raise InvalidValueError("shape", shape, "one of " + ", ".join(SHAPE_FACTORS))
    _positive("width", width)
    if not (math.isfinite(surcharge) and surcharge >= 0.0):
        raise InvalidValueError("surcharge", surcharge, "a finite number, at least 0 Pa")
    failing = failure_strength(soil.cohesion, soil.friction_angle, soil.bulldozing_failure == "local")
    for_cohesion, for_weight = SHAPE_FACTORS[shape]
    factors = failing.factors
    weight = 0.5 * soil.unit_weight(gravity) * width * factors.n_gamma
    return for_cohesion * failing.cohesion * factors.n_c + surcharge * factors.n_q + for_weight * weight


def safe_load(soil: SoilParams, diameter: float, gravity: float, sinkage: float = 0.0, safety: float = 3.0) -> float:
    """Load [N] that a round pad sunk by `sinkage` [m] carries with a factor of safety.

    Raises:
        InvalidValueError: an argument outside its range.
    """
    if not (math.isfinite(sinkage) and sinkage >= 0.0):
        raise InvalidValueError("sinkage", sinkage, "a finite number, at least 0 m")
    if not (math.isfinite(safety) and safety >= 1.0):
        raise InvalidValueError("safety", safety, "a finite number of at least 1")
    surcharge = soil.unit_weight(gravity) * sinkage
    pressure = ultimate_pressure(soil, diameter, gravity, "round", surcharge)
    return 0.25 * math.pi * diameter**2 * pressure / safety


def pad_sinkage(soil: SoilParams, load: float, diameter: float) -> float:
    """Sinkage [m] of a round pad under a load [N]; the width in k is its radius (Bekker 1969, circular plates).

    Raises:
        InvalidValueError: a negative load, or a diameter that is not positive.
    """
    _positive("diameter", diameter)
    return plate_sinkage(soil, 0.5 * diameter, load / (0.25 * math.pi * diameter**2))


def wheel_load(soil: SoilParams, radius: float, width: float, sinkage: float) -> float:
    """Load [N] that a rigid wheel at rest bears at a sinkage [m] of at most its radius.

    Raises:
        InvalidValueError: an argument outside its range.
    """
    _positive("radius", radius)
    if not 0.0 <= sinkage <= radius:
        raise InvalidValueError("sinkage", sinkage, f"0 to the radius, {radius:g} m")
    stiffness = modulus(soil, width)
    entry = math.acos(1.0 - sinkage / radius)

    def lift(root: float) -> float:
        # theta = theta1 (1 - u^2): smooth at the edge for n < 1 as well
        theta = entry * (1.0 - root * root)
        depth = max(radius * (math.cos(theta) - math.cos(entry)), 0.0)
        return 2.0 * root * entry * math.pow(depth, soil.n) * math.cos(theta)

    total = float(quad(lift, 0.0, 1.0, epsabs=0.0, epsrel=1e-10)[0]) if entry > 0.0 else 0.0
    return 2.0 * width * radius * stiffness * total


def static_wheel_sinkage(soil: SoilParams, load: float, radius: float, width: float) -> float:
    """Sinkage [m] of a rigid wheel at rest under a load [N]: inverse of `wheel_load`.

    Raises:
        InvalidValueError: a load that is negative or that sinks the wheel to its axle.
    """
    most = wheel_load(soil, radius, width, radius)
    if not 0.0 <= load <= most:
        raise InvalidValueError("load", load, f"0 to {most:.4g} N, which sinks the wheel to its axle")
    return float(brentq(lambda z: wheel_load(soil, radius, width, z) - load, 0.0, radius, xtol=1e-12))


def mean_ground_pressure(load: float, radius: float, width: float, sinkage: float) -> float:
    """Load over the plan area of the front of a wheel's contact, b sqrt(2 r z - z^2) [Pa].

    Raises:
        InvalidValueError: a sinkage that is not more than 0 and at most the radius.
    """
    _positive("width", width)
    if not 0.0 < sinkage <= radius:
        raise InvalidValueError("sinkage", sinkage, f"more than 0, at most the radius, {radius:g} m")
    return load / (width * math.sqrt(sinkage * (2.0 * radius - sinkage)))


def _positive(name: str, value: float) -> None:
    if not (math.isfinite(value) and value > 0.0):
        raise InvalidValueError(name, value, "a finite number more than 0")
