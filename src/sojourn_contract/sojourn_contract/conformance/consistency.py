"""Rates against positions: what a message calls a rate must be the change of what it calls a position.

Over one period the mean rate is (x_1 - x_0) / dt. It lies between the rates told at both ends, but for noise,
rounding and what happens within the period; so it must be within

    [min(v_0, v_1) - slack, max(v_0, v_1) + slack],   slack = tolerance + |v_1 - v_0| / 2

with the tolerance of the table. A jolt within the period, as of a wheel that meets a step, may leave the mean outside
of that. Who publishes the mean square S of what the rate was within the period less what is told at its end is judged
by what holds for every motion, since a mean's square is at most the mean square (Jensen),

    |(x_1 - x_0) / dt - v_1| <= sqrt(S) + tolerance

where that says more. So that nobody tells a spread for a fault, sqrt(S) counts up to LARGEST_SPREAD of the body's
speed: it does not gain by meeting the ground. Of a joint no spread is told. A wheel of radius r that rolls up an edge
of height h loses the part h / r of its rate at most (its centre turns about the edge), and most of it but for a moment:
the slack is more by the table's part p = h / r of the rate itself. That edge turns the joints between wheel and body,
too: its centre leaves the ground's direction by beta, cos beta = 1 - p, and rises at omega r sin beta, on an arm not
shorter than r. Where a wheel turns at omega a mean may be farther off by

    omega sin beta = omega sqrt(p (2 - p)),

if the rate told before that period lies, within the tolerance, between the mean rates of the periods before and after
it, as rates do that have not jumped. Those of a flipped sign, in degrees or of another joint do not.

A rate that may be taken over a window of several periods (an encoder's counts) lies
between the least and the greatest of the mean rates over the last period, the last two, and so on to the whole window,
within the tolerance alone. Degrees for
radians, a flipped sign, a rate in the wrong frame and a joint in another's place show here as soon as the rover moves.
"""

from collections import deque
from collections.abc import Callable, Sequence
from itertools import accumulate
from math import atan2, hypot, sqrt
from operator import attrgetter
from typing import Any

from sojourn_contract.conformance.findings import Finding
from sojourn_contract.conformance.observation import Observation
from sojourn_contract.stamps import CONTROL_PERIOD_NS, NANOSECONDS
from sojourn_contract.topic_types import FieldRule, Topic

LARGEST_SPREAD = 0.25
"""Part of a body's speed, or of its rate of turn, that it may be off within a period by what is told [-]."""
LONGEST_PERIODS = 5
"""Messages further apart than this are not compared."""

AXES = ["x", "y", "z"]
Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]


class RateRule:
    """Rates of one topic, of joints or of a body.

    Args:
        row: the topic. wheels: names of the joints of wheels, whose edges jolt the others of a message.
    """

    name = "rate of change"

    def __init__(self, row: Topic, wheels: Sequence[str] = ()) -> None:
        self._wheels = frozenset(wheels)
        rules = [rule for rule in row.fields if rule.rate_of]
        make: Callable[[FieldRule], _Joints | _Linear | _Angular]
        make = _Joints if row.type == "sensor_msgs/JointState" else _rate_of_body
        self._pairs = [(rule, make(rule)) for rule in rules]
        self._last: tuple[int, list[tuple[Sequence[Any], Sequence[float]]]] | None = None
        self._means: list[deque[Sequence[float]]] = [deque(maxlen=max(rule.rate_window, 2)) for rule in rules]
        self._names: list[str] = []
        self._excused = -LONGEST_PERIODS * CONTROL_PERIOD_NS - 1

    @staticmethod
    def applies(row: Topic) -> bool:
        """Whether a field of this row is the rate of another."""
        return any(rule.rate_of for rule in row.fields)

    def excuse(self, stamp: int) -> None:
        """Positions may be set anew at a stamp [ns], or in the LONGEST_PERIODS after it."""
        self._excused = stamp

    def judge(self, seen: Observation) -> list[Finding]:
        """Rates that do not agree with the change of their positions."""
        message = seen.message
        last = self._last
        if 0 <= seen.stamp - self._excused <= LONGEST_PERIODS * CONTROL_PERIOD_NS:
            last = None
        names = list(message.name) if hasattr(message, "name") else AXES
        now = [pair.read(message) for _, pair in self._pairs]
        self._last = (seen.stamp, now)
        same, self._names = names == self._names, names
        if last is None or not same or not 0 < seen.stamp - last[0] <= LONGEST_PERIODS * CONTROL_PERIOD_NS:
            for means in self._means:
                means.clear()
            return []
        dt = (seen.stamp - last[0]) / NANOSECONDS
        found = []
        for (rule, pair), means, before, after in zip(self._pairs, self._means, last[1], now, strict=True):
            means.append(pair.mean(before[0], after[0], dt))
            if len(means) >= rule.rate_window:
                found += self._compare(rule, means, before[1], after[1], _spread(rule, message))
        return found

    def _compare(
        self,
        rule: FieldRule,
        means: Sequence[Sequence[float]],
        v_0: Sequence[float],
        v_1: Sequence[float],
        spread: Sequence[float],
    ) -> list[Finding]:
        """Rates at both ends of a period against the mean rates of the periods of the window, the last one last; before
        those of a window of one there is the one before.
        """
        found = []
        believed = LARGEST_SPREAD * max(hypot(*v_0), hypot(*v_1)) if spread else 0.0
        for place, (name, a, b) in enumerate(zip(self._names, v_0, v_1, strict=False)):
            if rule.rate_window == 1:
                mean = means[-1][place]
                slack = rule.rate_tolerance + rule.rate_part * max(abs(a), abs(b))
                off = max(min(a, b) - mean, mean - max(a, b)) - slack - 0.5 * abs(b - a)
                if spread:
                    off = min(off, abs(mean - b) - min(spread[place], believed) - slack)
                if off > 0.0 and len(means) > 1:
                    low, high = sorted((means[-2][place], mean))
                    jumped = max(low - a, a - high) - rule.rate_tolerance
                    off = min(off, max(off - self._jolt(rule, (v_0, v_1)), jumped))
                change = f"{mean:.4g} {rule.unit}, the change of {rule.rate_of}"
            else:
                sums = accumulate(mean[place] for mean in reversed(means))
                over_last = [total / count for count, total in enumerate(sums, start=1)]
                low, high = min(over_last), max(over_last)
                off = max(low - b, b - high) - rule.rate_tolerance
                change = f"{low:.4g} to {high:.4g} {rule.unit}, the change of {rule.rate_of} in {len(means)} periods"
            if off > 0.0:
                path = f"{rule.path}.{name}" if self._names == AXES else f"{rule.path}[{name}]"
                found.append(Finding(path, b, f"{change}, within {rule.rate_tolerance:g}", off + rule.rate_tolerance))
        return found

    def _jolt(self, rule: FieldRule, rates: Sequence[Sequence[float]]) -> float:
        """How far the mean rate of a joint may be off by an edge under a wheel, with the rates at both ends [rad/s]."""
        turning = [abs(v) for told in rates for name, v in zip(self._names, told, strict=False) if name in self._wheels]
        return max(turning, default=0.0) * sqrt(rule.rate_part * (2.0 - rule.rate_part))


class _Joints:
    """Rates and positions of joints."""

    def __init__(self, rule: FieldRule) -> None:
        self._rates, self._positions = attrgetter(rule.path), attrgetter(rule.rate_of)

    def read(self, message: Any) -> tuple[Sequence[float], Sequence[float]]:
        """Positions and rates."""
        return self._positions(message).tolist(), self._rates(message).tolist()

    def mean(self, x_0: Sequence[float], x_1: Sequence[float], dt: float) -> list[float]:
        """Mean rates over `dt` [s]."""
        return [(after - before) / dt for before, after in zip(x_0, x_1, strict=False)]


class _Linear:
    """Velocity of a body in its own frame, and its position in the other."""

    def __init__(self, rule: FieldRule) -> None:
        self._rate, self._position = attrgetter(rule.path), attrgetter(rule.rate_of)
        self._orientation = attrgetter(rule.rate_of.removesuffix("position") + "orientation")

    def read(self, message: Any) -> tuple[tuple[float, ...], Vector]:
        """Position and orientation as one tuple, and velocity."""
        p, v = self._position(message), self._rate(message)
        return (p.x, p.y, p.z, *_quaternion(self._orientation(message))), (v.x, v.y, v.z)

    def mean(self, x_0: Sequence[float], x_1: Sequence[float], dt: float) -> Vector:
        """Mean velocity over `dt` [s], in the body's frame at its end."""
        a, b, c, w = x_1[3:]
        moved = ((x_1[0] - x_0[0]) / dt, (x_1[1] - x_0[1]) / dt, (x_1[2] - x_0[2]) / dt)
        return _rotate((-a, -b, -c, w), moved)


class _Angular:
    """Angular velocity of a body in its own frame, and its orientation."""

    def __init__(self, rule: FieldRule) -> None:
        self._rate, self._orientation = attrgetter(rule.path), attrgetter(rule.rate_of)

    def read(self, message: Any) -> tuple[Quaternion, Vector]:
        """Orientation and angular velocity."""
        w = self._rate(message)
        return _quaternion(self._orientation(message)), (w.x, w.y, w.z)

    def mean(self, x_0: Sequence[float], x_1: Sequence[float], dt: float) -> list[float]:
        """Mean angular velocity over `dt` [s]: the rotation vector of inverse(q_0) q_1 by the time."""
        a, b, c, d = -x_0[0], -x_0[1], -x_0[2], x_0[3]
        e, f, g, h = x_1
        x, y, z = d * e + a * h + b * g - c * f, d * f - a * g + b * h + c * e, d * g + a * f - b * e + c * h
        w = d * h - a * e - b * f - c * g
        sine = sqrt(x * x + y * y + z * z)
        factor = 2.0 / dt if sine < 1e-9 else 2.0 * atan2(sine, abs(w)) / sine / dt
        if w < 0.0:
            factor = -factor
        return [factor * x, factor * y, factor * z]


def _rate_of_body(rule: FieldRule) -> "_Linear | _Angular":
    return _Angular(rule) if rule.rate_of.endswith("orientation") else _Linear(rule)


def _spread(rule: FieldRule, message: Any) -> Sequence[float]:
    """Root mean square of what each component was within the period less what is told; empty where none is told."""
    if not rule.rate_spread:
        return ()
    covariance = attrgetter(rule.rate_spread)(message)
    size = round(sqrt(len(covariance)))
    diagonal = covariance[:: size + 1][rule.rate_spread_place :][: len(AXES)]
    return [sqrt(max(value, 0.0)) for value in diagonal]


def _quaternion(q: Any) -> Quaternion:
    return (q.x, q.y, q.z, q.w)


def _rotate(q: Quaternion, v: Vector) -> Vector:
    """v + 2 u x (u x v + w v), u the vector part of q."""
    a, b, c, w = q
    x, y, z = v
    s, t, u = b * z - c * y + w * x, c * x - a * z + w * y, a * y - b * x + w * z
    return (x + 2.0 * (b * u - c * t), y + 2.0 * (c * s - a * u), z + 2.0 * (a * t - b * s))
