"""Kinematics of a platform on wheels with rollers, by Muir & Neuman 1987: the independent route of drive and wheel."""

import math
from collections.abc import Sequence

import numpy as np

from sojourn_machine.params import FloatArray


def kinematic_matrix(
    positions: Sequence[tuple[float, float]], roller_angles: Sequence[float], radius: float
) -> FloatArray:
    """Rates of the wheels [rad/s] from the twist (v_x, v_y, yaw rate) of a platform: (wheels, 3).

    Args:
        positions: of the wheels from the platform's reference point, axles across it [m].
        roller_angles: η of each wheel [rad]. radius: of the wheels [m].
    """
    rows = []
    for (x, y), angle in zip(positions, roller_angles, strict=True):
        cotangent = 1.0 / math.tan(angle)
        rows.append((1.0, cotangent, -y + x * cotangent))
    return np.array(rows) / radius
