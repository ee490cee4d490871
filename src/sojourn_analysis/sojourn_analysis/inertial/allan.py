"""Allan deviation: of a record, of a data sheet, and of the model of `sojourn_physics.sensors.inertial_errors`.

Of a record with the integral theta(k dt), overlapping (IEEE Std 952-1997, annex C, eq. C.2 on all starts):

    sigma^2(t) = <(theta(k + 2 m) - 2 theta(k + m) + theta(k))^2> / (2 t^2),  t = m dt

Of a data sheet with random walk N, bias instability B, rate random walk K, quantisation Q (eq. C.9, C.13, C.17, C.19):

    sigma^2(t) = 3 Q^2 / t^2 + N^2 / t + (2 ln 2 / pi) B^2 + K^2 t / 3

Of the model the third term is the sum over its first-order Gauss-Markov processes (eq. C.21), u = t / T:

    (2 s^2 / u) (1 - (3 - 4 exp(-u) + exp(-2 u)) / (2 u))
"""

import numpy as np

from sojourn_machine.params import FloatArray
from sojourn_physics.sensors.inertial_errors import (
    CORRELATION_TIMES,
    FLICKER,
    FLICKER_SHARES,
    QUANTUM,
    RANDOM_WALK,
    RATE_WALK,
)

FLOOR = np.sqrt(2.0 * np.log(2.0) / np.pi)
"""Allan deviation of flicker over its coefficient B, 0.664."""


def allan_deviation(samples: FloatArray, dt: float, averaged: int) -> FloatArray:
    """Of the columns of a record.

    Args:
        samples: shape (n, columns), each the mean over `dt` [s]. averaged: samples in an averaging time, at most n / 2.

    Returns:
        shape (columns,), in the unit of the samples.
    """
    integral = np.concatenate([np.zeros((1, samples.shape[1])), np.cumsum(samples, axis=0)]) * dt
    second = integral[2 * averaged :] - 2.0 * integral[averaged:-averaged] + integral[: -2 * averaged]
    deviation: FloatArray = np.sqrt((second**2).mean(axis=0) / 2.0) / (averaged * dt)
    return deviation


def stated_deviation(triad: FloatArray, times: FloatArray) -> FloatArray:
    """Of a data sheet: a triad with columns of `inertial_errors`, over averaging times, shape (n,) [s]."""
    deviation: FloatArray = np.sqrt(_without_flicker(triad, times) + (FLOOR * triad[FLICKER]) ** 2)
    return deviation


def modelled_deviation(triad: FloatArray, times: FloatArray) -> FloatArray:
    """Of the model of such a triad."""
    ratio = times[:, None] / np.array(CORRELATION_TIMES)
    variance = (triad[FLICKER] * np.array(FLICKER_SHARES)) ** 2
    bracket = 1.0 - (3.0 - 4.0 * np.exp(-ratio) + np.exp(-2.0 * ratio)) / (2.0 * ratio)
    deviation: FloatArray = np.sqrt(_without_flicker(triad, times) + (2.0 * variance / ratio * bracket).sum(axis=1))
    return deviation


def _without_flicker(triad: FloatArray, times: FloatArray) -> FloatArray:
    quantisation = 3.0 * triad[QUANTUM] ** 2 / 12.0 / times**2
    variance: FloatArray = quantisation + triad[RANDOM_WALK] ** 2 / times + triad[RATE_WALK] ** 2 * times / 3.0
    return variance
