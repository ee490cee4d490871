"""An operator's word where the rover is, /initialpose: the estimate goes on from there.

What the word says, x, y and heading with their covariance, replaces what was believed of them; height, tilt, and what
has been learnt of gyro and slip stay. The cameras' key frames and the map of obstacles hang on the old pose: both begin
anew.
"""

from dataclasses import dataclass

import numpy as np

from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.messages import yaw_of
from sojourn_contract.values import PoseWithCovarianceStamped
from sojourn_flight.odometry.odometry import OdometryState, wrap_angle
from sojourn_flight.odometry.turn_drift import downhill_of
from sojourn_flight.supervision.drive import DriveModel
from sojourn_flight.supervision.drive_types import DriveState
from sojourn_machine.evolution import replace
from sojourn_machine.params import FloatArray

PLACE = "/initialpose"
FRAMES = ("map", "odom")
LEAST_SIGMA = 1e-3
"""Nobody knows where a rover is better than so [m, rad]."""
LARGEST_VARIANCE = 1e8
FARTHEST = 1e5
"""From the origin of the map along an axis [m], as for points of the contract."""
PLANE = np.ix_((0, 1, 5), (0, 1, 5))
"""x, y and heading in the covariance of a pose."""
PLACED = "an operator has said where it is"


@dataclass(frozen=True, slots=True)
class PlaceStatus:
    """What became of the last word."""

    stamp: int = 0
    state: str = ""
    reason: str = ""

    def status(self) -> dict[str, str]:
        """Fields of /drive/status; none before the first word."""
        if not self.state:
            return {}
        return {"placed_stamp": str(self.stamp), "placed_state": self.state, "placed_reason": self.reason}


def placed(model: DriveModel, drive: DriveState, message: PoseWithCovarianceStamped) -> DriveState:
    """The drive at the place that it is told.

    Raises:
        RefusedMessageError: it drives, the frame is another, there is no heading, the place is too far, or the
            covariance cannot be.
    """
    if drive.mode != "idle":
        raise RefusedMessageError(PLACE, "header", "a place now", "none while it drives: stop it first")
    if message.frame not in FRAMES:
        raise RefusedMessageError(PLACE, "header.frame_id", repr(message.frame), "one of " + ", ".join(FRAMES))
    yaw = yaw_of(message.orientation)
    if yaw is None:
        raise RefusedMessageError(PLACE, "pose.pose.orientation", "all zeros", "a heading")
    x, y = message.position[:2].tolist()
    if max(abs(x), abs(y)) > FARTHEST:
        raise RefusedMessageError(
            PLACE, "pose.pose.position", f"({x:g}, {y:g})", f"at most {FARTHEST:g} m off along an axis"
        )
    anew = model.initial_state(x, y, yaw)
    old, fresh = drive.odometry, anew.odometry
    covariance = old.covariance.copy()
    unknown = [0, 1, 2, *range(_key_from(old), len(covariance))]
    covariance[unknown, :] = covariance[:, unknown] = 0.0
    told = _plane_covariance(message)
    covariance[:3, :3] = told
    for place in range(_key_from(old), len(covariance), 3):
        covariance[place : place + 3, place : place + 3] = told
    odometry: OdometryState = replace(
        old,
        x=x,
        y=y,
        yaw=wrap_angle(yaw),
        v_x=0.0,
        v_y=0.0,
        yaw_rate=0.0,
        covariance=covariance,
        keys=fresh.keys,
        downhill=downhill_of(old.roll, old.pitch, yaw),
    )
    anew = replace(anew, odometry=odometry, mobility=drive.mobility, heading=drive.heading, text=PLACED)
    return model.in_motion(anew)


def _key_from(state: OdometryState) -> int:
    """Where the key frames are in the covariance; its end where there are none."""
    return len(state.covariance) - (0 if state.keys is None else state.keys.size)


def _plane_covariance(message: PoseWithCovarianceStamped) -> FloatArray:
    """Of x, y and heading, shape (3, 3). Raises RefusedMessageError where it is none."""
    told = np.asarray(message.covariance, dtype=np.float64).reshape(6, 6)[PLANE]
    if np.abs(told).max() > LARGEST_VARIANCE or not np.allclose(told, told.T, rtol=1e-9, atol=0.0):
        raise RefusedMessageError(PLACE, "pose.covariance", told.tolist(), "symmetric, of x, y and heading")
    told = 0.5 * (told + told.T)
    if np.linalg.eigvalsh(told)[0] < -1e-9 * max(1e-9, np.abs(told).max()):
        raise RefusedMessageError(PLACE, "pose.covariance", told.tolist(), "without a negative variance")
    return told + LEAST_SIGMA**2 * np.eye(3)
