"""What the judge reads of messages as a library of ROS, or of bags, has made them: parts of them as values."""

from typing import Any

import numpy as np

from sojourn_contract.stamps import NANOSECONDS
from sojourn_contract.values import (
    DiagnosticArray,
    DiagnosticStatus,
    JointTrajectory,
    PointCloud2,
    PointField,
    TrajectoryPoint,
)


def stamp_of(message: Any) -> int:
    """Stamp [ns] of any message of the contract: of its header, of a Header itself, or of a Clock."""
    if hasattr(message, "header"):
        message = message.header
    time = message.stamp if hasattr(message, "stamp") else message.clock
    return int(time.sec) * NANOSECONDS + int(time.nanosec)


def diagnostics_of(message: Any) -> DiagnosticArray:
    """A diagnostic_msgs/DiagnosticArray as a value, without levels, which the libraries tell in different ways."""
    status = [
        DiagnosticStatus(one.name, tuple((pair.key, pair.value) for pair in one.values), one.message)
        for one in message.status
    ]
    return DiagnosticArray(stamp_of(message), tuple(status))


def cloud_of(message: Any) -> PointCloud2:
    """A sensor_msgs/PointCloud2 as a value."""
    return PointCloud2(
        stamp_of(message),
        message.header.frame_id,
        message.width,
        tuple(PointField(one.name, one.offset, one.datatype, one.count) for one in message.fields),
        message.point_step,
        bytes(message.data),
        message.height,
        message.row_step,
        message.is_bigendian,
        message.is_dense,
    )


def trajectory_of(message: Any) -> JointTrajectory:
    """A trajectory_msgs/JointTrajectory as a value, without the times of its points."""
    points = [
        TrajectoryPoint._make((*map(np.array, (one.positions, one.velocities, one.accelerations, one.effort)), 0))
        for one in message.points
    ]
    return JointTrajectory(stamp_of(message), tuple(message.joint_names), tuple(points), message.header.frame_id)
