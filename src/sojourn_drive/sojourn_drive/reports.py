"""What the drive tells: its estimate of pose and twist every period, and once a second what it is doing."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pinocchio as pin
from nav_msgs.msg import Odometry

from sojourn_contract import stamps
from sojourn_contract.heartbeat import status_message
from sojourn_contract.messages import set_quaternion, set_xyz
from sojourn_flight.odometry.odometry import OdometryState
from sojourn_flight.supervision.drive_types import DriveOutput
from sojourn_machine.params import FloatArray


class OdometryReport:
    """/odom, in a message that is filled anew each period."""

    def __init__(self) -> None:
        self._message = Odometry(child_frame_id="base_link")
        self._message.header.frame_id = "odom"

    def message(self, stamp: int, output: DriveOutput, tilt_rates: tuple[float, float]) -> Odometry:
        """The estimate at a stamp [ns]; `tilt_rates` about x and y of base_link, as the gyro measures them [rad/s]."""
        message, estimate = self._message, output.odometry
        message.header.stamp = stamps.to_message(stamp)
        set_xyz(message.pose.pose.position, (estimate.x, estimate.y, estimate.z))
        set_quaternion(message.pose.pose.orientation, orientation(estimate))
        set_xyz(message.twist.twist.linear, (estimate.v_x, estimate.v_y, 0.0))
        set_xyz(message.twist.twist.angular, (*tilt_rates, estimate.yaw_rate))
        message.pose.covariance = output.pose_covariance.ravel()
        message.twist.covariance = output.twist_covariance.ravel()
        return message


def orientation(estimate: OdometryState) -> FloatArray:
    """Quaternion x y z w of base_link in odom."""
    rotation = pin.rpy.rpyToMatrix(estimate.roll, estimate.pitch, estimate.yaw)
    return np.array(pin.Quaternion(rotation).coeffs())


def drive_report(stamp: int, goals: Mapping[str, Any], fields: Mapping[str, str | float]) -> Any:
    """/drive/status at a stamp [ns].

    Args:
        goals: what became of the goals, with `state` and `reason`. fields: of the drive, see `drive_status`.
    """
    told = {key: f"{value:.6g}" if isinstance(value, float) else value for key, value in fields.items()}
    values = {**goals, **told}
    level = 1 if values["state"] in ("refused", "stopped") or values.get("failed_motors") else 0
    return status_message(stamp, "drive", values, values["reason"] or values["state"], level)
