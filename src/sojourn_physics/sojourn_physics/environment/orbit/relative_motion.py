"""What drifts beside a spacecraft in a circular orbit, in closed form.

    x'' = 2 n y' + 3 n^2 x,    y'' = -2 n x',    z'' = -n^2 z

x outward, y along the flight, z along the orbit's pole (Clohessy & Wiltshire 1960, J. Aerospace Sciences 27:653; the
transition matrix: Vallado 2013, section 6.8). Range: no force but the body's, distances small against the orbit's
radius: the error is of the order of distance^2 / radius.
"""

import math

import numpy as np

from sojourn_machine.params import FloatArray


def transition(rate: float, time: float) -> FloatArray:
    """Matrix (6, 6) from place [m] and velocity [m/s] now to those after a time [s].

    Args:
        rate: mean motion n [rad/s], more than 0.
    """
    s, c, angle = math.sin(rate * time), math.cos(rate * time), rate * time
    result = np.zeros((6, 6))
    result[0, [0, 3, 4]] = 4.0 - 3.0 * c, s / rate, 2.0 * (1.0 - c) / rate
    result[1, [0, 1, 3, 4]] = 6.0 * (s - angle), 1.0, 2.0 * (c - 1.0) / rate, (4.0 * s - 3.0 * angle) / rate
    result[2, [2, 5]] = c, s / rate
    result[3, [0, 3, 4]] = 3.0 * rate * s, c, 2.0 * s
    result[4, [0, 3, 4]] = 6.0 * rate * (c - 1.0), -2.0 * s, 4.0 * c - 3.0
    result[5, [2, 5]] = -rate * s, c
    return result
