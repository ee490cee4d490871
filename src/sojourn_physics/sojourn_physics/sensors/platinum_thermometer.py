"""Platinum resistance thermometer: the curve of IEC 60751, its classes, two, three or four wires.

    R(t) = R_0 (1 + A t + B t^2 + C (t - 100) t^3),   C = 0 for t >= 0        (Callendar 1887, van Dusen 1925)
    A = 3.9083e-3 /K, B = -5.775e-7 /K^2, C = -4.183e-12 /K^4                 (IEC 60751:2022)

t in degrees Celsius; 138.51 ohm at 100 degrees for R_0 = 100 ohm. The inverse is the quadratic's root at and above
zero, below it Newton's method from there, which the curve, monotonic and concave, lets converge.

    class     AA 0.1 + 0.0017 |t|, A 0.15 + 0.002 |t|, B 0.3 + 0.005 |t|, C 0.6 + 0.01 |t|  [K]
    heating   P = I^2 R at the measuring current I; k of the data sheet, 0 for one that is pulsed
    wires     four add nothing; three what one lead differs from the other; two both leads r, of which nobody knows

An element's error is drawn within its class: of its intercept and of its slope apart. Told are -200 to 850 degrees,
the range of the standard.
"""

import math
from typing import Literal

from pydantic import Field

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray
from sojourn_physics.sensors.resistance_thermometer import HALF_WIDTH, ZERO_CELSIUS, ResistanceThermometerParams

A, B, C = 3.9083e-3, -5.775e-7, -4.183e-12
COLDEST, WARMEST = -200.0, 850.0
"""Range of the curve [degree Celsius]."""
CLASSES = {"none": (0.0, 0.0), "AA": (0.1, 0.0017), "A": (0.15, 0.002), "B": (0.3, 0.005), "C": (0.6, 0.01)}
"""Largest error at zero [K] and its growth with the distance from it [1]; none: an element that has no error."""
INTERCEPT, SLOPE, LEADS = range(3)
"""Places of the drawn errors."""


class PlatinumThermometerParams(ResistanceThermometerParams):
    """A platinum thermometer."""

    resistance_at_zero: float = Field(default=100.0, gt=0.0, le=1e5, description="of the element at 0 degC [ohm]")
    tolerance: Literal["none", "AA", "A", "B", "C"] = Field(default="A", description="class of IEC 60751")
    wires: Literal[2, 3, 4] = Field(default=4, description="of the connection [1]")
    lead_resistance: float = Field(default=0.0, ge=0.0, le=1e3, description="of one lead [ohm]")
    lead_mismatch: float = Field(
        default=0.01, ge=0.0, le=1.0, description="largest difference of two leads, as a part of one [1]"
    )
    current: float = Field(default=1e-3, gt=0.0, le=0.1, description="measuring current [A]")
    reference_resistance: float = Field(
        default=400.0, gt=0.0, le=1e6, description="of the converter's reference, end of its range [ohm]"
    )

    @property
    def limits(self) -> tuple[float, float]:
        return COLDEST + ZERO_CELSIUS, WARMEST + ZERO_CELSIUS

    def element_resistance(self, temperature: float, errors: FloatArray) -> float:
        t = temperature - ZERO_CELSIUS
        at_zero, growth = CLASSES[self.tolerance]
        error = (at_zero * float(errors[INTERCEPT]) + growth * abs(t) * float(errors[SLOPE])) / HALF_WIDTH
        return self.resistance_at_zero * relative_resistance(t + error)

    def power(self, resistance: float) -> float:
        return self.current**2 * resistance

    def ratio(self, resistance: float, errors: FloatArray) -> float:
        leads = 2.0 * self.lead_resistance if self.wires == 2 else 0.0
        if self.wires == 3:
            leads = self.lead_mismatch * self.lead_resistance * float(errors[LEADS]) / HALF_WIDTH
        return (resistance + leads) / self.reference_resistance

    def temperature(self, ratio: float) -> float:
        relative = ratio * self.reference_resistance / self.resistance_at_zero
        held = min(max(relative, relative_resistance(COLDEST)), relative_resistance(WARMEST))
        return temperature_of(held) + ZERO_CELSIUS


def relative_resistance(celsius: float) -> float:
    """Of an element over that at zero, at a temperature [degree Celsius]."""
    t = celsius
    cubic = C * (t - 100.0) * t**3 if t < 0.0 else 0.0
    return 1.0 + A * t + B * t * t + cubic


def temperature_of(relative: float) -> float:
    """The temperature [degree Celsius] at which an element has this part of its resistance at zero.

    Raises:
        InvalidValueError: a resistance that platinum has at no temperature of the standard.
    """
    if not relative_resistance(COLDEST) - 1e-9 <= relative <= relative_resistance(WARMEST) + 1e-9:
        raise InvalidValueError("resistance over that at zero", relative, f"that of {COLDEST:g} to {WARMEST:g} degC")
    t = (-A + math.sqrt(A * A - 4.0 * B * (1.0 - relative))) / (2.0 * B)
    if t >= 0.0:
        return t
    for _ in range(20):
        slope = A + 2.0 * B * t + C * (4.0 * t - 300.0) * t * t
        change = (relative_resistance(t) - relative) / slope
        t -= change
        if abs(change) < 1e-12 * abs(t):
            break
    return t
