"""Absolute encoder with errors of its own: eccentricity, noise of the last count, and turns that it may not know.

    seen = s + e sin(s + f) + n,  s = r q the angle of its shaft, r its gear       told = d floor(seen/d + 1/2) / r

d = 2 pi / 2^b; the code disc sits off its centre, which is an error of once a turn (amplitude e, phase f drawn even);
n is the jitter of the edges. Within a turn the code is absolute. A sensor that counts turns through loss of power
(`keeps_turns`) knows all of the angle; another takes the turn nearest to zero at the start and counts from there.

Assumption: turns are counted in the sensor, however fast the shaft is. A disc of radius R whose centre is off by x
shows a point of its rim x/R sin(s + f) from where it should be: e = x/R.
"""

import math
from typing import NamedTuple

from pydantic import Field

from sojourn_machine.params import FloatArray
from sojourn_physics.sensors.angle_sensor import TURN, AngleSensorParams, AngleTold


class Disc(NamedTuple):
    """Phase of the eccentricity, and whole turns that are told too few [rad], both of the shaft."""

    phase: float
    missing: float


class AbsoluteEncoderParams(AngleSensorParams):
    """An absolute encoder."""

    kind: str = "absolute_encoder"
    bits: int = Field(ge=4, le=32, description="counts of a turn of its shaft, as a power of two [1]")
    eccentricity: float = Field(default=0.0, ge=0.0, le=0.1, description="amplitude of the error of once a turn [rad]")
    noise: float = Field(default=0.0, ge=0.0, le=1e3, description="standard deviation of the edges [counts]")
    keeps_turns: bool = Field(default=True, description="whether it knows whole turns of its shaft at the start")

    def begin(self, angle: float, drawn: FloatArray) -> Disc:
        shaft = angle * self.gear_ratio
        missing = 0.0 if self.keeps_turns else TURN * math.floor(shaft / TURN + 0.5)
        return Disc(math.pi * math.erf(float(drawn[0]) / math.sqrt(2.0)), missing)

    def read(self, memory: Disc, angle: float, noise: FloatArray, dt: float) -> AngleTold:
        shaft, step = angle * self.gear_ratio, TURN / 2.0**self.bits
        seen = shaft + self.eccentricity * math.sin(shaft + memory.phase) + self.noise * step * float(noise[0])
        return AngleTold(memory, (math.floor(seen / step + 0.5) * step - memory.missing) / self.gear_ratio)
