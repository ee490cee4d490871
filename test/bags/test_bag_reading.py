"""Reading: the fast path against the type store's own decoder, bags cut off anywhere, and what is no bag."""

import array
import random
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from fake_stack import contacts
from geometry_msgs.msg import PoseStamped
from hypothesis import given, settings
from hypothesis import strategies as st
from nav_msgs.msg import Odometry
from nav_msgs.msg import Path as Route
from sensor_msgs.msg import BatteryState, Imu, JointState, PointCloud2, PointField
from std_msgs.msg import Header
from synthetic import CHANNELS, PERIOD, SyntheticRun, cdr
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from sojourn_bags.definitions import ChannelSpec, full_type, typestore
from sojourn_bags.errors import UnknownTopicInBagError, UnreadableBagError
from sojourn_bags.layout import layout_of
from sojourn_bags.messages import Messages
from sojourn_bags.reading import bag_file, read_bag
from sojourn_bags.writer import BagWriter
from sojourn_contract.topics import TOPICS

texts = st.text(st.characters(codec="utf-8", exclude_characters="\0"), max_size=9)
numbers = st.lists(st.floats(width=64), max_size=5)


@st.composite
def messages(draw: Any) -> Any:
    """A message of one of the contract's types with lengths of every kind."""
    header = Header(frame_id=draw(texts))
    header.stamp.sec, header.stamp.nanosec = draw(st.integers(0, 10**6)), draw(st.integers(0, 10**9 - 1))
    wide = array.array("d", draw(numbers))
    names = draw(st.lists(texts, max_size=4))
    kind = draw(st.integers(0, 7))
    if kind == 0:
        return JointState(header=header, name=names, position=wide, effort=array.array("d", draw(numbers)))
    if kind == 1:
        return Odometry(header=header, child_frame_id=draw(texts))
    if kind == 2:
        cells = array.array("f", draw(st.lists(st.floats(width=32), max_size=3)))
        return BatteryState(header=header, voltage=3.5, cell_voltage=cells, location=draw(texts), present=True)
    if kind == 3:
        fields = [PointField(name=name, offset=4 * i, datatype=7, count=1) for i, name in enumerate(names)]
        return PointCloud2(header=header, fields=fields, data=array.array("B", draw(st.binary(max_size=9))))
    if kind == 4:
        values = [KeyValue(key=name, value=draw(texts)) for name in names]
        return DiagnosticArray(header=header, status=[DiagnosticStatus(level=b"\2", name=draw(texts), values=values)])
    if kind == 5:
        return Route(header=header, poses=[PoseStamped(header=Header(frame_id=name)) for name in names])
    if kind == 6:
        points = [JointTrajectoryPoint(positions=wide), JointTrajectoryPoint(effort=wide)]
        return JointTrajectory(header=header, joint_names=names, points=points)
    return Imu(header=header)


def attribute(message: Any, path: str) -> Any:
    """Value of a dotted path with indices."""
    for part in path.replace("[", ".[").split("."):
        message = message[int(part[1:-1])] if part.startswith("[") else getattr(message, part)
    return message


@settings(max_examples=60, deadline=None)
@given(messages())
def test_layout_finds_what_the_decoder_finds(message: Any) -> None:
    name = full_type(f"{type(message).__module__.split('.')[0]}/{type(message).__name__}")
    data = cdr(message)
    decoded = typestore().deserialize_cdr(data, name)
    layout = layout_of(name, data)
    rows = np.frombuffer(data, dtype=np.uint8)[np.newaxis]
    for path in layout.numbers:
        found = layout.column(rows, path)[0]
        assert np.array_equal(found, attribute(decoded, path), equal_nan=np.asarray(found).dtype.kind == "f"), path
    for path, text in layout.texts.items():
        assert data[text.offset : text.offset + text.length].decode() == attribute(decoded, path), path


@settings(max_examples=20, deadline=None)
@given(messages(), st.integers(0, 10**6))
def test_message_that_is_cut_off_is_refused(message: Any, place: int) -> None:
    name = full_type(f"{type(message).__module__.split('.')[0]}/{type(message).__name__}")
    data = cdr(message)
    with pytest.raises(ValueError, match="byte"):  # ends after so many bytes, or a text without its end at a byte
        layout_of(name, data[: place % len(data)])


def topic_of(*contents: Any) -> Messages:
    """Messages in memory."""
    kind = type(contents[0])
    name = full_type(f"{kind.__module__.split('.')[0]}/{kind.__name__}")
    return Messages("/topic", name, list(range(len(contents))), [cdr(content) for content in contents])


def test_joints_are_found_by_name_whatever_their_order() -> None:
    first = JointState(name=["aa", "bb"], position=array.array("d", [1.0, 2.0]), velocity=array.array("d", [3.0, 4.0]))
    turned = JointState(name=["bb", "aa"], position=array.array("d", [5.0, 6.0]))
    longer = JointState(name=["aa", "bb", "cc"], position=array.array("d", [7.0, 8.0, 9.0]))
    joints = topic_of(first, turned, first, longer).joints()
    assert joints.names == ("aa", "bb", "cc")
    nan = np.nan
    np.testing.assert_array_equal(joints.position, [[1, 2, nan], [6, 5, nan], [1, 2, nan], [7, 8, 9]])
    np.testing.assert_array_equal(joints.velocity[:2, :2], [[3, 4], [nan, nan]])
    assert np.isnan(joints.effort).all()
    with pytest.raises(UnknownTopicInBagError, match="joint dd"):
        joints.index("dd")


def test_points_are_read_by_their_fields_whatever_their_width() -> None:
    points = topic_of(contacts(20 * 10**6), contacts(40 * 10**6)).points()
    np.testing.assert_array_equal(points["x"], [[0.02] * 6, [0.04] * 6])  # float64: exact
    np.testing.assert_array_equal(points["y"], [range(6), range(6)])
    np.testing.assert_allclose(points["sinkage"][1], 0.01 * np.arange(1, 7), rtol=1e-6)
    assert list(points) == [
        "x", "y", "z", "sinkage", "slip_ratio", "slip_angle", "force_x", "force_y", "force_z", "torque",
        "soil",
    ]  # fmt: skip


def test_fields_that_some_messages_lack_are_nan() -> None:
    messages = topic_of(BatteryState(voltage=28.0), BatteryState(voltage=27.0, cell_voltage=array.array("f", [3.0])))
    np.testing.assert_array_equal(messages.column("voltage"), [28.0, 27.0])
    np.testing.assert_array_equal(messages.column("cell_voltage"), [[np.nan], [3.0]])
    with pytest.raises(UnknownTopicInBagError, match=r"/topic\.volts is not in the bag: there are .*voltage"):
        messages.column("volts")


@pytest.fixture
def recorded(tmp_path: Path) -> Path:
    """A small bag with three chunks, each flushed."""
    run = SyntheticRun(tmp_path / "bag", "flat_drive")
    for period in range(1, 31):
        run.truth(period * PERIOD, (0.1 * period, 0.0, 0.0, 0.0), {"wheel_front_left_joint": 1.0}, 2.0)
        if period % 10 == 0:
            run.writer.flush()
    run.close(30 * PERIOD)
    return run.writer.path


def test_bag_cut_off_anywhere_is_read_as_far_as_it_goes(recorded: Path, tmp_path: Path) -> None:
    whole = recorded.read_bytes()
    reference = read_bag(recorded)
    assert reference.whole
    expected = reference["/truth/odom"].data
    start = whole.index(b"ros2")
    places = sorted(random.Random(1).sample(range(start + 40, len(whole) - 1), 25))
    counts = []
    for place in places:
        cut = tmp_path / "cut.mcap"
        cut.write_bytes(whole[:place])
        bag = read_bag(cut)
        assert not bag.whole
        found = bag["/truth/odom"].data if "/truth/odom" in bag else []
        assert found == expected[: len(found)]
        counts.append(len(found))
    assert counts == sorted(counts) and set(counts) <= {0, 10, 20, 30} and counts[-1] == 30


def test_what_is_no_bag_is_said_in_a_sentence(recorded: Path, tmp_path: Path) -> None:
    text = tmp_path / "notes" / "notes.mcap"
    text.parent.mkdir()
    text.write_text("this is no bag at all, but it is long enough")
    with pytest.raises(UnreadableBagError, match="it is no MCAP file"):
        read_bag(text)
    with pytest.raises(UnreadableBagError, match="no such file or folder"):
        read_bag(tmp_path / "nothing")
    assert bag_file(recorded.parent) == bag_file(recorded.parent.parent) == recorded
    with pytest.raises(UnknownTopicInBagError, match="/odom is not in the bag: there are /clock"):
        read_bag(recorded)["/odom"]


def test_messages_of_a_topic_are_numbered_and_unused_topics_left_out(tmp_path: Path) -> None:
    specs = [ChannelSpec(row.name, row.type, {}) for row in TOPICS]
    writer = BagWriter(tmp_path / "bag", specs)
    for number in range(3):
        writer.write(CHANNELS["/arm/stop"], number, number, cdr(Header()))
    writer.close()
    writer.close()
    assert writer.recorded() == {"/arm/stop": 3}
    assert list(read_bag(tmp_path / "bag").topics) == ["/arm/stop"]
