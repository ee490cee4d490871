"""How sharply a machine can turn: greatest curvature, fastest change of curvature, and whether it turns on the spot.

Driving ahead at curvature k, a wheel at (x, y) must head along d(k) = atan2(k x, 1 - k y) (see kinematics). From
this:

- The curvature is as large as all wheels can follow without sliding sideways by more than SLIDING of the speed,
  found by bisection. Wheels that no angle fits even in the gentlest curve (a fixed wheel off the axis that all
  others turn about, all wheels of a skid-steered machine) slide by design and do not count.
- The curvature may change with distance by no more than the slowest of: the steering, |d'(k)| sharpness V <= steer
  rate; the wheels' rim speed V |1 - k y|, |y| sharpness V^2 <= acceleration.
- It turns on the spot if every steered wheel can roll in a turn about base_link, or if none is steered (skid).

Assumption: level ground; slip makes curves wider, which the tracking law takes out.
"""

import numpy as np

from sojourn_flight.mobility.ability import TurningLimits
from sojourn_flight.mobility.kinematics import wheels_from_twist
from sojourn_flight.mobility.rolling_limits import RollingLimits
from sojourn_flight.mobility.twist import PlanarTwist
from sojourn_flight.mobility.wheel_table import WheelTableColumn
from sojourn_machine.params import FloatArray

SLIDING = 1e-6
"""Sideways speed of a wheel over the speed of the machine that still counts as rolling [-]."""
GENTLE = 1e-3
"""Curvature that any machine can drive [1/m]."""


def turning_limits(table: FloatArray, limits: RollingLimits, greatest_curvature: float) -> TurningLimits:
    """Limits of a machine.

    Args:
        table: wheels, from `SteeringGeometryParams.table()`.
        limits: speed, steering rate and acceleration of the machine.
        greatest_curvature: curvature not to exceed even if the steering could [1/m].
    """
    able = _slide(table, 1.0, GENTLE) <= SLIDING
    curvature = greatest_curvature
    if np.any(_slide(table, 1.0, curvature)[able] > SLIDING):
        low, high = GENTLE, greatest_curvature
        for _ in range(50):
            middle = 0.5 * (low + high)
            low, high = (low, middle) if np.any(_slide(table, 1.0, middle)[able] > SLIDING) else (middle, high)
        curvature = low
    steered = table[:, WheelTableColumn.STEERED] > 0.5
    on_the_spot = bool(np.all(_slide(table, 0.0, 1.0)[steered] <= SLIDING))
    return TurningLimits(curvature, _sharpness(table, limits, curvature), on_the_spot)


def _slide(table: FloatArray, speed: float, yaw_rate: float) -> FloatArray:
    """Sideways speed of each wheel [m/s], shape (wheels,)."""
    twist = PlanarTwist(speed, 0.0, yaw_rate)
    left = np.abs(wheels_from_twist(table, twist, np.zeros(table.shape[0])).residual)
    right = np.abs(wheels_from_twist(table, twist._replace(yaw_rate=-yaw_rate), np.zeros(table.shape[0])).residual)
    return np.asarray(np.maximum(left, right))


def _sharpness(table: FloatArray, limits: RollingLimits, curvature: float) -> float:
    """Fastest growth of the curvature with distance [1/m^2]; d'(k) by differences."""
    curvatures = np.linspace(-curvature, curvature, 101)
    straight = np.zeros(table.shape[0])
    angles = [wheels_from_twist(table, PlanarTwist(1.0, 0.0, float(k)), straight).steer_angles for k in curvatures]
    turning = float(np.max(np.abs(np.diff(angles, axis=0)))) / float(curvatures[1] - curvatures[0])
    speed, widest = limits.max_speed, float(np.max(np.abs(table[:, WheelTableColumn.Y])))
    sharpness = limits.max_acceleration / (speed**2 * widest) if widest > 0.0 else np.inf
    if turning > 0.0:
        sharpness = min(sharpness, limits.max_steer_rate / (speed * turning))
    return float(sharpness)
