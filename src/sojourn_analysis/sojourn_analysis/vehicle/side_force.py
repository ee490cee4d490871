"""Side force of a wheel for its load and slip angle a, a > 0 where the wheel moves to its left: the force is to the
right.

    `LinearSideForce`   F_y = -C a
    `FirmSideForce`     brush model without carcass (Fromm; Pacejka 2012, sec. 3.2): with x = C tan a/(3 mu F_z), |x| <
    1
                        F_y = -mu F_z (3 x - 3 x |x| + x^3), full sliding beyond; C = c F_z, proportional to the load
    `SoilSideForce`     steady state of the rigid wheel on the test bed of `contact.wheel_bench`, at a slip of the
    carriage

The cornering stiffness is -dF_y/da at a = 0. Range: |a| up to a right angle; one wheel, upright.
"""

import math
from dataclasses import dataclass, field
from typing import Protocol

from sojourn_analysis.vehicle.wheel_traction import WheelBench
from sojourn_physics.contact.wheel_shape import WheelShape
from sojourn_physics.soil.params import SoilParams


class SideForce(Protocol):
    """Law of the side force of a wheel."""

    def force(self, load: float, slip_angle: float) -> float:
        """F_y [N] at a load [N] and a slip angle [rad]."""


@dataclass(frozen=True, slots=True)
class LinearSideForce:
    """Cornering stiffness of one wheel [N/rad], whatever its load."""

    stiffness: float

    def force(self, load: float, slip_angle: float) -> float:
        """As `SideForce.force`."""
        return -self.stiffness * slip_angle


@dataclass(frozen=True, slots=True)
class FirmSideForce:
    """Wheel on firm ground: friction coefficient, and cornering stiffness over the load [1/rad]."""

    friction: float
    stiffness_per_load: float

    def force(self, load: float, slip_angle: float) -> float:
        """As `SideForce.force`."""
        if load <= 0.0:
            return 0.0
        limit = self.friction * load
        x = self.stiffness_per_load * load * math.tan(slip_angle) / (3.0 * limit)
        if abs(x) >= 1.0:
            return -math.copysign(limit, x)
        return -limit * (3.0 * x - 3.0 * x * abs(x) + x**3)


@dataclass(frozen=True, slots=True, eq=False)
class SoilSideForce:
    """Rigid wheel on soil; `slip` is the longitudinal slip with which it rolls, gravity in m/s^2."""

    soil: SoilParams
    shape: WheelShape
    gravity: float
    slip: float = 0.0
    bench: WheelBench = field(init=False, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "bench", WheelBench(self.soil, self.shape, self.gravity))

    def force(self, load: float, slip_angle: float) -> float:
        """As `SideForce.force`."""
        if load <= 0.0:
            return 0.0
        return self.bench.state(load, self.slip, slip_angle)[2]


def cornering_stiffness(law: SideForce, load: float, angle: float = 1e-3) -> float:
    """-dF_y/da of one wheel at no slip angle [N/rad], by a central difference."""
    return (law.force(load, -angle) - law.force(load, angle)) / (2.0 * angle)
