"""What every message must satisfy on arrival, whatever its topic: finite numbers and matching array lengths.

A node adds its own checks (joint names, frames) on top. NaN and infinity never enter a state: they stop here.
"""

from collections.abc import Callable, Sequence
from math import isfinite
from typing import Any

import numpy as np

from sojourn_contract.clouds import points_of
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.topic_types import Topic
from sojourn_contract.values import (
    BatteryState,
    Imu,
    JointState,
    JointTrajectory,
    Message,
    Odometry,
    Path,
    PointCloud2,
    PoseStamped,
    TwistStamped,
    Vector3Stamped,
    WrenchStamped,
)
from sojourn_machine.params import FloatArray


def check_message(topic: str, message: Message) -> None:
    """Raise RefusedMessageError, naming topic and field, if a message holds what no node may take."""
    check = _CHECKS.get(type(message))
    if check is not None:
        check(topic, message)


def check_finite(topic: str, field: str, values: FloatArray) -> None:
    """Raise RefusedMessageError if one of `values`, shape (n,), is NaN or infinite."""
    numbers = values.tolist()
    if isfinite(sum(numbers)):
        return
    for index, value in enumerate(numbers):
        if not isfinite(value):
            raise RefusedMessageError(topic, f"{field}[{index}]", value, "a finite number")


def check_names(topic: str, names: Sequence[str], known: dict[str, int]) -> None:
    """Raise RefusedMessageError if a joint is unknown or named twice. `known`: joint name -> index."""
    for name in names:
        if name not in known:
            raise RefusedMessageError(topic, "name", name, "one of " + ", ".join(known))
    if len(set(names)) != len(names):
        raise RefusedMessageError(topic, "name", ", ".join(names), "each joint once")


def check_complete(topic: str, message: JointState) -> None:
    """Raise RefusedMessageError if a measured JointState lacks the position or the rate of a joint that it
    names.
    """
    for field in ("position", "velocity"):
        count = len(getattr(message, field))
        if count != len(message.names):
            raise RefusedMessageError(topic, field, f"{count} numbers", f"one for each of {len(message.names)} names")


def check_ranges(row: Topic, message: JointState) -> None:
    """Raise RefusedMessageError if a number of a JointState is out of the plausible range that its row
    states.
    """
    for rule in row.fields:
        values = getattr(message, rule.path).tolist()
        if values and (min(values) < rule.low or max(values) > rule.high):
            worst = min(values) if min(values) < rule.low else max(values)
            allowed = f"{rule.low:g} to {rule.high:g} {rule.unit}"
            raise RefusedMessageError(row.name, rule.path, worst, allowed)


def _check_scalar(topic: str, field: str, value: float) -> None:
    if not isfinite(value):
        raise RefusedMessageError(topic, field, value, "a finite number")


def _check_vector(topic: str, field: str, vector: FloatArray) -> None:
    """Of 3 numbers x y z, or 4, x y z w."""
    if not isfinite(sum(vector.tolist())):
        for axis, value in zip("xyzw", vector.tolist(), strict=False):
            _check_scalar(topic, f"{field}.{axis}", value)


def _check_pose(topic: str, field: str, pose: PoseStamped | Odometry) -> None:
    _check_vector(topic, f"{field}.position", pose.position)
    _check_vector(topic, f"{field}.orientation", pose.orientation)


def _check_joint_state(topic: str, message: JointState) -> None:
    count = len(message.names)
    for field, values in (("position", message.position), ("velocity", message.velocity), ("effort", message.effort)):
        if len(values) not in (0, count):
            raise RefusedMessageError(topic, field, f"{len(values)} numbers", f"none, or one for each of {count} names")
        check_finite(topic, field, values)


def _check_trajectory(topic: str, message: JointTrajectory) -> None:
    count = len(message.names)
    for index, point in enumerate(message.points):
        for field in ("positions", "velocities", "accelerations", "effort"):
            values = getattr(point, field)
            where = f"points[{index}].{field}"
            if len(values) not in ((count,) if field == "positions" else (0, count)):
                raise RefusedMessageError(topic, where, f"{len(values)} numbers", f"one for each of {count} joints")
            check_finite(topic, where, values)


def _check_twist(topic: str, message: TwistStamped) -> None:
    _check_vector(topic, "twist.linear", message.linear)
    _check_vector(topic, "twist.angular", message.angular)


def _check_wrench(topic: str, message: WrenchStamped) -> None:
    """Numbers, or NaN throughout: not measured."""
    if not (np.isnan(message.force).all() and np.isnan(message.torque).all()):
        _check_vector(topic, "wrench.force", message.force)
        _check_vector(topic, "wrench.torque", message.torque)


def _check_odometry(topic: str, message: Odometry) -> None:
    _check_pose(topic, "pose.pose", message)
    _check_vector(topic, "twist.twist.linear", message.linear)
    _check_vector(topic, "twist.twist.angular", message.angular)


def _check_imu(topic: str, message: Imu) -> None:
    _check_vector(topic, "angular_velocity", message.angular_velocity)
    _check_vector(topic, "linear_acceleration", message.linear_acceleration)
    _check_vector(topic, "orientation", message.orientation)


def _check_battery(topic: str, message: BatteryState) -> None:
    for field in ("voltage", "current", "temperature"):
        _check_scalar(topic, field, getattr(message, field))


def _check_path(topic: str, message: Path) -> None:
    for index, pose in enumerate(message.poses):
        _check_pose(topic, f"poses[{index}].pose", pose)


_CHECKS: dict[type, Callable[[str, Any], object]] = {
    JointState: _check_joint_state,
    JointTrajectory: _check_trajectory,
    TwistStamped: _check_twist,
    PoseStamped: lambda topic, message: _check_pose(topic, "pose", message),
    Path: _check_path,
    Odometry: _check_odometry,
    Imu: _check_imu,
    Vector3Stamped: lambda topic, message: _check_vector(topic, "vector", message.vector),
    BatteryState: _check_battery,
    WrenchStamped: _check_wrench,
    PointCloud2: points_of,
}
