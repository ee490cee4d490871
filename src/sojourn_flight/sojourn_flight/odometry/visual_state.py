"""What visual odometry is given, what it remembers, and what it tells of itself."""

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sojourn_flight.odometry.disparity_plane import DisparityPlane
from sojourn_flight.odometry.stereo_geometry import PinholePair
from sojourn_machine.params import FloatArray


@dataclass(frozen=True, eq=False, slots=True)
class StereoImages:
    """What a rectified pair has taken at one moment; images without pixels where it had no power."""

    left: NDArray[np.uint8]
    right: NDArray[np.uint8]
    """Shape (rows, columns)."""
    pair: PinholePair


class Pose(NamedTuple):
    """Of base_link by the odometry."""

    x: float
    y: float
    z: float
    """[m]"""
    roll: float
    pitch: float
    yaw: float
    """[rad]"""


@dataclass(frozen=True, eq=False, slots=True)
class View:
    """A key frame: what was seen there."""

    images: StereoImages
    seen: FloatArray
    """u, v in the left image and u in the right one of each point, shape (n, 3) [px]."""
    plane: DisparityPlane
    """The ground, by most of them."""
    pose: Pose


@dataclass(frozen=True, slots=True)
class VisualOdometryState:
    """The key frame, and what became of the looks."""

    view: View | None = None
    """None before the first look with ground in it."""
    rolled: float = 0.0
    """Way of the supports since the key frame, slip and all [m]."""
    turned: float = 0.0
    """By how much the machine has turned since then, to either side [rad]."""
    looks: int = 0
    """That were compared with a key frame; the random numbers of the next are drawn from it."""
    matches: int = 0
    """That were used."""
    rejected: int = 0
    """That were not."""
    text: str = "no image yet"
    """What became of the last look, in words."""
    points: int = 0
    """That agreed on the last motion."""
    error_px: float = 0.0
    """Of their places, one standard deviation [px]."""
    deviation: float = 0.0
    """Of the last innovation, in standard deviations [-]."""
    slip: float = 0.0
    """Of the way to the last look that was used: what the supports went less what was seen, over the former [-]."""


def rolled_on(state: VisualOdometryState, speed: float, yaw_rate: float, dt: float) -> VisualOdometryState:
    """After a period `dt` [s] in which the supports went with `speed` [m/s], whatever they slip."""
    if speed == yaw_rate == 0.0:
        return state
    return replace(state, rolled=state.rolled + abs(speed) * dt, turned=state.turned + abs(yaw_rate) * dt)


def visual_status(state: VisualOdometryState | None, slip_error: float) -> dict[str, str | float]:
    """Fields of /drive/status; none of a machine without. slip_error: what is made of the slip, by all cameras [-]."""
    if state is None:
        return {}
    return {
        "visual_odometry": state.text,
        "visual_matches": float(state.matches),
        "visual_rejected": float(state.rejected),
        "visual_points": float(state.points),
        "visual_error_px": state.error_px,
        "visual_deviation_sigma": state.deviation,
        "visual_slip": state.slip,
        "visual_slip_correction": slip_error,
    }
