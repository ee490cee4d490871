"""Slew limits of steer angles and wheel rates, and slowing down while the steering is not where it should be.

Law, for one period dt:

1. e = the largest steer error of any wheel, commanded or measured against wanted.
2. Speed factor f = 1 for e <= e_full, 0 for e >= e_stop, linear between. All wheels take the same factor, so
   the centre of rotation of the wanted motion is kept and no wheel works against another.
3. Steering moves all wheels in the same proportion, the slowest of them at its rate limit, so that they arrive
   together: with the misses m and the largest of them m_max, the rates wanted are k m, k as large as the rate limits
   and a stop at the end with the acceleration a allow: n periods of -a from k m_max, n the least that can, end there.
   k m_max = m_max / (n dt) + (n - 1) a dt / 2,   n (n + 1) / 2 >= m_max / (a dt^2). The rates move towards these by
   one factor, with no wheel above a. If the commanded error is e_stop or more while a wheel still rolls, the steering
   comes to rest and waits until the wheels stand: a change of mode (curve to point turn, say) is stop, steer, go, and
   nothing is dragged sideways. What a wheel rolls because its own steering moves it does not count.
4. The rates move from their last value towards those asked for, in the same proportion for all wheels, with no
   wheel above its acceleration (away from zero) or deceleration (towards zero) at the rim.

With nothing wanted the caller passes the present angles (kinematics keeps them), so the steering never turns
at a stand unless a motion is asked for that needs it.

Source: own formulation; proportional scaling of all wheels is the usual way to keep the centre of rotation,
see Siegwart et al. (2011), section 3.2. Range: any dt for which a period's move is small against the limits'
meaning (dt <= 0.1 s).
"""

import math
from typing import NamedTuple

import numpy as np

from sojourn_flight.mobility.rolling_limits import RollingLimits
from sojourn_flight.mobility.rolling_lines import rolling_line
from sojourn_flight.mobility.rolling_params import SteeringTransitionParams
from sojourn_flight.mobility.wheel_table import WheelTableColumn
from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray

_RADIUS = int(WheelTableColumn.RADIUS)
_STEERED = int(WheelTableColumn.STEERED)
_MAX_STEER_RATE = int(WheelTableColumn.MAX_STEER_RATE)


class LimiterState(NamedTuple):
    """Last commands sent to the motors. Arrays have shape (wheels,)."""

    steer_angles: FloatArray
    """[rad]"""
    wheel_rates: FloatArray
    """[rad/s]"""
    steer_rates: FloatArray
    """[rad/s]"""

    @classmethod
    def at_rest(cls, steer_angles: FloatArray) -> "LimiterState":
        """Everything stands, the steering at these angles [rad]."""
        return cls(steer_angles, np.zeros_like(steer_angles), np.zeros_like(steer_angles))


class SteeringPace(NamedTuple):
    """How fast the steering may move."""

    rate: float
    """[rad/s]"""
    acceleration: float
    """[rad/s^2]"""


class SteeringLimits(NamedTuple):
    """How fast the steering may move, and how wheels and steering wait for each other."""

    rate: float
    """[rad/s]"""
    acceleration: float
    """[rad/s^2]"""
    full_speed_error: float
    """Steer error up to which the wheels roll at their full speed [rad]."""
    stop_error: float
    """From which they stand [rad]."""
    rolling_speed: float
    """Of a rim, above which a large move of the steering waits [m/s]."""


class SteeringStep(NamedTuple):
    """One period of the steering."""

    angles: FloatArray
    """New commands [rad], shape (wheels,)."""
    rates: FloatArray
    """Rate of the steering command in this period [rad/s], shape (wheels,)."""
    speed_factor: float
    """1 when the wheels may roll freely, 0 when they wait for the steering [-]."""
    error: float
    """Largest steer error, commanded or measured against wanted [rad]."""


@njit(cache=True)
def _arriving_rate(to_go: float, acceleration: float, dt: float) -> float:
    """Fastest rate [rad/s] from which periods of at most this deceleration [rad/s^2] end `to_go` [rad] ahead."""
    periods = max(math.ceil(math.sqrt(0.25 + 2.0 * to_go / (acceleration * dt * dt)) - 0.5 - 1e-9), 1.0)
    return to_go / (periods * dt) + 0.5 * (periods - 1.0) * acceleration * dt


@njit(cache=True)
def _steering_kernel(
    table: FloatArray,
    limits: SteeringLimits,
    angles: FloatArray,
    wheel_rates: FloatArray,
    steer_rates: FloatArray,
    wanted_angles: FloatArray,
    measured_angles: FloatArray,
    dt: float,
) -> tuple[FloatArray, FloatArray, float, float]:
    """The fields of a SteeringStep. Arrays one by one: as a LimiterState they take a microsecond more to hand over."""
    acceleration = limits.acceleration
    count = table.shape[0]
    new_angles, new_rates = np.empty(count), np.empty(count)
    command_error = 0.0
    error = 0.0
    gain = 1.0 / dt  # rate over miss
    rolling = False
    for i in range(count):
        if table[i, _STEERED] > 0.5:
            miss = abs(wanted_angles[i] - angles[i])
            command_error = max(command_error, miss)
            error = max(error, abs(wanted_angles[i] - measured_angles[i]))
            most = min(limits.rate, table[i, _MAX_STEER_RATE])
            if miss * gain > most:
                gain = most / miss
        _, _, _, own = rolling_line(table[i], angles[i], steer_rates[i])
        if abs(wheel_rates[i] * table[i, _RADIUS] - own) > limits.rolling_speed:
            rolling = True
    error = max(error, command_error)
    factor = min(max((limits.stop_error - error) / (limits.stop_error - limits.full_speed_error), 0.0), 1.0)
    if rolling and command_error >= limits.stop_error:
        gain = 0.0
    elif command_error > 0.0:
        gain = min(gain, _arriving_rate(command_error, acceleration, dt) / command_error)
    step = 1.0
    for i in range(count):
        change = abs(gain * (wanted_angles[i] - angles[i]) - steer_rates[i])
        if change * step > acceleration * dt:
            step = acceleration * dt / change
    arrives = step == 1.0 and gain * dt >= 1.0 - 1e-12
    for i in range(count):
        rate = steer_rates[i] + step * (gain * (wanted_angles[i] - angles[i]) - steer_rates[i])
        new_angles[i] = wanted_angles[i] if arrives else angles[i] + rate * dt
        new_rates[i] = (new_angles[i] - angles[i]) / dt
    return new_angles, new_rates, factor, error


@njit(cache=True)
def _rates_kernel(
    table: FloatArray,
    targets: FloatArray,
    rates: FloatArray,
    dt: float,
    acceleration: float,
    deceleration: float,
    new_rates: FloatArray,
) -> None:
    """Fills the rates that are commanded next [rad/s]."""
    step = 1.0
    for i in range(table.shape[0]):
        change = abs(targets[i] - rates[i])
        slowing = abs(targets[i]) < abs(rates[i]) and targets[i] * rates[i] >= 0.0
        most = (deceleration if slowing else acceleration) * dt / table[i, _RADIUS]
        if change * step > most:
            step = most / change
    for i in range(table.shape[0]):
        new_rates[i] = targets[i] if step == 1.0 else rates[i] + step * (targets[i] - rates[i])


def limit_steering(
    table: FloatArray,
    pace: SteeringPace,
    transition: SteeringTransitionParams,
    state: LimiterState,
    wanted_angles: FloatArray,
    measured_angles: FloatArray,
    dt: float,
    waits: bool = True,
) -> SteeringStep:
    """Next steering commands on the way from the last ones to the wanted ones.

    Args:
        table: wheels, from `SteeringGeometryParams.table()`.
        pace: of all wheels.
        transition: steer errors at which wheels slow down and stop.
        state: last commands.
        wanted_angles: [rad], shape (wheels,), float64.
        measured_angles: where the steering is [rad], shape (wheels,); a stuck motor keeps the wheels limits.
        dt: period [s], above 0.
        waits: whether a large move waits until the wheels stand; not where they roll along with the steering.
    """
    limits = SteeringLimits(
        float(pace.rate),
        float(pace.acceleration),
        transition.full_speed_error,
        transition.stop_error,
        transition.rolling_speed if waits else math.inf,
    )
    step = _steering_kernel(
        table,
        limits,
        state.steer_angles,
        state.wheel_rates,
        state.steer_rates,
        wanted_angles,
        measured_angles,
        float(dt),
    )
    return SteeringStep(*step)


def limit_rates(
    table: FloatArray, limits: RollingLimits, rates: FloatArray, targets: FloatArray, dt: float
) -> FloatArray:
    """Next wheel rates [rad/s], shape (wheels,), on the way from the last ones to those asked for."""
    new_rates = np.empty(table.shape[0])
    _rates_kernel(table, targets, rates, float(dt), limits.max_acceleration, limits.max_deceleration, new_rates)
    return new_rates


def stopping_speed(distance: float, deceleration: float) -> float:
    """Speed [m/s] from which a deceleration [m/s^2] comes to rest in a distance [m]."""
    return math.sqrt(2.0 * deceleration * max(distance, 0.0))
