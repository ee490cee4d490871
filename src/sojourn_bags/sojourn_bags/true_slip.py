"""Slip of each wheel or track as reports draw it: none while it stands on a machine that stands.

There slip, a quotient of the speeds of rim and ground, is one of two trembles, and its angle the direction of one.
"""

import numpy as np

from sojourn_bags.curves import FloatArray
from sojourn_bags.description import Run
from sojourn_bags.reading import Bag

STANDING = 0.005
"""Speed of rim and machine below which they stand [m/s]."""
WHERE_IT_STANDS = "0 where it stands"
"""For titles."""


def true_slip(bag: Bag, run: Run, field: str) -> FloatArray:
    """`slip_ratio` [-] or `slip_angle` [rad] of a field of /truth/contacts, shape (messages, wheels or tracks).

    The bag has /truth/contacts, /truth/odom and /truth/joint_states.
    """
    contacts, truth, states = bag["/truth/contacts"], bag["/truth/odom"], bag["/truth/joint_states"]
    velocity = truth.columns(*(f"twist.twist.linear.{axis}" for axis in "xyz"))
    speed = np.interp(contacts.times, truth.times, np.linalg.norm(velocity, axis=1))
    joints, rolling = states.joints(), run.machine.rolling
    slip = contacts.points()[field][:, : len(rolling)].copy()
    for number, wheel in enumerate(rolling):
        turning = np.abs(joints.velocity[:, joints.index(wheel.joint)])
        rim = np.interp(contacts.times, states.times, wheel.radius * turning)
        slip[np.maximum(rim, speed) < STANDING, number] = 0.0
    return np.asarray(slip)
