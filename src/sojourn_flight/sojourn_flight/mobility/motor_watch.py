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

from sojourn_flight.mobility.rate_limiter import LimiterState
from sojourn_flight.mobility.wheel_table import WheelTableColumn
from sojourn_flight.supervision.params import MotionLimits, MotorWatchParams
from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray

BoolArray = NDArray[np.bool_]

MOVING = 0.1
"""A steering that moves faster than this part of its fastest is on its way; a wheel commanded less stands [-]."""
DRAGGED = 0.2
"""Part of `rate_error` that counts where the ground turns the wheel [-]."""
ANCHORED = 0.5
"""Part of its distance from base_link by which a wheel without its motor moves base_link in turning a radian [-]."""
SLOWEST_ERROR = 0.02
"""Rate [rad/s] below which no error counts."""
STEERED = int(WheelTableColumn.STEERED)
_NOT_MEASURED: FloatArray = np.empty(0)


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
    steer_doubt, drive_doubt, steer_failed, drive_failed, held = _watched(
        table, state.steer_doubt, state.drive_doubt, state.steer_failed, state.drive_failed, state.held,
        commanded.steer_angles, commanded.wheel_rates, steer_angles, steer_rates, wheel_rates,
        _NOT_MEASURED if wheel_efforts is None else wheel_efforts, params.steer_error, params.steer_time,
        params.rate_error, params.drive_time, limits.max_steer_rate, limits.max_wheel_rate, dt,
    )  # fmt: skip
    return MotorState(steer_doubt, drive_doubt, steer_failed, drive_failed, held)


@njit(cache=True)
def _watched(
    table: FloatArray, old_steer_doubt: FloatArray, old_drive_doubt: FloatArray, old_steer_failed: BoolArray,
    old_drive_failed: BoolArray, old_held: FloatArray, angles_commanded: FloatArray, rates_commanded: FloatArray,
    angles: FloatArray, steer_rates: FloatArray, rates: FloatArray, efforts: FloatArray, steer_error: float,
    steer_time: float, rate_error: float, drive_time: float, max_steer_rate: float, max_wheel_rate: float, dt: float,
) -> tuple[FloatArray, FloatArray, BoolArray, BoolArray, FloatArray]:  # fmt: skip
    """The fields of a MotorState after a period."""
    steer_doubt, drive_doubt = old_steer_doubt.copy(), old_drive_doubt.copy()
    steer_failed, drive_failed, held = old_steer_failed.copy(), old_drive_failed.copy(), old_held.copy()
    wrong = _does_not_follow(old_drive_failed, rates_commanded, rates, efforts, rate_error, MOVING * max_wheel_rate)
    for i in range(table.shape[0]):
        off = abs(angles_commanded[i] - angles[i]) > steer_error
        still = abs(steer_rates[i]) < MOVING * max_steer_rate
        jammed = table[i, STEERED] > 0.5 and off and still
        steer_doubt[i] = min(max(steer_doubt[i] + (dt if jammed else -dt), 0.0), steer_time)
        if steer_doubt[i] >= steer_time and not steer_failed[i]:
            steer_failed[i], held[i] = True, angles[i]
        drive_doubt[i] = min(max(drive_doubt[i] + (dt if wrong[i] else -dt), 0.0), drive_time)
        drive_failed[i] = drive_doubt[i] >= drive_time or (drive_failed[i] and drive_doubt[i] > 0.0)
    return steer_doubt, drive_doubt, steer_failed, drive_failed, held


@njit(cache=True)
def _does_not_follow(
    failed: BoolArray, commanded: FloatArray, rates: FloatArray, efforts: FloatArray, rate_error: float, least: float
) -> BoolArray:
    """Whether each drive motor misses its command; `least` is the smallest rate that counts as one [rad/s]."""
    size = np.abs(commanded)
    asked = size > least
    if not asked.any():
        return failed  # nothing is learnt: a failed motor stays one
    miss = np.abs(commanded - rates) / np.maximum(size, SLOWEST_ERROR / rate_error)
    others = asked & ~failed
    if np.median(miss[others] if others.any() else miss) > 0.5 * rate_error:
        return failed
    push = efforts * np.sign(commanded) if efforts.shape[0] else np.zeros_like(commanded)
    others_push = others.any() and np.median(push[others]) > 0.0
    wrong = failed.copy()
    for i in range(size.shape[0]):
        if asked[i]:
            dragged = others_push and push[i] < 0.0 and miss[i] > DRAGGED * rate_error
            wrong[i] = miss[i] > rate_error or dragged
    return wrong


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


def dragging_sigma(table: FloatArray, state: MotorState) -> float:
    """Error of the position in a turn that a wheel without its motor makes [m/rad^0.5].

    It stands in loose ground as an anchor: the machine turns about it as much as about the centre that is wanted. In
    half a turn on 5 degrees of lunar_nominal base_link of the explorer, 0.88 m from the wheel, went 0.3 to 1.5 m aside.
    """
    if not state.drive_failed.any():
        return 0.0
    failed = table[state.drive_failed]
    return ANCHORED * float(np.hypot(failed[:, WheelTableColumn.X], failed[:, WheelTableColumn.Y]).max())


def shortcoming(table: FloatArray, state: MotorState, names: tuple[str, ...]) -> str:
    """Why a goal cannot be driven to with the motors that are left; empty where it can."""
    if not (state.steer_failed.any() or state.drive_failed.any()):
        return ""
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
