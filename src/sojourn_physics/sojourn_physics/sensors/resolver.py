"""Resolver: sine and cosine of its shaft, with errors of amplitude, phase and offset, through a tracking converter.

    u = (1 + a) sin x + o_s,   v = cos(x + p) + o_c,   x = P s        P pairs of poles, s = r q its shaft
    told angle of the shaft = (x + e)/P in steps of 2 pi / (2^b P),   e = atan2(u cos x - v sin x, u sin x + v cos x)
    e = a/2 sin 2x + p/2 (1 - cos 2x) + o_s cos x - o_c sin x         to the first order

(Hanselman 1990, "Resolver signal requirements for high accuracy resolver-to-digital conversion", IEEE Trans. Ind.
Electron. 37, 556.) a, p, o_s, o_c are drawn once; noise is white in every reading.

Assumptions: the converter's loop, of the second type, has settled: no error at a steady rate, none told at others; it
counts turns and knows in which the shaft begins. Range: errors small against 1.
"""

import math
from typing import NamedTuple

from pydantic import Field

from sojourn_machine.params import FloatArray
from sojourn_physics.sensors.angle_sensor import TURN, AngleSensorParams, AngleTold


class Windings(NamedTuple):
    """Errors of amplitude [1], phase [rad] and the offsets of sine and cosine [1]."""

    amplitude: float
    phase: float
    sine: float
    cosine: float

    def error(self, electrical: float) -> float:
        """Of the electrical angle [rad] at an electrical angle [rad]."""
        s, c = math.sin(electrical), math.cos(electrical)
        u = (1.0 + self.amplitude) * s + self.sine
        v = math.cos(electrical + self.phase) + self.cosine
        return math.atan2(u * c - v * s, u * s + v * c)


class ResolverParams(AngleSensorParams):
    """A resolver and its converter."""

    kind: str = "resolver"
    pole_pairs: int = Field(default=1, ge=1, le=64, description="electrical turns of a turn of its shaft [1]")
    bits: int = Field(default=16, ge=8, le=24, description="counts of an electrical turn, as a power of two [1]")
    amplitude_error: float = Field(default=0.0, ge=0.0, le=0.2, description="standard deviation of a [1]")
    phase_error: float = Field(default=0.0, ge=0.0, le=0.2, description="standard deviation of p [rad]")
    offset_error: float = Field(default=0.0, ge=0.0, le=0.2, description="standard deviation of o_s and of o_c [1]")
    noise: float = Field(default=0.0, ge=0.0, le=0.1, description="standard deviation, of the electrical angle [rad]")
    drawn = 4

    def begin(self, angle: float, drawn: FloatArray) -> Windings:
        a, p, o_s, o_c = drawn.tolist()
        return Windings(
            self.amplitude_error * a, self.phase_error * p, self.offset_error * o_s, self.offset_error * o_c
        )

    def read(self, memory: Windings, angle: float, noise: FloatArray, dt: float) -> AngleTold:
        scale, step = self.gear_ratio * self.pole_pairs, TURN / 2.0**self.bits
        electrical = angle * scale
        seen = electrical + memory.error(electrical) + self.noise * float(noise[0])
        return AngleTold(memory, math.floor(seen / step + 0.5) * step / scale)
