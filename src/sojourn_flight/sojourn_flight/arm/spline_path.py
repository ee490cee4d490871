"""A path of n joints without time: cubic splines of a parameter s, smooth to the second derivative.

Through points the parameter is the length of the polygon through them (chord length; de Boor, A Practical Guide to
Splines, 1978), each joint counted in half ranges, or else a slow joint would set the pace; the ends are natural.
A spline may swing past the points that it goes through: `extremes` gives its exact range.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class SplinePath:
    """Joint positions as a function of s from 0 to `end`."""

    spline: Any  # scipy CubicSpline of (n,) values
    end: float

    def at(self, s: float | FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Positions [rad or m] and their first two derivatives by s: (n,), or (k, n) for s of (k,)."""
        return np.asarray(self.spline(s)), np.asarray(self.spline(s, 1)), np.asarray(self.spline(s, 2))

    def extremes(self) -> tuple[FloatArray, FloatArray]:
        """Lowest and highest position of each joint, (n,) each, exact."""
        knots = self.spline(self.spline.x)
        low, high = knots.min(axis=0), knots.max(axis=0)
        turns = self.spline.derivative().roots(discontinuity=False, extrapolate=False)
        for i, places in enumerate(turns):
            finite = np.asarray(places)[np.isfinite(places)]
            if finite.size:
                values = self.spline(finite)[:, i]
                low[i], high[i] = min(low[i], values.min()), max(high[i], values.max())
        return low, high


def spline_through(points: FloatArray, places: FloatArray) -> SplinePath:
    """A path through `points` (m, n), m at least 2, at the rising `places` (m,) of s that begin at 0."""
    if points.shape[0] < 2 or not np.all(np.isfinite(points)) or not np.all(np.diff(places) > 0.0):
        raise InvalidValueError("points of a path", points.tolist(), "two or more of finite numbers, no two the same")
    return SplinePath(CubicSpline(places, points, axis=0, bc_type="natural"), float(places[-1]))


def chord_length(points: FloatArray, scale: FloatArray) -> FloatArray:
    """Places of `points` (m, n) by the length of the polygon through them, joints counted in `scale` (n,)."""
    steps = np.linalg.norm(np.diff(points, axis=0) / scale, axis=1)
    return np.concatenate([[0.0], np.cumsum(steps)])
