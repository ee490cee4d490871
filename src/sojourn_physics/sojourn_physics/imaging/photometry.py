"""How bright ground and machine look: from the light that falls on them to what leaves them towards a camera.

Radiance  L = E r(i, e, α) + D ρ/π (1 + n_z)/2 + B ρ/π (1 - n_z)/2,  with E the Sun's irradiance across the beam, D the
sky's on level ground, B what sunlit ground sends up, n_z of the surface's normal, and r the bidirectional
reflectance for the angles of incidence i, emission e and phase α:

    matt            r = ρ cos i / π                                                     (Lambert)
    regolith        r = (w/4π) μ0/(μ0 + μ) [(1 + B(α)) P(α) + H(μ0) H(μ) - 1],  B = B0/(1 + tan(α/2)/h),
                    P = 1 + b cos α + c (3 cos² α - 1)/2,  H(x) = (1 + 2x)/(1 + 2x √(1 - w))

(Hapke 1981, JGR 86:3039; 1986, Icarus 67:264, without large-scale roughness, which the relief brings), scaled so that
it is ρ/π at i = 30°, e = 0. For ground under no air: w = 0.21, h = 0.07, B0 = 2.01, b = 0.29, c = 0.39 of the Moon's
mean (Helfenstein & Veverka 1987, Icarus 72:342); so the ground looks bright with the Sun behind, and the shadow of the
camera has a bright edge. Under air the dust is taken as matt.

The constants are in single precision, see `single`.
"""

import math
from typing import NamedTuple

from sojourn_machine.kernels import vector_kernel
from sojourn_physics.imaging.single import HALF, ONE, THREE, TWO, ZERO, constant

W = 0.21
"""w of the Moon."""
WIDTH, B0, FIRST, SECOND = constant(0.07), constant(2.01), constant(0.29), constant(0.39)
"""h, B0, b and c."""
SCATTERED, H_ROOT = constant(W / (4.0 * math.pi)), constant(math.sqrt(1.0 - W))
"""w/4π, and the root of 1 - w."""
MATT = constant(1.0 / math.pi)
"""Reflectance of a matt surface, over its albedo and the cosine of incidence [1/sr]."""
GRAZING, OPPOSITE = constant(0.02), constant(1e-9)
"""Least cosine of emission, and of the phase more than -1."""
HAPKE_AT_30 = constant(0.055534209123)
"""π r of these at i = 30°, e = 0, by which they are scaled [-]."""


class Look(NamedTuple):
    """Of the ground, for the kernels."""

    albedo: float
    """ρ of the soil that is everywhere [-]."""
    regolith: float
    """1 for regolith, 0 for matt."""


class Illumination(NamedTuple):
    """What falls on the place, for the kernels [W/m2]."""

    direct: float
    """Across the beam of the whole Sun."""
    diffuse: float
    """Of the sky on level ground."""


@vector_kernel
def _h(x: float) -> float:
    return (ONE + TWO * x) / (ONE + TWO * x * H_ROOT)


@vector_kernel
def hapke(mu0: float, mu: float, cos_phase: float) -> float:
    """Reflectance of the Moon's mean regolith [1/sr]; mu0, mu: cosines of incidence and emission, more than 0."""
    cosine = min(max(cos_phase, -ONE), ONE)
    half = math.sqrt((ONE - cosine) / max(ONE + cosine, OPPOSITE))
    surge = B0 / (ONE + half / WIDTH)
    phase = ONE + FIRST * cosine + SECOND * HALF * (THREE * cosine * cosine - ONE)
    return float(SCATTERED * mu0 / (mu0 + mu) * ((ONE + surge) * phase + _h(mu0) * _h(mu) - ONE))


@vector_kernel
def reflectance(look: Look, mu0: float, mu: float, cos_phase: float) -> float:
    """Of the ground [1/sr]; mu0, mu: cosines of incidence and emission; 0 where the Sun is behind."""
    if mu0 <= ZERO:
        return ZERO * mu0  # in its precision
    if look.regolith > ZERO:
        return float(look.albedo * hapke(mu0, max(mu, GRAZING), cos_phase) / HAPKE_AT_30)
    return look.albedo * mu0 * MATT


@vector_kernel
def ambient(light: Illumination, albedo: float, ground: float, normal_z: float) -> float:
    """Radiance by the light of the sky and of sunlit ground around [W/m2/sr].

    Args:
        albedo: of the surface. ground: what the ground around sends up [W/m2].
    """
    return albedo * MATT * (light.diffuse * HALF * (ONE + normal_z) + ground * HALF * (ONE - normal_z))
