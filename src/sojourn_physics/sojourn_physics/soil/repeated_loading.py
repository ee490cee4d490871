"""Soil that has been loaded before: unloading, reloading, and the law that a second wheel meets.

Bekker (1969, Introduction to Terrain-Vehicle Systems, ch. 1) and Wong (2008, Theory of Ground Vehicles, 4th ed.,
sec. 2.4.3): virgin soil follows p = k z^n. Unloaded from the greatest sinkage z_u it has seen, and loaded again, it
follows a straight line

    p = p_u - k_u (z_u - z),   p_u = k z_u^n,   k_u = k_0 + A_u z_u

down to p = 0 at z_r = z_u - p_u / k_u, the depth of the rut that stays; beyond z_u it is virgin again. k_u is held to
at least max(1, n) k z_u^(n-1): unloading is never softer than loading, and no rut rises above the old surface.

The contact laws know one power law p = k' h^n' of the depth h below the surface. For a wheel in a rut, whose bottom is
h = z - z_r below the rut, `equivalent_law` gives the k', n' that have the same pressure P at that depth and the same
work W per area down to it (and so the same compaction resistance b W, Bekker 1969):

    n' = P h / W - 1,   k' = P / h^n'

Exact on the reloading line (n' = 1, k' = k_u) and on virgin soil (n' = n, k' = k), continuous between.

Shear leaves nothing behind that a Janosi soil would feel: reloaded, it has to be sheared anew (Wong 2008, sec. 2.4.4).
"""

from sojourn_machine.kernels import kernel

LEAST_EXPONENT = 0.05
"""Least n': a crust far stiffer than what is under it comes near to a constant pressure."""


@kernel
def rut_depth(modulus: float, exponent: float, greatest: float, stiffness: float, per_sinkage: float) -> float:
    """Depth z_r of the rut that stays [m].

    Args:
        modulus, exponent: k [N/m^(n+2)] and n of the virgin soil.
        greatest: z_u, the greatest sinkage seen [m].
        stiffness, per_sinkage: k_0 [N/m^3] and A_u [N/m^4].
    """
    if greatest <= 0.0 or modulus <= 0.0:
        return 0.0
    secant = modulus * greatest ** (exponent - 1.0)
    unloading = max(stiffness + per_sinkage * greatest, max(1.0, exponent) * secant)
    return float(greatest * (1.0 - secant / unloading))


@kernel
def equivalent_law(modulus: float, exponent: float, greatest: float, rut: float, depth: float) -> tuple[float, float]:
    """k' and n' of the soil below a rut, for a wheel that is `depth` [m] below the rut's bottom.

    Args:
        modulus, exponent: of the virgin soil. greatest: z_u. rut: z_r, at least 0 and at most z_u. depth: h.
    """
    rebound = greatest - rut
    if rut <= 0.0 or depth <= 0.0:
        return modulus, exponent
    peak = modulus * greatest**exponent
    if depth <= rebound:
        return peak / rebound, 1.0
    reached = rut + depth
    pressure = modulus * reached**exponent
    work = 0.5 * peak * rebound + (pressure * reached - peak * greatest) / (exponent + 1.0)
    power = max(pressure * depth / work - 1.0, LEAST_EXPONENT)
    return pressure / depth**power, power
