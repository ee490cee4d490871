"""Pause, go on, and stop softly at any moment of a motion, without leaving its path and within its limits.

The motion q(T) is run by a clock of its own: dT/dt = r, from 1 (as planned) to 0 (at rest on the path). Then
(Dahl & Nielsen, IEEE Trans. Robotics and Automation 6(5), 1990)
    qd = r q'(T),   qdd = r^2 q''(T) + dr/dt q'(T),   qddd = r^3 q'''(T) + 3 r dr/dt q''(T) + d2r/dt2 q'(T),
and what the limits leave beside the motion itself is for changing r. d2r/dt2 is constant over a period. Acceleration is
looked at `PARTS` times in a period, jerk as the mean between two of them; and as the motion's own jerk may jump within
such a part, with that of the part before and of the part after as well.

A change that is allowed now must not lead to where none is: with every choice for a period goes the way in which dr/dt
then fades, evenly, in a number of periods, and this is looked at to its end. So there is always a way to go on, that of
the period before; and once dr/dt is zero the motion is run at an even rate of at most 1, which is always within the
limits. Of the choices of `FADES` and `SHARES` the one is taken that changes the rate most in the sense that is wanted,
and does not run past the wanted rate.
"""

from dataclasses import dataclass

import numpy as np

from sojourn_flight.arm.profiles import TimedPath
from sojourn_machine.params import FloatArray

PARTS = 2
"""Looks at the acceleration in a period."""
FADES = (0, 1, 2, 3, 4, 6, 8, 11, 15, 20, 27, 36, 48, 64)
"""Periods in which dr/dt may fade."""
SHARES = (1.0, 0.85, 0.7, 0.55, 0.4, 0.3, 0.2, 0.12, 0.06, 0.02)
"""Of the largest change that a choice could make."""
_QUICKEST = 4.0
"""Largest |dr/dt| [1/s]."""
_SLACK = 1.0e-6
"""Of the limits: what follows from rounding when the same way is looked at again."""
_SAME = 1.0e-9
"""Difference of two rates that counts as none [-]."""


@dataclass(frozen=True, slots=True)
class PathClock:
    """Where a motion is: a plain value."""

    time: float = 0.0  # T, on the motion [s]
    rate: float = 0.0  # r [-]
    change: float = 0.0  # dr/dt [1/s]
    fade: int = 0  # periods in which it may fade within the limits


@dataclass(frozen=True, slots=True)
class ClockLimits:
    """What the joints may be asked for, (n,) each; the motion itself must be within them."""

    acceleration: FloatArray  # [rad/s2 or m/s2]
    jerk: FloatArray  # [rad/s3 or m/s3]; infinite for a motion whose own jerk is


def advance(motion: TimedPath, clock: PathClock, wanted: float, limits: ClockLimits, dt: float) -> PathClock:
    """The clock a period of `dt` [s] later; `wanted`: rate, 1 to run, 0 to pause or to stop, or any share between."""
    known = -clock.change / (clock.fade * dt) if clock.fade else 0.0
    leads_to = clock.rate + 0.5 * clock.change * clock.fade * dt
    if clock.change == 0.0 and abs(wanted - clock.rate) <= _SAME:
        return PathClock(min(clock.time + dt * wanted, motion.duration), wanted)
    if abs(leads_to - wanted) <= _SAME:
        return _after(motion, clock, known, max(clock.fade - 1, 0), dt)
    sense = 1.0 if wanted > leads_to else -1.0
    seconds, fades = _choices(motion, clock, sense, wanted, known, limits, dt)
    allowed = _are_within(motion, clock, seconds, fades, limits, dt)
    if not allowed.any():
        return _after(motion, clock, known, max(clock.fade - 1, 0), dt)
    best = int(np.argmax(np.where(allowed, sense * seconds, -np.inf)))
    return _after(motion, clock, float(seconds[best]), int(fades[best]), dt)


def sample(motion: TimedPath, clock: PathClock) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Position, velocity, acceleration (n,) each."""
    q, velocity, acceleration = motion.sample(clock.time)
    return q, clock.rate * velocity, clock.rate**2 * acceleration + clock.change * velocity


def _after(motion: TimedPath, clock: PathClock, second: float, fade: int, dt: float) -> PathClock:
    """The clock after a period with d2r/dt2 = `second`."""
    time = clock.time + dt * (clock.rate + dt * (0.5 * clock.change + dt * second / 6.0))
    rate = clock.rate + dt * (clock.change + 0.5 * dt * second)
    change = 0.0 if fade == 0 else clock.change + dt * second
    return PathClock(min(time, motion.duration), min(max(rate, 0.0), 1.0), change, fade)


def _choices(
    motion: TimedPath, clock: PathClock, sense: float, wanted: float, known: float, limits: ClockLimits, dt: float
) -> tuple[FloatArray, FloatArray]:
    """d2r/dt2 for this period, and the periods of fading after it, (k,) each: better than what is known."""
    longest = 2.0 * float(np.max(limits.acceleration / limits.jerk)) / dt
    fades = np.array([fade for fade in FADES if fade <= longest or fade < 2], dtype=np.float64)
    # r after the fading: rate + (change dt + second dt^2/2) + (change + second dt) fade dt/2
    exact = (wanted - clock.rate - clock.change * dt * (1.0 + 0.5 * fades)) / (0.5 * dt**2 * (1.0 + fades))
    exact[0] = -clock.change / dt  # to end the change within this period
    slope = np.abs(motion.sample(clock.time)[1])
    with np.errstate(divide="ignore"):
        by_jerk = float(np.min(2.0 * limits.jerk / np.maximum(slope, 1e-12)))
    most = min(by_jerk, (_QUICKEST - sense * clock.change) / dt)
    largest = np.minimum(sense * exact, most)
    steps = np.array(SHARES)[None, :] * (largest - sense * known)[:, None]
    steps = np.column_stack([steps, np.full(len(fades), -sense * known)])  # the change stays as it is
    seconds = sense * (sense * known + steps)
    seconds[0] = exact[0]
    keep = (steps > 0.0) & (sense * seconds <= (sense * exact * (1.0 + 1e-12) + _SAME)[:, None])
    keep[0] = (sense * seconds[0] > sense * known) & (np.arange(seconds.shape[1]) == 0)
    return seconds[keep], np.broadcast_to(fades[:, None], seconds.shape)[keep]


def _are_within(
    motion: TimedPath, clock: PathClock, seconds: FloatArray, fades: FloatArray, limits: ClockLimits, dt: float
) -> FloatArray:
    """Whether each choice (k,) keeps the limits until its change has faded."""
    if not len(seconds):
        return np.zeros(0, dtype=bool)
    part = dt / PARTS
    times = np.arange(PARTS * (int(fades.max()) + 1) + 2) * part  # and the part after the last
    first = np.minimum(times, dt)[None, :]
    then = np.clip(times - dt, 0.0, fades[:, None] * dt)
    second = seconds[:, None]
    rate = clock.rate + first * (clock.change + 0.5 * first * second)
    time = clock.time + first * (clock.rate + first * (0.5 * clock.change + first * second / 6.0))
    change_after = clock.change + dt * second
    fading = -change_after / (np.maximum(fades, 1.0) * dt)[:, None]
    time = time + then * (rate[:, -1:] + then * (0.5 * change_after + then * fading / 6.0))
    rate = rate + then * (change_after + 0.5 * then * fading)
    change = np.where(times[None, :] <= dt, clock.change + first * second, change_after + then * fading)
    done = times[None, :] > (1.0 + fades[:, None]) * dt + 1e-9
    _, velocities, accelerations = motion.states(time.ravel())
    shape = (*time.shape, -1)
    asked = rate[..., None] ** 2 * accelerations.reshape(shape) + change[..., None] * velocities.reshape(shape)
    over = np.any(np.abs(asked) > limits.acceleration * (1.0 + _SLACK), axis=2)
    earlier = motion.states(np.array([max(clock.time - clock.rate * part, 0.0)]))[2]
    own = rate[:, 1:, None] ** 2 * np.diff(accelerations.reshape(shape), axis=1) / part
    own_before = clock.rate**2 * (accelerations[:1] - earlier) / part
    over[:, 1:] |= _are_over(np.diff(asked, axis=1) / part, own, own_before, limits.jerk * (1.0 + _SLACK))
    beyond = (rate < -_SAME) | (rate > 1.0 + _SAME)  # a longer fade of less change may well lead further
    return np.asarray(~np.any((over | beyond) & ~done, axis=1))


def _are_over(jerks: FloatArray, own: FloatArray, own_before: FloatArray, limits: FloatArray) -> FloatArray:
    """Whether the mean jerk (k, parts, n) of each part is over its limit, wherever in it the motion's own jumps.

    Args:
        own: of it the motion's (k, parts, n). own_before: that of the part before them (1, n).
    """
    first = np.broadcast_to(own_before, own[:, :1].shape)
    jumps = np.diff(np.concatenate((first, own, own[:, -1:]), axis=1), axis=1)
    after, before = jumps[:, 1:], -jumps[:, :-1]
    most = jerks + np.maximum(np.maximum(after, before), 0.0)
    least = jerks + np.minimum(np.minimum(after, before), 0.0)
    return np.asarray(np.any((most > limits) | (least < -limits), axis=2))
