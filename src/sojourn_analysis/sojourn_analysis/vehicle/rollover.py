"""Roll-over and sliding on a curve and across a slope.

Lateral acceleration in units of gravity, V^2/(R g), at which (t track, h height of the centre of mass, mu side
friction, b bank angle towards the inside of the curve):

    it rolls over   (tan b + t/2h')/(1 - tan b t/2h')         roll-over factor t/2h' on level ground
    it slides       (tan b + mu)/(1 - mu tan b)               sliding factor mu on level ground

whichever is smaller comes first. With suspensions the body leans out by the angle p = (m a_y h_s)/(K - m g h_s) and the
centre of mass moves: t/2 shrinks by h_s sin p. Static roll-over angle across a slope: atan(t/2h').
(Genta and Morello 2009, vol. 2, sec. 24.5; Gillespie 1992, ch. 9.)
Assumptions: quasi-static, rigid ground, no tripping. Range: b below the angle at which the factors go through infinity.
"""

import math
from typing import NamedTuple

from scipy.optimize import brentq

from sojourn_machine.errors import InvalidValueError


class CurveLimit(NamedTuple):
    """Lateral acceleration over gravity at which it rolls over and at which it slides, and what comes first."""

    roll_over: float
    sliding: float
    first: str

    @property
    def least(self) -> float:
        """The smaller of both [-]."""
        return min(self.roll_over, self.sliding)


def roll_over_factor(track: float, height: float, sprung_height: float = 0.0, flexibility: float = 0.0) -> float:
    """Lateral acceleration over gravity at which a vehicle rolls over on level ground.

    Args:
        track, height: [m]. sprung_height: h_s of the centre of mass over the roll axis [m].
        flexibility: m g/K of the springs in roll [1/m]; 0 is rigid; h_s m g/K is below 1, or it falls over by itself.
    """
    if not (track > 0.0 and height > 0.0):
        raise InvalidValueError("track, height", (track, height), "more than 0 m")
    softness = flexibility * sprung_height
    if not 0.0 <= softness < 1.0:
        raise InvalidValueError("flexibility", flexibility, "one with which the springs hold the body upright")
    if softness == 0.0:
        return 0.5 * track / height

    def moment(acceleration: float) -> float:
        lean = acceleration * softness / (1.0 - softness)
        return 0.5 * track - sprung_height * math.sin(lean) - acceleration * height

    return float(brentq(moment, 0.0, 0.5 * track / height, xtol=1e-14))


def curve_limit(roll_over: float, friction: float, bank: float = 0.0) -> CurveLimit:
    """Limits on a curve with a bank angle [rad], positive where the outside is higher.

    Args:
        roll_over: roll-over factor on level ground. friction: side friction coefficient.
    """
    tangent = math.tan(bank)
    values = []
    for factor in (roll_over, friction):
        below = 1.0 - factor * tangent
        values.append((tangent + factor) / below if below > 0.0 else math.inf)
    return CurveLimit(values[0], values[1], "roll-over" if values[0] < values[1] else "sliding")


def curve_speed(limit: float, radius: float, gravity: float) -> float:
    """Speed [m/s] on a radius [m] for a lateral acceleration over gravity; 0 where the slope alone is too much."""
    return math.sqrt(max(limit, 0.0) * radius * gravity)
