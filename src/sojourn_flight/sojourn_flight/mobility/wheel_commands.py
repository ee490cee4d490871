"""From the twist wanted to the next motor commands: kinematics, slew limits, and the slip that is expected.

Order of a period: steer angles for the twist; the next step of the steering and what speed it leaves (`rate_limiter`);
the rates with which the wheels roll at that speed; those faster by the expected slip s,

    r W = (rolling line) / (1 - s),

so that the ground speed is met (off, s = 0, where no slip is known); the rates' own limits.

Two bodies with a steered joint between them roll along while the joint turns: the wheels take the rates of the twist
that the joint's angle and rate allow, so that nothing is dragged, at a stand neither; to that end the joint speeds up
and slows down no faster than the wheels can. So does a machine whose steering may not turn at a stand
(`steering_at_stand`): it drives on slowly and steers as it goes.

Source: own formulation, on `kinematics` and `rate_limiter`. The slip is that of all wheels together: a wheel on other
soil than its neighbours is not told from them.
"""

import math
from typing import NamedTuple

import numpy as np

from sojourn_flight.mobility.kinematics import allowed_kernel, rates_kernel, wheels_kernel
from sojourn_flight.mobility.rate_limiter import LimiterState, SteeringPace, limit_rates, limit_steering
from sojourn_flight.mobility.rolling_limits import RollingLimits
from sojourn_flight.mobility.rolling_params import SteeringTransitionParams
from sojourn_flight.mobility.twist import PlanarTwist
from sojourn_flight.mobility.wheel_table import SAME_PLACE, WheelTableColumn
from sojourn_flight.odometry.odometry_params import OdometryParams
from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray

CREEP = 0.25
"""Part of the speed that is left while a machine steers that may not do so at a stand [-]."""
LEAST_SLIP, MOST_SLIP = -0.3, 0.5
"""Expectations of slip beyond these are not met by turning the wheels slower or faster [-]."""


class WheelCommands(NamedTuple):
    """Commands of one period."""

    state: LimiterState
    """What is sent to the motors."""
    wanted_angles: FloatArray
    """Steer angles on which the commands aim [rad], shape (wheels,)."""
    speed_factor: float
    """1 when the wheels may roll freely, 0 when they wait for the steering [-]."""
    steer_error: float
    """Largest steer error, commanded or measured against wanted [rad]."""
    residual: FloatArray
    """Velocity across each wheel's heading that it cannot follow once the steering has arrived [m/s]."""


@njit(cache=True)
def is_articulated(table: FloatArray) -> bool:
    """Whether a joint of the machine turns wheels that are not on its axis: two bodies, articulated steering."""
    for wheel in table:
        if wheel[WheelTableColumn.STEERED] > 0.5 and abs(wheel[WheelTableColumn.ARM_X]) > SAME_PLACE:
            return True
    return False


def expected_slip(params: OdometryParams, pitch: float, v_x: float) -> float:
    """Slip that the soil is expected to give on the grade that is driven up [-].

    Args:
        params: what the odometry expects. pitch: positive nose down [rad]. v_x: wanted, for its sense [m/s].
    """
    grade = -math.sin(pitch) * (1.0 if v_x >= 0.0 else -1.0)
    return min(max(params.mean_slip + params.slip_per_grade * grade, LEAST_SLIP), MOST_SLIP)


def command_wheels(
    table: FloatArray,
    limits: RollingLimits,
    transition: SteeringTransitionParams,
    state: LimiterState,
    twist: PlanarTwist,
    measured_angles: FloatArray,
    dt: float,
    slip: float = 0.0,
) -> WheelCommands:
    """Next commands for a twist that is inside the machine's limits.

    Args:
        table: wheels, from `SteeringGeometryParams.table()`.
        limits: rate and acceleration limits. transition: how wheels and steering wait for each other.
        state: last commands.
        twist: wanted motion of base_link.
        measured_angles: where the steering is [rad], shape (wheels,).
        dt: period [s], above 0.
        slip: expected of all wheels, below 1 [-].
    """
    count = table.shape[0]
    angles, rates, residual = np.empty(count), np.empty(count), np.empty(count)
    v_x, v_y, yaw_rate = float(twist.v_x), float(twist.v_y), float(twist.yaw_rate)
    wheels_kernel(table, v_x, v_y, yaw_rate, state.steer_angles, angles, rates, residual)
    articulated = is_articulated(table)
    rolls_along = articulated or not transition.steering_at_stand
    fastest, acceleration, least = limits.max_steer_rate, limits.max_steer_acceleration, 0.0
    if articulated:
        acceleration = min(acceleration, _joint_acceleration(table, limits))
    if not transition.steering_at_stand:
        rim = float(np.abs(state.wheel_rates * table[:, WheelTableColumn.RADIUS]).mean())
        fastest *= min(rim / (CREEP * limits.max_speed), 1.0)
        least = CREEP
    pace = SteeringPace(fastest, acceleration)
    steering = limit_steering(table, pace, transition, state, angles, measured_angles, dt, waits=not rolls_along)
    factor = max(steering.speed_factor, least)
    v_x, v_y, yaw_rate = factor * v_x, factor * v_y, factor * yaw_rate
    if rolls_along:
        v_y, yaw_rate = allowed_kernel(table, v_x, v_y, yaw_rate, steering.angles, steering.rates)
        rates_kernel(table, v_x, v_y, yaw_rate, steering.angles, steering.rates, rates)
    else:
        rates *= factor
        rates += _own_rates(table, steering.angles, steering.rates)
    if slip != 0.0:
        rates /= 1.0 - slip
    new_rates = limit_rates(table, limits, state.wheel_rates, rates, dt)
    new_state = LimiterState(steering.angles, new_rates, steering.rates)
    return WheelCommands(new_state, angles, factor, steering.error, residual)


def _joint_acceleration(table: FloatArray, limits: RollingLimits) -> float:
    """Acceleration of a joint between two bodies with which the wheels can keep up [rad/s^2]."""
    lever = np.hypot(
        table[:, WheelTableColumn.X] - table[:, WheelTableColumn.PIVOT_X],
        table[:, WheelTableColumn.Y] - table[:, WheelTableColumn.PIVOT_Y],
    ).max()
    return 0.5 * min(limits.max_acceleration, limits.max_deceleration) / float(lever)  # half is for the way


def _own_rates(table: FloatArray, angles: FloatArray, steer_rates: FloatArray) -> FloatArray:
    """What the wheels roll because their own steering moves them [rad/s]: not about their contact."""
    rates = np.empty(table.shape[0])
    rates_kernel(table, 0.0, 0.0, 0.0, angles, steer_rates, rates)
    return rates
