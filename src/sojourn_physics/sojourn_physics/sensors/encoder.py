"""Joint encoders: quantised position, and rate from the difference of counts over a window.

Equations. An encoder of b bits on a shaft that turns `ratio` times for one turn of the joint resolves d = 2
pi / (2^b ratio) at the joint (ratio 1 on the output side). It counts n = floor(q/d + 1/2), over many turns
and with sign, and reports q' = n d, so |q' - q| <= d/2. The rate over the last w periods is (n_k - n_(k-w))
d / (w dt); it lags by half the window and its error against the mean rate of the window is at most d / (w
dt) (Petrella et al. 2007, "Speed measurement algorithms for low-resolution incremental encoder equipped
drives", fixed-time method).

Assumptions: no eccentricity, no missed counts; backlash and flexibility between motor and output are the
actuator's. Deterministic: no random numbers. The period dt is constant from one step to the next. Range:
|q/d| below 2^52, beyond which a float no longer resolves a count.
"""

from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray, IntArray
from sojourn_physics.sensors.angle_sensor import AngleSensorParams


class EncoderParams(AngleSensorParams):
    """One encoder."""

    kind: str = Field(default="encoder", exclude=True, description="kind of angle sensor")
    bits: int = Field(ge=4, le=32, description="counts of a turn of the encoder's shaft, as a power of two [1]")

    @property
    def resolution(self) -> float:
        """Angle of one count at the joint [rad]."""
        return float(2.0 * pi / (2.0**self.bits * self.gear_ratio))


@dataclass(frozen=True, eq=False, slots=True)
class EncoderBank:
    """The encoders of n joints as columns."""

    resolution: FloatArray
    """Angle of one count, shape (n,) [rad]."""
    window: IntArray
    """Periods of the rate, shape (n,) [1]."""


@dataclass(frozen=True, eq=False, slots=True)
class EncoderState:
    """The counts that the rates need."""

    history: FloatArray
    """Counts (whole numbers), newest first, shape (largest window + 1, n)."""
    filled: int
    """Periods since the reset, at most the largest window [1]."""


def bank(encoders: tuple[EncoderParams, ...]) -> EncoderBank:
    """Columns of the encoders of n joints."""
    return EncoderBank(
        resolution=np.array([encoder.resolution for encoder in encoders], dtype=np.float64),
        window=np.array([encoder.rate_window for encoder in encoders], dtype=np.int64),
    )


def counts(resolution: FloatArray, position: FloatArray) -> FloatArray:
    """Counts at joint positions [rad], shape (n,); whole numbers."""
    whole: NDArray[np.float64] = np.floor(position / resolution + 0.5)
    return whole


def initial_state(encoders: EncoderBank, position: FloatArray) -> EncoderState:
    """Encoders of joints at rest at `position` [rad], shape (n,)."""
    now = counts(encoders.resolution, position)
    depth = int(encoders.window.max()) + 1 if encoders.window.size else 1
    return EncoderState(history=np.tile(now, (depth, 1)), filled=0)


def step(
    encoders: EncoderBank, state: EncoderState, position: FloatArray, dt: float
) -> tuple[EncoderState, FloatArray, FloatArray]:
    """Read joints at `position` [rad], shape (n,), one period of `dt` [s] after the last reading.

    Returns:
        the state, the measured position [rad] and the measured rate [rad/s], both of shape (n,).
    """
    filled = min(state.filled + 1, state.history.shape[0] - 1)
    history, measured, rate = _read(encoders.resolution, encoders.window, state.history, filled, position, dt)
    return EncoderState(history=history, filled=filled), measured, rate


@njit(cache=True)
def _read(
    resolution: FloatArray,
    window: IntArray,
    history: FloatArray,
    filled: int,
    position: FloatArray,
    dt: float,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """The history with the new counts in front, positions [rad] and rates [rad/s]."""
    now = np.empty_like(history)
    now[1:] = history[:-1]
    measured = np.empty_like(position)
    rate = np.empty_like(position)
    for i in range(position.shape[0]):
        now[0, i] = np.floor(position[i] / resolution[i] + 0.5)
        measured[i] = now[0, i] * resolution[i]
        periods = min(window[i], filled)
        rate[i] = (now[0, i] - now[periods, i]) * resolution[i] / (periods * dt)
    return now, measured, rate
