"""A motion of n joints as pieces of constant jerk: sampled at any time, checked exactly, a plain value.

Within a piece that starts at time s, with u = t - s:
    q = p + v u + a u^2/2 + j u^3/6,   qd = v + a u + j u^2/2,   qdd = a + j u.
Extremes of speed are at the ends of a piece or where u = -a/j; extremes of position where qd = 0. Before 0
and after `duration` the path stays at its first and last points (at rest).
"""

from dataclasses import dataclass

import numpy as np

from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray


@dataclass(frozen=True, slots=True)
class JointPath:
    """Pieces of constant jerk; piece k of joint i starts at starts[i, k]. Arrays (n, K), never written to."""

    starts: FloatArray  # [s], rising along k
    position: FloatArray  # [rad or m] at the start of the piece
    velocity: FloatArray  # [rad/s]
    acceleration: FloatArray  # [rad/s2]
    jerk: FloatArray  # [rad/s3]
    duration: float  # [s]

    def sample(self, time: float) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Position, velocity, acceleration (n,) each at `time` [s] after the start."""
        n = self.starts.shape[0]
        out = np.empty((3, n))
        sample_into(
            self.starts,
            self.position,
            self.velocity,
            self.acceleration,
            self.jerk,
            float(time),
            self.duration,
            out,
        )
        return out[0], out[1], out[2]

    def states(self, times: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """As `sample`, at `times` (m,) [s]: (m, n) each."""
        out = np.empty((times.shape[0], 3, self.starts.shape[0]))
        states_into(
            self.starts,
            self.position,
            self.velocity,
            self.acceleration,
            self.jerk,
            np.ascontiguousarray(times, dtype=np.float64),
            self.duration,
            out,
        )
        return out[:, 0], out[:, 1], out[:, 2]

    def samples(self, times: FloatArray) -> FloatArray:
        """Positions (m, n) at `times` (m,) [s]."""
        positions = np.empty((times.shape[0], self.starts.shape[0]))
        sample_many(
            self.starts,
            self.position,
            self.velocity,
            self.acceleration,
            self.jerk,
            times,
            self.duration,
            positions,
        )
        return positions

    def extremes(self) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]:
        """Exact lowest and highest position, largest |speed|, |acceleration|, |jerk|, each (n,)."""
        ends = np.concatenate([self.starts[:, 1:], np.full((self.starts.shape[0], 1), self.duration)], axis=1)
        length = np.maximum(ends - self.starts, 0.0)
        p, v, a, j = self.position, self.velocity, self.acceleration, self.jerk
        with np.errstate(divide="ignore", invalid="ignore"):
            turn = np.where(j != 0.0, -a / j, 0.0)
            root = np.sqrt(np.maximum(a * a - 2.0 * j * v, 0.0))
            first = np.where(j != 0.0, (-a - root) / j, np.where(a != 0.0, -v / a, 0.0))
            second = np.where(j != 0.0, (-a + root) / j, 0.0)
        instants = np.stack([np.zeros_like(length), length, turn, first, second])
        u = np.clip(np.nan_to_num(instants), 0.0, length)
        positions = p + u * (v + u * (a / 2.0 + u * j / 6.0))
        velocities = v + u * (a + u * j / 2.0)
        accelerations = a + u * j
        jerks = np.where(length > 0.0, np.abs(j), 0.0)
        return (
            positions.min(axis=(0, 2)),
            positions.max(axis=(0, 2)),
            np.abs(velocities).max(axis=(0, 2)),
            np.abs(accelerations).max(axis=(0, 2)),
            jerks.max(axis=1),
        )


def join(parts: list[JointPath]) -> JointPath:
    """One path that runs `parts` (at least one) one after the other."""
    offsets = np.concatenate([[0.0], np.cumsum([part.duration for part in parts])])
    return JointPath(
        starts=np.concatenate([part.starts + offset for part, offset in zip(parts, offsets[:-1], strict=True)], axis=1),
        position=np.concatenate([part.position for part in parts], axis=1),
        velocity=np.concatenate([part.velocity for part in parts], axis=1),
        acceleration=np.concatenate([part.acceleration for part in parts], axis=1),
        jerk=np.concatenate([part.jerk for part in parts], axis=1),
        duration=float(offsets[-1]),
    )


@njit(cache=True)
def sample_into(
    starts: FloatArray,
    position: FloatArray,
    velocity: FloatArray,
    acceleration: FloatArray,
    jerk: FloatArray,
    time: float,
    duration: float,
    out: FloatArray,
) -> None:
    """Write position, velocity, acceleration at `time` to the rows of out (3, n)."""
    t = min(max(time, 0.0), duration)
    for i in range(starts.shape[0]):
        k = max(int(np.searchsorted(starts[i], t, side="right")) - 1, 0)
        u = t - starts[i, k]
        out[0, i] = position[i, k] + u * (velocity[i, k] + u * (acceleration[i, k] / 2.0 + u * jerk[i, k] / 6.0))
        out[1, i] = velocity[i, k] + u * (acceleration[i, k] + u * jerk[i, k] / 2.0)
        out[2, i] = acceleration[i, k] + u * jerk[i, k]


@njit(cache=True)
def states_into(
    starts: FloatArray,
    position: FloatArray,
    velocity: FloatArray,
    acceleration: FloatArray,
    jerk: FloatArray,
    times: FloatArray,
    duration: float,
    out: FloatArray,
) -> None:
    """Write position, velocity, acceleration at every time (m,) to the rows of out (m, 3, n)."""
    for m in range(times.shape[0]):
        sample_into(starts, position, velocity, acceleration, jerk, times[m], duration, out[m])


@njit(cache=True)
def sample_many(
    starts: FloatArray,
    position: FloatArray,
    velocity: FloatArray,
    acceleration: FloatArray,
    jerk: FloatArray,
    times: FloatArray,
    duration: float,
    positions: FloatArray,
) -> None:
    """Write the position at every time (m,) to positions (m, n)."""
    out = np.empty((3, starts.shape[0]))
    for m in range(times.shape[0]):
        sample_into(starts, position, velocity, acceleration, jerk, times[m], duration, out)
        positions[m] = out[0]
