"""Stamps and messages: there and back again, through the bytes that go over the wire."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rclpy.serialization import serialize_message
from sensor_msgs.msg import BatteryState, PointField

from ros_messages import ros_message, ros_time
from sojourn_contract import messages, stamps
from sojourn_contract.topic_types import Topic
from sojourn_contract.topics import TOPICS
from sojourn_contract.types import message_class

NANOSECONDS = st.integers(min_value=0, max_value=(2**31 - 1) * 10**9)


@given(NANOSECONDS)
def test_stamp_in_seconds(stamp: int) -> None:
    assert stamps.seconds(stamp) == pytest.approx(stamp * 1e-9)


@pytest.mark.parametrize("row", TOPICS, ids=lambda row: row.name)
@settings(max_examples=10, deadline=None)
@given(stamp=NANOSECONDS)
def test_stamp_of_the_bytes_is_the_stamp_of_the_message(row: Topic, stamp: int) -> None:
    message = message_class(row.type)()
    time = ros_time(stamp)
    if row.name == "/clock":
        message.clock = time
    elif row.type == "std_msgs/Header":
        message.stamp, message.frame_id = time, "a frame"
    else:
        message.header.stamp, message.header.frame_id = time, "a frame"
    assert stamps.from_cdr(serialize_message(message)) == stamp


def test_stamp_of_big_endian_bytes() -> None:
    assert stamps.from_cdr(b"\x00\x00\x00\x00" + (7).to_bytes(4, "big") + (9).to_bytes(4, "big")) == 7 * 10**9 + 9


def test_control_period_divides_a_second() -> None:
    assert stamps.NANOSECONDS % stamps.CONTROL_PERIOD_NS == 0
    assert stamps.NANOSECONDS == 50 * stamps.CONTROL_PERIOD_NS


@given(st.floats(min_value=-3.1, max_value=3.1), st.floats(min_value=0.1, max_value=3.0))
def test_heading(yaw: float, length: float) -> None:
    """People type quaternions that are not of unit length; one of no length asks for no heading."""
    orientation = np.array([0.0, 0.0, length * math.sin(yaw / 2), length * math.cos(yaw / 2)])
    assert messages.yaw_of(orientation) == pytest.approx(yaw, abs=1e-9)
    assert messages.yaw_of(np.zeros(4)) is None


def test_battery_round_trip() -> None:
    sent = messages.battery_state(40_000_000, 28.4, 3.25, 293.15, 0.75, 3600.0 * 30.0, 3600.0 * 40.0)
    got = ros_message(sent)
    assert (got.voltage, got.current, got.temperature) == pytest.approx((28.4, -3.25, 20.0), rel=1e-6)
    assert (got.percentage, got.charge, got.capacity) == pytest.approx((0.75, 30.0, 40.0))
    assert got.power_supply_status == BatteryState.POWER_SUPPLY_STATUS_DISCHARGING
    assert messages.battery_readings(sent) == pytest.approx((28.4, 3.25, 293.15), rel=1e-6)
    charging = messages.battery_state(0, 28.4, -1.0, 293.15, math.nan, math.nan, math.nan)
    assert charging.power_supply_status == BatteryState.POWER_SUPPLY_STATUS_CHARGING
    assert math.isnan(charging.percentage)


def test_contact_cloud_round_trip() -> None:
    report = np.arange(3.0 * len(messages.CONTACT_FIELDS)).reshape(3, -1)
    got = ros_message(messages.contact_cloud(60_000_000, report))
    assert (got.width, got.height, got.row_step) == (3, 1, 3 * got.point_step)
    assert len(got.data) == got.row_step
    for column, field in enumerate(got.fields):
        assert field.name == messages.CONTACT_FIELDS[column] and field.datatype == PointField.FLOAT64
        for point in range(3):
            start = point * got.point_step + field.offset
            assert np.frombuffer(bytes(got.data[start : start + 8]), dtype="<f8")[0] == report[point, column]
