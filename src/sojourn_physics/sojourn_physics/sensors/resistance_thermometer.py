"""Thermometers whose resistance tells the temperature: what platinum and thermistors have alike.

    T_e' = (T - T_e) / tau                      the element follows what it sits on; exact for constant T
    R    = resistance(T_e + k P)                its power P warms it by k, of the element as it was made
    x    = ratio(R)                             voltage at the converter, as a part of its reference: ratiometric
    n    = round(2^b (x (1 + g) + s N / 2^b))   b bits, gain error g, noise of s counts, held to 1 .. 2^b - 1
    told = temperature(resistance of n / 2^b)   by the curve of the data sheet, which knows of no error

The errors of the element, its leads and the gain are drawn once, of unit standard deviation each; those that a data
sheet holds within limits are even between them (JCGM 100:2008, sec. 4.3.7: half width over sqrt 3). The variance that
is told with a reading is the mean square of its error by the law of propagation (JCGM 100:2008, eq. 10, sensitivities
by finite differences): drawn errors, noise, rounding by 1/12 of a count (Bennett 1948, "Spectra of quantized signals"),
and, squared, what leads and heating always add. So a user who weighs by it is right on the average of many sensors.

Assumptions: power taken at the temperature of the surroundings; errors small. A temperature outside of what curve and
converter can tell is told as the nearest that they can.
"""

import math
from dataclasses import dataclass

import numpy as np
from pydantic import Field

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray, Params
from sojourn_physics.sensors.noise import NoiseStream, draw, initial_stream

ZERO_CELSIUS = 273.15
"""[K]"""
ERRORS = 4
"""Drawn for a thermometer: two of its element, one of leads or series resistor, the gain of its converter."""
GAIN = ERRORS - 1
NO_ERRORS = np.zeros(ERRORS)
AT_THE_END = 1e-6
"""So near to an end of the range a reading is one beyond it [K]."""
HALF_WIDTH = math.sqrt(3.0)
"""Of an even distribution of unit standard deviation."""


class ResistanceThermometerParams(Params):
    """A thermometer and its converter. A kind has the curve of its element and its circuit."""

    time_constant: float = Field(default=0.0, ge=0.0, le=1e5, description="after which 63 % of a step are told [s]")
    self_heating: float = Field(default=0.0, ge=0.0, le=1e5, description="warming by its own power [K/W]")
    bits: int = Field(default=16, ge=8, le=24, description="counts of the converter, as a power of two [1]")
    noise: float = Field(default=0.5, ge=0.0, le=1e4, description="standard deviation at the converter [counts]")
    gain_error: float = Field(default=0.0, ge=0.0, le=0.1, description="standard deviation of the gain less 1 [1]")

    @property
    def limits(self) -> tuple[float, float]:
        """Least and largest temperature that can be told [K]."""
        raise NotImplementedError

    def element_resistance(self, temperature: float, errors: FloatArray) -> float:
        """Of an element with these errors, (ERRORS,), at a temperature [K]; [ohm]."""
        raise NotImplementedError

    def power(self, resistance: float) -> float:
        """Taken by the element at a resistance [ohm]; [W]."""
        raise NotImplementedError

    def ratio(self, resistance: float, errors: FloatArray) -> float:
        """Voltage at the converter over its reference, for an element [ohm] whose circuit has these errors."""
        raise NotImplementedError

    def temperature(self, ratio: float) -> float:
        """What is told of a voltage over the reference, between 0 and 1 [K]."""
        raise NotImplementedError


@dataclass(frozen=True, eq=False, slots=True)
class ThermometerState:
    """Errors of the run, (ERRORS,), the element's temperature [K] and the random stream."""

    errors: FloatArray
    element: float
    stream: NoiseStream


@dataclass(frozen=True, slots=True)
class ThermometerReading:
    """What is told."""

    temperature: float
    """[K]"""
    variance: float
    """Mean square of its error; 0, as the message has it, where that is not known: at an end of the range [K^2]."""


def even(normal: FloatArray) -> FloatArray:
    """Numbers even between -sqrt 3 and sqrt 3, of unit standard deviation, from as many standard normal ones."""
    return np.array([HALF_WIDTH * math.erf(number / math.sqrt(2.0)) for number in normal.tolist()])


def initial_state(params: ResistanceThermometerParams, seed: int, name: str, temperature: float) -> ThermometerState:
    """A thermometer that is as warm as what it sits on [K], its errors drawn from the stream of `name`.

    Raises InvalidValueError: see `step`.
    """
    _require(temperature)
    stream, row = draw(initial_stream(seed, name, ERRORS))
    errors = np.append(even(row[:GAIN]), row[GAIN])
    return ThermometerState(errors, temperature, stream)


def step(
    params: ResistanceThermometerParams, state: ThermometerState, temperature: float, dt: float
) -> tuple[ThermometerState, ThermometerReading]:
    """A reading, `dt` [s] after the last one, of something at a temperature [K].

    Raises:
        InvalidValueError: a temperature that is not finite or not above zero, a negative or infinite time.
    """
    _require(temperature)
    if not (math.isfinite(dt) and dt >= 0.0):
        raise InvalidValueError("dt [s]", dt, "a finite number, at least 0")
    left = math.exp(-dt / params.time_constant) if params.time_constant > 0.0 else 0.0
    element = temperature + (state.element - temperature) * left
    stream, noise = draw(state.stream)
    counts = 2.0**params.bits
    count = math.floor(counts * _ratio(params, element, state.errors) + params.noise * float(noise[0]) + 0.5)
    told = params.temperature(min(max(count, 1.0), counts - 1.0) / counts)
    coldest, warmest = params.limits
    inside = 1.0 <= count <= counts - 1.0 and coldest + AT_THE_END < told < warmest - AT_THE_END
    of_error = variance(params, told) if inside else 0.0
    return ThermometerState(state.errors, element, stream), ThermometerReading(told, of_error)


def variance(params: ResistanceThermometerParams, temperature: float) -> float:
    """Mean square of the error of a reading at a temperature [K]; [K^2]."""
    counts = 2.0**params.bits
    without = _ratio(params, temperature, NO_ERRORS)
    told = params.temperature(_within(without))
    step_ = params.temperature(_within(without + 1.0 / counts)) - params.temperature(_within(without - 1.0 / counts))
    total = (told - temperature) ** 2 + (params.noise**2 + 1.0 / 12.0) * (0.5 * step_) ** 2
    for place in range(ERRORS):
        errors = NO_ERRORS.copy()
        errors[place] = 1.0
        total += (params.temperature(_within(_ratio(params, temperature, errors))) - told) ** 2
    return total


def _ratio(params: ResistanceThermometerParams, element: float, errors: FloatArray) -> float:
    """At the converter, its gain included, of an element as warm as that [K] without its own power."""
    warmed = element + params.self_heating * params.power(params.element_resistance(element, NO_ERRORS))
    ratio = params.ratio(params.element_resistance(warmed, errors), errors)
    return ratio * (1.0 + params.gain_error * float(errors[GAIN]))


def _within(ratio: float) -> float:
    return min(max(ratio, 1e-9), 1.0 - 1e-9)


def _require(temperature: float) -> None:
    if not (math.isfinite(temperature) and temperature > 0.0):
        raise InvalidValueError("temperature [K]", temperature, "a finite number above 0")
