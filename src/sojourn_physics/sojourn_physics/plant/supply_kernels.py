"""The compiled part of power and heat over a control period: the Sun as the machine sees it, and what warms it."""

import numpy as np
from numpy.typing import NDArray

from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray

HEAT, SWITCHED = range(2)
"""Rows of what is summed up for the thermal network: what of each load is heat in the machine [J], and its switch
[1].
"""


@njit(cache=True)
def in_base(configuration: FloatArray, direction: FloatArray) -> tuple[FloatArray, FloatArray]:
    """A unit vector in map, and the zenith, as base_link has them, each (3,).

    Args:
        configuration: of the machine, its base's quaternion (x, y, z, w) from the fourth number on. direction: (3,).
    """
    x, y, z, w = configuration[3], configuration[4], configuration[5], configuration[6]
    east, north, over = direction[0], direction[1], direction[2]
    up = np.array((2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)))
    seen = np.array(
        (
            (1.0 - 2.0 * (y * y + z * z)) * east + 2.0 * (x * y + z * w) * north + up[0] * over,
            2.0 * (x * y - z * w) * east + (1.0 - 2.0 * (x * x + z * z)) * north + up[1] * over,
            2.0 * (x * z + y * w) * east + 2.0 * (y * z - x * w) * north + up[2] * over,
        )
    )
    return seen, up


@njit(cache=True)
def with_period(
    sums: FloatArray,
    power: FloatArray,
    fractions: FloatArray,
    moves: NDArray[np.bool_],
    moved: FloatArray,
    heat: float,
    periods: int,
    period: float,
) -> FloatArray:
    """What has been summed up (2, loads), rows as HEAT and SWITCHED, with so many control periods more.

    Of the loads that move the machine only the heat of its motors stays in it, shared by the energy that each took or
    gave back; the rest is work on the ground. Of the others all is heat.

    Args:
        power: that each load took (loads,) [W]. fractions: its switch (loads,) [1]. moves: whether it moves the machine
            (loads,). moved: energy that its motors took (loads,) [J]. heat: of all motors [J].
        periods: as many. period: length of one [s].
    """
    after, turned = sums.copy(), 0.0
    for i in range(moves.size):
        turned += abs(moved[i]) if moves[i] else 0.0
    for i in range(moves.size):
        if not moves[i]:
            after[HEAT, i] += power[i] * periods * period
        elif turned > 0.0:
            after[HEAT, i] += heat * (abs(moved[i]) / turned)  # heat over next to nothing would be infinite
        after[SWITCHED, i] += periods * fractions[i]
    return after
