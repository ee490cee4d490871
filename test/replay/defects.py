"""Defects as they happen to people who write nodes. Each is put into a node of ours, after it has been made.

A defect says which field the comparison with the recorded answers must name, and which field the judge of the contract
must, who knows nothing of those answers; None where it cannot see it. Both at once is the rule for what the contract
forbids, the comparison alone for numbers that are wrong and plausible.
"""

import math
from collections.abc import Callable
from copy import deepcopy
from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Any

import numpy as np
from rclpy.qos import QoSProfile, ReliabilityPolicy

from ros_messages import ros_message, ros_time, value_of
from sojourn_contract.heartbeat import RUNNING
from sojourn_contract.stamps import CONTROL_PERIOD_NS
from sojourn_contract.types import message_class
from sojourn_physics.environment.gravity.field import UniformField

SECOND = 1_000_000_000
Alter = Callable[[Any], Any]


@dataclass(frozen=True)
class Defect:
    """A defect.

    Args:
        name: what it is. role: whose node has it. put_in: patches a node.
        replay: the field that the comparison names; None where the replay goes on as if nothing were.
        judge: the field that the judge names, likewise.
    """

    name: str
    role: str
    put_in: Callable[[Any], None]
    replay: str | None
    judge: str | None


DEFECTS: list[Defect] = []


def defect(role: str, replay: str | None = None, judge: str | None = None) -> Callable[[Any], Any]:
    def note(put_in: Callable[[Any], None]) -> Callable[[Any], None]:
        DEFECTS.append(Defect(put_in.__name__, role, put_in, replay, judge))
        return put_in

    return note


# Ways to put a defect in


def alter(node: Any, topic: str, change: Alter) -> None:
    """Every message of a topic is changed by `change(message)`, as one of the ROS library, before it is published."""
    publish = node.publish

    def altered(name: str, message: Any) -> None:
        if name == topic:
            changed = ros_message(message)
            change(changed)
            message = value_of(changed)
        publish(name, message)

    node.publish = altered


def lose(node: Any, topic: str, every: int) -> None:
    """Each so-many-th message is counted as sent, and never is."""
    sender, count = node.endpoints.senders[topic], iter(range(1, 1_000_000))
    node.endpoints.senders[topic] = SimpleNamespace(
        publish=lambda message: None if next(count) % every == 0 else sender.publish(message),
        get_subscription_count=sender.get_subscription_count,
    )


def one_behind(node: Any, topic: str, *fields: str) -> None:
    """What was true a period ago is said with today's stamp."""
    held: dict[str, Any] = {}

    def change(message: Any) -> None:
        for name in fields:
            now = deepcopy(getattr(message, name))
            setattr(message, name, held.get(name, now))
            held[name] = now

    alter(node, topic, change)


def restamp(node: Any, topic: str, stamp_of: Callable[[int], int]) -> None:
    def change(message: Any) -> None:
        message.header.stamp = ros_time(stamp_of(value_of(message).stamp))

    alter(node, topic, change)


def swap(values: Any, first: int, second: int) -> None:
    values[first], values[second] = values[second], values[first]


def rotate_velocity(node: Any, topic: str) -> None:
    """A velocity in the frame of the pose, which should be in the body's."""

    def change(message: Any) -> None:
        q, v = message.pose.pose.orientation, message.twist.twist.linear
        yaw = 2.0 * math.atan2(q.z, q.w)
        v.x, v.y = v.x * math.cos(yaw) - v.y * math.sin(yaw), v.x * math.sin(yaw) + v.y * math.cos(yaw)

    alter(node, topic, change)


def set_parameters(node: Any, **changes: Any) -> None:
    """Other parameters of the drive's goal follower."""
    params = node.app.model.params
    follower = params.follower.model_copy(update=changes)
    object.__setattr__(node.app.model, "params", params.model_copy(update={"follower": follower}))


# Drive


@defect("drive", replay="/drive_command.velocity")
def a_gain_is_one_percent_off(drive: Any) -> None:
    set_parameters(drive, distance_gain=1.01 * drive.app.model.params.follower.distance_gain)


@defect("drive", replay="/odom.twist.twist.angular.z")
def the_gyro_has_the_wrong_sign(drive: Any) -> None:
    read = drive.app._measurements.drive_input

    def flipped(*given: Any) -> Any:
        measured = read(*given)
        return replace(measured, felt=measured.felt._replace(gyro=tuple(-rate for rate in measured.felt.gyro)))

    drive.app._measurements.drive_input = flipped


@defect("drive", replay="/drive_command.position", judge="/drive_command.position")
def steering_is_commanded_in_degrees(drive: Any) -> None:
    def change(message: Any) -> None:
        message.position = np.degrees(message.position).tolist()

    alter(drive, "/drive_command", change)


@defect("drive", replay="/odom.header.frame_id", judge="/odom.header.frame_id")
def odometry_is_in_the_wrong_frame(drive: Any) -> None:
    alter(drive, "/odom", lambda message: setattr(message.header, "frame_id", "map"))


@defect("drive", replay="/odom.twist.twist.linear.y", judge="/odom.twist.twist.linear.y")
def velocity_is_given_in_odom(drive: Any) -> None:
    rotate_velocity(drive, "/odom")


@defect("drive", replay="/drive_command.velocity")
def commands_come_a_period_late(drive: Any) -> None:
    one_behind(drive, "/drive_command", "position", "velocity")


@defect("drive", replay="/odom missing", judge="/odom.header.stamp")
def one_message_in_a_hundred_is_lost(drive: Any) -> None:
    lose(drive, "/odom", 100)


@defect("drive", replay="/drive_command missing", judge="/drive_command.header.stamp")
def stamps_are_those_of_the_last_period(drive: Any) -> None:
    restamp(drive, "/drive_command", lambda stamp: stamp - CONTROL_PERIOD_NS)


@defect("drive", replay="/odom missing", judge="/odom.header.stamp")
def the_clock_drifts(drive: Any) -> None:
    restamp(drive, "/odom", lambda stamp: stamp + stamp // 100_000)


@defect("drive", replay="/drive_command.velocity")
def a_pair_of_wheels_is_swapped(drive: Any) -> None:
    alter(drive, "/drive_command", lambda message: swap(message.velocity, 0, 1))


@defect("drive", replay="/drive_command.velocity", judge="/drive_command.velocity")
def a_rate_is_nan_once(drive: Any) -> None:
    def change(message: Any) -> None:
        if value_of(message).stamp == 3 * SECOND:
            message.velocity[2] = math.nan

    alter(drive, "/drive_command", change)


@defect("drive", replay="/odom.pose.pose.position.x")
def odometry_is_kept_in_float32(drive: Any) -> None:
    def change(message: Any) -> None:
        position = message.pose.pose.position
        position.x, position.y = float(np.float32(position.x)), float(np.float32(position.y))

    alter(drive, "/odom", change)


@defect("drive", replay="/odom.pose.covariance", judge="/odom.pose.covariance")
def a_covariance_is_not_symmetric(drive: Any) -> None:
    alter(drive, "/odom", lambda message: message.pose.covariance.__setitem__(1, message.pose.covariance[0]))


@defect("drive", replay="/diagnostics missing", judge="/diagnostics.header.stamp of drive")
def a_heartbeat_is_missing(drive: Any) -> None:
    send = drive._send_heartbeat

    def forgetful(state: str, stamp: int, *rest: Any, **more: Any) -> None:
        if (state, stamp) != (RUNNING, 3 * SECOND):
            send(state, stamp, *rest, **more)

    drive._send_heartbeat = forgetful


@defect("drive", replay="/odom: qos.reliability", judge="/odom: qos.reliability")
def a_publisher_is_best_effort(drive: Any) -> None:
    drive.destroy_publisher(drive.endpoints.senders["/odom"])
    loose = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)
    drive.endpoints.senders["/odom"] = drive.create_publisher(message_class("nav_msgs/Odometry"), "odom", loose)


# Arm


@defect("arm", replay="/arm_command.effort")
def gravity_has_the_wrong_sign(arm: Any) -> None:
    measured = arm.app._measurements
    gravity_in_base = measured._gravity_in_base
    measured._gravity_in_base = lambda *given: -gravity_in_base(*given)


@defect("arm", replay="/arm_command.name", judge="/arm_command.position")
def joints_are_named_in_another_order(arm: Any) -> None:
    """The numbers stay where they were: the shoulder does what the elbow should."""
    alter(arm, "/arm_command", lambda message: swap(message.name, 1, 2))


@defect("arm", replay="/arm_command.name", judge="/arm_command.name")
def a_joint_has_the_name_of_another_machine(arm: Any) -> None:
    alter(arm, "/arm_command", lambda message: message.name.__setitem__(0, "arm_joint_1"))


@defect("arm", replay="/arm_command.position")
def a_goal_is_read_in_degrees(arm: Any) -> None:
    read = arm.app._goals.request

    def request(topic: str, message: Any, *rest: Any) -> Any:
        if topic == "/arm/joint_goal":
            message = message._replace(position=np.radians(message.position))
        return read(topic, message, *rest)

    arm.app._goals.request = request


@defect("arm", replay="/arm_command.velocity (length)", judge="/arm_command.velocity")
def an_array_is_too_short(arm: Any) -> None:
    alter(arm, "/arm_command", lambda message: message.velocity.pop())


# Power


@defect("power", replay="/battery_state.percentage", judge="/battery_state.percentage")
def charge_is_given_in_percent(power: Any) -> None:
    alter(power, "/battery_state", lambda message: setattr(message, "percentage", 100.0 * message.percentage))


@defect("power", replay="/battery_state.temperature", judge="/battery_state.temperature")
def temperature_is_given_in_kelvin(power: Any) -> None:
    alter(power, "/battery_state", lambda message: setattr(message, "temperature", message.temperature + 273.15))


@defect("power", replay="/battery_state.current")
def current_has_the_wrong_sign(power: Any) -> None:
    alter(power, "/battery_state", lambda message: setattr(message, "current", -message.current))


@defect("power", replay="/power/switches.status.values.actuator_heater")
def a_load_is_shed_at_another_charge(power: Any) -> None:
    law = power.app.params.law.model_copy(update={"shed_soc_first": 1.01 * power.app.params.law.shed_soc_first})
    power.app.params = power.app.params.model_copy(update={"law": law})


@defect("power", replay="/power/switches.status.values.drive", judge="/power/switches.status.values.key")
def a_load_is_misspelt(power: Any) -> None:
    def change(message: Any) -> None:
        for pair in message.status[0].values:
            pair.key = "drives" if pair.key == "drive" else pair.key

    alter(power, "/power/switches", change)


@defect("power", replay="/power/switches missing", judge="/power/switches.header.stamp")
def switches_are_said_at_half_the_rate(power: Any) -> None:
    lose(power, "/power/switches", 2)


# Sensors


@defect("sensors", replay="/joint_states.name", judge="/joint_states.position")
def encoders_are_wired_in_another_order(sensors: Any) -> None:
    alter(sensors, "/joint_states", lambda message: swap(message.name, 0, 1))


@defect("sensors", replay="/joint_states.velocity", judge="/joint_states.velocity")
def rates_are_in_degrees(sensors: Any) -> None:
    def change(message: Any) -> None:
        message.velocity = np.degrees(message.velocity).tolist()

    alter(sensors, "/joint_states", change)


@defect("sensors", judge="/joint_states.velocity")
def an_encoder_counts_from_zero_to_a_turn(sensors: Any) -> None:
    """A whole turn more is the same angle to the comparison; to who takes differences it is a jump."""

    def change(message: Any) -> None:
        message.position = np.mod(message.position, 2.0 * math.pi).tolist()

    alter(sensors, "/joint_states", change)


@defect("sensors", replay="/joint_states.velocity")
def rates_are_taken_over_a_period_that_drifts(sensors: Any) -> None:
    act = sensors.on_period

    def drifting(stamp: int, *rest: Any) -> None:
        before = sensors.state  # the period is a ten-thousandth longer
        sensors.state = replace(before, measured_at=before.measured_at - 2000)
        act(stamp, *rest)

    sensors.on_period = drifting


@defect("sensors", replay="/imu/data.linear_acceleration.z")
def gravity_is_left_out(sensors: Any) -> None:
    _imu(sensors)._motion._gravity = UniformField(0.0)


@defect("sensors", replay="/imu/data.orientation", judge="/imu/data.orientation")
def an_attitude_is_not_of_unit_length(sensors: Any) -> None:
    def change(message: Any) -> None:
        message.orientation.w *= 1.01

    alter(sensors, "/imu/data", change)


@defect("sensors", replay="/imu/data.angular_velocity.x")
def noise_has_another_seed(sensors: Any) -> None:
    site = _imu(sensors).site
    other = site.scenario.config.model_copy(update={"seed": site.seed + 1})
    site.scenario = replace(site.scenario, config=other)


def _imu(sensors: Any) -> Any:
    return next(sensor for sensor in sensors.app.sensors if sensor.name == "imu")


# Plant


@defect("plant", replay="/truth/odom.twist.twist.linear.y", judge="/truth/odom.twist.twist.linear.y")
def true_velocity_is_given_in_map(plant: Any) -> None:
    rotate_velocity(plant, "/truth/odom")
