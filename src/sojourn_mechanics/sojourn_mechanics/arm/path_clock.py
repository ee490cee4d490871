"""Pause, go on, and stop softly at any moment of a motion, without leaving its path and within its limits.

The motion q(T) is run by a clock of its own: dT/dt = r, from 1 (as planned) to 0 (at rest on the path). Then
(Dahl & Nielsen, IEEE Trans. Robotics and Automation 6(5), 1990)
    qd = r q'(T),   qdd = r^2 q''(T) + (dr/dt) q'(T),
and what the limits of acceleration leave beside r^2 q'' is for changing r. Speeds are never above those planned; where
a joint already uses all of its acceleration, the clock waits (dr/dt = 0 is always allowed). A period is taken with
constant dr/dt and asked for at its beginning and its end, and at `INNER` moments between. Jerk is not limited: a change
of dr/dt is a step of acceleration.
"""

from dataclasses import dataclass

import numpy as np

from sojourn_mechanics.arm.profiles import TimedPath
from sojourn_mechanics.params import FloatArray

INNER = 3
_BISECTIONS = 12
_SLACK = 1.0e-9


@dataclass(frozen=True, slots=True)
class PathClock:
    """Where a motion is: a plain value."""

    time: float = 0.0  # T, on the motion [s]
    rate: float = 0.0  # r [-]
    change: float = 0.0  # dr/dt of the last period [1/s]


def advance(
    motion: TimedPath, clock: PathClock, wanted_rate: float, acceleration: FloatArray, dt: float, quickest: float = 4.0
) -> PathClock:
    """The clock a period later.

    Args:
        wanted_rate: 1 to run, 0 to pause or to stop, or any share between.
        acceleration: limits (n,) [rad/s2 or m/s2]; the motion itself must be within them.
        dt: period [s].
        quickest: largest change of the rate [1/s].
    """
    asked = float(np.clip((wanted_rate - clock.rate) / dt, -quickest, quickest))
    allowed, refused = 0.0, asked
    if _is_within(motion, clock, asked, acceleration, dt):
        allowed = asked
    else:
        for _ in range(_BISECTIONS):
            middle = 0.5 * (allowed + refused)
            if _is_within(motion, clock, middle, acceleration, dt):
                allowed = middle
            else:
                refused = middle
    time = clock.time + dt * (clock.rate + 0.5 * dt * allowed)
    return PathClock(min(time, motion.duration), min(max(clock.rate + dt * allowed, 0.0), 1.0), allowed)


def sample(motion: TimedPath, clock: PathClock) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Position, velocity, acceleration (n,) each, as they are at the end of the period that led to `clock`."""
    q, velocity, acceleration = motion.sample(clock.time)
    return q, clock.rate * velocity, clock.rate**2 * acceleration + clock.change * velocity


def _is_within(motion: TimedPath, clock: PathClock, change: float, limits: FloatArray, dt: float) -> bool:
    for u in np.linspace(0.0, dt, INNER + 2):
        rate = clock.rate + u * change
        _, velocity, acceleration = motion.sample(clock.time + u * (clock.rate + 0.5 * u * change))
        if np.any(np.abs(rate**2 * acceleration + change * velocity) > limits * (1.0 + _SLACK)):
            return False
    return True
