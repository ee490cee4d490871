"""Potentiometer: a wiper on a track with two ends, as a voltage divider through a converter.

    y = s/w + 1/2 + l(s),   s = r q - c the angle from the middle of the track, w its electrical travel, r the gear
    l(s) = L sum_k h_k sin(2 pi k s/w + f_k),   k = 1 .. 3, of which no value is above L        independent linearity
    told = c/r + (w/r) (round(2^b (y + n)) / 2^b - 1/2),   y held to 0 .. 1

Between the ends, where there is no track, the wiper is open and the converter's own resistor pulls it to 0: a joint
there is told at the lower end of the track. h and f are drawn once (h sums to one at most); n is the noise of the
contact (VRCI-P-100A, "Wirewound and nonwirewound precision potentiometers": independent linearity, electrical travel,
output smoothness).

Assumption: converter without load on the wiper. Turns of the shaft are not counted: it is the same one turn on.
"""

import math
from typing import NamedTuple, Self

from pydantic import Field, model_validator

from sojourn_machine.params import FloatArray
from sojourn_physics.sensors.angle_sensor import TURN, AngleSensorParams, AngleTold

HARMONICS = 3


class Track(NamedTuple):
    """Deviation from a straight line: parts of the largest, (HARMONICS,) [1], and phases, (HARMONICS,) [rad]."""

    parts: tuple[float, ...]
    phases: tuple[float, ...]

    def deviation(self, place: float) -> float:
        """Over the largest, at a place of the track from 0 to 1."""
        waves = zip(self.parts, self.phases, strict=True)
        return sum(part * math.sin(TURN * k * place + phase) for k, (part, phase) in enumerate(waves, start=1))


class PotentiometerParams(AngleSensorParams):
    """A potentiometer of one turn or less."""

    kind: str = "potentiometer"
    travel_deg: float = Field(default=340.0, gt=0.0, le=360.0, description="electrical travel of its shaft [deg]")
    centre_deg: float = Field(
        default=0.0, ge=-360.0, le=360.0, description="its shaft at the middle of the track [deg]"
    )
    linearity: float = Field(default=0.0, ge=0.0, le=0.1, description="largest deviation from a straight line [1]")
    noise: float = Field(default=0.0, ge=0.0, le=0.1, description="standard deviation, as a part of the travel [1]")
    bits: int = Field(default=12, ge=4, le=24, description="counts of the converter, as a power of two [1]")
    drawn = 2 * HARMONICS

    @model_validator(mode="after")
    def _check_shaft(self) -> Self:
        if self.side == "motor" and self.gear_ratio != 1.0:
            raise ValueError("side = 'motor': allowed is output, for a potentiometer does not count turns of a gear")
        return self

    def begin(self, angle: float, drawn: FloatArray) -> Track:
        sizes = [abs(number) for number in drawn[:HARMONICS].tolist()]
        total = max(sum(sizes), 1e-12)
        phases = tuple(TURN * math.erf(number / math.sqrt(2.0)) for number in drawn[HARMONICS:].tolist())
        return Track(tuple(size / total for size in sizes), phases)

    def read(self, memory: Track, angle: float, noise: FloatArray, dt: float) -> AngleTold:
        travel, centre, counts = math.radians(self.travel_deg), math.radians(self.centre_deg), 2.0**self.bits
        from_centre = math.remainder(angle - centre, TURN)
        share = 0.0
        if abs(from_centre) <= 0.5 * travel:
            place = from_centre / travel + 0.5
            seen = place + self.linearity * memory.deviation(place) + self.noise * float(noise[0])
            share = min(max(math.floor(counts * seen + 0.5), 0.0), counts) / counts
        return AngleTold(memory, centre + travel * (share - 0.5))
