"""Comparing: a change of any one value is found, named and measured; what is the same is not told."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from message_sets import (
    JOINTS,
    as_messages,
    contacts,
    imu,
    joint_states,
    odometry,
    one_run,
    status,
    with_value,
)
from synthetic import PERIOD

from sojourn_bags.comparison import compare, until
from sojourn_bags.comparison_result import Verdict
from sojourn_bags.comparison_words import comparison_lines
from sojourn_bags.layout import layout_of
from sojourn_bags.messages import Messages
from sojourn_contract.flow import topic_order
from sojourn_contract.messages import CONTACT_FIELDS, contact_cloud
from sojourn_contract.tolerance import rule_of, tolerance_of

RUN = one_run()
NUMBERS = [
    (name, path, element)
    for name, messages in RUN.items()
    for path, number in layout_of(messages.type, messages.data[0]).numbers.items()
    if number.dtype.kind == "f"
    for element in range(1 if number.count is None else number.count)
]
"""Every floating-point number of the run's messages."""
ATTITUDE = "orientation."


def test_a_run_is_identical_to_itself() -> None:
    result = compare(RUN, one_run())
    assert result.verdict is Verdict.IDENTICAL
    assert result.matched == sum(len(messages) for messages in RUN.values())
    assert result.fields == () and result.divergence() is None


@settings(max_examples=150, deadline=None)
@given(st.sampled_from(NUMBERS), st.integers(0, 5), st.floats(allow_infinity=True, allow_nan=True))
def test_any_one_value_that_is_changed_is_found_named_and_measured(
    where: tuple[str, str, int], index: int, value: float
) -> None:
    name, path, element = where
    changed, before, after = with_value(RUN[name], index, path, element, value)
    result = compare(RUN, RUN | {name: changed})
    same = (before == after and math.copysign(1, before) == math.copysign(1, after)) or (
        math.isnan(before) and math.isnan(after)
    )
    if same:
        assert result.verdict is Verdict.IDENTICAL
        return
    (found,) = result.fields
    assert (found.topic, found.messages, found.compared) == (name, 1, 6)
    assert (found.first.stamp, found.first.element) == (found.largest.stamp, found.largest.element)
    assert found.first.stamp == (index + 1) * PERIOD * (5 if name == "/bus/state" else 1)
    assert result.divergence() is not None and result.divergence().stamp == found.first.stamp
    if ATTITUDE in path and "covariance" not in path:
        assert (found.field, found.kind) == (path.rpartition(".")[0], "attitude")
        return
    assert found.field == path
    if path in ("position", "velocity", "effort"):
        assert found.first.element == f"[{JOINTS[element]}]"
    np.testing.assert_array_equal((found.first.one, found.first.other), (before, after))
    rule = rule_of(name, path)
    expected = abs(before - after)
    if not math.isfinite(expected):
        expected = math.inf
    elif rule is not None and rule.unit == "rad" and expected > math.pi:
        expected = abs(math.remainder(before - after, 2 * math.pi))
        assert found.first.difference == pytest.approx(expected, abs=1e-9 + 1e-12 * abs(after))
        return
    assert found.first.difference == expected
    assert (found.beyond == 1) == (expected > tolerance_of(rule))
    assert (result.verdict is Verdict.DIFFERENT) == (found.beyond == 1)


@settings(max_examples=60, deadline=None)
@given(
    st.lists(st.tuples(st.integers(0, 5), st.sampled_from(CONTACT_FIELDS), st.integers(0, 3)), min_size=1, max_size=6)
)
def test_points_of_a_cloud_are_compared_by_their_fields(changes: list[tuple[int, str, int]]) -> None:
    clouds = contacts(6)
    for index, field, point in changes:
        report = np.frombuffer(bytes(clouds[index].data), dtype=np.float64).reshape(4, len(CONTACT_FIELDS)).copy()
        report[point, CONTACT_FIELDS.index(field)] += 0.25
        clouds[index] = contact_cloud((index + 1) * PERIOD, report)
    result = compare(RUN, RUN | {"/truth/contacts": as_messages("/truth/contacts", clouds)})
    assert {each.field for each in result.fields} == {field for _, field, _ in changes}
    for each in result.fields:
        mine = [(index, point) for index, field, point in changes if field == each.field]
        assert each.messages == len({index for index, _ in mine})
        first = min(mine)
        assert (each.first.stamp, each.first.element) == ((first[0] + 1) * PERIOD, f"[{first[1]}]")
        assert each.largest.difference == 0.25 * max(mine.count(place) for place in mine)


def changed(name: str, contents: list[Any]) -> dict[str, Messages]:
    return RUN | {name: as_messages(name, contents)}


def test_minus_zero_is_not_equal_and_within_tolerance() -> None:
    contents = imu(6)
    contents[2].angular_velocity.x = -0.0
    result = compare(RUN, changed("/imu/data", contents))
    (found,) = result.fields
    assert (found.name, found.first.difference) == ("/imu/data.angular_velocity.x", 0.0)
    assert result.verdict is Verdict.WITHIN_TOLERANCE


def test_the_opposite_quaternion_is_the_same_attitude_and_not_equal() -> None:
    contents = odometry(6)
    turned = contents[3].pose.pose.orientation
    turned.x, turned.y, turned.z, turned.w = -turned.x, -turned.y, -turned.z, -turned.w
    result = compare(RUN, changed("/odom", contents))
    (found,) = result.fields
    assert (found.name, found.kind) == ("/odom.pose.pose.orientation", "attitude")
    assert (found.largest.difference, found.messages, found.beyond) == (0.0, 1, 0)
    turned.z += 1e-6
    (found,) = compare(RUN, changed("/odom", contents)).fields
    assert found.largest.difference == pytest.approx(1e-6) and found.beyond == 1


def test_angles_wrap_and_rates_do_not() -> None:
    contents = joint_states(6)
    contents[1].position[2] += 4 * math.pi + 1e-6
    contents[1].velocity[2] += 4 * math.pi
    position, velocity = compare(RUN, changed("/joint_states", contents)).fields
    assert (position.field, position.kind, velocity.field) == ("position", "angle", "velocity")
    assert position.largest.difference == pytest.approx(1e-6, rel=1e-6)
    assert velocity.largest.difference == pytest.approx(4 * math.pi)


def test_nan_against_a_number_is_beyond_every_tolerance() -> None:
    contents = joint_states(6)
    contents[4].effort[0] = 0.0
    (found,) = compare(RUN, changed("/joint_states", contents)).fields
    assert (found.field, found.largest.difference, found.beyond) == ("effort", math.inf, 1)


def test_changed_frame_is_told_with_both_texts() -> None:
    contents = imu(6)
    contents[5].header.frame_id = "base_link"  # another length
    contents[4].header.frame_id = "imu_lint"  # the same length
    result = compare(RUN, changed("/imu/data", contents))
    (found,) = result.fields
    assert (found.name, found.kind, found.messages) == ("/imu/data.header.frame_id", "text", 2)
    assert (found.first.stamp, found.first.one, found.first.other) == (5 * PERIOD, "imu_link", "imu_lint")
    assert result.verdict is Verdict.DIFFERENT


def test_swapped_joint_names_are_told() -> None:
    contents = joint_states(6)
    contents[0].name = [JOINTS[1], JOINTS[0], JOINTS[2]]
    found = compare(RUN, changed("/joint_states", contents)).fields
    assert {each.field for each in found} == {"name[0]", "name[1]"}


def test_arrays_of_another_length_are_told_with_both_lengths() -> None:
    result = compare(RUN, changed("/joint_states", joint_states(6, JOINTS[:2], effort=False)))
    lengths = {each.field: (each.first.one, each.first.other) for each in result.fields}
    assert lengths == {
        "name (length)": (3, 2),
        "position (length)": (3, 2),
        "velocity (length)": (3, 2),
        "effort (length)": (3, 0),
    }


def test_missing_and_extra_messages_are_counted_with_the_first_stamp() -> None:
    contents = odometry(6)
    left_out = as_messages("/odom", [contents[0], *contents[3:]])
    result = compare(RUN, RUN | {"/odom": left_out})
    topic = next(topic for topic in result.topics if topic.topic == "/odom")
    assert (topic.missing, topic.extra, topic.matched) == ((2 * PERIOD, 3 * PERIOD), (), 4)
    assert result.divergence() is not None and result.divergence().what == "message missing"
    topic = next(topic for topic in compare(RUN | {"/odom": left_out}, RUN).topics if topic.topic == "/odom")
    assert topic.extra == (2 * PERIOD, 3 * PERIOD)
    twice = as_messages("/odom", [contents[0], *contents])
    assert compare(RUN, RUN | {"/odom": twice}).topics[-1].extra == (PERIOD,)


def test_a_topic_that_one_side_lacks_is_missing_whole() -> None:
    result = compare(RUN, {name: messages for name, messages in RUN.items() if name != "/imu/data"})
    assert result.verdict is Verdict.DIFFERENT
    assert [len(topic.missing) for topic in result.topics if topic.topic == "/imu/data"] == [6]


def test_heartbeats_are_matched_by_their_sender() -> None:
    beats = [status(50 * PERIOD, {"state": "running", "published /x": "3"}, name) for name in ("arm", "drive", "power")]
    one = {"/diagnostics": as_messages("/diagnostics", beats)}
    assert compare(one, {"/diagnostics": as_messages("/diagnostics", beats[::-1])}).verdict is Verdict.IDENTICAL
    gone = compare(one, {"/diagnostics": as_messages("/diagnostics", beats[1:])})
    assert gone.topics[0].missing == (50 * PERIOD,) and not gone.fields


@pytest.mark.parametrize(
    ("one", "other", "verdict"),
    [
        ("0.123", "0.124", Verdict.WITHIN_TOLERANCE),  # rounded apart
        ("0.123", "0.125", Verdict.DIFFERENT),
        ("37.8", "37.9", Verdict.DIFFERENT),  # too coarse to be rounding
        ("37.8", "37.8001", Verdict.WITHIN_TOLERANCE),
        ("12", "13", Verdict.DIFFERENT),  # counts
        ("moving", "reached", Verdict.DIFFERENT),
        ("0.5", "nan", Verdict.DIFFERENT),
    ],
)
def test_values_of_a_status_are_compared_by_key(one: str, other: str, verdict: Verdict) -> None:
    sides = [
        {"/drive/status": as_messages("/drive/status", [status(50 * PERIOD, {"a": "1", "key": text})])}
        for text in (one, other)
    ]
    result = compare(*sides)
    (found,) = result.fields
    assert (found.name, found.first.one, found.first.other) == ("/drive/status.status.values.key", one, other)
    assert result.verdict is verdict


def test_keys_that_come_go_and_change_places_are_told() -> None:
    def side(values: dict[str, str]) -> dict[str, Messages]:
        return {"/drive/status": as_messages("/drive/status", [status(50 * PERIOD, values)])}

    (gone,) = compare(side({"a": "1", "b": "2"}), side({"a": "1"})).fields
    assert (gone.field, gone.first.other) == ("status.values.b", "(absent)")
    (moved,) = compare(side({"a": "1", "b": "2"}), side({"b": "2", "a": "1"})).fields
    assert moved.field == "status (order)"


def test_what_a_side_leaves_out_does_not_hide_what_differs() -> None:
    many = {f"key_{number}": "1" for number in range(100)}
    one = {"/drive/status": as_messages("/drive/status", [status(50 * PERIOD, many | {"a": "1"})])}
    other = {"/drive/status": as_messages("/drive/status", [status(50 * PERIOD, {"a": "2"})])}
    lines = comparison_lines(compare(one, other), "ours", "theirs")
    assert any("status.values.a " in line for line in lines)
    (lacking,) = (line for line in lines if "theirs has no" in line)
    assert lacking.endswith("status.values.key_5 and 94 more")


@settings(max_examples=60, deadline=None)
@given(st.dictionaries(st.sampled_from(sorted(RUN)), st.integers(0, 5), min_size=1))
def test_the_first_divergence_is_the_earliest_and_among_equals_the_nearest_to_the_plant(places: dict[str, int]) -> None:
    paths = {
        "/joint_states": "velocity",
        "/imu/data": "angular_velocity.y",
        "/odom": "pose.covariance",
        "/bus/state": "voltage",
    }
    other = dict(RUN)
    for name, index in places.items():
        if name == "/truth/contacts":
            clouds = contacts(6)
            clouds[index] = contact_cloud((index + 1) * PERIOD, np.zeros((4, len(CONTACT_FIELDS))))
            other[name] = as_messages(name, clouds)
        else:
            other[name], _, _ = with_value(RUN[name], index, paths[name], 0, 99.0)
    order = topic_order()
    stamps = {name: (index + 1) * (5 if name == "/bus/state" else 1) * PERIOD for name, index in places.items()}
    expected = min(stamps, key=lambda name: (stamps[name], order.index(name)))
    found = compare(RUN, other).divergence()
    assert found is not None and (found.topic, found.stamp) == (expected, stamps[expected])


def test_a_difference_within_tolerance_does_not_hide_where_it_goes_beyond() -> None:
    contents = odometry(6)
    contents[0].pose.pose.position.x += 1e-12
    contents[3].pose.pose.position.x += 1e-3
    result = compare(RUN, changed("/odom", contents))
    (found,) = result.fields
    assert (found.messages, found.beyond, found.first.stamp) == (2, 1, PERIOD)
    beyond = result.divergence(beyond_tolerance=True)
    assert beyond is not None and beyond.stamp == 4 * PERIOD == found.largest.stamp
    assert found.first_beyond == found.largest


def in_file(messages: dict[str, Messages], places: dict[str, list[int]]) -> dict[str, Messages]:
    """As read from a bag, with a place in the file and a log time for each."""
    return {
        name: Messages(name, each.type, [place // 10 for place in places[name]], each.data, places[name])
        for name, each in messages.items()
    }


def test_another_order_of_the_file_is_not_identical() -> None:
    run = {name: RUN[name] for name in ("/imu/data", "/odom")}
    even, odd = [0, 2, 4, 6, 8, 10], [1, 3, 5, 7, 9, 11]
    one = in_file(run, {"/imu/data": even, "/odom": odd})
    assert compare(one, one).verdict is Verdict.IDENTICAL
    turned = compare(one, in_file(run, {"/imu/data": [1, 2, 4, 6, 8, 10], "/odom": [0, 3, 5, 7, 9, 11]}))
    assert turned.verdict is Verdict.WITHIN_TOLERANCE
    assert turned.order_differs_at == ("/imu/data", PERIOD)


def test_another_type_on_a_topic_is_told() -> None:
    other = Messages("/odom", "sensor_msgs/msg/Imu", data=RUN["/imu/data"].data)
    (found,) = compare(RUN, RUN | {"/odom": other}).fields
    assert (found.field, found.kind) == ("(type)", "type")


def test_messages_of_a_cut_bag_are_taken_as_far_as_they_are_complete() -> None:
    run = in_file({"/odom": RUN["/odom"]}, {"/odom": [0, 10, 20, 30, 40, 50]})
    assert len(until(run, 3)["/odom"]) == 3
    assert until(run, 0) == {}
