"""Rules on single messages: each test breaks one thing in a clean run, and exactly that is found."""

import array
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from clean_run import PERIOD, CleanRun, explorer, kinds, make, value_of
from geometry_msgs.msg import PoseStamped, TwistStamped
from hypothesis import given, settings
from hypothesis import strategies as st
from nav_msgs.msg import Path
from sensor_msgs.msg import JointState
from std_msgs.msg import Header
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from ros_messages import ros_message
from sojourn_contract.conformance.geometry import CovarianceRule
from sojourn_contract.conformance.numbers import NumberRule
from sojourn_contract.conformance.observation import Observation
from sojourn_contract.heartbeat import status_message
from sojourn_contract.topics import topic

Edit = Callable[[Any], None]


def set_at(path: str, value: Any) -> Edit:
    """An edit that sets a field; numbers in the path are indices."""

    def edit(message: Any) -> None:
        *parents, last = path.split(".")
        for name in parents:
            message = message[int(name)] if name.isdigit() else getattr(message, name)
        if last.isdigit():
            message[int(last)] = value
        else:
            setattr(message, last, value)

    return edit


def without(joint: str) -> Edit:
    """An edit that leaves out a joint with its numbers."""

    def edit(message: JointState) -> None:
        place = list(message.name).index(joint)
        message.name = [name for name in message.name if name != joint]
        for field in ("position", "velocity", "effort"):
            values = getattr(message, field)
            setattr(message, field, [value for index, value in enumerate(values) if index != place])

    return edit


def name_twice(message: JointState) -> None:
    message.name = [message.name[1], *message.name[1:]]


def degrees(field: str) -> Edit:
    def edit(message: JointState) -> None:
        setattr(message, field, [math.degrees(value) for value in getattr(message, field)])

    return edit


def say(key: str, text: str) -> Edit:
    return lambda message: setattr(value_of(message, key), "value", text)


def wider_cloud(message: Any) -> None:
    message.width += 1


def infinite_torque(message: Any) -> None:
    points = np.frombuffer(bytes(message.data)).reshape(explorer().contacts, -1).copy()
    points[2, 9] = math.inf
    message.data = points.tobytes()


def put_point(message: Any, point: int, column: int, value: float) -> None:
    points = np.frombuffer(bytes(message.data), dtype=np.float32).reshape(-1, 3).copy()
    points[point, column] = value
    message.data = points.tobytes()


def no_number(message: Any) -> None:
    put_point(message, 7, 1, math.nan)


def far_point(message: Any) -> None:
    put_point(message, 3, 0, 1e4)


WHEELS = "wheel_front_left_joint"
DEFECTS: dict[str, tuple[str, Edit, str, str]] = {
    "NaN in a position": ("/odom", set_at("pose.pose.position.x", math.nan), "value", "pose.pose.position.x"),
    "infinite effort": ("/arm_command", set_at("effort.2", math.inf), "value", "effort"),
    "NaN in a covariance": ("/odom", set_at("pose.covariance.7", math.nan), "value", "pose.covariance"),
    "NaN where it is measured": ("/bus/state", set_at("voltage", math.nan), "value", "voltage"),
    "infinite where it is not measured": ("/bus/state", set_at("charge", math.inf), "value", "charge"),
    "voltage out of range": ("/bus/state", set_at("voltage", 280.0), "value", "voltage"),
    "percentage in percent": ("/battery_state", set_at("percentage", 60.0), "value", "percentage"),
    "wrong frame": ("/odom", set_at("header.frame_id", "map"), "frame", "header.frame_id"),
    "wrong frame of the truth": ("/truth/odom", set_at("header.frame_id", "odom"), "frame", "header.frame_id"),
    "wrong frame of the IMU": ("/imu/data", set_at("header.frame_id", "base_link"), "frame", "header.frame_id"),
    "wrong frame of the contacts": ("/truth/contacts", set_at("header.frame_id", ""), "frame", "header.frame_id"),
    "wrong child frame": ("/odom", set_at("child_frame_id", "base"), "frame", "child_frame_id"),
    "a joint left out of the truth": ("/truth/joint_states", without("bogie_left_joint"), "joints", "name"),
    "a joint left out by the sensors": ("/joint_states", without(WHEELS), "joints", "name"),
    "an unknown joint": ("/drive_command", set_at("name.0", "wheel_7"), "joints", "name"),
    "a joint of the arm in a wheel command": ("/drive_command", set_at("name.0", "arm_wrist_joint"), "joints", "name"),
    "a wheel in an arm command": ("/arm_command", set_at("name.0", WHEELS), "joints", "name"),
    "a joint named twice": ("/arm_command", name_twice, "joints", "name"),
    "too few positions": ("/arm_command", set_at("position", [0.0]), "joints", "position"),
    "too few efforts": ("/truth/joint_states", set_at("effort", [0.0]), "joints", "effort"),
    "no efforts where they are asked for": ("/truth/joint_states", set_at("effort", []), "joints", "effort"),
    "no rates for wheels": ("/drive_command", set_at("velocity", []), "joints", "velocity"),
    "no positions for steering": ("/drive_command", set_at("position", []), "joints", "position"),
    "degrees for radians": ("/drive_command", degrees("velocity"), "limit", "velocity"),
    "an angle beyond the stop": ("/arm_command", set_at("position.0", 2.0), "limit", "position"),
    "a quaternion that is none": ("/odom", set_at("pose.pose.orientation.w", 0.9), "orientation",
                                  "pose.pose.orientation"),
    "an attitude of zeros": ("/imu/data", set_at("orientation.w", 0.0), "orientation", "orientation"),
    "a negative variance": ("/odom", set_at("pose.covariance.7", -1e-3), "covariance", "pose.covariance"),
    "a covariance across its diagonal": ("/odom", set_at("twist.covariance.1", 0.1), "covariance", "twist.covariance"),
    "one point too many": ("/truth/contacts", wider_cloud, "cloud", "width"),
    "a field of the cloud renamed": ("/truth/contacts", set_at("fields.3.name", "depth"), "cloud", "fields"),
    "an infinite torque": ("/truth/contacts", infinite_torque, "cloud", "torque"),
    "a cloud in the camera's frame": ("/hazcam/points", set_at("header.frame_id", "hazcam_link"), "frame",
                                      "header.frame_id"),
    "a point that is none": ("/hazcam/points", no_number, "cloud", "y"),
    "a point on the horizon": ("/hazcam/points", far_point, "cloud", "x"),
    "a cloud without heights": ("/hazcam/points", set_at("fields.2.name", "intensity"), "cloud", "fields"),
    "points cut off": ("/hazcam/points", set_at("data", [1, 2]), "cloud", "data"),
    "data cut off": ("/truth/contacts", set_at("data", [1, 2]), "cloud", "data"),
    "a way in another frame": ("/plan", set_at("header.frame_id", "map"), "frame", "header.frame_id"),
    "a way that leads nowhere": ("/plan", set_at("poses.0.pose.position.y", math.nan), "value",
                                 "poses"),
    "a cell too few": ("/local_costmap/costmap", set_at("data", array.array("b", [0])), "grid", "data"),
    "a cell of more than all": ("/local_costmap/costmap", set_at("data.3", 127), "grid", "data"),
    "a grid without sides": ("/local_costmap/costmap", set_at("info.resolution", -0.1), "value", "info.resolution"),
    "a grid that lies nohow": ("/local_costmap/costmap", set_at("info.origin.orientation.w", 0.0), "orientation",
                               "info.origin.orientation"),
    "a load that is not there": ("/power/switches", lambda m: setattr(value_of(m, "arm"), "key", "oven"), "switches",
                                 "status.values.key"),
    "a switch that is none": ("/power/switches", say("arm", "half"), "switches", "status.values.arm"),
    "a state that is none": ("/drive/status", say("state", "driving"), "status", "status.values.state"),
    "a stamp that is none": ("/arm/status", say("goal_stamp", "0.2"), "status", "status.values.goal_stamp"),
    "an empty status": ("/arm/status", set_at("status", []), "status", "status"),
    "a power that is no number": ("/truth/loads", say("power drive", "nan"), "loads", "status.values.power drive"),
    "a tick that is none": ("/operator/tick", set_at("frame_id", "goals: 1"), "tick", "frame_id"),
}  # fmt: skip


def test_a_clean_run_has_no_violation() -> None:
    report = CleanRun().judge()
    assert not list(report.lines())
    assert report.violations == 0 and sum(report.messages.values()) == len(CleanRun().entries)


@pytest.mark.parametrize("defect", DEFECTS)
def test_one_defect_is_found_and_nothing_else(defect: str) -> None:
    name, edit, rule, field = DEFECTS[defect]
    run = CleanRun()
    edit(run.one(name))
    also = {"rate of change"} if name in ("/odom", "/imu/data", "/joint_states", "/truth/joint_states") else set()
    report = run.judge()
    found = kinds(report)
    assert (rule, name, field) in found
    # a wrong orientation or position is a wrong change as well; nothing else may be found
    assert {kind for kind in found if kind[0] not in also} == {(rule, name, field)}
    (group,) = [group for group in report.groups if group.rule == rule]
    assert len({violation.stamp for violation in group.first}) == 1
    assert group.first[0].stamp is not None and name in str(group.first[0]) and "allowed" in str(group.first[0])


@pytest.mark.parametrize("defect", ["NaN in a position", "wrong frame", "an unknown joint"])
def test_a_violation_names_topic_stamp_field_value_and_what_is_allowed(defect: str) -> None:
    name, edit, _, _ = DEFECTS[defect]
    run = CleanRun()
    edit(run.one(name))
    line = next(iter(run.judge().lines()))
    texts = {
        "NaN in a position": "/odom at 0.82 s: pose.pose.position.x = NaN (allowed: a finite number)",
        "wrong frame": "/odom at 0.82 s: header.frame_id = 'map' (allowed: 'odom')",
        "an unknown joint": "/drive_command at 0.82 s: name = wheel_7 (allowed: one of wheel_front_left_joint,",
    }
    assert line.startswith(texts[defect])


def test_repeats_are_counted() -> None:
    run = CleanRun()
    for entry in run.of("/imu/data"):
        entry.message.header.frame_id = "imu"
    report = run.judge()
    lines = list(report.lines())
    assert report.violations == 110 and len(lines) == 4
    assert lines[-1] == "/imu/data: 107 more like the last until 2.20 s, worst: 'imu'"
    data = report.as_data()
    assert data["topics"]["/imu/data"] == {"messages": 110, "violations": 110}
    assert data["groups"][0]["count"] == 110 and len(data["groups"][0]["first"]) == 3


def goal(name: str, message: Any, stamp: int = 3 * PERIOD) -> CleanRun:
    """A clean run with one goal in it, counted by the operator."""
    run = CleanRun()
    run.add(name, stamp, message)
    return run


def pose(frame: str, w: float = 1.0) -> PoseStamped:
    message = PoseStamped()
    message.header.frame_id, message.pose.orientation.w = frame, w
    return message


def request(**switches: str) -> Any:
    return ros_message(status_message(0, "request", switches))


def test_good_goals() -> None:
    joints = list(explorer().arm)
    route = Path(poses=[pose("map")])
    route.header.frame_id = "map"
    twist = TwistStamped()
    named = JointState()
    named.header.frame_id = "stow"
    trajectory = JointTrajectory(joint_names=joints, points=[JointTrajectoryPoint(positions=[0.0] * 5)])
    for name, message in {
        "/goal_pose": pose("odom", 0.0),
        "/arm/goal_pose": pose("base_link"),
        "/waypoints": route,
        "/arm/path": route,
        "/cmd_vel": twist,
        "/arm/cmd_vel": twist,
        "/arm/joint_goal": named,
        "/arm/joint_trajectory": trajectory,
        "/arm/stop": Header(),
        "/power/request": request(cameras="off", arm="on"),
    }.items():
        assert not list(goal(name, message).judge().lines()), name


@pytest.mark.parametrize(
    ("name", "message", "rule", "field"),
    [
        ("/goal_pose", pose("moon"), "frame", "header.frame_id"),
        ("/arm/goal_pose", pose("camera"), "frame", "header.frame_id"),
        ("/arm/path", Path(), "frame", "header.frame_id"),
        ("/goal_pose", pose("map", 0.5), "orientation", "pose.orientation"),
        ("/arm/joint_goal", JointState(), "joints", "header.frame_id"),
        ("/arm/joint_goal", JointState(name=["elbow"], position=[0.0]), "joints", "name"),
        ("/arm/joint_goal", JointState(name=["arm_elbow_joint"], position=[170.0]), "limit", "position"),
        (
            "/arm/joint_trajectory",
            JointTrajectory(joint_names=["arm_elbow_joint"], points=[JointTrajectoryPoint(positions=[0.0, 0.0])]),
            "joints",
            "points",
        ),
        ("/power/request", request(oven="on"), "request", "status.values.key"),
        ("/power/request", request(cameras="dim"), "request", "status.values.cameras"),
        ("/power/request", request(), "request", "status.values"),
    ],
)
def test_bad_goals(name: str, message: Any, rule: str, field: str) -> None:
    assert kinds(goal(name, message).judge()) == {(rule, name, field)}


def test_a_goal_that_comes_too_late_or_from_another_clock() -> None:
    run = goal("/goal_pose", pose("map"))
    run.entries[-1].logged = 3 * PERIOD + 10_500_000_000
    assert kinds(run.judge()) == {("stamp", "/goal_pose", "age")}
    run = goal("/goal_pose", pose("map"), 1_700_000_000 * 10**9)
    run.entries[-1].logged = PERIOD
    assert kinds(run.judge()) == {("stamp", "/goal_pose", "header.stamp")}
    run = goal("/goal_pose", pose("map"), 0)
    assert not list(run.judge().lines())


NUMBERS = {
    "/odom": ["pose.pose.position.y", "twist.twist.linear.z", "twist.twist.angular.x", "pose.pose.orientation.x"],
    "/imu/data": ["angular_velocity.x", "linear_acceleration.y"],
    "/battery_state": ["voltage", "current", "temperature", "charge", "percentage"],
    "/cmd_vel": ["twist.linear.x", "twist.angular.z"],
    "/goal_pose": ["pose.position.z", "pose.orientation.w"],
}
VALUES = st.floats(-(2.0**100), 2.0**100, width=32) | st.sampled_from([math.nan, math.inf, -math.inf])
MESSAGES = {"/cmd_vel": TwistStamped, "/goal_pose": PoseStamped}


@given(st.sampled_from([(name, path) for name, paths in NUMBERS.items() for path in paths]), VALUES)
@settings(max_examples=200, deadline=None)
def test_a_number_is_found_exactly_if_it_is_out_of_its_range(place: tuple[str, str], value: float) -> None:
    name, path = place
    row = topic(name)
    message = MESSAGES[name]() if name in MESSAGES else make(row, PERIOD, explorer())
    set_at(path, value)(message)
    (rule,) = [rule for rule in row.fields if path == rule.path or path.startswith(rule.path + ".")]
    good = (rule.low <= value <= rule.high) or (rule.optional and math.isnan(value))
    found = NumberRule(row).judge(Observation(row, message, PERIOD, None, 0))
    assert [entry.field for entry in found] == ([] if good else [path])


@given(st.lists(st.floats(-1e3, 1e3), min_size=36, max_size=36))
def test_any_product_of_a_matrix_with_its_transpose_is_a_covariance(values: list[float]) -> None:
    factor = np.array(values).reshape(6, 6)
    row = topic("/odom")
    message = make(row, PERIOD, explorer())
    message.pose.covariance = (factor @ factor.T).ravel()
    assert not CovarianceRule(row).judge(Observation(row, message, PERIOD, None, 0))
