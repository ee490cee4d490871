"""Soil pushed aside: resistance of bulldozing and bearing capacity, for the kernels.

    per width      R_b/b = 2 z c K_c + γ z² K_γ, halved: c z K_c + γ z² K_γ/2               (Wong 2008, sec. 2.4)
    rigid wheel    Hegedus 1960 in Bekker 1969, sec. 2.8; the formula is that of `soil.bearing`
    round footing  p_u = 1.3 c N_c + γ z N_q + 0.6 γ a N_γ, radius a                          (Terzaghi 1943)

with Terzaghi's factors of `soil.bearing` from tan φ. A law gives c and tan φ of the failure that the soil's file names,
general or local (columns BULLDOZING_ of a soil's row).
"""

import math

from sojourn_machine.kernels import kernel
from sojourn_physics.soil.bearing import COHESION_FACTOR_WITHOUT_FRICTION

MAX_TANGENT = math.tan(math.radians(60.0))
MIN_TANGENT = 1e-6


@kernel
def terzaghi_factors(tan_phi: float) -> tuple[float, float, float, float, float]:
    """N_q, N_c, N_γ, K_c, K_γ [-]."""
    tangent = min(max(tan_phi, 0.0), MAX_TANGENT)
    phi = math.atan(tangent)
    cosine_squared = 1.0 / (1.0 + tangent * tangent)
    half_wedge = math.cos(0.25 * math.pi + 0.5 * phi)
    n_q = math.exp((1.5 * math.pi - phi) * tangent) / (2.0 * half_wedge * half_wedge)
    n_c = (n_q - 1.0) / tangent if tangent > MIN_TANGENT else COHESION_FACTOR_WITHOUT_FRICTION
    ratio = 2.0 * (n_q + 1.0) / (1.0 + 0.4 * math.sin(4.0 * phi))
    return n_q, n_c, ratio * tangent, (n_c - tangent) * cosine_squared, (2.0 * ratio + 1.0) * cosine_squared


@kernel
def wall_resistance(sinkage: float, cohesion: float, tan_phi: float, unit_weight: float) -> float:
    """Force a width of soil z deep puts up against a wall that is pushed into it [N/m]."""
    _, _, _, k_c, k_gamma = terzaghi_factors(tan_phi)
    return float(sinkage * (cohesion * k_c + 0.5 * unit_weight * sinkage * k_gamma))


@kernel
def wheel_bulldozing(
    sinkage: float, radius: float, width: float, cohesion: float, tan_phi: float, unit_weight: float
) -> float:
    """Force of the soil that a rigid wheel pushes ahead of itself [N]; beyond the axle as at the axle."""
    z = min(sinkage, radius)
    if z <= 0.0:
        return 0.0
    _, _, _, k_c, k_gamma = terzaghi_factors(tan_phi)
    phi = math.atan(min(max(tan_phi, 0.0), MAX_TANGENT))
    approach = math.acos(1.0 - z / radius)
    if approach <= 0.0:
        return 0.0
    wedge = z * math.tan(0.25 * math.pi - 0.5 * phi) ** 2
    shape = math.sin(approach + phi) / (2.0 * math.sin(approach) * math.cos(phi))
    passive = 2.0 * z * cohesion * k_c + unit_weight * z * z * k_gamma
    side = wedge**3 * unit_weight / 3.0 * (0.5 * math.pi - phi)
    side += cohesion * wedge * wedge * (1.0 + math.tan(0.25 * math.pi + 0.5 * phi))
    return float(width * shape * passive + side)


@kernel
def obstacle_resistance(height: float, radius: float, load: float) -> float:
    """Push that takes a wheel up on an edge of a height that bears its load [N], without friction: by the moments about
    the edge, W tan α with cos α = 1 - height/r (Bekker 1969, sec. 3.1); no end of it from the axle's height on.
    """
    cosine = 1.0 - height / radius
    if cosine <= 0.0:
        return math.inf
    return load * math.sqrt(1.0 - cosine * cosine) / cosine


@kernel
def round_bearing_capacity(sinkage: float, radius: float, cohesion: float, tan_phi: float, unit_weight: float) -> float:
    """Pressure that a round footing at a depth can carry [Pa]."""
    n_q, n_c, n_gamma, _, _ = terzaghi_factors(tan_phi)
    return float(1.3 * cohesion * n_c + unit_weight * (sinkage * n_q + 0.6 * radius * n_gamma))
