"""Motion of base_link in a period from its wheels at both ends: position differences, so that nothing is lost between
samples, and mean steer angles. Equations and sources are in `wheel_twist`.
"""

from typing import NamedTuple

import numpy as np

from sojourn_flight.mobility.wheel_twist import twist_kernel, velocity_kernel
from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray


class WheelPeriod(NamedTuple):
    """Wheels at both ends of a period. Arrays have shape (wheels,)."""

    positions_before: FloatArray
    """Encoder angles [rad]."""
    positions: FloatArray
    rates: FloatArray
    """As measured at the end [rad/s]."""
    angles_before: FloatArray
    """Of the steering [rad]."""
    angles: FloatArray


@njit(cache=True)
def wheel_motion(
    table: FloatArray,
    wheels: WheelPeriod,
    dt: float,
    plausible_rate: float,
    lateral_weight: float,
    yaw_rate: float,
    use_gyro: bool,
) -> tuple[float, float, float, float, float, int]:
    """v_x, v_y, yaw rate of the wheels alone, residual, fastest rim (roll or steer) [m/s], encoder jumps."""
    angles, old_angles = wheels.angles, wheels.angles_before
    count = table.shape[0]
    rates, middle, turning = np.empty(count), np.empty(count), np.empty(count)
    fastest = 0.0
    jumps = 0
    for i in range(count):
        rates[i] = (wheels.positions[i] - wheels.positions_before[i]) / dt
        if abs(rates[i]) > plausible_rate:
            rates[i] = wheels.rates[i]
            jumps += 1
        middle[i] = 0.5 * (angles[i] + old_angles[i])
        turning[i] = (angles[i] - old_angles[i]) / dt
        fastest = max(fastest, abs(rates[i]) * table[i, 2])
        fastest = max(fastest, abs(turning[i]) * table[i, 2])
    v_x, v_y, wheel_yaw_rate, residual = twist_kernel(table, rates, middle, turning, lateral_weight)
    if use_gyro:
        v_x, v_y, residual = velocity_kernel(table, rates, middle, turning, yaw_rate, lateral_weight)
    return v_x, v_y, wheel_yaw_rate, residual, fastest, jumps
