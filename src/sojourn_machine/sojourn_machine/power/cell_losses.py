"""What a battery's chemistry loses beside the resistances of its cells."""

from math import exp, expm1, log, log1p
from typing import NamedTuple

REFERENCE = 293.15
"""Of self-discharge [K]."""
DOUBLING = 10.0
"""Van 't Hoff's rule: of its rate [K]."""


class CellLosses(NamedTuple):
    """For a step."""

    efficiency: float
    """Part of a charging current that is stored [1]."""
    side_current: float = 0.0
    """That empties the pack beside the current at its terminals, all of it heat [A]."""


class SelfDischarge(NamedTuple):
    """Of a pack whose charge leaks away in proportion to what is left."""

    part: float
    """That is lost in `duration` at 20 degrees [1]."""
    duration: float
    """[s]"""

    def lost(self, temperature: float, dt: float) -> float:
        """Part that is lost in dt [s] at a temperature [K] [1]."""
        if self.part <= 0.0:
            return 0.0
        quicker = exp(log(2.0) * (temperature - REFERENCE) / DOUBLING)
        return -expm1(log1p(-self.part) * quicker * dt / self.duration)
