"""Motors that have failed: recognised from measurements, and what the others then have to do.

A steering motor has failed if its angle is off its command by more than `steer_error` and hardly moves, for
`steer_time` in all. A drive motor has failed if its rate misses the command by more than `rate_error`, for
`drive_time` in all; or by a fifth of that while the ground turns it (its torque is against its command, that of the
other wheels is not), as a dead motor is dragged along on firm ground. Where most wheels miss their rates together,
power or slope is the reason, and no motor is blamed. Times count down as they count up, so that a moment of calm
changes nothing and a wheel that was held up for a while is forgiven.

What follows from a failure:

- a locked steering keeps its angle: its limits become that angle, the wheel rolls with the part of the motion that is
  along it, and the other wheels turn about the centre of rotation that is wanted;
- the odometry no longer believes that such a wheel does not slide, nor that a wheel without its motor rolls;
- a drive motor is still commanded, and is taken back when it follows again. A steering motor is spared (it may pull
  at something that is jammed); a new goal gives it another try.

Source: own formulation. It follows practice on Mars: Opportunity drove for years with a steering actuator locked at 8
degrees, Spirit with a wheel that was dragged (Arvidson et al. 2011, J. Geophys. Res. 116:E00F15, section 2).
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sojourn_mechanics.params import FloatArray
from sojourn_mechanics.steering.params import MotionLimits, MotorWatchParams
from sojourn_mechanics.steering.rate_limiter import LimiterState
from sojourn_mechanics.steering.wheel_table import WheelTableColumn

BoolArray = NDArray[np.bool_]

MOVING = 0.1
"""A steering that moves faster than this part of its fastest is on its way; a wheel commanded less stands [-]."""
DRAGGED = 0.2
"""Part of `rate_error` that counts where the ground turns the wheel [-]."""
SLOWEST_ERROR = 0.02
"""Rate [rad/s] below which no error counts."""


@dataclass(frozen=True, slots=True)
class MotorState:
    """What is thought of each motor. Arrays have shape (wheels,)."""

    steer_doubt: FloatArray
    drive_doubt: FloatArray
    """Time for which the motor has not followed, less that for which it has [s]."""
    steer_failed: BoolArray
    drive_failed: BoolArray
    held: FloatArray
    """Angles at which the failed steering stands [rad]."""

    @classmethod
    def unsuspected(cls, wheels: int) -> "MotorState":
        """All motors are well."""
        zeros, no = np.zeros(wheels), np.zeros(wheels, dtype=np.bool_)
        return cls(zeros, zeros, no, no, zeros)

    @property
    def any_failed(self) -> bool:
        """Whether there is any failure."""
        return bool(self.steer_failed.any() or self.drive_failed.any())

    def steering_on_trial(self) -> "MotorState":
        """The steering motors get another try."""
        return replace(self, steer_doubt=np.zeros_like(self.steer_doubt), steer_failed=np.zeros_like(self.steer_failed))


def watch_motors(
    params: MotorWatchParams,
    limits: MotionLimits,
    table: FloatArray,
    state: MotorState,
    commanded: LimiterState,
    steer_angles: FloatArray,
    steer_rates: FloatArray,
    wheel_rates: FloatArray,
    wheel_efforts: FloatArray | None,
    dt: float,
) -> MotorState:
    """What is thought of the motors after one more period; arrays have shape (wheels,).

    Args:
        table: wheels, from `SteeringGeometryParams.table()`.
        commanded: last period's commands.
        steer_angles [rad], steer_rates [rad/s], wheel_rates [rad/s], wheel_efforts [N m]: measured; no efforts where
            there is no such measurement.
        dt: period [s].
    """
    steered = table[:, WheelTableColumn.STEERED] > 0.5
    off = np.abs(commanded.steer_angles - steer_angles) > params.steer_error
    still = np.abs(steer_rates) < MOVING * limits.max_steer_rate
    steer_doubt = _counted(state.steer_doubt, steered & off & still, params.steer_time, dt)
    newly = (steer_doubt >= params.steer_time) & ~state.steer_failed
    held = np.where(newly, steer_angles, state.held) if newly.any() else state.held
    drive_doubt = _counted(
        state.drive_doubt,
        _does_not_follow(params, limits, state.drive_failed, commanded.wheel_rates, wheel_rates, wheel_efforts),
        params.drive_time,
        dt,
    )
    drive_failed = (drive_doubt >= params.drive_time) | (state.drive_failed & (drive_doubt > 0.0))
    return MotorState(steer_doubt, drive_doubt, state.steer_failed | newly, drive_failed, held)


def _counted(doubt: FloatArray, wrong: BoolArray, most: float, dt: float) -> FloatArray:
    """Time of doubt, up while something is wrong and down while not [s]."""
    return np.minimum(np.maximum(np.where(wrong, doubt + dt, doubt - dt), 0.0), most)


def _does_not_follow(
    params: MotorWatchParams,
    limits: MotionLimits,
    failed: BoolArray,
    commanded: FloatArray,
    rates: FloatArray,
    efforts: FloatArray | None,
) -> BoolArray:
    asked = np.abs(commanded) > MOVING * limits.max_wheel_rate
    if not asked.any():
        return failed  # nothing is learnt: a failed motor stays one
    miss = np.abs(commanded - rates) / np.maximum(np.abs(commanded), SLOWEST_ERROR / params.rate_error)
    if np.median(miss[asked & ~failed] if (asked & ~failed).any() else miss) > 0.5 * params.rate_error:
        return failed
    wrong = miss > params.rate_error
    if efforts is not None:
        push = efforts * np.sign(commanded)
        others = asked & ~failed
        if others.any() and np.median(push[others]) > 0.0:
            wrong |= (push < 0.0) & (miss > DRAGGED * params.rate_error)
    return np.asarray(np.where(asked, wrong, failed))


def commandable(table: FloatArray, state: MotorState) -> FloatArray:
    """The table with which wheels are commanded: a failed steering can only be where it is."""
    if not state.steer_failed.any():
        return table
    rest = table.copy()
    for column in (WheelTableColumn.STEER_MIN, WheelTableColumn.STEER_MAX):
        rest[state.steer_failed, column] = state.held[state.steer_failed]
    return rest


def believable(table: FloatArray, state: MotorState) -> FloatArray:
    """The table from which the wheels' motion is told: failed wheels slide or do not roll as they turn."""
    if not state.any_failed:
        return table
    rest = table.copy()
    rest[state.steer_failed, WheelTableColumn.SLIDE_WEIGHT] = 0.0
    rest[state.drive_failed, WheelTableColumn.ROLL_WEIGHT] = 0.0
    return rest


def shortcoming(table: FloatArray, state: MotorState, names: tuple[str, ...]) -> str:
    """Why a goal cannot be driven to with the motors that are left; empty where it can."""
    steered = table[:, WheelTableColumn.STEERED] > 0.5
    if steered.any() and state.steer_failed[steered].all():
        return f"no steering follows its command: {_list(names, state.steer_failed)}"
    if 2 * int(state.drive_failed.sum()) > len(names):
        return f"most wheels have no drive: {_list(names, state.drive_failed)}"
    return ""


def failures(state: MotorState, names: tuple[str, ...]) -> str:
    """The failed motors in words; empty where there are none."""
    found = [
        f"steering of {names[i]} stands at {np.degrees(state.held[i]):.1f} degrees"
        for i in np.flatnonzero(state.steer_failed)
    ]
    found += [f"drive of {names[i]} does not follow" for i in np.flatnonzero(state.drive_failed)]
    return "; ".join(found)


def _list(names: tuple[str, ...], chosen: BoolArray) -> str:
    return ", ".join(names[i] for i in np.flatnonzero(chosen))
