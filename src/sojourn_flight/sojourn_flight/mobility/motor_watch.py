"""Motors that have failed: recognised from measurements, and what the others then have to do.

A steering motor has failed if its angle is off its command by more than `steer_error` and hardly moves, for
`steer_time` in all. A drive motor has failed if its rate misses the command by more than `rate_error`, for
`drive_time` in all; or by a fifth of that while the ground turns it (its torque is against its command, that of the
other wheels is not), as a dead motor is dragged along on firm ground. Where more than half of the wheels miss
their rates together, power or slope is the reason, and no motor is blamed. Times count down as they count up, so that
a moment of calm changes nothing and a wheel that was held up for a while is forgiven.

What follows from a failure:

- a locked steering keeps its angle: its limits become that angle, the wheel rolls with the part of the motion that is
  along it, and the other wheels turn about the centre of rotation that is wanted;
- the odometry no longer believes that such a wheel does not slide, nor that a wheel without its motor rolls;
- a drive motor is still commanded, and is taken back when it follows again. A steering motor is spared (it may pull
  at something that is jammed); a new goal gives it another try.

Source: own formulation. It follows practice on Mars: Opportunity drove for years with a steering actuator locked at 8
degrees, Spirit with a wheel that was dragged (Arvidson et al. 2011, J. Geophys. Res. 116:E00F15, section 2).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sojourn_flight.mobility.rate_limiter import LimiterState
from sojourn_flight.mobility.rolling_limits import RollingLimits
from sojourn_flight.mobility.rolling_params import MotorWatchParams
from sojourn_flight.mobility.wheel_table import WheelTableColumn
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


class MotorState(NamedTuple):
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
        return bool(np.count_nonzero(self.steer_failed) or np.count_nonzero(self.drive_failed))

    def steering_on_trial(self) -> "MotorState":
        """The steering motors get another try."""
        zeros, no = np.zeros_like(self.steer_doubt), np.zeros_like(self.steer_failed)
        return self._replace(steer_doubt=zeros, steer_failed=no)


class MeasuredMotors(NamedTuple):
    """What is measured of the motors. Arrays have shape (wheels,)."""

    steer_angles: FloatArray
    """[rad]"""
    steer_rates: FloatArray
    """[rad/s]"""
    wheel_rates: FloatArray
    """[rad/s]"""
    wheel_efforts: FloatArray
    """[N m]; shape (0,) where there is no such measurement."""


class MotorThresholds(NamedTuple):
    """From where on a motor does not follow: see the module header."""

    steer_error: float
    """[rad]"""
    steer_time: float
    """[s]"""
    rate_error: float
    """Part of the command [-]."""
    drive_time: float
    """[s]"""
    least_steer_rate: float
    """Of a steering that is on its way [rad/s]."""
    least_wheel_rate: float
    """Commanded of a wheel that does not stand [rad/s]."""


def watch_motors(
    params: MotorWatchParams,
    limits: RollingLimits,
    table: FloatArray,
    state: MotorState,
    commanded: LimiterState,
    measured: MeasuredMotors,
    dt: float,
) -> MotorState:
    """What is thought of the motors after one more period.

    Args:
        table: wheels, from `SteeringGeometryParams.table()`.
        commanded: last period's commands.
        dt: period [s].
    """
    thresholds = MotorThresholds(
        params.steer_error, params.steer_time, params.rate_error, params.drive_time,
        MOVING * limits.max_steer_rate, MOVING * limits.max_wheel_rate,
    )  # fmt: skip
    return _watched(table, state, commanded, measured, thresholds, dt)  # type: ignore[no-any-return]


@njit(cache=True)
def _watched(
    table: FloatArray,
    old: MotorState,
    commanded: LimiterState,
    measured: MeasuredMotors,
    thresholds: MotorThresholds,
    dt: float,
) -> MotorState:
    steer_doubt, drive_doubt = old.steer_doubt.copy(), old.drive_doubt.copy()
    steer_failed, drive_failed, held = old.steer_failed.copy(), old.drive_failed.copy(), old.held.copy()
    steer_time, drive_time = thresholds.steer_time, thresholds.drive_time
    wrong = _does_not_follow(old.drive_failed, commanded.wheel_rates, measured, thresholds)
    for i in range(table.shape[0]):
        off = abs(commanded.steer_angles[i] - measured.steer_angles[i]) > thresholds.steer_error
        still = abs(measured.steer_rates[i]) < thresholds.least_steer_rate
        jammed = table[i, STEERED] > 0.5 and off and still
        steer_doubt[i] = min(max(steer_doubt[i] + (dt if jammed else -dt), 0.0), steer_time)
        if steer_doubt[i] >= steer_time and not steer_failed[i]:
            steer_failed[i], held[i] = True, measured.steer_angles[i]
        drive_doubt[i] = min(max(drive_doubt[i] + (dt if wrong[i] else -dt), 0.0), drive_time)
        drive_failed[i] = drive_doubt[i] >= drive_time or (drive_failed[i] and drive_doubt[i] > 0.0)
    return MotorState(steer_doubt, drive_doubt, steer_failed, drive_failed, held)


@njit(cache=True)
def _does_not_follow(
    failed: BoolArray, commanded: FloatArray, measured: MeasuredMotors, thresholds: MotorThresholds
) -> BoolArray:
    """Whether each drive motor misses its command."""
    rates, efforts, rate_error = measured.wheel_rates, measured.wheel_efforts, thresholds.rate_error
    size = np.abs(commanded)
    asked = size > thresholds.least_wheel_rate
    if not asked.any():
        return failed  # nothing is learnt: a failed motor stays one
    miss = np.abs(commanded - rates) / np.maximum(size, SLOWEST_ERROR / rate_error)
    others = asked & ~failed
    if _lower_median(miss[others] if others.any() else miss) > 0.5 * rate_error:
        return failed
    push = efforts * np.sign(commanded) if efforts.shape[0] else np.zeros_like(commanded)
    others_push = others.any() and np.median(push[others]) > 0.0
    wrong = failed.copy()
    for i in range(size.shape[0]):
        if asked[i]:
            dragged = others_push and push[i] < 0.0 and miss[i] > DRAGGED * rate_error
            wrong[i] = miss[i] > rate_error or dragged
    return wrong


@njit(cache=True)
def _lower_median(values: FloatArray) -> float:
    """What at least half of them do not exceed: a half that follows is enough to tell who of the other half fails."""
    return float(np.sort(values)[(values.size - 1) // 2])


def commandable(table: FloatArray, state: MotorState) -> FloatArray:
    """The table with which wheels are commanded: a failed steering can only be where it is."""
    if not np.count_nonzero(state.steer_failed):
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
    if not state.any_failed:
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
