"""Which motions a machine's wheels allow, and what is said of one that they do not.

A twist is allowed if every wheel that cannot slide by design (rollers slide, and wheels that scrub act as one axle, see
`wheel_table`) finds an angle inside its limits at which it rolls without sliding. Fixed wheels hold the centre of
rotation on the line of their axle, so that v_y = -x_axle yaw_rate; a twist that misses this by little (base_link does
not stand over the axle, a hand is not steady on a stick) is fitted to it, any other is refused as a whole: a machine
that did the part which it can would go where nobody sent it.

Source: Siegwart, Nourbakhsh, Scaramuzza, Introduction to Autonomous Mobile Robots, 2nd ed. (2011), section 3.3 (degree
of mobility and steerability). Assumptions: those of `kinematics`; the steering stands where the motion wants it.
"""

import math
from dataclasses import dataclass, field

import numpy as np

from sojourn_flight.mobility.kinematics import wheels_from_twist
from sojourn_flight.mobility.rolling_lines import sliding_line
from sojourn_flight.mobility.twist import PlanarTwist
from sojourn_flight.mobility.wheel_table import WheelTableColumn
from sojourn_machine.params import FloatArray

FITTED = 0.1
"""Part of the fastest wheel's speed by which a twist may miss the line of the fixed axle and is fitted to it [-]."""
SLIDING = 0.02
"""Part of the fastest wheel's speed that a wheel may slide and still counts as rolling [-]."""
WHOLE_DEGREES = 91
WIDE = 1e3
"""Radius of a curve that every machine can drive [m]."""


@dataclass(frozen=True, eq=False)
class AllowedMotion:
    """What a machine's wheels allow.

    Args:
        table: wheels, from `SteeringGeometryParams.table()`. names: theirs.
    """

    table: FloatArray
    names: tuple[str, ...]
    axle: float | None = field(init=False)
    """Place of the fixed wheels' axle along the body [m]; None where all wheels steer or have rollers."""
    crab_deg: int = field(init=False)
    """Whole degrees by which it can drive off its heading."""
    narrowest: float = field(init=False)
    """Radius of the narrowest curve ahead [m]; 0 of a machine that turns on the spot."""

    def __post_init__(self) -> None:
        fixed = (self.table[:, WheelTableColumn.STEERED] < 0.5) & (self.table[:, WheelTableColumn.SLIDE_WEIGHT] > 0.0)
        axle = round(float(self.table[fixed, WheelTableColumn.ARM_X].mean()), 9) if fixed.any() else None
        object.__setattr__(self, "axle", axle)
        aside = [self._rolls(PlanarTwist(math.cos(a), math.sin(a), 0.0)) for a in np.radians(np.arange(WHOLE_DEGREES))]
        crab = 0 if axle is not None else (aside.index(False) if False in aside else WHOLE_DEGREES) - 1
        object.__setattr__(self, "crab_deg", crab)
        object.__setattr__(self, "narrowest", self._narrowest())

    def fit(self, twist: PlanarTwist) -> tuple[PlanarTwist, str]:
        """The twist that the wheels allow in place of one that was asked for, and why it is refused.

        Returns:
            the same twist or one very near to it, and no words; or no motion, and what the machine cannot and what it
            can do.
        """
        speed = self._fastest(twist)
        if self.axle is not None and speed > 0.0:
            aside = 0.0 - self.axle * twist.yaw_rate  # never minus zero, whose direction is another
            if abs(twist.v_y - aside) > FITTED * speed:
                return PlanarTwist(0.0, 0.0, 0.0), self._refusal(twist)
            twist = twist._replace(v_y=aside)
        if speed > 0.0 and not self._rolls(twist):
            return PlanarTwist(0.0, 0.0, 0.0), self._refusal(twist)
        return twist, ""

    def _refusal(self, twist: PlanarTwist) -> str:
        slide = self._slide(twist)
        worst = int(np.argmax(slide))
        return (
            f"{self.names[worst]} would be dragged sideways at {slide[worst]:.3f} m/s by v_x = {twist.v_x:.3f} m/s, "
            f"v_y = {twist.v_y:.3f} m/s, yaw rate = {twist.yaw_rate:.3f} rad/s; {self.abilities()}"
        )

    def abilities(self) -> str:
        """What the machine can do, in words."""
        curves = "in any curve and on the spot"
        if self.narrowest > 0.0:
            curves = f"in curves of {self.narrowest:.1f} m radius or wider, not on the spot"
        aside = "not sideways"
        if self.crab_deg > 0:
            aside = "to all sides" if self.crab_deg == WHOLE_DEGREES - 1 else f"up to {self.crab_deg} degrees aside"
        return f"this machine drives ahead and back {curves}, and {aside}"

    def _narrowest(self) -> float:
        """Radius of the narrowest curve [m] by bisection, between a tenth of the machine and what any machine can."""
        if self._rolls(self._curve(0.0)):
            return 0.0
        low, high = 0.1 * self._fastest(PlanarTwist(0.0, 0.0, 1.0)), WIDE
        for _ in range(40):
            middle = math.sqrt(low * high)
            low, high = (low, middle) if self._rolls(self._curve(middle)) else (middle, high)
        return high

    def _curve(self, radius: float) -> PlanarTwist:
        return PlanarTwist(radius, 0.0 - (self.axle or 0.0), 1.0)

    def _rolls(self, twist: PlanarTwist) -> bool:
        return bool(self._slide(twist).max() <= SLIDING * self._fastest(twist))

    def _slide(self, twist: PlanarTwist) -> FloatArray:
        """Sideways speed of each wheel [m/s], shape (wheels,)."""
        angles = wheels_from_twist(self.table, twist, np.zeros(len(self.table))).steer_angles
        lines = (sliding_line(row, angle, 0.0) for row, angle in zip(self.table, angles, strict=True))
        slides = [abs(x * twist.v_x + y * twist.v_y + w * twist.yaw_rate) for x, y, w, _ in lines]
        return np.where(self.table[:, WheelTableColumn.SLIDE_WEIGHT] > 0.0, slides, 0.0)

    def _fastest(self, twist: PlanarTwist) -> float:
        """Speed over ground of the wheel that moves fastest [m/s]."""
        x, y = self.table[:, WheelTableColumn.X], self.table[:, WheelTableColumn.Y]
        return float(np.hypot(twist.v_x - twist.yaw_rate * y, twist.v_y + twist.yaw_rate * x).max())
