"""Every codec against the ROS library's own serialisation, both ways, and against bytes that hold no message."""

import struct
from contextlib import suppress
from typing import Any

import numpy as np
import pytest
from hostile_bytes import GARBAGE, whole
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from rclpy.serialization import deserialize_message, serialize_message

from ros_messages import ros_message
from sojourn_contract import values
from sojourn_contract.codecs import CODECS, decode
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.topic_types import Topic
from sojourn_contract.topics import TOPICS, topic
from sojourn_contract.types import message_class

STAMPS = st.integers(-(2**31) * 10**9, (2**31 - 1) * 10**9 + 10**9 - 1)
TEXTS = st.text(st.characters(exclude_characters="\0", exclude_categories=("Cs",)), max_size=9)
LONG_TEXTS = TEXTS | st.just("κ" * 300)
BYTE = st.integers(0, 255)
WORD = st.integers(0, 2**32 - 1)
FLOAT32 = st.floats(-(2.0**126), 2.0**126, width=32) | st.just(float("nan"))


def doubles(least: int = 0, most: int = 30) -> Any:
    return arrays.arrays(np.float64, st.integers(least, most), elements=st.floats())


def block(count: int) -> Any:
    return doubles(count, count)


POSES = st.builds(values.PoseStamped, STAMPS, TEXTS, block(3), block(4))
NAMES = st.lists(TEXTS, max_size=25).map(tuple)
STATUS = st.builds(
    values.DiagnosticStatus, TEXTS, st.lists(st.tuples(TEXTS, LONG_TEXTS), max_size=5).map(tuple), TEXTS, BYTE, TEXTS
)
FIELDS = st.lists(st.builds(values.PointField, TEXTS, WORD, BYTE, WORD), max_size=4).map(tuple)
CELLS = st.lists(FLOAT32, max_size=4).map(tuple)
POINTS = st.builds(values.TrajectoryPoint, doubles(), doubles(), doubles(), doubles(), STAMPS)
ROI = st.builds(values.RegionOfInterest, WORD, WORD, WORD, WORD, st.booleans())
CAMERAS = {"sensor_msgs/CameraInfo", "sensor_msgs/Image"}
"""Types of no row of the table, but of cameras."""
VALUES = {
    "diagnostic_msgs/DiagnosticArray": st.builds(
        values.DiagnosticArray, STAMPS, st.lists(STATUS, max_size=3).map(tuple), TEXTS
    ),
    "geometry_msgs/PoseStamped": POSES,
    "geometry_msgs/PoseWithCovarianceStamped": st.builds(
        values.PoseWithCovarianceStamped, STAMPS, TEXTS, block(3), block(4), block(36)
    ),
    "geometry_msgs/TwistStamped": st.builds(values.TwistStamped, STAMPS, TEXTS, block(3), block(3)),
    "geometry_msgs/Vector3Stamped": st.builds(values.Vector3Stamped, STAMPS, TEXTS, block(3)),
    "geometry_msgs/WrenchStamped": st.builds(values.WrenchStamped, STAMPS, TEXTS, block(3), block(3)),
    "nav_msgs/Odometry": st.builds(
        values.Odometry, STAMPS, TEXTS, TEXTS, block(3), block(4), block(3), block(3), block(36), block(36)
    ),
    "nav_msgs/OccupancyGrid": st.builds(
        values.OccupancyGrid, STAMPS, TEXTS, FLOAT32, WORD, WORD, block(3), st.binary(max_size=99), block(4), STAMPS
    ),
    "nav_msgs/Path": st.builds(values.Path, STAMPS, TEXTS, st.lists(POSES, max_size=4).map(tuple)),
    "rosgraph_msgs/Clock": st.builds(values.Clock, STAMPS),
    "sensor_msgs/BatteryState": st.builds(
        values.BatteryState, STAMPS, TEXTS, *[FLOAT32] * 7, *[BYTE] * 3, st.booleans(), CELLS, CELLS, TEXTS, LONG_TEXTS
    ),
    "sensor_msgs/CameraInfo": st.builds(
        values.CameraInfo, STAMPS, TEXTS, WORD, WORD, TEXTS, doubles(), block(9), block(9), block(12), WORD, WORD, ROI
    ),
    "sensor_msgs/Image": st.builds(values.Image, STAMPS, TEXTS, WORD, WORD, TEXTS, WORD, st.binary(max_size=99), BYTE),
    "sensor_msgs/Imu": st.builds(values.Imu, STAMPS, TEXTS, block(4), block(3), block(3), block(9), block(9), block(9)),
    "sensor_msgs/JointState": st.builds(values.JointState, STAMPS, NAMES, doubles(), doubles(), doubles(), TEXTS),
    "sensor_msgs/PointCloud2": st.builds(
        values.PointCloud2, STAMPS, TEXTS, WORD, FIELDS, WORD, st.binary(max_size=99), WORD, WORD, *[st.booleans()] * 2
    ),
    "std_msgs/Header": st.builds(values.Header, STAMPS, LONG_TEXTS),
    "trajectory_msgs/JointTrajectory": st.builds(
        values.JointTrajectory, STAMPS, NAMES, st.lists(POINTS, max_size=4).map(tuple), TEXTS
    ),
}
KINDS = pytest.mark.parametrize("kind", sorted(CODECS))


def same(one: Any, other: Any) -> bool:
    """Whether two values are equal in each field, NaN equal to NaN."""
    if isinstance(one, np.ndarray):
        return isinstance(other, np.ndarray) and other.dtype == one.dtype and np.array_equal(one, other, equal_nan=True)
    if isinstance(one, tuple):
        return type(one) is type(other) and len(one) == len(other) and all(map(same, one, other))
    return type(one) is type(other) and (one == other or (one != one and other != other))


def test_every_type_of_the_table_has_a_codec() -> None:
    assert set(CODECS) == {row.type for row in TOPICS} | CAMERAS == set(VALUES)


@KINDS
@settings(max_examples=40)
@given(st.data())
def test_what_ros_has_serialised_is_read(kind: str, data: st.DataObject) -> None:
    value = data.draw(VALUES[kind])
    sent = bytes(serialize_message(ros_message(value)))
    assert same(CODECS[kind].decode(sent), value)
    assert same(CODECS[kind].decode(sent + data.draw(st.binary(max_size=9))), value)  # what stands behind is nothing


@KINDS
@settings(max_examples=40)
@given(st.data())
def test_ros_reads_what_is_written(kind: str, data: st.DataObject) -> None:
    value = data.draw(VALUES[kind])
    sent = ros_message(value)
    got = deserialize_message(CODECS[kind].encode(value), message_class(kind))
    assert serialize_message(got) == serialize_message(sent) or repr(got) == repr(sent)  # padding is not initialised
    assert same(CODECS[kind].decode(CODECS[kind].encode(value)), value)


@KINDS
@settings(max_examples=40)
@given(st.data())
def test_cut_or_changed_bytes_are_refused_or_read(kind: str, data: st.DataObject) -> None:
    row = next((row for row in TOPICS if row.type == kind), Topic("/camera/topic", kind, "sensors", (), 50, 3.0, ""))
    sent = bytearray(CODECS[kind].encode(data.draw(VALUES[kind])))
    for _ in range(data.draw(st.integers(0, 4))):
        sent[data.draw(st.integers(0, len(sent) - 1))] = data.draw(st.sampled_from((0, 1, 7, 127, 128, 255)))
    cut = bytes(sent[: data.draw(st.integers(0, len(sent)))])
    try:
        value = decode(row, cut)
    except RefusedMessageError as refusal:
        assert refusal.topic == row.name and kind in refusal.allowed
    else:
        assert type(value).__name__ == kind.partition("/")[2]


@KINDS
@given(st.binary(max_size=60))
def test_noise_is_refused_or_read(kind: str, noise: bytes) -> None:
    for data in (noise, b"\0\1\0\0" + noise, b"\0\0\0\0" + noise):
        with suppress(ValueError, struct.error):
            CODECS[kind].decode(data)


@pytest.mark.parametrize("name", sorted(GARBAGE))
def test_garbage_that_has_ended_a_run_is_refused(name: str) -> None:
    with pytest.raises(RefusedMessageError):
        decode(topic(name), GARBAGE[name])


def test_a_truncated_message_is_refused_at_every_length_that_matters() -> None:
    for row in TOPICS:
        sent = whole(row)
        for length in range(12):
            with pytest.raises(RefusedMessageError):
                decode(row, sent[:length])


def test_the_other_byte_order_is_read() -> None:
    data = struct.pack(">4xiI", 3, 20_000_000) + struct.pack(">I4s", 4, b"map\0") + struct.pack(">3d", 1.0, 2.0, 3.0)
    value = CODECS["geometry_msgs/Vector3Stamped"].decode(data)
    assert value.stamp == 3_020_000_000 and value.frame == "map" and value.vector.tolist() == [1.0, 2.0, 3.0]
    names = struct.pack(">I2s2xI2s2x", 2, b"a\0", 2, b"b\0")
    data = struct.pack(">4xiIIx3xI", 1, 2, 1, 2) + names + struct.pack(">I2dII", 2, 5.0, 6.0, 0, 0)
    joints = CODECS["sensor_msgs/JointState"].decode(data)
    assert joints.names == ("a", "b") and joints.position.tolist() == [5.0, 6.0] and not len(joints.velocity)


def test_arrays_of_another_length_are_not_sent() -> None:
    with pytest.raises(ValueError, match="vector: 2 numbers where there are 3"):
        CODECS["geometry_msgs/Vector3Stamped"].encode(values.Vector3Stamped(0, "map", np.zeros(2)))


def test_an_array_that_was_read_belongs_to_the_reader() -> None:
    data = CODECS["sensor_msgs/JointState"].encode(values.JointState(1, ("a",), np.ones(1), np.ones(1)))
    one = CODECS["sensor_msgs/JointState"].decode(data)
    one.position[0] = 5.0
    assert CODECS["sensor_msgs/JointState"].decode(data).position[0] == 1.0 and one.position.flags.aligned


@given(st.lists(st.tuples(st.text("ab", min_size=2, max_size=2), st.text("ab", min_size=3, max_size=3)), min_size=2))
def test_texts_as_long_as_those_before_are_read_anew(pairs: list[tuple[str, str]]) -> None:
    codec = CODECS["diagnostic_msgs/DiagnosticArray"]
    said = [
        values.DiagnosticArray(stamp, (values.DiagnosticStatus("name", (pair,)),)) for stamp, pair in enumerate(pairs)
    ]
    assert [codec.decode(codec.encode(value)) for value in said] == said
