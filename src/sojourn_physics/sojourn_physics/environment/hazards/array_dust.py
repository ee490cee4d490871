"""Dust that settles on photovoltaic arrays: the part of the light that still comes through.

    T = (1 - a)^n   after n sols since the last cleaning

a = 0.28 % a sol, measured by the Materials Adherence Experiment of Pathfinder under a clear sky (Landis and Jenkins
2000, J. Geophys. Res. 105:1855); 0.2 % early on Spirit (Stella, Ewell and Hoskin 2005, IEEE Photovoltaic Specialists
Conf. 31:626). Range: some hundred sols; later the rovers' arrays settled at a half to three quarters, as the wind took
as much as fell, and gusts cleaned them within a sol: a cleaning takes off a share of what lies there.
"""

from collections.abc import Sequence
from typing import NamedTuple

from sojourn_machine.errors import InvalidValueError

PATHFINDER, SPIRIT = 0.0028, 0.002
"""Losses [1/sol]."""


class Cleaning(NamedTuple):
    """A gust, or a brush."""

    sol: float
    """When, in sols since the array was clean."""
    share: float
    """Part of the loss that it takes away, 0 to 1."""


def light_through_dust(sols: float, loss: float = PATHFINDER, cleanings: Sequence[Cleaning] = ()) -> float:
    """Part of the light that comes through, 0 to 1, `sols` after the array was clean.

    Args:
        loss: in a sol, 0 to below 1. cleanings: in the order of their sols; later ones than `sols` do not count.

    Raises:
        InvalidValueError: a loss, a share or an order that cannot be.
    """
    if not 0.0 <= loss < 1.0:
        raise InvalidValueError("loss by dust", loss, "0 to below 1 a sol")
    through, last = 1.0, 0.0
    for cleaning in cleanings:
        if not 0.0 <= cleaning.share <= 1.0 or cleaning.sol < last:
            raise InvalidValueError("cleaning", tuple(cleaning), "a share of 0 to 1, sols in order")
        if cleaning.sol > sols:
            break
        through *= (1.0 - loss) ** (cleaning.sol - last)
        through += cleaning.share * (1.0 - through)
        last = cleaning.sol
    return through * float((1.0 - loss) ** (sols - last))
