"""A route of the tip: legs of lines and arcs, run through without a stop where their corners can be rounded.

Round a corner the end of one leg is laid over the beginning of the next (Lloyd & Hayward, IEEE Trans. Robotics and
Automation 9(2), 1993, for legs of any kind): with tau from -1 to 1 on the stretch of length d before and after it,
    p = A(-d h(-tau)) + B(d h(tau)) - corner,     h(tau) = (tau + 1)^3 (3 - tau)/16,
A and B the places on the legs at a distance from the corner. h has no slope and no curvature at -1, and the slope 1
and no curvature at 1: the place is smooth to the second derivative. It passes the corner at 3/16 d |b - a|, with a and
b the directions of the legs there; d is what keeps this below `corner`, at most half of either leg. Turns are laid over
each other in the same way.

At a corner that cannot be rounded, where the tip would go back nearly as it came or only turns, it stops.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sojourn_flight.arm.cartesian_path import TipPath
from sojourn_machine.params import FloatArray

TURNING_LENGTH = 0.1
"""A turn of one radian takes as long as so much of the way, where that is longer [m]."""
_SHARPEST = 1.9
"""|b - a| of a corner that is rounded: at 2 the tip goes back as it came."""
_BLUNTEST = 0.75
"""A corner that is blunter is rounded as if it were so sharp."""
_NEAR = 1.0e-4
"""Share of a leg over which its direction at the corner is taken."""


@dataclass(frozen=True, slots=True, eq=False)
class TipRoute:
    """Legs with rounded corners; its parameter s runs from 0 to 1, in even steps of length but in the corners."""

    legs: tuple[TipPath, ...]
    rounded: tuple[float, ...]
    """Length before and after each inner corner that is rounded [m], one fewer than legs."""

    @property
    def length(self) -> float:
        """Of all legs, turning included [m]."""
        return sum(_way(leg) for leg in self.legs)

    @property
    def breaks(self) -> tuple[float, ...]:
        """Values of s at which a corner's rounding begins or ends."""
        corners = np.cumsum([_way(leg) for leg in self.legs])[:-1]
        ends = [place for corner, d in zip(corners, self.rounded, strict=True) for place in (corner - d, corner + d)]
        return tuple(sorted({float(place) / self.length for place in ends}))

    def pose(self, s: float) -> tuple[FloatArray, FloatArray]:
        """Place (3,) [m] and rotation (3, 3) at s from 0 to 1."""
        gone = min(max(s, 0.0), 1.0) * self.length
        for k, leg in enumerate(self.legs):
            way = _way(leg)
            before = self.rounded[k - 1] if k > 0 else 0.0
            after = self.rounded[k] if k < len(self.rounded) else 0.0
            if gone < before:
                return self._round(k - 1, gone)
            if gone <= way - after or k == len(self.legs) - 1:
                return leg.pose(min(gone / way, 1.0))
            if gone < way:
                return self._round(k, gone - way)
            gone -= way
        return self.legs[-1].pose(1.0)

    def _round(self, k: int, beyond: float) -> tuple[FloatArray, FloatArray]:
        """The pose `beyond` [m] the corner after leg k."""
        first, second, d = self.legs[k], self.legs[k + 1], self.rounded[k]
        place, turned = first.pose(1.0 - d * _ramp(-beyond / d) / _way(first))
        other, turned_on = second.pose(d * _ramp(beyond / d) / _way(second))
        corner, rotation = first.pose(1.0)
        return place + other - corner, turned_on @ rotation.T @ turned


def routes_along(legs: Sequence[TipPath], corner: float) -> list[TipRoute]:
    """Routes through all legs in turn, from stop to stop.

    Args:
        legs: each begins where the one before it ends.
        corner: most that a rounded corner may be passed by [m]; 0: stop at each.
    """
    runs: list[tuple[list[TipPath], list[float]]] = []
    for leg in legs:
        room = _rounding(runs[-1][0][-1], leg, corner) if runs else 0.0
        if room > 0.0:
            runs[-1][0].append(leg)
            runs[-1][1].append(room)
        else:
            runs.append(([leg], []))
    return [TipRoute(tuple(run), tuple(rounded)) for run, rounded in runs]


def _rounding(first: TipPath, second: TipPath, corner: float) -> float:
    """Length before and after the corner of two legs that is to be rounded [m]; 0 where it cannot be."""
    if min(first.length, second.length) < TURNING_LENGTH * _NEAR or corner <= 0.0:
        return 0.0
    into = first.pose(1.0)[0] - first.pose(1.0 - _NEAR)[0]
    out = second.pose(_NEAR)[0] - second.pose(0.0)[0]
    sharpness = float(np.linalg.norm(out / np.linalg.norm(out) - into / np.linalg.norm(into)))
    if sharpness > _SHARPEST:
        return 0.0
    return min(16.0 / 3.0 * corner / max(sharpness, _BLUNTEST), 0.5 * _way(first), 0.5 * _way(second))


def _way(leg: TipPath) -> float:
    return max(leg.length, TURNING_LENGTH * math.sqrt(float(leg.turn @ leg.turn)))


def _ramp(tau: float) -> float:
    """h(tau), from -1 to 1."""
    return (tau + 1.0) ** 3 * (3.0 - tau) / 16.0
