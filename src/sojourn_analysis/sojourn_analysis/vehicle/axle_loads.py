"""Loads on the axles of a vehicle in a plane: weight, grade and acceleration.

On a grade a with acceleration v', the body pulls back with X = m (g sin a + v') at height h, and presses with
Z = m g cos a. For axles at x_i from the centre of mass with vertical stiffness k_i, the body moves down by p + q x_i:

    N_i = k_i (p + q x_i),   sum N_i = Z,   sum N_i x_i = - h X

With two axles the stiffness drops out: N_1 = (Z b - X h)/l, N_2 = (Z a + X h)/l (Genta and Morello 2009, vol. 2, sec.
23.2). With three and more the system is hyperstatic, and the compliance decides. An axle that would pull is taken out
and the rest solved again. A rocker-bogie divides the load otherwise, by its levers: see `rocker_bogie`.
"""

import numpy as np
from numpy.typing import ArrayLike

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray


def axle_loads(
    x: FloatArray, height: float, press: float, pull_back: float, stiffness: ArrayLike | None = None
) -> FloatArray:
    """Load of each axle [N], shape (axles,): 0 for one that has lifted.

    Args:
        x: of the axles from the centre of mass [m], shape (axles,). height: of the centre of mass [m].
        press: Z, at least 0 [N]. pull_back: X, positive to the rear [N].
        stiffness: of each axle, equal if left out [any unit].

    Raises:
        InvalidValueError: the vehicle tips over: fewer than two axles would carry.
    """
    rates = np.ones(len(x)) if stiffness is None else np.asarray(stiffness, dtype=np.float64)
    carries = np.ones(len(x), dtype=bool)
    moment = -height * pull_back
    while np.count_nonzero(carries) >= 2:
        places, weights = x[carries], rates[carries]
        matrix = np.array(
            [
                [weights.sum(), weights @ places],
                [weights @ places, weights @ (places * places)],
            ]
        )
        p, q = np.linalg.solve(matrix, [press, moment])
        loads = weights * (p + q * places)
        if np.all(loads >= -1e-12 * max(press, 1.0)):
            result = np.zeros(len(x))
            result[carries] = np.maximum(loads, 0.0)
            return result
        carries[np.flatnonzero(carries)[np.argmin(loads)]] = False
    raise InvalidValueError("pull_back", pull_back, f"one that does not tip the vehicle over, with h = {height:g} m")
