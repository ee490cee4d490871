"""The odometry as it is published: corrections go in by and by.

The frame odom is continuous (REP 105), and the twist of /odom is the change of its pose: what the Sun or the ground of
the hazard camera correct at once in the filter is let into the published pose at a speed that is hidden in what the
twist is good for.

What is published is thus off the filter's pose by b, which is known, and the filter's own error e has no part in it:
its covariance is the mean square of e + b, P + b b^T. Without it a machine that slips more than is believed, and is put
back with every look, would say that it is good to two centimetres and be ten off.
"""

import math

import numpy as np

from sojourn_flight.odometry.odometry import OdometryState, wrap_angle
from sojourn_machine.evolution import replace

CORRECTION_SPEED, CORRECTION_RATE = 0.005, 0.02
"""How fast a correction is made at least [m/s], [rad/s]."""
CORRECTION_TIME = 4.0
"""In about so long a large correction of the position is made, so that what is published does not lag for long [s]."""
LARGEST_CORRECTION_SPEED = 0.015
"""What is published must not move by 0.02 m/s more than its twist says, which is the contract's tolerance [m/s]."""

Behind = tuple[float, float, float]
"""Corrections that are not in the published pose yet: x, y [m] and yaw [rad]."""
NOTHING: Behind = (0.0, 0.0, 0.0)


def eased(rolled: OdometryState, fixed: OdometryState, behind: Behind, dt: float) -> tuple[OdometryState, Behind]:
    """The odometry as it is published after a period `dt` [s], and what is then still behind.

    Args:
        rolled, fixed: the odometry before and after the corrections of the period.
    """
    x, y, turn = behind
    if fixed is not rolled:
        x, y, turn = x + fixed.x - rolled.x, y + fixed.y - rolled.y, turn + wrap_angle(fixed.yaw - rolled.yaw)
    if x == y == turn == 0.0:
        return fixed, NOTHING
    size = max(math.hypot(x, y), 1e-12)
    speed = min(max(CORRECTION_SPEED, size / CORRECTION_TIME), LARGEST_CORRECTION_SPEED)
    left = max(1.0 - speed * dt / size, 0.0)
    x, y, turn = left * x, left * y, turn - min(max(turn, -CORRECTION_RATE * dt), CORRECTION_RATE * dt)
    covariance = fixed.covariance.copy()
    off = np.array((x, y, turn))
    covariance[:3, :3] += off[:, np.newaxis] * off
    pose = fixed.x - x, fixed.y - y, wrap_angle(fixed.yaw - turn)
    return replace(fixed, x=pose[0], y=pose[1], yaw=pose[2], covariance=covariance), (x, y, turn)
