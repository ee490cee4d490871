"""What no message may hold: each is refused where it arrives, with the topic and the field named."""

import math
from array import array
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped, TwistStamped
from hypothesis import given
from hypothesis import strategies as st
from nav_msgs.msg import Odometry, Path
from sensor_msgs.msg import BatteryState, Imu, JointState
from std_msgs.msg import Header
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from ros_messages import value_of
from sojourn_contract.checks import check_complete, check_finite, check_message, check_names, check_ranges
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.switches import check_switches, fraction_of
from sojourn_contract.topics import topic
from sojourn_contract.values import WrenchStamped as WrenchValue

BAD = [math.nan, math.inf, -math.inf]
FIELDS: list[tuple[Callable[[], Any], str]] = [
    (TwistStamped, "twist.linear.x"),
    (TwistStamped, "twist.angular.z"),
    (PoseStamped, "pose.position.y"),
    (PoseStamped, "pose.orientation.w"),
    (PoseStamped, "pose.orientation.x"),
    (PoseWithCovarianceStamped, "pose.pose.position.x"),
    (PoseWithCovarianceStamped, "pose.pose.orientation.z"),
    (Odometry, "pose.pose.position.z"),
    (Odometry, "pose.pose.orientation.w"),
    (Odometry, "twist.twist.linear.x"),
    (Odometry, "twist.twist.angular.y"),
    (Imu, "angular_velocity.x"),
    (Imu, "linear_acceleration.z"),
    (Imu, "orientation.w"),
    (Imu, "orientation.y"),
    (BatteryState, "voltage"),
    (BatteryState, "current"),
    (BatteryState, "temperature"),
]


@pytest.mark.parametrize("value", BAD)
@pytest.mark.parametrize("make,field", FIELDS, ids=lambda item: getattr(item, "__name__", item))
def test_not_finite_is_refused_by_name(make: Callable[[], Any], field: str, value: float) -> None:
    message = make()
    check_message("/some/topic", value_of(message))
    *parents, last = field.split(".")
    target = message
    for name in parents:
        target = getattr(target, name)
    setattr(target, last, value)
    with pytest.raises(RefusedMessageError) as refusal:
        check_message("/some/topic", value_of(message))
    assert (refusal.value.topic, refusal.value.field) == ("/some/topic", field)
    assert str(value) in str(refusal.value)


def test_path_names_the_pose() -> None:
    path = Path(poses=[PoseStamped(), PoseStamped()])
    check_message("/waypoints", value_of(path))
    path.poses[1].pose.position.x = math.nan
    with pytest.raises(RefusedMessageError, match=r"/waypoints\.poses\[1\]\.pose\.position\.x"):
        check_message("/waypoints", value_of(path))


def test_what_a_battery_does_not_measure_may_be_no_number() -> None:
    message = BatteryState(voltage=28.0, current=-2.0, temperature=20.0)
    message.charge = message.capacity = message.percentage = math.nan
    check_message("/bus/state", value_of(message))


numbers = st.lists(st.floats(width=64), max_size=4)


@given(st.integers(min_value=0, max_value=3), numbers, numbers, numbers)
def test_joint_state(count: int, position: list[float], velocity: list[float], effort: list[float]) -> None:
    """Refused exactly if a list is neither empty nor as long as the names, or holds what is not finite."""
    message = JointState(name=[f"joint_{i}" for i in range(count)])
    fields = {"position": position, "velocity": velocity, "effort": effort}
    bad = []
    for name, values in fields.items():
        setattr(message, name, array("d", values))
        if len(values) not in (0, count) or not all(map(math.isfinite, values)):
            bad.append(name)
    if not bad:
        check_message("/joint_states", value_of(message))
        return
    with pytest.raises(RefusedMessageError) as refusal:
        check_message("/joint_states", value_of(message))
    assert refusal.value.topic == "/joint_states"
    assert refusal.value.field.split("[")[0] == bad[0]


def test_large_finite_numbers_are_finite() -> None:
    check_finite("/x", "effort", np.array([1.7e308, 1.7e308]))


@pytest.mark.parametrize("field", ["positions", "velocities", "accelerations", "effort"])
def test_trajectory(field: str) -> None:
    def trajectory(values: list[float]) -> JointTrajectory:
        points = [JointTrajectoryPoint(positions=[0.0, 0.0]), JointTrajectoryPoint(positions=[0.0, 0.0])]
        setattr(points[1], field, values)
        return JointTrajectory(joint_names=["a", "b"], points=points)

    check_message("/arm/joint_trajectory", value_of(trajectory([0.0, 1.0])))
    for values in ([0.0], [0.0, math.nan], [0.0, 1.0, 2.0]):
        with pytest.raises(RefusedMessageError, match=rf"points\[1\]\.{field}"):
            check_message("/arm/joint_trajectory", value_of(trajectory(values)))


def test_measured_joints_are_complete() -> None:
    message = JointState(name=["a", "b"], position=[0.0, 0.0])
    with pytest.raises(RefusedMessageError, match="velocity = 0 numbers"):
        check_complete("/joint_states", value_of(message))
    message.velocity = [0.0, 0.0]
    check_complete("/joint_states", value_of(message))
    message.position = []
    with pytest.raises(RefusedMessageError, match="position = 0 numbers"):
        check_complete("/joint_states", value_of(message))


def test_ranges_of_the_table() -> None:
    row = topic("/drive_command")
    check_ranges(row, value_of(JointState(name=["a"], position=[0.0], velocity=[200.0])))
    for field, value in (("velocity", 200.1), ("velocity", -1e300), ("position", 1e7)):
        with pytest.raises(RefusedMessageError, match=rf"/drive_command\.{field}.*allowed is -"):
            check_ranges(row, value_of(JointState(name=["a"], **{field: [value]})))


def test_joint_names() -> None:
    known = {"a": 0, "b": 1}
    check_names("/drive_command", ["b", "a"], known)
    with pytest.raises(RefusedMessageError, match="c: allowed is one of a, b"):
        check_names("/drive_command", ["a", "c"], known)
    with pytest.raises(RefusedMessageError, match="each joint once"):
        check_names("/drive_command", ["a", "a"], known)


def test_types_without_numbers_pass() -> None:
    check_message("/operator/tick", value_of(Header()))


@pytest.mark.parametrize("text,fraction", [("on", 1.0), ("off", 0.0), ("0.25", 0.25), ("1", 1.0)])
def test_switch_texts(text: str, fraction: float) -> None:
    assert fraction_of(text) == fraction
    check_switches("/power/switches", {"arm": text}, ("arm",))


@pytest.mark.parametrize("text", ["nan", "inf", "-0.1", "1.01", "ON", "", "limit"])
def test_other_switch_texts_are_refused(text: str) -> None:
    with pytest.raises(RefusedMessageError, match=r"/power/switches\.status\.values\.arm"):
        check_switches("/power/switches", {"arm": text})


def test_unknown_load_is_refused_with_the_known_ones() -> None:
    with pytest.raises(RefusedMessageError, match="heater: allowed is one of arm, drive"):
        check_switches("/power/switches", {"heater": "on"}, ("arm", "drive"))


def test_a_wrench_is_finite_or_nowhere_measured() -> None:
    nan, zeros = np.full(3, np.nan), np.zeros(3)
    check_message("/wrench", WrenchValue(0, "", nan, nan))
    for force, torque, field in (
        (nan, zeros, "wrench.force.x"),
        (zeros, np.array([0.0, np.inf, 0.0]), "wrench.torque.y"),
    ):
        with pytest.raises(RefusedMessageError) as refusal:
            check_message("/wrench", WrenchValue(0, "", force, torque))
        assert refusal.value.field == field
