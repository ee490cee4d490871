"""Slew limits of steer angles and wheel rates, and slowing down while the steering is not where it should be.

Law, for one period dt:

1. e = the largest steer error of any wheel, commanded or measured against wanted.
2. Speed factor f = 1 for e <= e_full, 0 for e >= e_stop, linear between. All wheels take the same factor, so
   the centre of rotation of the wanted motion is kept and no wheel works against another.
3. Steering moves all wheels in the same proportion, the farthest at its rate limit, so that they arrive
   together. If the commanded error is e_stop or more while a wheel still rolls, the steering waits until the
   wheels stand: a change of mode (curve to point turn, say) is stop, steer, go, and nothing is dragged
   sideways.
4. The rates move from their last value towards f x wanted, in the same proportion for all wheels, with no
   wheel above its acceleration (away from zero) or deceleration (towards zero) at the rim.

With nothing wanted the caller passes the present angles (kinematics keeps them), so the steering never turns
at a stand unless a motion is asked for that needs it.

Source: own formulation; proportional scaling of all wheels is the usual way to keep the centre of rotation,
see Siegwart et al. (2011), section 3.2. Range: any dt for which a period's move is small against the limits'
meaning (dt <= 0.1 s).
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numba import njit

from sojourn_mechanics.params import FloatArray
from sojourn_mechanics.steering.params import MotionLimits, SteeringTransitionParams


@dataclass(frozen=True, slots=True)
class LimiterState:
    """Last commands sent to the motors. Arrays have shape (wheels,)."""

    steer_angles: FloatArray
    """[rad]"""
    wheel_rates: FloatArray
    """[rad/s]"""


class LimiterOutput(NamedTuple):
    """Result of one period of the limiter."""

    state: LimiterState
    """New commands."""
    steer_rates: FloatArray
    """Rate of the steering command in this period [rad/s], shape (wheels,)."""
    speed_factor: float
    """1 when the wheels may roll freely, 0 when they wait for the steering [-]."""
    steer_error: float
    """Largest steer error, commanded or measured against wanted [rad]."""


@njit(cache=True)
def _limit_kernel(
    table: FloatArray,
    wanted_angles: FloatArray,
    wanted_rates: FloatArray,
    angles: FloatArray,
    rates: FloatArray,
    measured_angles: FloatArray,
    dt: float,
    max_steer_rate: float,
    acceleration: float,
    deceleration: float,
    full_speed_error: float,
    stop_error: float,
    rolling_speed: float,
    new_angles: FloatArray,
    new_rates: FloatArray,
    steer_rates: FloatArray,
) -> tuple[float, float]:
    """One period; fills the last three arrays and gives the speed factor and the largest steer error."""
    count = table.shape[0]
    command_error = 0.0
    error = 0.0
    rolling = False
    for i in range(count):
        if table[i, 3] > 0.5:
            command_error = max(command_error, abs(wanted_angles[i] - angles[i]))
            error = max(error, abs(wanted_angles[i] - measured_angles[i]))
        if abs(rates[i]) * table[i, 2] > rolling_speed:
            rolling = True
    error = max(error, command_error)
    factor = min(max((stop_error - error) / (stop_error - full_speed_error), 0.0), 1.0)

    move = 1.0
    if command_error > max_steer_rate * dt:
        move = max_steer_rate * dt / command_error
    if rolling and command_error >= stop_error:
        move = 0.0
    step = 1.0
    for i in range(count):
        new_angles[i] = wanted_angles[i] if move == 1.0 else angles[i] + move * (wanted_angles[i] - angles[i])
        steer_rates[i] = (new_angles[i] - angles[i]) / dt
        target = factor * wanted_rates[i]
        change = abs(target - rates[i])
        slowing = abs(target) < abs(rates[i]) and target * rates[i] >= 0.0
        most = (deceleration if slowing else acceleration) * dt / table[i, 2]
        if change * step > most:
            step = most / change
    for i in range(count):
        target = factor * wanted_rates[i]
        new_rates[i] = target if step == 1.0 else rates[i] + step * (target - rates[i])
    return factor, error


def limit_rates(
    table: FloatArray,
    limits: MotionLimits,
    transition: SteeringTransitionParams,
    state: LimiterState,
    wanted_angles: FloatArray,
    wanted_rates: FloatArray,
    measured_angles: FloatArray,
    dt: float,
) -> LimiterOutput:
    """Next commands on the way from the last ones to the wanted ones.

    Args:
        table: wheels, from `SteeringGeometryParams.table()`.
        limits: rate and acceleration limits.
        transition: steer errors at which wheels slow down and stop.
        state: last commands.
        wanted_angles: [rad], shape (wheels,), float64.
        wanted_rates: [rad/s], shape (wheels,), float64.
        measured_angles: where the steering is [rad], shape (wheels,); a stuck motor keeps the wheels waiting.
        dt: period [s], above 0.
    """
    count = table.shape[0]
    angles, rates, steer_rates = np.empty(count), np.empty(count), np.empty(count)
    factor, error = _limit_kernel(
        table,
        wanted_angles,
        wanted_rates,
        state.steer_angles,
        state.wheel_rates,
        measured_angles,
        float(dt),
        limits.max_steer_rate,
        limits.max_acceleration,
        limits.max_deceleration,
        transition.full_speed_error,
        transition.stop_error,
        transition.rolling_speed,
        angles,
        rates,
        steer_rates,
    )
    return LimiterOutput(LimiterState(angles, rates), steer_rates, factor, error)


def stopping_speed(distance: float, deceleration: float) -> float:
    """Speed [m/s] from which a deceleration [m/s^2] comes to rest in a distance [m]."""
    return math.sqrt(2.0 * deceleration * max(distance, 0.0))
