"""Tachometer: a generator on a shaft, which tells a rate and no angle.

    w     = r (q_k - q_(k-1)) / dt                              mean rate of the shaft, of a converter that integrates
    told  = d round(((1 + g) w (1 + p sin(N s)) + o + n) / d) / r
    angle = q_0 + sum of told dt                                dead reckoning from where the joint began

g, o drawn once; p the ripple of N commutator bars a turn; n white. The angle drifts by o/r and the walk of n, as it
does for whoever has nothing else (Electro-Craft 1980, DC Motors, Speed Controls, Servo Systems).
"""

import math
from typing import NamedTuple

from pydantic import Field

from sojourn_machine.params import FloatArray
from sojourn_physics.sensors.angle_sensor import AngleSensorParams, AngleTold


class Generator(NamedTuple):
    """Gain less 1, offset [rad/s] of the shaft, true angle of the last reading and the sum of what was told [rad]."""

    gain: float
    offset: float
    angle: float
    summed: float


class TachometerParams(AngleSensorParams):
    """A tachometer and its converter."""

    kind: str = "tachometer"
    resolution: float = Field(gt=0.0, le=100.0, description="step of the converter, at its shaft [rad/s]")
    gain_error: float = Field(default=0.0, ge=0.0, le=0.1, description="standard deviation of the gain less 1 [1]")
    offset_error: float = Field(default=0.0, ge=0.0, le=10.0, description="standard deviation, at its shaft [rad/s]")
    ripple: float = Field(default=0.0, ge=0.0, le=0.5, description="amplitude, as a part of the rate [1]")
    ripples: int = Field(default=11, ge=1, le=1000, description="of a turn of its shaft [1]")
    noise: float = Field(default=0.0, ge=0.0, le=10.0, description="standard deviation, at its shaft [rad/s]")
    drawn = 2

    def begin(self, angle: float, drawn: FloatArray) -> Generator:
        gain, offset = drawn.tolist()
        return Generator(self.gain_error * gain, self.offset_error * offset, angle, angle)

    def read(self, memory: Generator, angle: float, noise: FloatArray, dt: float) -> AngleTold:
        shaft = angle * self.gear_ratio
        true = self.gear_ratio * (angle - memory.angle) / dt if dt > 0.0 else 0.0
        seen = (1.0 + memory.gain) * true * (1.0 + self.ripple * math.sin(self.ripples * shaft))
        seen += memory.offset + self.noise * float(noise[0])
        rate = math.floor(seen / self.resolution + 0.5) * self.resolution / self.gear_ratio
        summed = memory.summed + rate * dt
        return AngleTold(memory._replace(angle=angle, summed=summed), summed, rate)
