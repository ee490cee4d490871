"""Spectra of the ground's height along a track.

One-sided power spectral density G(n) [m^3] over the spatial frequency n [cycles/m], with <h^2> = int G dn:

    ISO 8608 (2016): G(n) = G(n_0) (n/n_0)^-2,  n_0 = 0.1 cycles/m; classes A to H with G(n_0) = 16e-6 4^k m^3, k = 0 to
    7 self-affine ground with structure function nu(L)^2 = <(h(s + L) - h(s))^2> = nu_0^2 (L/L_0)^(2 H):
        G(n) = a n^-(2 H + 1),   a = nu_0^2 / (2 (2 pi L_0)^(2 H) I(2 H)),   I(p) = pi/(2 Gamma(1 + p) sin(pi p/2))
    lunar: median slopes at a baseline of 17 m of 2.0 deg in maria and 7.5 deg in highlands, median Hurst exponents 0.76
    and
        0.95 (Rosenburg et al. 2011, J. Geophys. Res. 116:E02001, from laser altimetry). Used at the wavelengths of a
        wheel it is an extrapolation by two decades (highlands come out as the smoother below 2 m); craters and rocks
        come on top. nu(L) = L tan(slope), RMS taken for the median.

A vehicle at a speed V feels G_t(f) = G(f/V)/V [m^2/Hz].
"""

import math
from typing import NamedTuple

import numpy as np
from scipy.special import gamma

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray

REFERENCE = 0.1
"""n_0 of ISO 8608 [cycles/m]."""
CLASSES = "ABCDEFGH"


class Roughness(NamedTuple):
    """G(n) = level (n/0.1)^-exponent: level in m^3."""

    level: float
    exponent: float

    def spectrum(self, frequencies: FloatArray) -> FloatArray:
        """G [m^3] at spatial frequencies of more than 0 [cycles/m]."""
        return np.asarray(self.level * (np.asarray(frequencies, dtype=np.float64) / REFERENCE) ** -self.exponent)

    def at_speed(self, speed: float, frequencies: FloatArray) -> FloatArray:
        """G [m^2/Hz] in time at a speed [m/s] and frequencies of more than 0 [Hz]."""
        if not speed > 0.0:
            raise InvalidValueError("speed", speed, "more than 0 m/s")
        return self.spectrum(np.asarray(frequencies) / speed) / speed


def iso_8608(name: str) -> Roughness:
    """Geometric mean of a class A to H of ISO 8608."""
    if len(name) != 1 or name.upper() not in CLASSES:
        raise InvalidValueError("class", name, "a letter from A to H")
    return Roughness(16e-6 * 4.0 ** CLASSES.index(name.upper()), 2.0)


def self_affine(slope: float, baseline: float, hurst: float) -> Roughness:
    """Ground with an RMS slope [rad] at a baseline [m] and a Hurst exponent between 0 and 1."""
    if not 0.0 < hurst < 1.0:
        raise InvalidValueError("hurst", hurst, "more than 0, less than 1")
    if not (baseline > 0.0 and 0.0 < slope < 0.5 * math.pi):
        raise InvalidValueError("slope, baseline", (slope, baseline), "0 to pi/2 rad, more than 0 m")
    power = 2.0 * hurst
    integral = math.pi / (2.0 * gamma(1.0 + power) * math.sin(0.5 * math.pi * power))
    amount = (baseline * math.tan(slope)) ** 2 / (2.0 * (2.0 * math.pi * baseline) ** power * integral)
    return Roughness(float(amount) * REFERENCE ** -(power + 1.0), power + 1.0)


def lunar(region: str) -> Roughness:
    """`maria` or `highlands`."""
    known = {"maria": (2.0, 0.76), "highlands": (7.5, 0.95)}
    if region not in known:
        raise InvalidValueError("region", region, " or ".join(known))
    slope, hurst = known[region]
    return self_affine(math.radians(slope), 17.0, hurst)
