"""Types of common_interfaces without a codec of ours: their messages go through the ROS library, bit for bit."""

import math
from contextlib import suppress
from typing import Any

import numpy as np
import pytest
from geometry_msgs.msg import Point
from hypothesis import given
from hypothesis import strategies as st
from rclpy.serialization import deserialize_message
from sensor_msgs.msg import CompressedImage, LaserScan, MagneticField, Range, Temperature

from sojourn_contract.codecs import CODECS, decode, encode
from sojourn_contract.codecs.ros_library import message_of, serialised
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.topic_types import Topic

LARGEST = float(np.float32(3.4e38))
"""The ROS library refuses the very largest float32: it takes 3.402823466e+38 for the bound, which is less."""
NUMBERS = st.floats(-LARGEST, LARGEST, width=32) | st.sampled_from([math.inf, -math.inf])
KINDS = {
    "sensor_msgs/Range": st.builds(lambda x: Range(range=x, max_range=9.0), NUMBERS),
    "sensor_msgs/Temperature": st.builds(lambda x: Temperature(temperature=x), NUMBERS),
    "sensor_msgs/LaserScan": st.builds(lambda x: LaserScan(ranges=np.array(x, np.float32)), st.lists(NUMBERS)),
    "sensor_msgs/MagneticField": st.builds(lambda x: MagneticField(magnetic_field_covariance=[x] * 9), NUMBERS),
    "sensor_msgs/CompressedImage": st.builds(
        lambda x: CompressedImage(format="png", data=list(x)), st.binary(max_size=40)
    ),
}
every_kind = pytest.mark.parametrize("kind", sorted(KINDS))


def row_of(kind: str) -> Topic:
    return Topic("/something", kind, "sensors", (), 1, 1.0, "what it says")


@every_kind
@given(st.data())
def test_a_message_comes_out_as_it_went_in(kind: str, data: st.DataObject) -> None:
    assert kind not in CODECS
    message: Any = data.draw(KINDS[kind])
    seconds, part = data.draw(st.integers(0, 2**31 - 1)), data.draw(st.integers(0, 999_999_999))
    message.header.stamp.sec, message.header.stamp.nanosec = seconds, part
    message.header.frame_id = data.draw(st.text(st.characters(codec="ascii", exclude_characters="\0"), max_size=9))
    value = serialised(message)
    sent = encode(row_of(kind), value)
    assert value.stamp == seconds * 1_000_000_000 + part
    assert deserialize_message(sent, type(message)) == message == message_of(value)
    assert decode(row_of(kind), sent) == value


@every_kind
@given(st.binary(max_size=80))
def test_noise_is_refused_or_read(kind: str, noise: bytes) -> None:
    for data in (noise, b"\0\1\0\0" + noise):
        with suppress(RefusedMessageError):
            assert decode(row_of(kind), data).type == kind


def test_a_value_of_another_type_is_not_sent() -> None:
    with pytest.raises(TypeError, match=r"sensor_msgs/Range is no sensor_msgs/Temperature"):
        encode(row_of("sensor_msgs/Temperature"), serialised(Range()))


def test_a_message_without_a_header_has_no_stamp() -> None:
    with pytest.raises(ValueError, match=r"geometry_msgs/Point has no header"):
        serialised(Point())
