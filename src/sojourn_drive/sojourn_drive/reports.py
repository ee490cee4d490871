"""What the drive tells: its estimate of pose and twist every period, and once a second what it is doing, the way ahead
of it and the ground round it.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pinocchio as pin

from sojourn_contract.heartbeat import status_message
from sojourn_contract.messages import single
from sojourn_contract.values import DiagnosticArray, OccupancyGrid, Odometry, Path, PoseStamped
from sojourn_flight.hazards.occupancy import occupancy
from sojourn_flight.odometry.odometry import OdometryState
from sojourn_flight.supervision.avoidance_types import AvoidanceState
from sojourn_flight.supervision.drive_types import DriveOutput, DriveState
from sojourn_flight.supervision.way_ahead import way_ahead
from sojourn_machine.params import FloatArray
from sojourn_machine.rotations import quaternion_of

FRAME = "odom"


def odometry_report(stamp: int, output: DriveOutput, tilt_rates: tuple[float, float]) -> Odometry:
    """/odom at a stamp [ns]; `tilt_rates` about x and y of base_link, as the gyro measures them [rad/s]."""
    estimate = output.odometry
    return Odometry(
        stamp,
        FRAME,
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
    return quaternion_of(rotation)


def drive_report(stamp: int, goals: Mapping[str, Any], fields: Mapping[str, str | float]) -> DiagnosticArray:
    """/drive/status at a stamp [ns].

    Args:
        goals: what became of the goals, with `state` and `reason`. fields: of the drive, see `drive_status`.
    """
    texts = {key: f"{value:.6g}" if isinstance(value, float) else value for key, value in fields.items()}
    values = {**goals, **texts}
    level = 1 if values["state"] in ("refused", "stopped") or values.get("failed_motors") else 0
    return status_message(stamp, "drive", values, values["reason"] or values["state"], level)


def plan(stamp: int, state: DriveState) -> Path:
    """/plan at a stamp [ns], at the height at which the rover is."""
    poses = way_ahead(state)
    half = 0.5 * poses[:, 2]
    turns = np.stack([np.zeros(len(poses)), np.zeros(len(poses)), np.sin(half), np.cos(half)], axis=1)
    places = np.column_stack([poses[:, :2], np.full(len(poses), state.odometry.z)])
    return Path(stamp, FRAME, tuple(PoseStamped(stamp, FRAME, *pose) for pose in zip(places, turns, strict=True)))


def costmap(stamp: int, seen: AvoidanceState | None) -> OccupancyGrid:
    """/local_costmap/costmap at a stamp [ns]; of a rover that knows no obstacles one without cells."""
    if seen is None:
        return OccupancyGrid(stamp, FRAME, 0.0, 0, 0, np.zeros(3), b"")
    cells = occupancy(seen.map, seen.ground)
    height, width = cells.shape
    corner = np.array((seen.map.x0, seen.map.y0, seen.level))
    return OccupancyGrid(stamp, FRAME, single(seen.map.cell), width, height, corner, cells.tobytes())
