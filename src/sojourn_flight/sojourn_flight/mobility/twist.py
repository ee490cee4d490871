"""Motion of base_link in its own plane."""

from typing import NamedTuple


class PlanarTwist(NamedTuple):
    """Motion of base_link in its own x-y plane: v_x, v_y [m/s], yaw_rate [rad/s]."""

    v_x: float
    v_y: float
    yaw_rate: float


NO_MOTION = PlanarTwist(0.0, 0.0, 0.0)
