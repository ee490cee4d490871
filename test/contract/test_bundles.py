"""Bundles: what comes out is what went in, the ROS library reads them, and bytes that are none are refused."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rclpy.serialization import deserialize_message
from std_msgs.msg import UInt8MultiArray

from sojourn_contract.bundles import MOST_TWINS, Twins
from sojourn_contract.bundling import bundle_of, pack, unpack
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.topics import TOPICS

TOPIC = bundle_of("plant").name
SAID = st.lists(st.tuples(st.sampled_from([row.name for row in TOPICS]), st.binary(max_size=200)), max_size=6)


@given(SAID, st.binary(max_size=8))
def test_what_is_packed_comes_out_whatever_the_middleware_appends(said: list[tuple[str, bytes]], more: bytes) -> None:
    assert unpack(TOPIC, pack(said) + more) == said


@given(SAID)
def test_the_ros_library_reads_the_same_bytes(said: list[tuple[str, bytes]]) -> None:
    data = pack(said)
    message = deserialize_message(data, UInt8MultiArray)
    assert not message.layout.dim and message.layout.data_offset == 0
    assert data.endswith(bytes(message.data)) and len(data) - len(message.data) == len(pack([]))


@given(st.lists(st.tuples(st.sampled_from(["/odom", "/clock"]), st.binary(max_size=50)), min_size=1), st.data())
def test_one_that_is_cut_off_is_refused(said: list[tuple[str, bytes]], data: st.DataObject) -> None:
    whole = pack(said)
    with pytest.raises(RefusedMessageError, match=TOPIC):
        unpack(TOPIC, whole[: data.draw(st.integers(0, len(whole) - 1))])


@given(st.one_of(st.binary(max_size=80), SAID.map(pack)), st.lists(st.tuples(st.integers(0, 400), st.integers(0, 255))))
def test_of_hostile_bytes_nothing_comes_but_a_refusal_or_texts_and_bytes(
    data: bytes, changes: list[tuple[int, int]]
) -> None:
    changed = bytearray(data)
    for place, value in changes:
        if place < len(changed):
            changed[place] = value
    try:
        said = unpack(TOPIC, bytes(changed))
    except RefusedMessageError as refusal:
        assert refusal.topic == TOPIC
        return
    assert sum(len(name) + len(content) for name, content in said) <= len(changed)


@given(
    st.lists(st.sampled_from([b"one", b"other", b"third one"]), max_size=12),
    st.lists(st.booleans(), max_size=24),
    st.integers(0, 4),
)
def test_of_what_comes_both_ways_each_is_heard_once_and_in_order(
    said: list[bytes], turns: list[bool], strange: int
) -> None:
    """Whichever way is ahead, and with messages between that others have said."""
    twins, left = Twins(), {True: list(said), False: list(said)}
    heard = []
    for number, bundled in enumerate([*turns, *[True] * len(said), *[False] * len(said)]):
        if number < strange:
            assert not twins.is_second(TOPIC, b"what a stranger says %d" % number, bundled=False)
        if not left[bundled]:
            continue
        data = left[bundled].pop(0)
        if not twins.is_second(TOPIC, data if bundled else data + bytes(-len(data) % 4), bundled):
            heard.append(data)
    assert heard == said


def test_the_same_said_again_is_heard_again_and_on_another_topic_too() -> None:
    twins = Twins()
    assert [twins.is_second(TOPIC, b"again", way) for way in (True, False, True, False)] == [False, True, False, True]
    assert not twins.is_second(TOPIC, b"there", True) and not twins.is_second("/odom", b"there", False)


def test_what_has_no_twin_is_forgotten_after_a_while() -> None:
    twins = Twins()
    for number in range(10 * MOST_TWINS):
        twins.is_second(TOPIC, b"%d" % number, False)
    assert len(twins) == MOST_TWINS
    assert twins.is_second(TOPIC, b"%d" % (10 * MOST_TWINS - 1), True)
