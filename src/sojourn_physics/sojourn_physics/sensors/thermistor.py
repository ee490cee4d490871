"""Thermistor with a negative coefficient, in a divider with a fixed resistor.

    1/T = a + b ln R + c (ln R)^3                     (Steinhart and Hart 1968, Deep-Sea Research 15, 497)
    1/T = 1/T_25 + ln(R/R_25) / beta                  the same with b = 1/beta and c = 0
    ln R = cbrt(y - x/2) - cbrt(y + x/2),  x = (a - 1/T)/c,  y = sqrt((b/(3 c))^3 + x^2/4)     its inverse: Cardano
    v = R / (R + R_s)                                 voltage of the divider over its supply, which is the reference
    P = (V v)^2 / R                                   warms it; k is 1 over the data sheet's dissipation constant

Errors: the resistance at 25 degrees and the slope of ln R within their tolerances, the series resistor within its own.
Told is the range of the data sheet; where R is far from R_s the converter's counts are coarse.
"""

import math
from typing import Self

from pydantic import Field, model_validator

from sojourn_machine.params import FloatArray
from sojourn_physics.sensors.resistance_thermometer import HALF_WIDTH, ZERO_CELSIUS, ResistanceThermometerParams

ROOM = ZERO_CELSIUS + 25.0
"""At which thermistors are named by their resistance [K]."""
AT_ROOM, SLOPE, SERIES = range(3)
"""Places of the drawn errors."""


class ThermistorParams(ResistanceThermometerParams):
    """A thermistor: either `steinhart_hart`, or `resistance` and `beta`."""

    steinhart_hart: tuple[float, float, float] | None = Field(
        default=None, description="a [1/K], b [1/K], c [1/K] of the curve, R in ohm"
    )
    resistance: float | None = Field(default=None, gt=0.0, le=1e8, description="at 25 degC [ohm]")
    beta: float | None = Field(default=None, ge=500.0, le=1e4, description="of the curve without a cubic term [K]")
    resistance_tolerance: float = Field(default=0.0, ge=0.0, le=0.5, description="largest error at 25 degC [1]")
    slope_tolerance: float = Field(
        default=0.0, ge=0.0, le=0.2, description="largest error of the slope of ln R against 1/T [1]"
    )
    series_resistance: float = Field(gt=0.0, le=1e8, description="resistor between supply and thermistor [ohm]")
    series_tolerance: float = Field(default=0.001, ge=0.0, le=0.2, description="largest error of that resistor [1]")
    supply: float = Field(default=2.5, gt=0.0, le=50.0, description="voltage of the divider [V]")
    coldest: float = Field(default=193.15, ge=100.0, le=400.0, description="least temperature of the curve [K]")
    warmest: float = Field(default=423.15, ge=200.0, le=600.0, description="largest temperature of the curve [K]")

    @model_validator(mode="after")
    def _check(self) -> Self:
        if (self.steinhart_hart is None) != (self.resistance is not None and self.beta is not None):
            raise ValueError("allowed is either steinhart_hart, or resistance and beta together")
        if self.steinhart_hart is not None:
            if self.resistance is not None or self.beta is not None:
                raise ValueError("allowed is either steinhart_hart, or resistance and beta together")
            _, b, c = self.steinhart_hart
            if not (b > 0.0 and c >= 0.0):
                raise ValueError(f"steinhart_hart: b = {b}, c = {c}: allowed are b above 0 and c at least 0")
        if self.warmest <= self.coldest:
            raise ValueError(f"warmest = {self.warmest}: allowed is above coldest, {self.coldest}")
        return self

    @property
    def curve(self) -> tuple[float, float, float]:
        """a, b, c of the data sheet."""
        if self.steinhart_hart is not None:
            return self.steinhart_hart
        resistance, beta = self.resistance or 1.0, self.beta or 1.0  # both are there, or the file was refused
        return 1.0 / ROOM - math.log(resistance) / beta, 1.0 / beta, 0.0

    @property
    def limits(self) -> tuple[float, float]:
        return self.coldest, self.warmest

    def element_resistance(self, temperature: float, errors: FloatArray) -> float:
        room = log_resistance(self.curve, ROOM)
        from_room = log_resistance(self.curve, temperature) - room
        slope = 1.0 + self.slope_tolerance * float(errors[SLOPE]) / HALF_WIDTH
        at_room = 1.0 + self.resistance_tolerance * float(errors[AT_ROOM]) / HALF_WIDTH
        return at_room * math.exp(room + slope * from_room)

    def power(self, resistance: float) -> float:
        return (self.supply / (resistance + self.series_resistance)) ** 2 * resistance

    def ratio(self, resistance: float, errors: FloatArray) -> float:
        series = self.series_resistance * (1.0 + self.series_tolerance * float(errors[SERIES]) / HALF_WIDTH)
        return resistance / (resistance + series)

    def temperature(self, ratio: float) -> float:
        least, largest = log_resistance(self.curve, self.warmest), log_resistance(self.curve, self.coldest)
        told = math.log(self.series_resistance * ratio / (1.0 - ratio))
        return temperature_of(self.curve, min(max(told, least), largest))


def temperature_of(curve: tuple[float, float, float], log_of_resistance: float) -> float:
    """Of a thermistor with a curve a, b, c, by the logarithm of its resistance in ohm [K]."""
    a, b, c = curve
    return 1.0 / (a + b * log_of_resistance + c * log_of_resistance**3)


def log_resistance(curve: tuple[float, float, float], temperature: float) -> float:
    """Logarithm of the resistance in ohm of a thermistor with a curve a, b, c at a temperature [K]."""
    a, b, c = curve
    if c == 0.0:
        return (1.0 / temperature - a) / b
    x = (a - 1.0 / temperature) / c
    y = math.sqrt((b / (3.0 * c)) ** 3 + 0.25 * x * x)
    return math.cbrt(y - 0.5 * x) - math.cbrt(y + 0.5 * x)
