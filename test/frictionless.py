"""Joints without friction."""

import numpy as np

from sojourn_flight.arm.friction import JointFriction


def no_friction(count: int) -> JointFriction:
    """Joints that turn freely."""
    zero = np.zeros(count)
    return JointFriction(zero, zero, zero, zero, np.ones(count))
