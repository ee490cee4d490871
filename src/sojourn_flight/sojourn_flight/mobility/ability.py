"""What a machine can do, whatever it moves on."""

from dataclasses import dataclass
from typing import NamedTuple

from sojourn_machine.params import FloatArray


class TurningLimits(NamedTuple):
    """What paths of a machine may ask for."""

    curvature: float
    """Greatest curvature [1/m]."""
    sharpness: float
    """Fastest growth of the curvature with distance, at full speed [1/m^2]."""
    on_the_spot: bool
    """True if it can turn where it stands."""


@dataclass(frozen=True, eq=False)
class Ability:
    """Worked out once for a machine."""

    turning: TurningLimits
    """How sharply it can turn."""
    turn_radius: float
    """Distance of the farthest support from base_link [m]."""
    supports: FloatArray
    """Where it stands on the ground, in base_link, shape (n, 2) [m]: on these it settles."""
    ride_height: float = 0.0
    """Height of base_link over the plane on which it stands [m]."""
