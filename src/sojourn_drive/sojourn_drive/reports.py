"""What the drive tells: its estimate of pose and twist every period, and once a second what it is doing."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pinocchio as pin

from sojourn_contract.heartbeat import status_message
from sojourn_contract.values import DiagnosticArray, Odometry
from sojourn_flight.odometry.odometry import OdometryState
from sojourn_flight.supervision.drive_types import DriveOutput
from sojourn_machine.params import FloatArray


def odometry_report(stamp: int, output: DriveOutput, tilt_rates: tuple[float, float]) -> Odometry:
    """/odom at a stamp [ns]; `tilt_rates` about x and y of base_link, as the gyro measures them [rad/s]."""
    estimate = output.odometry
    return Odometry(
        stamp,
        "odom",
        "base_link",
        np.array((estimate.x, estimate.y, estimate.z)),
        orientation(estimate),
        np.array((estimate.v_x, estimate.v_y, 0.0)),
        np.array((*tilt_rates, estimate.yaw_rate)),
        output.pose_covariance.ravel(),
        output.twist_covariance.ravel(),
    )


def orientation(estimate: OdometryState) -> FloatArray:
    """Quaternion x y z w of base_link in odom."""
    rotation = pin.rpy.rpyToMatrix(estimate.roll, estimate.pitch, estimate.yaw)
    return np.array(pin.Quaternion(rotation).coeffs())


def drive_report(stamp: int, goals: Mapping[str, Any], fields: Mapping[str, str | float]) -> DiagnosticArray:
    """/drive/status at a stamp [ns].

    Args:
        goals: what became of the goals, with `state` and `reason`. fields: of the drive, see `drive_status`.
    """
    texts = {key: f"{value:.6g}" if isinstance(value, float) else value for key, value in fields.items()}
    values = {**goals, **texts}
    level = 1 if values["state"] in ("refused", "stopped") or values.get("failed_motors") else 0
    return status_message(stamp, "drive", values, values["reason"] or values["state"], level)
