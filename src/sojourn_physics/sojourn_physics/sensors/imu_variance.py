"""What an IMU says of its own errors: variances of a reading and of the attitude, in closed form.

Of an axis at rest, with the errors of `inertial_errors`, b^2 = bias^2 + (k_b dT)^2 + (G g)^2 the variance of what
stays, s and T of each process of the flicker, t the time since the reset and dt that of a reading:

    reading   N^2 / dt + b^2 + sum s^2 + K^2 t + q^2 / (6 dt^2)

and of its integral, which is what the heading is,

    drift     N^2 t + b^2 t^2 + sum 2 s^2 T (t - T (1 - exp(-t/T))) + K^2 t^3 / 3 + q^2 / 12

where (k_b dT)^2 t^2 is k_b^2 times the square of the integral of dT (integrals of white noise, of a first-order
Gauss-Markov process from its steady state, and of a random walk: Gelb 1974, Applied Optimal Estimation, sec. 3.8).

Roll and pitch are a first-order filter of gain k, whose inputs are the gyro, and k times the accelerometer over
gravity; through 1 / (p + k) the balance is for white noise N^2 / (2 k), for a bias (b / k)^2, for a process of the
flicker s^2 / (k (k + 1/T)), for a random walk that is slow against k K^2 t / k^2. The white noise of the accelerometers
counts twice that, as it is in the mean over an alignment of the time 1/k that the attitude starts with.

Left out: scale factors, which a turn shows, misalignment, and readings at the end of the range.
"""

import numpy as np

from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray
from sojourn_physics.sensors.inertial_errors import (
    BIAS,
    BIAS_PER_KELVIN,
    CORRELATION_TIMES,
    FLICKER,
    FLICKER_SHARES,
    G_SENSITIVITY,
    QUANTUM,
    RANDOM_WALK,
    RATE_WALK,
)


@njit(cache=True)
def variances(
    stated: FloatArray, gain: float, gravity: float, dt: float, since: float, warmer: float, heat: float
) -> FloatArray:
    """Of angular velocity [rad^2/s^2], specific force [m^2/s^4] and attitude [rad^2], about x, y, z, shape (3, 3).

    Args:
        stated: errors of gyros and accelerometers, shape (2, STATED). gain: of the levelling [1/s]. gravity: [m/s^2].
        dt: time of a reading [s]. since: time since the reset [s].
        warmer: temperature over that of the calibration [K], and `heat`, its integral since the reset [K s].
    """
    result = np.empty((3, 3))
    tilt = 0.0
    drift = 0.0
    for triad in range(2):
        row = stated[triad]
        white, walk, quantum = row[RANDOM_WALK] ** 2, row[RATE_WALK] ** 2, row[QUANTUM] ** 2
        lasting = row[BIAS] ** 2 + (row[G_SENSITIVITY] * gravity) ** 2
        by_heat = row[BIAS_PER_KELVIN] ** 2
        steady, filtered, integral = 0.0, 0.0, 0.0
        if row[FLICKER] > 0.0:
            for p in range(len(CORRELATION_TIMES)):
                time, variance = CORRELATION_TIMES[p], (FLICKER_SHARES[p] * row[FLICKER]) ** 2
                steady += variance
                filtered += variance / (gain * (gain + 1.0 / time))
                integral += 2.0 * variance * time * (since + time * np.expm1(-since / time))
        constant = lasting + by_heat * warmer**2 + walk * since
        result[triad] = white / dt + constant + steady + quantum / (6.0 * dt * dt)
        balance = white / (2.0 * gain) + constant / gain**2 + filtered
        if triad == 0:
            drift = white * since + lasting * since**2 + by_heat * heat**2 + integral
            drift += walk * since**3 / 3.0 + quantum / 12.0
            tilt = balance + quantum / 12.0
        elif gravity > 0.0:
            tilt += (balance + white / (2.0 * gain)) * (gain / gravity) ** 2
    result[2] = tilt if gravity > 0.0 else drift
    result[2, 2] = drift
    return result
