"""The fastest timing of a path of joints under limits of speed, acceleration, torque and power.

On a path q(s):  qd = q' sd,  qdd = q' sdd + q'' sd^2, and so (Bobrow, Dubowsky & Gibson, IJRR 4(3), 1985)
    tau = m sdd + c sd^2 + b sd + g,   m = M q',  c = M q'' + c(q, q'),  b = viscous friction q',  g = gravity + Coulomb
friction in the sense of q'. So for a given s and sd every limit bounds sdd to an interval. Power drawn:
    P = sum over joints of max(0, tau_i qd_i) / efficiency
(what a joint that is driven backward gives is lost), at most the given watts: convex in sdd, again an interval.

Solved as in Pham & Pham, IEEE T-RO 34(3), 2018 (TOPP-RA): on a grid of s, backward the largest speed from which the end
can be reached at rest, forward the largest acceleration that stays below it. Limits are asked for at both ends of each
interval of the grid; then the motion is sampled between and, should a limit be passed by there, timed with a margin.
The acceleration jumps between intervals: jerk is not limited.
"""

import contextlib
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from sojourn_flight.arm.dynamics import coriolis_effort, gravity_effort, mass_matrix, rigid_effort
from sojourn_flight.arm.serial_arm import SerialArm
from sojourn_flight.arm.spline_path import SplinePath
from sojourn_machine.errors import InvalidValueError, MachineError
from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray

_MARGINS = (1.0, 0.997, 0.99, 0.97, 0.94, 0.9)
_ROUNDING = 1.0e-6
_GRIDS = (1, 2, 4, 8, 16)
"""Times as many intervals that are tried, where a sharp turn of the path is too much for a coarse grid."""
_CHECKS = 3
"""Samples within each interval of the grid that are checked in the end."""


class TimingError(MachineError):
    """The path cannot be followed within the limits, however slowly; the message says where."""


class JointLimits(NamedTuple):
    """Limits of n joints, arrays (n,); of the whole arm, the power drawn."""

    speed: FloatArray  # [rad/s or m/s]
    acceleration: FloatArray  # [rad/s2 or m/s2]
    effort: FloatArray  # [N m or N]
    power: float = np.inf  # [W]
    efficiency: float = 1.0  # of motors and gears [-]


class PathDynamics(NamedTuple):
    """Coefficients of the module header at the places of a grid, (k, n) each."""

    slope: FloatArray  # q'
    curve: FloatArray  # q''
    m: FloatArray
    c: FloatArray
    b: FloatArray
    g: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class TimedSpline:
    """A path of joints in time: constant sdd on each interval of the grid."""

    path: SplinePath
    places: FloatArray  # s of the grid (k,)
    rates: FloatArray  # sd there (k,) [1/s]
    times: FloatArray  # when it is there (k,) [s]

    @property
    def duration(self) -> float:
        """[s]."""
        return float(self.times[-1])

    def sample(self, time: float) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Position, velocity, acceleration (n,) each at `time` [s]; at rest before and after."""
        q, velocity, acceleration = self.states(np.array([time]))
        return q[0], velocity[0], acceleration[0]

    def states(self, times: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """As `sample`, at `times` (k,): (k, n) each."""
        t = np.clip(times, 0.0, self.duration)
        k = np.clip(np.searchsorted(self.times, t, side="right") - 1, 0, len(self.times) - 2)
        u, span = t - self.times[k], self.times[k + 1] - self.times[k]
        inside = (times >= 0.0) & (times <= self.duration)
        rate = np.where(inside, (self.rates[k + 1] - self.rates[k]) / span, 0.0)
        speed = np.where(inside, self.rates[k] + u * rate, 0.0)[:, None]
        places = np.minimum(self.places[k] + u * (self.rates[k] + 0.5 * u * rate), self.path.end)
        q, slope, curve = self.path.at(np.where(times > self.duration, self.path.end, places))
        return q, slope * speed, slope * rate[:, None] + curve * speed**2


def fastest_timing(
    arm: SerialArm, path: SplinePath, limits: JointLimits, gravity: FloatArray, intervals: int = 200
) -> TimedSpline:
    """The fastest motion along `path` from rest to rest.

    Args:
        gravity: in the base (3,) [m/s2].
        intervals: of the grid, evenly spread over s; up to 16 times as many where that is too coarse.

    Raises:
        TimingError: the arm cannot even hold itself somewhere on the path, or cannot leave it at rest.
    """
    for name in ("speed", "acceleration", "effort", "power", "efficiency"):
        if not np.all(np.asarray(getattr(limits, name)) > 0.0):
            raise InvalidValueError(f"{name} limit", getattr(limits, name), "above 0")
    for finer in _GRIDS[:-1]:
        with contextlib.suppress(TimingError):
            return _timed(arm, path, limits, gravity, finer * intervals)
    return _timed(arm, path, limits, gravity, _GRIDS[-1] * intervals)


def _timed(arm: SerialArm, path: SplinePath, limits: JointLimits, gravity: FloatArray, intervals: int) -> TimedSpline:
    """The fastest motion on one grid.

    Raises:
        TimingError: as `fastest_timing`, or a limit would be passed by between the places of the grid.
    """
    places = np.linspace(0.0, path.end, intervals + 1)
    coefficients = _coefficients(arm, path, places, gravity)
    for margin in _MARGINS:
        tight = limits._replace(
            speed=margin * limits.speed,
            acceleration=margin * limits.acceleration,
            effort=margin * limits.effort,
            power=float(margin * limits.power),
        )
        squared, failed = _solve(coefficients, tight, path.end / intervals)
        if failed >= 0:
            at = f"at {100.0 * failed / intervals:.0f} % of the path"
            raise TimingError(f"{at} the limits of effort or power are too small, however slowly it is followed")
        rates = np.sqrt(squared)
        spans = 2.0 * np.diff(places) / (rates[1:] + rates[:-1])
        timed = TimedSpline(path, places, rates, np.concatenate([[0.0], np.cumsum(spans)]))
        if largest_share(arm, timed, limits, gravity, _check_times(timed)) <= 1.0 + _ROUNDING:
            return timed
    raise TimingError(f"the limits are passed by between the {intervals} places that were looked at: use more")


def largest_share(
    arm: SerialArm, motion: TimedSpline, limits: JointLimits, gravity: FloatArray, times: FloatArray
) -> float:
    """The largest ratio of speed, acceleration, effort or power to its limit at `times` (k,) [s] of a motion."""
    worst = 0.0
    for q, qd, qdd in zip(*motion.states(times), strict=True):
        effort = rigid_effort(arm, q, qd, qdd, gravity) + _sliding_friction(arm, qd)
        drawn = float(np.sum(np.maximum(effort * qd, 0.0))) / limits.efficiency
        ratios = (np.abs(qd) / limits.speed, np.abs(qdd) / limits.acceleration, np.abs(effort) / limits.effort)
        worst = max(worst, drawn / limits.power, *(float(ratio.max()) for ratio in ratios))
    return worst


def _check_times(motion: TimedSpline) -> FloatArray:
    shares = (np.arange(_CHECKS) + 0.5) / _CHECKS
    return np.concatenate([motion.times[:-1] + share * np.diff(motion.times) for share in shares])


def _sliding_friction(arm: SerialArm, velocities: FloatArray) -> FloatArray:
    """Coulomb and viscous friction in the sense of the motion (n,): the breakaway of a start is not counted."""
    coulomb = np.where(velocities > 0.0, arm.friction.forward, -arm.friction.backward)
    return np.where(velocities != 0.0, coulomb, 0.0) + arm.friction.viscous * velocities


def _coefficients(arm: SerialArm, path: SplinePath, places: FloatArray, gravity: FloatArray) -> PathDynamics:
    positions, slopes, curves = path.at(places)
    rows = []
    for q, slope, curve in zip(positions, slopes, curves, strict=True):
        inertia = mass_matrix(arm, q)
        coulomb = np.where(slope >= 0.0, arm.friction.forward, -arm.friction.backward)
        still = gravity_effort(arm, q, gravity) + np.where(np.abs(slope) > 1e-9, coulomb, 0.0)
        turning = inertia @ curve + coriolis_effort(arm, q, slope)
        rows.append((inertia @ slope, turning, arm.friction.viscous * slope, still))
    m, c, b, g = (np.array(column) for column in zip(*rows, strict=True))
    return PathDynamics(np.ascontiguousarray(slopes), np.ascontiguousarray(curves), m, c, b, g)


@njit(cache=True)
def _solve(path: PathDynamics, limits: JointLimits, step: float) -> tuple[FloatArray, int]:
    """sd^2 on the grid (k,), `step` wide, and the place where it cannot be done or -1."""
    slope, speed, count = path.slope, limits.speed, path.slope.shape[0]
    top = np.zeros(count)  # the largest sd^2 from which the end can be reached
    for i in range(count - 2, -1, -1):
        high = 1e12
        for j in range(slope.shape[1]):
            if abs(slope[i, j]) > 1e-12:
                high = min(high, (speed[j] / slope[i, j]) ** 2)
        low = 0.0
        if not _reaches(i, 0.0, top[i + 1], path, limits, step):
            return top, i
        if _reaches(i, high, top[i + 1], path, limits, step):
            top[i] = high
            continue
        for _ in range(50):
            middle = 0.5 * (low + high)
            if _reaches(i, middle, top[i + 1], path, limits, step):
                low = middle
            else:
                high = middle
        top[i] = low
    x = np.zeros(count)
    for i in range(count - 1):
        lowest, highest = _interval(i, x[i], path, limits, step)
        highest = min(highest, 0.5 * (top[i + 1] - x[i]) / step)
        # where the interval is one point, rounding may leave nothing of it
        u = highest if lowest <= highest else 0.5 * (lowest + highest)
        x[i + 1] = max(min(x[i] + 2.0 * step * u, top[i + 1]), 0.0)
        if i + 1 < count - 1 and x[i + 1] < 1e-14:
            return x, i
    x[count - 1] = 0.0
    return x, -1


@njit(cache=True)
def _reaches(
    i: int,
    x: float,
    beyond: float,
    path: PathDynamics,
    limits: JointLimits,
    step: float,
) -> bool:
    """Whether from sd^2 = x at i some allowed sdd leads to sd^2 of at most `beyond` at the next place."""
    lowest, highest = _interval(i, x, path, limits, step)
    lowest = max(lowest, -0.5 * x / step)
    highest = min(highest, 0.5 * (beyond - x) / step)
    return bool(lowest <= highest + 1e-12 * (1.0 + abs(highest)))


@njit(cache=True)
def _interval(
    i: int,
    x: float,
    path: PathDynamics,
    limits: JointLimits,
    step: float,
) -> tuple[float, float]:
    """Allowed sdd at place i with sd^2 = x: by the limits there, and at the next place with the sd^2 it leads to."""
    slope, curve, m, c, b, g = path
    acceleration, effort, power = limits.acceleration, limits.effort, limits.power * limits.efficiency
    low, high = -1e12, 1e12
    rate = np.sqrt(x)
    for j in range(slope.shape[1]):
        for place in (i, i + 1):
            ahead = 2.0 * step * float(place - i)  # sd^2 there is x + ahead sdd
            low, high = _cut(slope[place, j] + ahead * curve[place, j], curve[place, j] * x, acceleration[j], low, high)
            still = c[place, j] * x + b[place, j] * rate + g[place, j]
            low, high = _cut(m[place, j] + ahead * c[place, j], still, effort[j], low, high)
    if power < 1e11 and low < high:
        low, high = _cut_by_power(i, x, path, power, step, low, high)
    return low, high


@njit(cache=True)
def _cut(factor: float, rest: float, limit: float, low: float, high: float) -> tuple[float, float]:
    """[low, high] cut to where |factor u + rest| <= limit."""
    if abs(factor) < 1e-12:
        return (low, high) if abs(rest) <= limit * (1.0 + 1e-9) else (1.0, -1.0)
    first, second = (-limit - rest) / factor, (limit - rest) / factor
    return max(low, min(first, second)), min(high, max(first, second))


@njit(cache=True)
def _cut_by_power(
    i: int,
    x: float,
    path: PathDynamics,
    power: float,
    step: float,
    low: float,
    high: float,
) -> tuple[float, float]:
    """[low, high] cut to where the power drawn is within its limit: between the roots of a convex function."""
    left, right = low, high
    for _ in range(45):  # the place of least power
        one, two = left + (right - left) / 3.0, right - (right - left) / 3.0
        if _drawn(i, x, one, path, step) <= _drawn(i, x, two, path, step):
            right = two
        else:
            left = one
    least = 0.5 * (left + right)
    for end in (low, high):  # at the edge of what is possible the least power is at an end, which thirds never reach
        if _drawn(i, x, end, path, step) < _drawn(i, x, least, path, step):
            least = end
    if _drawn(i, x, least, path, step) > power * (1.0 + 1e-9):
        return least + 1.0, least - 1.0
    for side in range(2):
        inside, outside = least, (low if side == 0 else high)
        if _drawn(i, x, outside, path, step) > power:
            for _ in range(40):
                middle = 0.5 * (inside + outside)
                if _drawn(i, x, middle, path, step) <= power:
                    inside = middle
                else:
                    outside = middle
            if side == 0:
                low = inside
            else:
                high = inside
    return low, high


@njit(cache=True)
def _drawn(
    i: int,
    x: float,
    u: float,
    path: PathDynamics,
    step: float,
) -> float:
    """The larger of the powers drawn at place i with sd^2 = x, and at the next one, with sdd = u [W]."""
    slope, m, c, b, g = path.slope, path.m, path.c, path.b, path.g
    largest = 0.0
    for place in (i, i + 1):
        square = max(x + 2.0 * step * float(place - i) * u, 0.0)
        rate = np.sqrt(square)
        total = 0.0
        for j in range(slope.shape[1]):
            effort = m[place, j] * u + c[place, j] * square + b[place, j] * rate + g[place, j]
            total += max(0.0, effort * slope[place, j] * rate)
        largest = max(largest, total)
    return largest
