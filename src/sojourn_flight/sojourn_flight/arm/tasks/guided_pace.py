"""Share of a task's velocity at which a guided motion is run: changed softly, in a pause and by the power granted.

With rates q' of the joints at the task's whole velocity, the share s adds  ds/dt q'  to their accelerations and
d2s/dt2 q'  to their jerks; limits of the joints, and that of the tip's acceleration, so bound both. In the n periods h
in which ds/dt falls by b = h d2s/dt2 each, from v to nothing, the share changes by  h (n v - n (n - 1)/2 b):  the
fewest n that are enough give the v from which it comes to rest where it is wanted.
"""

import math
from dataclasses import dataclass

import numpy as np

from sojourn_flight.arm.model import ArmModel
from sojourn_machine.params import FloatArray

_MARGIN = 0.8
"""Share of the limits: the way of the tip needs some, too."""
_MOST = 10.0
"""Largest |ds/dt| where no joint bounds it [1/s]."""
_SHARPEST = 100.0
"""Largest |d2s/dt2| where no joint bounds it [1/s2]."""


@dataclass(frozen=True, slots=True)
class GuidedPace:
    """A plain value."""

    share: float = 1.0  # s
    change: float = 0.0  # ds/dt [1/s]


@dataclass(frozen=True, slots=True)
class PaceLimits:
    """Of the share of a velocity."""

    change: float  # |ds/dt| [1/s]
    sharpness: float  # |d2s/dt2| [1/s2]


def pace_limits(model: ArmModel, rates: FloatArray, speed: float, acceleration: float) -> PaceLimits:
    """What the joints allow.

    Args:
        rates: of the joints at the whole velocity (n,) [rad/s or m/s]. speed: of the tip then [m/s].
        acceleration: of the tip, at most [m/s2].
    """
    size = np.maximum(np.abs(rates), 1e-9)
    change = min(float(np.min(model.max_acceleration / size)), acceleration / max(speed, 1e-9))
    return PaceLimits(min(_MARGIN * change, _MOST), min(_MARGIN * float(np.min(model.max_jerk / size)), _SHARPEST))


def next_pace(pace: GuidedPace, wanted: float, limits: PaceLimits, dt: float) -> GuidedPace:
    """The share a period of `dt` [s] later, on its way to `wanted`, 0 to 1."""
    left = wanted - pace.share
    step = limits.sharpness * dt
    steps = abs(left) / (step * dt)
    periods = max(math.ceil(0.5 * (math.sqrt(1.0 + 8.0 * steps) - 1.0)), 1)
    change = math.copysign(min(step * (steps / periods + 0.5 * (periods - 1)), limits.change), left)
    change = min(max(change, pace.change - step), pace.change + step)
    share = pace.share + change * dt
    if abs(share - wanted) < 1e-9 and abs(change) <= step:
        return GuidedPace(wanted, change if abs(left) >= 1e-9 else 0.0)
    return GuidedPace(min(max(share, 0.0), 1.0), change)
