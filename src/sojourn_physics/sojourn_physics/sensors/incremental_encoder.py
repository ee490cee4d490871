"""Incremental encoder with an index: counts edges, and does not know its zero until the index has been passed.

    n    = floor(s/d),  d = 2 pi / (4 L)         edges of two tracks of L lines in quadrature; s = r q its shaft
    told = (n - n_0) d / r + q_0 + z             counts since the start, from where the joint is believed to be
    z    = drawn at the start; at the first index the nearest whole number of turns of the shaft, which are alike

So the change of what is told is that of the angle within one count, always; and after the index the angle itself is,
provided that z was under half a turn of the shaft. What was told before does not change: the step stands in the period
in which the index was passed. (Ellis 2012, Control System Design Guide, ch. 14: quadrature by four, index.)

Assumptions: no edge is lost, however fast the shaft is; the index is as narrow as a count.
"""

import math
from typing import NamedTuple

from pydantic import Field

from sojourn_machine.params import FloatArray
from sojourn_physics.sensors.angle_sensor import TURN, AngleSensorParams, AngleTold


class Counter(NamedTuple):
    """Error of its zero [rad] of the joint, whether the index has been passed, turns of the shaft since the index."""

    zero: float
    indexed: bool
    turn: int


class IncrementalEncoderParams(AngleSensorParams):
    """An incremental encoder."""

    kind: str = "incremental_encoder"
    lines: int = Field(ge=1, le=10**7, description="of each of its two tracks on a turn of the shaft [1]")
    zero_error: float = Field(
        default=0.0, ge=0.0, le=10.0, description="standard deviation of where the joint is believed to begin [rad]"
    )
    index_deg: float = Field(default=0.0, ge=-180.0, le=180.0, description="angle of its shaft at the index [deg]")

    @property
    def count(self) -> float:
        """Angle of one edge at the shaft [rad]."""
        return TURN / (4.0 * self.lines)

    def begin(self, angle: float, drawn: FloatArray) -> Counter:
        return Counter(self.zero_error * float(drawn[0]), False, self._turn(angle))

    def read(self, memory: Counter, angle: float, noise: FloatArray, dt: float) -> AngleTold:
        zero, indexed, turn = memory
        here = self._turn(angle)
        if here != turn and not indexed:
            whole = TURN / self.gear_ratio
            zero, indexed = whole * math.floor(zero / whole + 0.5), True
        counted = math.floor(angle * self.gear_ratio / self.count) * self.count / self.gear_ratio
        return AngleTold(Counter(zero, indexed, here), counted + zero)

    def _turn(self, angle: float) -> int:
        """Whole turns of the shaft from the index."""
        return math.floor((angle * self.gear_ratio - math.radians(self.index_deg)) / TURN)
