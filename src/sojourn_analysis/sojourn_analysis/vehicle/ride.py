"""Ride over rough ground: spectra of the response, RMS values, and weighting for people (ISO 2631-1).

    S_out(f) = |H(f)|^2 G_t(f),   rms^2 = int S_out df             (Newland 1993, An Introduction to Random Vibrations,
    ch. 7) ISO 2631-1 (1997), annex A: weighting H = H_h H_l H_t H_s, with s = 2 pi j f, w_i = 2 pi f_i
        H_h = 1/(1 + sqrt2 w_1/s + (w_1/s)^2)            H_l = 1/(1 + sqrt2 s/w_2 + (s/w_2)^2)
        H_t = (1 + s/w_3)/(1 + s/(Q_4 w_4) + (s/w_4)^2)  H_s = (1 + s/(Q_5 w_5) + (s/w_5)^2)/(1 + s/(Q_6 w_6) +
        (s/w_6)^2) (w_5/w_6)^2 W_k (vertical, seat): f_1..6 = 0.4, 100, 12.5, 12.5, 2.37, 3.35 Hz, Q_4..6 = 0.63, 0.91,
        0.91; W_d (horizontal): f_3 = f_4 = 2, Q_4 = 0.63, H_s = 1
    comfort by the weighted RMS [m/s^2], annex C: bands of `COMFORT`; they are for gravity on Earth and healthy seated
    people. Shock response: greatest absolute acceleration of oscillators of one degree of freedom, exact for a base
    acceleration that is linear between samples (Nigam and Jennings 1969, Bull. Seism. Soc. Am. 59:909).
Range: stationary Gaussian ground, linear vehicle; weighting from 0.1 to 400 Hz.
"""

import itertools
import math
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray

ComplexArray: TypeAlias = NDArray[np.complex128]

COMFORT = (
    (0.315, "not uncomfortable"),
    (0.63, "a little uncomfortable"),
    (1.0, "fairly uncomfortable"),
    (1.6, "uncomfortable"),
    (2.5, "very uncomfortable"),
    (math.inf, "extremely uncomfortable"),
)
"""Upper bound of the weighted RMS acceleration [m/s^2] and its word. The standard's bands overlap; these part them."""


class Weighting(NamedTuple):
    """Corner frequencies [Hz] and quality factors; `step` is false where H_s = 1."""

    f3: float
    f4: float
    q4: float
    f5: float = 1.0
    q5: float = 1.0
    f6: float = 1.0
    q6: float = 1.0
    step: bool = False


VERTICAL = Weighting(12.5, 12.5, 0.63, 2.37, 0.91, 3.35, 0.91, True)
HORIZONTAL = Weighting(2.0, 2.0, 0.63)


def iso_2631_gain(weighting: Weighting, frequencies: FloatArray) -> FloatArray:
    """|H| at frequencies of more than 0 [Hz], shape (n,)."""
    s = 2j * math.pi * np.asarray(frequencies, dtype=np.float64)

    def corner(frequency: float) -> float:
        return 2.0 * math.pi * frequency

    low, high, w3, w4 = corner(0.4), corner(100.0), corner(weighting.f3), corner(weighting.f4)
    gain = 1.0 / (1.0 + math.sqrt(2.0) * low / s + (low / s) ** 2)
    gain = gain / (1.0 + math.sqrt(2.0) * s / high + (s / high) ** 2)
    gain = gain * (1.0 + s / w3) / (1.0 + s / (weighting.q4 * w4) + (s / w4) ** 2)
    if weighting.step:
        w5, w6 = corner(weighting.f5), corner(weighting.f6)
        gain = gain * (1.0 + s / (weighting.q5 * w5) + (s / w5) ** 2)
        gain = gain / (1.0 + s / (weighting.q6 * w6) + (s / w6) ** 2) * (w5 / w6) ** 2
    return np.abs(gain)


def rms(frequencies: FloatArray, response: FloatArray, ground: FloatArray) -> float:
    """Root of the integral of |response|^2 times the ground's spectrum over the frequencies [Hz], by trapezoids."""
    density = np.abs(response) ** 2 * ground
    return math.sqrt(float(np.trapezoid(density, frequencies)))


def weighted_acceleration(
    frequencies: FloatArray, acceleration: FloatArray, ground: FloatArray, weighting: Weighting = VERTICAL
) -> float:
    """Weighted RMS acceleration [m/s^2] of a response z''/h [1/s^2] to a ground's spectrum [m^2/Hz]."""
    return rms(frequencies, np.abs(acceleration) * iso_2631_gain(weighting, frequencies), ground)


def comfort(weighted: float) -> str:
    """The standard's word for a weighted RMS acceleration [m/s^2]."""
    if not weighted >= 0.0:
        raise InvalidValueError("weighted", weighted, "at least 0 m/s2")
    return next(word for bound, word in COMFORT if weighted < bound or math.isinf(bound))


def acceleration_over(profile: FloatArray, response: ComplexArray) -> FloatArray:
    """Acceleration [m/s^2] of a linear system over a profile that repeats, shape (n,), by its lines in frequency.

    Args:
        profile: height of the ground at even steps of time, shape (n,) [m]. response: z''/h at 1, 2, ... times the
            inverse of the profile's whole time, shape (lines,), at most n/2 of them; 0 beyond [1/s^2].

    Raises:
        InvalidValueError: more lines than the profile can tell.
    """
    lines = np.fft.rfft(profile)
    if len(response) >= len(lines):
        raise InvalidValueError("response", len(response), f"at most {len(lines) - 1} lines")
    lines[0] = 0.0
    lines[1 : len(response) + 1] *= response
    lines[len(response) + 1 :] = 0.0
    return np.asarray(np.fft.irfft(lines, n=len(profile)))


def shock_spectrum(
    base_acceleration: FloatArray, dt: float, frequencies: FloatArray, damping: float = 0.05, rest: float = 1.0
) -> FloatArray:
    """Greatest absolute acceleration [m/s^2] of oscillators on a base, shape (frequencies,).

    Args:
        base_acceleration: at steps of dt [s], shape (n,) [m/s^2]. frequencies: undamped, more than 0 [Hz].
        damping: ratio, 0 to below 1. rest: periods after the end that are looked at.
    """
    if not 0.0 <= damping < 1.0:
        raise InvalidValueError("damping", damping, "0 to below 1")
    found = []
    for frequency in np.asarray(frequencies, dtype=np.float64):
        natural = 2.0 * math.pi * frequency
        quiet = np.zeros(math.ceil(rest / frequency / dt) + 1)
        base = np.concatenate([base_acceleration, quiet])
        # relative motion x'' = -2 d w x' - w^2 x - a; (x, x', a, a') with a linear within a step
        system = np.zeros((4, 4))
        system[0, 1], system[2, 3] = 1.0, 1.0
        system[1] = [-(natural**2), -2.0 * damping * natural, -1.0, 0.0]
        step = expm(system * dt)[:2]
        x, v, greatest = 0.0, 0.0, 0.0
        for now, then in itertools.pairwise(base):
            state = step @ np.array([x, v, now, (then - now) / dt])
            x, v = float(state[0]), float(state[1])
            greatest = max(greatest, abs(2.0 * damping * natural * v + natural**2 * x))
        found.append(greatest)
    return np.array(found)
