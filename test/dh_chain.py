"""The tip of a Denavit-Hartenberg table, transform by transform: the independent route of the arms' kinematics."""

import numpy as np

from sojourn_flight.arm.dh import DhGeometry, screw, twist
from sojourn_machine.params import FloatArray


def tip_transform(geometry: DhGeometry, positions: FloatArray) -> FloatArray:
    """Tip in the base (4, 4) at joint `positions` (n,) [rad or m]."""
    transform = geometry.base @ twist(geometry.a[0], geometry.alpha[0])
    for i, revolute in enumerate(geometry.revolute):
        turn = geometry.theta[i] + (positions[i] if revolute else 0.0)
        shift = geometry.d[i] + (0.0 if revolute else positions[i])
        transform = transform @ screw(turn, shift) @ twist(geometry.a[i + 1], geometry.alpha[i + 1])
    return np.asarray(transform @ geometry.tool, dtype=np.float64)
