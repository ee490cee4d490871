"""What every message must satisfy on arrival, whatever its topic: finite numbers and matching array lengths.

A node adds its own checks (joint names, frames) on top. NaN and infinity never enter a state: they stop here.
"""

from collections.abc import Callable, Sequence
from math import isfinite, isnan
from typing import Any, NamedTuple, TypeAlias

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
    PoseStamped,
    PoseWithCovarianceStamped,
    TwistStamped,
    Vector3Stamped,
    WrenchStamped,
)
from sojourn_machine.params import FloatArray

Check: TypeAlias = Callable[[str, Any], object]
"""Of the message of a topic: raises RefusedMessageError."""


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
    distinct = set(names)
    if not distinct <= known.keys():
        name = next(name for name in names if name not in known)
        raise RefusedMessageError(topic, "name", name, "one of " + ", ".join(known))
    if len(distinct) != len(names):
        raise RefusedMessageError(topic, "name", ", ".join(names), "each joint once")


def check_complete(topic: str, message: JointState) -> None:
    """Raise RefusedMessageError if a measured JointState lacks the position or the rate of a joint that it
    names.
    """
    named = len(message.names)
    for field, count in (("position", len(message.position)), ("velocity", len(message.velocity))):
        if count != named:
            raise RefusedMessageError(topic, field, f"{count} numbers", f"one for each of {named} names")


def check_ranges(row: Topic, message: JointState) -> None:
    """Raise RefusedMessageError if a number of a JointState is out of the plausible range that its row
    states.
    """
    for rule in row.fields:
        values = getattr(message, rule.path).tolist()
        if not values:
            continue
        least, most = min(values), max(values)
        if least < rule.low or most > rule.high:
            allowed = f"{rule.low:g} to {rule.high:g} {rule.unit}"
            raise RefusedMessageError(row.name, rule.path, least if least < rule.low else most, allowed)


def _check_scalar(topic: str, field: str, value: float) -> None:
    if not isfinite(value):
        raise RefusedMessageError(topic, field, value, "a finite number")


def _check_vector(topic: str, field: str, vector: FloatArray) -> None:
    """Of 3 numbers x y z, or 4, x y z w."""
    numbers = vector.tolist()
    if not isfinite(sum(numbers)):
        for axis, value in zip("xyzw", numbers, strict=False):
            _check_scalar(topic, f"{field}.{axis}", value)


def _vectors(kind: type[NamedTuple], **fields: str) -> Check:
    """Check of the vectors of a message, in the order in which they are given: name in its value, name in ROS."""
    places = [kind._fields.index(name) for name in fields]

    def check(topic: str, message: Message) -> None:
        total = 0.0
        for place in places:
            total += sum(message[place].tolist())
        if not isfinite(total):
            for field, place in zip(fields.values(), places, strict=True):
                _check_vector(topic, field, message[place])

    return check


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


def _check_wrench(topic: str, message: WrenchStamped) -> None:
    """Numbers, or NaN throughout: not measured."""
    force, torque = message.force.tolist(), message.torque.tolist()
    if not isfinite(sum(force + torque)) and not all(map(isnan, force + torque)):
        _check_wrench_vectors(topic, message)


def _check_battery(topic: str, message: BatteryState) -> None:
    for field in ("voltage", "current", "temperature"):
        _check_scalar(topic, field, getattr(message, field))


def _check_place(topic: str, message: PoseWithCovarianceStamped) -> None:
    _check_vector(topic, "pose.pose.position", message.position)
    _check_vector(topic, "pose.pose.orientation", message.orientation)
    check_finite(topic, "pose.covariance", message.covariance)


def _check_path(topic: str, message: Path) -> None:
    for index, pose in enumerate(message.poses):
        _check_vector(topic, f"poses[{index}].pose.position", pose.position)
        _check_vector(topic, f"poses[{index}].pose.orientation", pose.orientation)


_check_wrench_vectors = _vectors(WrenchStamped, force="wrench.force", torque="wrench.torque")
_CHECKS: dict[type, Check] = {
    JointState: _check_joint_state,
    JointTrajectory: _check_trajectory,
    TwistStamped: _vectors(TwistStamped, linear="twist.linear", angular="twist.angular"),
    PoseStamped: _vectors(PoseStamped, position="pose.position", orientation="pose.orientation"),
    PoseWithCovarianceStamped: _check_place,
    Path: _check_path,
    Odometry: _vectors(
        Odometry,
        position="pose.pose.position",
        orientation="pose.pose.orientation",
        linear="twist.twist.linear",
        angular="twist.twist.angular",
    ),
    Imu: _vectors(
        Imu,
        angular_velocity="angular_velocity",
        linear_acceleration="linear_acceleration",
        orientation="orientation",
    ),
    Vector3Stamped: _vectors(Vector3Stamped, vector="vector"),
    BatteryState: _check_battery,
    WrenchStamped: _check_wrench,
}
