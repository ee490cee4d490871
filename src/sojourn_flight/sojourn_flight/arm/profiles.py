"""Motions from rest to rest over a distance: the shapes of the textbooks, each as fast as its limits allow.

With distance D, limits of speed v, acceleration a, jerk j (Biagiotti & Melchiorri, Trajectory Planning for Automatic
Machines and Robots, 2008, chapters 2 and 3), the durations T are

    trapezoid   D/v + v/a, or triangular 2 sqrt(D/a) where D < v^2/a
    cubic       s = D (3 u^2 - 2 u^3),                u = t/T:  T = max(3D/2v, sqrt(6 D/a))
    quintic     s = D (10 u^3 - 15 u^4 + 6 u^5):                T = max(15D/8v, sqrt(10 D/(sqrt(3) a)))
    cycloidal   s = D (u - sin(2 pi u)/(2 pi)):                 T = max(2D/v, sqrt(2 pi D/a))
    seven segments of constant jerk, section 3.4: D/v + v/a + a/j where speed and acceleration reach their limits
Only the last one takes the jerk limit into account.

Several joints at once: one profile of the share of the way, within the limits that every joint's distance sets; so they
start and arrive together and move on a straight line in joint space.
"""

import math
from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray

Shape = Literal["trapezoid", "cubic", "quintic", "cycloidal", "seven_segments"]
SHAPES: tuple[Shape, ...] = ("trapezoid", "cubic", "quintic", "cycloidal", "seven_segments")


class Profile(Protocol):
    """A motion along one coordinate."""

    @property
    def duration(self) -> float:
        """[s]."""

    def sample(self, time: float) -> tuple[float, float, float]:
        """Place, speed, acceleration at `time` [s]; at rest before and after."""


class TimedPath(Protocol):
    """A motion of n joints in time: JointPath, TimedLine, TimedSpline."""

    @property
    def duration(self) -> float:
        """[s]."""

    def sample(self, time: float) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Position, velocity, acceleration (n,) each at `time` [s]."""

    def states(self, times: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """As `sample`, at `times` (m,): (m, n) each."""


@dataclass(frozen=True, slots=True)
class PolynomialProfile:
    """Pieces of polynomials: piece k starts at starts[k] and has the coefficients of rising powers of t - starts[k]."""

    starts: tuple[float, ...]  # [s]
    coefficients: tuple[tuple[float, ...], ...]
    duration: float

    def sample(self, time: float) -> tuple[float, float, float]:
        """Place, speed, acceleration at `time` [s]."""
        t = min(max(time, 0.0), self.duration)
        k = max(i for i, start in enumerate(self.starts) if start <= t)
        u, values = t - self.starts[k], [0.0, 0.0, 0.0]
        for coefficient in reversed(self.coefficients[k]):  # Horner, with its derivatives
            values[2] = values[2] * u + 2.0 * values[1]
            values[1] = values[1] * u + values[0]
            values[0] = values[0] * u + coefficient
        if time < 0.0 or time > self.duration:
            return values[0], 0.0, 0.0
        # at rest at the end, whatever rounding has made of a short last piece after a long way
        return values[0], 0.0 if time == self.duration else values[1], values[2]


@dataclass(frozen=True, slots=True)
class CycloidalProfile:
    """s = D (u - sin(2 pi u)/(2 pi))."""

    distance: float
    duration: float

    def sample(self, time: float) -> tuple[float, float, float]:
        """Place, speed, acceleration at `time` [s]."""
        t, total = min(max(time, 0.0), self.duration), self.duration
        if total == 0.0:
            return self.distance, 0.0, 0.0
        turn = 2.0 * math.pi * t / total
        speed = self.distance / total * (1.0 - math.cos(turn))
        acceleration = 2.0 * math.pi * self.distance / total**2 * math.sin(turn)
        return self.distance * (t / total - math.sin(turn) / (2.0 * math.pi)), speed, acceleration


@dataclass(frozen=True, slots=True, eq=False)
class TimedLine:
    """n joints on a straight line in joint space."""

    start: FloatArray  # (n,) [rad or m]
    way: FloatArray  # (n,) [rad or m]
    share: Profile  # of the way, 0 to 1

    @property
    def duration(self) -> float:
        """[s]."""
        return self.share.duration

    def sample(self, time: float) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Position, velocity, acceleration (n,) each at `time` [s]."""
        s, speed, acceleration = self.share.sample(time)
        return self.start + s * self.way, speed * self.way, acceleration * self.way

    def states(self, times: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """As `sample`, at `times` (m,): (m, n) each."""
        rows = [self.sample(float(time)) for time in times]
        return np.array([q for q, _, _ in rows]), np.array([v for _, v, _ in rows]), np.array([a for _, _, a in rows])


def rest_to_rest(
    shape: Shape, distance: float, speed: float, acceleration: float, jerk: float | None = None
) -> Profile:
    """The fastest profile of a shape over a distance of at least 0.

    Args:
        jerk: only seven_segments needs it and heeds it.

    Raises:
        InvalidValueError: a limit that is not above 0, a distance that is not finite or negative.
    """
    limits = {"speed": speed, "acceleration": acceleration}
    if shape == "seven_segments":
        limits["jerk"] = math.nan if jerk is None else jerk
    for name, value in limits.items():
        if not (value > 0.0 and math.isfinite(value)):
            raise InvalidValueError(f"{name} limit of a {shape} profile", value, "a finite number above 0")
    if not (distance >= 0.0 and math.isfinite(distance)):
        raise InvalidValueError(f"distance of a {shape} profile", distance, "a finite number of at least 0")
    if distance == 0.0:
        return PolynomialProfile((0.0,), ((0.0,),), 0.0)
    if shape == "trapezoid":
        return _trapezoid(distance, speed, acceleration)
    if shape == "seven_segments":
        return _seven_segments(distance, speed, acceleration, limits["jerk"])
    if shape == "cycloidal":
        total = max(2.0 * distance / speed, math.sqrt(2.0 * math.pi * distance / acceleration))
        return CycloidalProfile(distance, total)
    if shape == "cubic":
        total = max(1.5 * distance / speed, math.sqrt(6.0 * distance / acceleration))
        return PolynomialProfile((0.0,), ((0.0, 0.0, 3.0 * distance / total**2, -2.0 * distance / total**3),), total)
    total = max(1.875 * distance / speed, math.sqrt(10.0 / math.sqrt(3.0) * distance / acceleration))
    powers = (10.0 * distance / total**3, -15.0 * distance / total**4, 6.0 * distance / total**5)
    return PolynomialProfile((0.0,), ((0.0, 0.0, 0.0, *powers),), total)


def joint_motion(
    shape: Shape,
    start: FloatArray,
    goal: FloatArray,
    speed: FloatArray,
    acceleration: FloatArray,
    jerk: FloatArray | None = None,
) -> TimedLine:
    """All joints from `start` to `goal` (n,) together, within limits (n,) each.

    Raises:
        InvalidValueError: as `rest_to_rest`.
    """
    way = goal - start
    moving = np.abs(way) > 0.0
    if not np.any(moving):
        return TimedLine(start, way, PolynomialProfile((0.0,), ((0.0,),), 0.0))
    shares = [
        None if limits is None else float(np.min(limits[moving] / np.abs(way[moving])))
        for limits in (speed, acceleration, jerk)
    ]
    fastest, hardest, sharpest = shares
    if fastest is None or hardest is None:
        raise InvalidValueError("limits", None, "a speed and an acceleration for each joint")
    return TimedLine(start, way, rest_to_rest(shape, 1.0, fastest, hardest, sharpest))


def _trapezoid(distance: float, speed: float, acceleration: float) -> PolynomialProfile:
    top = min(speed, math.sqrt(distance * acceleration))
    ramp, total = top / acceleration, distance / top + top / acceleration
    rise = 0.5 * top * ramp
    return PolynomialProfile(
        (0.0, ramp, total - ramp),
        ((0.0, 0.0, 0.5 * acceleration), (rise, top), (distance - rise, top, -0.5 * acceleration)),
        total,
    )


def _seven_segments(distance: float, speed: float, acceleration: float, jerk: float) -> PolynomialProfile:
    if speed * jerk < acceleration**2:  # the acceleration's limit is not reached
        rise = math.sqrt(speed / jerk)
        ramp = 2.0 * rise
    else:
        rise = acceleration / jerk
        ramp = rise + speed / acceleration
    cruise = distance / speed - ramp
    if cruise < 0.0:  # the speed's limit is not reached
        cruise = 0.0
        if distance >= 2.0 * acceleration**3 / jerk**2:
            rise = acceleration / jerk
            ramp = 0.5 * rise + math.sqrt(0.25 * rise**2 + distance / acceleration)
        else:
            rise = (0.5 * distance / jerk) ** (1.0 / 3.0)
            ramp = 2.0 * rise
    hold = max(ramp - 2.0 * rise, 0.0)
    lengths = (rise, hold, rise, cruise, rise, hold, rise)
    signs = (1.0, 0.0, -1.0, 0.0, -1.0, 0.0, 1.0)
    time, p, v, a = 0.0, 0.0, 0.0, 0.0
    starts, coefficients = [], []
    for length, sign in zip(lengths, signs, strict=True):
        j = sign * jerk
        starts.append(time)
        coefficients.append((p, v, 0.5 * a, j / 6.0))
        p += length * (v + length * (0.5 * a + length * j / 6.0))
        v += length * (a + 0.5 * length * j)
        a += length * j
        time += length
    return PolynomialProfile(tuple(starts), tuple(coefficients), time)
