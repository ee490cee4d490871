"""What is left of the way that the drive follows, as poses of base_link in odom: for maps of operators."""

import math

import numpy as np

from sojourn_flight.planning.path import thinned
from sojourn_flight.supervision.drive_types import DriveState
from sojourn_flight.supervision.path_check import path_ahead
from sojourn_machine.params import FloatArray

EVERY = 0.25
"""Distance of two poses, about [m]."""


def way_ahead(state: DriveState) -> FloatArray:
    """x, y [m] and yaw [rad] along the way to the goal, the last those of the goal, shape (n, 3); none without a goal.

    While the rover backs off an obstacle, the way that it backs along.
    """
    way, seen = state.follower, state.avoidance
    if way is None:
        return np.empty((0, 3))
    if seen is not None and seen.back is not None:
        samples = seen.back.leg.samples
        poses = samples[np.searchsorted(samples[:, 0], seen.back.gone).clip(max=len(samples) - 1) :]
        return _astern(poses[thinned(poses[:, 0], EVERY), 1:4])
    distances, poses = path_ahead(way, math.inf)
    if len(distances):
        poses = poses[thinned(distances, EVERY)]
        poses = _astern(poses) if way.astern else poses
    else:  # it stands at the end of its path
        poses = np.array([[*way.goal.points[-1], state.odometry.yaw]])
    if way.goal.yaw is not None:
        poses[-1, 2] = way.goal.yaw
    return poses


def _astern(poses: FloatArray) -> FloatArray:
    """Of the body, where the headings are those of a motion backwards."""
    return np.asarray(poses + np.array((0.0, 0.0, math.pi)))
