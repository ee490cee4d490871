"""What every message must satisfy on arrival, whatever its topic: finite numbers and matching array lengths.

A node adds its own checks (joint names, frames) on top. NaN and infinity never enter a state: they stop here.
"""

from collections.abc import Callable
from math import isfinite, isnan
from typing import Any

from sojourn_contract.clouds import points_of
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.topic_types import Topic


def check_message(topic: str, message: Any) -> None:
    """Raise RefusedMessageError, naming topic and field, if a message holds what no node may take."""
    check = _CHECKS.get(type(message).__name__)
    if check is not None:
        check(topic, message)


def check_finite(topic: str, field: str, values: Any) -> None:
    """Raise RefusedMessageError if one of `values` (any sequence of floats) is NaN or infinite."""
    if isfinite(sum(values)):
        return
    for index, value in enumerate(values):
        if not isfinite(value):
            raise RefusedMessageError(topic, f"{field}[{index}]", value, "a finite number")


def check_names(topic: str, names: list[str], known: dict[str, int]) -> None:
    """Raise RefusedMessageError if a joint is unknown or named twice. `known`: joint name -> index."""
    for name in names:
        if name not in known:
            raise RefusedMessageError(topic, "name", name, "one of " + ", ".join(known))
    if len(set(names)) != len(names):
        raise RefusedMessageError(topic, "name", ", ".join(names), "each joint once")


def check_complete(topic: str, message: Any) -> None:
    """Raise RefusedMessageError if a measured JointState lacks the position or the rate of a joint that it
    names.
    """
    for field in ("position", "velocity"):
        count = len(getattr(message, field))
        if count != len(message.name):
            raise RefusedMessageError(topic, field, f"{count} numbers", f"one for each of {len(message.name)} names")


def check_ranges(row: Topic, message: Any) -> None:
    """Raise RefusedMessageError if a number of a JointState is out of the plausible range that its row
    states.
    """
    for rule in row.fields:
        values = getattr(message, rule.path)
        if len(values) and (min(values) < rule.low or max(values) > rule.high):
            worst = min(values) if min(values) < rule.low else max(values)
            allowed = f"{rule.low:g} to {rule.high:g} {rule.unit}"
            raise RefusedMessageError(row.name, rule.path, worst, allowed)


def _check_scalar(topic: str, field: str, value: float) -> None:
    if not isfinite(value):
        raise RefusedMessageError(topic, field, value, "a finite number")


def _check_xyz(topic: str, field: str, vector: Any) -> None:
    for axis in ("x", "y", "z"):
        _check_scalar(topic, f"{field}.{axis}", getattr(vector, axis))


def _check_pose(topic: str, field: str, pose: Any) -> None:
    _check_xyz(topic, f"{field}.position", pose.position)
    _check_xyz(topic, f"{field}.orientation", pose.orientation)
    _check_scalar(topic, f"{field}.orientation.w", pose.orientation.w)


def _check_joint_state(topic: str, message: Any) -> None:
    count = len(message.name)
    for field in ("position", "velocity", "effort"):
        values = getattr(message, field)
        if len(values) not in (0, count):
            raise RefusedMessageError(topic, field, f"{len(values)} numbers", f"none, or one for each of {count} names")
        check_finite(topic, field, values)


def _check_trajectory(topic: str, message: Any) -> None:
    count = len(message.joint_names)
    for index, point in enumerate(message.points):
        for field in ("positions", "velocities", "accelerations", "effort"):
            values = getattr(point, field)
            where = f"points[{index}].{field}"
            if len(values) not in ((count,) if field == "positions" else (0, count)):
                raise RefusedMessageError(topic, where, f"{len(values)} numbers", f"one for each of {count} joints")
            check_finite(topic, where, values)


def _check_twist(topic: str, message: Any) -> None:
    _check_xyz(topic, "twist.linear", message.twist.linear)
    _check_xyz(topic, "twist.angular", message.twist.angular)


def _check_wrench(topic: str, message: Any) -> None:
    """Numbers, or NaN throughout: not measured."""
    force, torque = message.wrench.force, message.wrench.torque
    if not all(isnan(value) for value in (force.x, force.y, force.z, torque.x, torque.y, torque.z)):
        _check_xyz(topic, "wrench.force", force)
        _check_xyz(topic, "wrench.torque", torque)


def _check_odometry(topic: str, message: Any) -> None:
    _check_pose(topic, "pose.pose", message.pose.pose)
    _check_xyz(topic, "twist.twist.linear", message.twist.twist.linear)
    _check_xyz(topic, "twist.twist.angular", message.twist.twist.angular)


def _check_imu(topic: str, message: Any) -> None:
    _check_xyz(topic, "angular_velocity", message.angular_velocity)
    _check_xyz(topic, "linear_acceleration", message.linear_acceleration)
    _check_xyz(topic, "orientation", message.orientation)
    _check_scalar(topic, "orientation.w", message.orientation.w)


def _check_battery(topic: str, message: Any) -> None:
    for field in ("voltage", "current", "temperature"):
        _check_scalar(topic, field, getattr(message, field))


def _check_path(topic: str, message: Any) -> None:
    for index, pose in enumerate(message.poses):
        _check_pose(topic, f"poses[{index}].pose", pose.pose)


def _check_cloud(topic: str, message: Any) -> None:
    points_of(topic, message)


_CHECKS: dict[str, Callable[[str, Any], None]] = {
    "JointState": _check_joint_state,
    "JointTrajectory": _check_trajectory,
    "TwistStamped": _check_twist,
    "PoseStamped": lambda topic, message: _check_pose(topic, "pose", message.pose),
    "Path": _check_path,
    "Odometry": _check_odometry,
    "Imu": _check_imu,
    "Vector3Stamped": lambda topic, message: _check_xyz(topic, "vector", message.vector),
    "BatteryState": _check_battery,
    "WrenchStamped": _check_wrench,
    "PointCloud2": _check_cloud,
}
