"""Errors of a triad of gyros or accelerometers, after IEEE Std 952-1997, annex C, and Titterton and Weston 2004, ch. 4
and 6. Of an axis of a triad, as `imu_kernels.read_triads` has it:

    raw = (1 + S + X + k_S dT) truth + bias + k_b dT + G f + sum x_p + w + N / sqrt(dt) n
    read = difference of q round((integral of clip(raw, range)) / q), over dt

S scale factors, X cross-axis terms from misalignment, bias, its growth k_b and that of the scale factor k_S with the
temperature dT over that of the calibration, and G, the sensitivity to specific force f, are drawn at the reset.

Random walk N [unit s^0.5]: angle random walk, of accelerometers velocity random walk; two-sided, so that the Allan
variance over an averaging time t is N^2 / t. Quantum q: angle (velocity) of the least bit of the increments that such
an instrument sends; Allan variance q^2 / (4 t^2), which is 3 Q^2 / t^2 of the standard with Q^2 = q^2 / 12.

Flicker (bias instability B): a density B^2 / (2 pi f), Allan variance 2 ln 2 B^2 / pi = (0.664 B)^2 at every t. A
process that remembers all of its past has no state; a sum of first-order Gauss-Markov processes x_p one decade apart
comes near it. Of the deviation s and the correlation time T each has the density 2 s^2 T / (1 + (2 pi f T)^2); over
the logarithm of T these add up to s^2 / (2 f ln 10), which is the flicker's where

    s = B sqrt(ln 10 / pi)

The first and the last stand for all that are left out beyond them, whose sum is a geometric series: s^2 / (1 - 1/10).
From t = 0.3 s to 6000 s the Allan deviation so is flat to 2 %, at 0.1 s and 3 10^4 s it is 14 % low. x_p starts in its
steady state.

Rate random walk K [unit/s^0.5], of accelerometers acceleration random walk: w with steps K sqrt(dt), from 0 at the
reset; Allan variance K^2 t / 3.
"""

from math import log, pi, sqrt

import numpy as np

from sojourn_machine.params import FloatArray
from sojourn_physics.sensors.noise import draw, initial_stream

RANDOM_WALK, BIAS, FLICKER, RATE_WALK, QUANTUM, RANGE, BIAS_PER_KELVIN, SCALE_PER_KELVIN = range(8)
"""Columns of an axis, in SI units: what a data sheet states, one standard deviation each, or what was drawn from it.
RANGE is infinite where there is none. Like the rows below, compiled into kernels."""
G_SENSITIVITY, SCALE_FACTOR, MISALIGNMENT = 8, 9, 10
"""Of a data sheet only: what of them was drawn has its columns in G_ROW and MATRIX_ROW."""
G_ROW, MATRIX_ROW = 11, 14
"""The first of three columns each that were drawn: of G, and of 1 + S + X."""
STATED, DRAWN = 11, 17
"""So many columns has a triad of a data sheet, an axis of an instrument."""
CORRELATION_TIMES = (0.1, 1.0, 10.0, 100.0, 1e3, 1e4)
"""T of the Gauss-Markov processes of the flicker [s]."""
_PART = log(10.0) / pi
FLICKER_SHARES = tuple(
    sqrt(_PART / 0.9 if time in (CORRELATION_TIMES[0], CORRELATION_TIMES[-1]) else _PART) for time in CORRELATION_TIMES
)
"""Standard deviation of each over B."""
REMAINDER, PROCESSES, WALK = 0, 1, 1 + len(CORRELATION_TIMES)
"""Columns of what an axis remembers: of the quantisation, x_p, and w, the last."""


def has_drift(stated: FloatArray) -> bool:
    """Whether a triad of a data sheet, shape (n, STATED), has flicker or rate random walk."""
    return bool(np.any(stated[:, (FLICKER, RATE_WALK)]))


def drawn(stated: FloatArray, seed: int, name: str) -> tuple[FloatArray, FloatArray]:
    """An instrument of a data sheet, from the stream of `name`.

    Args:
        stated: gyros and accelerometers, shape (2, STATED).

    Returns:
        the axes x, y, z of the gyros and of the accelerometers, shape (6, DRAWN), and what they remember at first,
        shape (6, 1 + WALK), or (6, 1) without drift.
    """
    processes = len(CORRELATION_TIMES)
    # Each error has its own columns: one more or less shifts no other.
    _, row = draw(initial_stream(seed, f"{name}.reset", 45 + 6 * processes))
    axes = np.zeros((6, DRAWN))
    axes[:, :STATED] = np.repeat(stated, 3, axis=0)
    axes[:, BIAS] *= np.concatenate((row[9:12], row[21:24]))
    axes[:3, MATRIX_ROW:] = _matrix(row[0:3] * stated[0, SCALE_FACTOR], row[3:9] * stated[0, MISALIGNMENT])
    axes[3:, MATRIX_ROW:] = _matrix(row[12:15] * stated[1, SCALE_FACTOR], row[15:21] * stated[1, MISALIGNMENT])
    axes[:, BIAS_PER_KELVIN] *= row[24:30]
    axes[:, SCALE_PER_KELVIN] *= row[30:36]
    axes[:3, G_ROW:MATRIX_ROW] = row[36:45].reshape(3, 3) * stated[0, G_SENSITIVITY]
    if not has_drift(stated):
        return axes, np.zeros((6, PROCESSES))
    memory = np.zeros((6, 1 + WALK))
    steady = axes[:, FLICKER, None] * np.array(FLICKER_SHARES)
    memory[:, PROCESSES:WALK] = steady * row[45:].reshape(6, processes)
    return axes, memory


def _matrix(scale: FloatArray, cross: FloatArray) -> FloatArray:
    matrix = np.diag(1.0 + scale)
    matrix[~np.eye(3, dtype=np.bool_)] = cross
    return matrix
