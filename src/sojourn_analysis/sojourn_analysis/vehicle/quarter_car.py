"""Quarter car: sprung mass m on spring K and damper c, unsprung mass mu on the tyre's stiffness P, over a moving ground
h.

    m z'' = -K (z - u) - c (z' - u'),     mu u'' = K (z - u) + c (z' - u') - P (u - h)
    without unsprung mass all responses |z/h| pass, whatever c, through the fixed point
        w_f^2 = 2 w_1^2 w_2^2/(w_1^2 + w_2^2),  |z/h| = w_2^2/(w_2^2 - w_f^2),   w_1^2 = K P/((K + P) m),  w_2^2 = P/m
    and the damping for which acceleration and tyre load have their greatest value of the resonance there is
        c_opt = sqrt(m K/2) sqrt((P + 2 K)/P)
(Genta and Morello 2009, vol. 2, sec. 26.4; Gillespie 1992, ch. 5.)
Assumptions: linear, the wheel keeps contact, point contact. Range: amplitudes small against the travel.
"""

import math
from typing import NamedTuple

import numpy as np

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray


class QuarterCar(NamedTuple):
    """Sprung mass [kg], spring rate [N/m], damping [N s/m], tyre rate [N/m], unsprung mass [kg] (may be 0)."""

    sprung: float
    spring: float
    damping: float
    tyre: float
    unsprung: float = 0.0


class Responses(NamedTuple):
    """Complex responses to a ground of unit amplitude, one entry a frequency.

    body: z/h [-]; acceleration: z''/h [1/s^2]; travel: (z - u)/h [-]; tyre_load: P (h - u)/h [N/m], on top of the
    weight.
    """

    body: FloatArray
    acceleration: FloatArray
    travel: FloatArray
    tyre_load: FloatArray


def optimum_damping(sprung: float, spring: float, tyre: float) -> float:
    """c_opt [N s/m] for a mass [kg], a spring and a tyre rate [N/m]."""
    _check(QuarterCar(sprung, spring, 0.0, tyre))
    return math.sqrt(0.5 * sprung * spring) * math.sqrt((tyre + 2.0 * spring) / tyre)


def fixed_point(sprung: float, spring: float, tyre: float) -> tuple[float, float]:
    """Frequency [Hz] and amplitude ratio [-] that no damping changes, without unsprung mass."""
    _check(QuarterCar(sprung, spring, 0.0, tyre))
    low, high = spring * tyre / (spring + tyre) / sprung, tyre / sprung
    square = 2.0 * low * high / (low + high)
    return math.sqrt(square) / (2.0 * math.pi), high / (high - square)


def undamped_modes(car: QuarterCar) -> FloatArray:
    """Natural frequencies without damping [Hz], rising: two, or one where there is no unsprung mass."""
    _check(car)
    if car.unsprung == 0.0:
        return np.array([math.sqrt(car.spring * car.tyre / (car.spring + car.tyre) / car.sprung) / (2.0 * math.pi)])
    matrix = np.array(
        [
            [car.spring / car.sprung, -car.spring / car.sprung],
            [-car.spring / car.unsprung, (car.spring + car.tyre) / car.unsprung],
        ]
    )
    return np.sort(np.sqrt(np.linalg.eigvals(matrix).real)) / (2.0 * math.pi)


def damping_ratio(car: QuarterCar) -> float:
    """c over its critical value of the sprung mass on its spring alone [-]."""
    _check(car)
    return car.damping / (2.0 * math.sqrt(car.spring * car.sprung))


def state_matrices(car: QuarterCar) -> tuple[FloatArray, FloatArray]:
    """A (4, 4) and B (4,) of the state (z, z', u, u') under the ground height h; the unsprung mass is more than 0."""
    _check(car)
    if car.unsprung == 0.0:
        raise InvalidValueError("unsprung", 0.0, "more than 0 kg for a motion in time")
    m, k, c, p, mu = car.sprung, car.spring, car.damping, car.tyre, car.unsprung
    a = np.array(
        [
            [0.0, 1.0, 0.0, 0.0],
            [-k / m, -c / m, k / m, c / m],
            [0.0, 0.0, 0.0, 1.0],
            [k / mu, c / mu, -(k + p) / mu, -c / mu],
        ]
    )
    return a, np.array([0.0, 0.0, 0.0, p / mu])


def responses(car: QuarterCar, frequencies: FloatArray) -> Responses:
    """Responses at frequencies of at least 0 [Hz], shape (n,)."""
    _check(car)
    s = 2j * math.pi * np.asarray(frequencies, dtype=np.float64)
    link = car.spring + car.damping * s
    wheel = car.unsprung * s * s + car.tyre
    body_per_wheel = link / (car.sprung * s * s + link)
    wheel_motion = car.tyre / (wheel + link * (1.0 - body_per_wheel))
    body = body_per_wheel * wheel_motion
    return Responses(body, s * s * body, body - wheel_motion, car.tyre * (1.0 - wheel_motion))


def _check(car: QuarterCar) -> None:
    for name in ("sprung", "spring", "tyre"):
        value = getattr(car, name)
        if not (math.isfinite(value) and value > 0.0):
            raise InvalidValueError(name, value, "a finite number more than 0")
    for name in ("damping", "unsprung"):
        value = getattr(car, name)
        if not (math.isfinite(value) and value >= 0.0):
            raise InvalidValueError(name, value, "a finite number, at least 0")
