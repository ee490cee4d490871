"""A bag that is read by pieces for its summary: as much of it as of the whole bag, and little of it in memory."""

import random
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from nav_msgs.msg import Odometry
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from synthetic import CHANNELS, PERIOD, SyntheticRun, cdr

from sojourn_bags import reading
from sojourn_bags.condensed import CondensedMessages, Excerpt
from sojourn_bags.errors import IncompleteConfigError, UnknownTopicInBagError
from sojourn_bags.messages import Messages
from sojourn_bags.reading import read_bag, read_beginning
from sojourn_bags.summary import summarise
from sojourn_bags.summary_reading import read_for_summary
from sojourn_bags.writer import BagWriter

REFERENCE = Path(__file__).parents[1] / "replay" / "short_goals"
PERIODS = 900
OTHER_CLOCKS = (("/clock", 10**18, Clock()), ("/truth/odom", 10**18, Odometry()))


def long_run(folder: Path, hostile: int = 0) -> Path:
    """A drive whose arm moves, with goals of each kind, and garbage on every topic of it now and then."""
    run, noise = SyntheticRun(folder, "lunar_sample"), random.Random(hostile)
    arm = list(run.run.resolved["arm"]["joint_names"])
    for period in range(1, PERIODS + 1):
        stamp = period * PERIOD
        angles = {name: 0.3 * np.sin(0.01 * period + number) for number, name in enumerate(arm)}
        run.truth(stamp, (0.01 * period, 0.1, 0.5, 0.001 * period), {"wheel_front_left_joint": period, **angles}, 0.0)
        run.contacts(stamp, np.full((6 + period % 3, 11), 0.01 + 1e-5 * (period % 97)))
        if period % 5 == 0:
            run.electrical(stamp, 60.0 + period % 7, 0.9 - 1e-5 * period)
        if period % 50 == 0:
            run.status("/drive/status", stamp, "reached" if period > 800 else "moving", 100 * PERIOD)
            run.status("/arm/status", stamp, "failed" if period > 600 else "moving", 400 * PERIOD, "it is stuck")
        if period == 100:
            run.goal("/goal_pose", stamp, [(8.9, 0.1, 0.0)])
        if period == 400:
            run.goal("/arm/goal_pose", stamp, [(1.0, 0.0, 0.4)], "base_link")
        if hostile and period % 11 == 0:
            name = noise.choice(
                ["/truth/odom", "/truth/joint_states", "/drive/status", "/clock", "/goal_pose", "/imu/data"]
            )
            run.writer.write(CHANNELS[name], stamp, stamp, noise.choice([noise.randbytes(30), b""]))
        if hostile and period % 17 == 0:
            run.write(*noise.choice(OTHER_CLOCKS), log_time=stamp)
    run.close(PERIODS * PERIOD)
    return run.writer.path


@pytest.fixture
def small_pieces(monkeypatch: pytest.MonkeyPatch) -> None:
    """As of a bag that is many times as long."""
    monkeypatch.setattr(reading, "BATCH", 13)


@pytest.mark.usefixtures("small_pieces")
@pytest.mark.parametrize("hostile", [0, 1, 2])
def test_a_summary_is_that_of_the_whole_bag(tmp_path: Path, hostile: int) -> None:
    path = long_run(tmp_path / "bag", hostile)
    whole, condensed = read_bag(path), read_for_summary(path)
    summary = summarise(whole)
    assert summarise(condensed) == summary
    assert [goal["outcome"] for goal in summary["goals"]][:2] == ["reached", "failed"]
    assert summary["arm_error_m"] > 0.0 and summary["energy_wh"] > 0.0 and summary["max_sinkage_m"] > 0.01
    assert bool(whole.unusable) == bool(hostile)
    by_time = [sorted((one.log_time, one.topic) for one in bag.unusable) for bag in (whole, condensed)]
    assert by_time[0] == by_time[1]


@pytest.mark.usefixtures("small_pieces")
@pytest.mark.parametrize("part", [0.75, 0.95])
def test_so_is_that_of_a_bag_that_is_cut_off(tmp_path: Path, part: float) -> None:
    """Whose last record, which says that it is a run of ours, is lost: another clock's messages are no truth in it
    either.
    """
    file = read_bag(long_run(tmp_path / "bag", hostile=3)).path
    file.write_bytes(file.read_bytes()[: int(part * file.stat().st_size)])
    whole, condensed = read_bag(file), read_for_summary(file)
    assert not whole.whole and len(whole["/truth/odom"]) > 50
    assert summarise(condensed) == summarise(whole)
    assert summarise(whole)["sim_time_s"] < PERIODS * PERIOD * 1e-9 + 60.0


def test_messages_are_not_held(tmp_path: Path) -> None:
    path = long_run(tmp_path / "bag")
    held = sum(len(data) for messages in read_for_summary(path).topics.values() for data in messages.data)
    assert 0 < held < 0.001 * sum(len(data) for messages in read_bag(path).topics.values() for data in messages.data)


def test_what_is_not_kept_is_not_given(tmp_path: Path) -> None:
    bag = read_for_summary(long_run(tmp_path / "bag"))
    for ask in (
        partial(bag["/truth/odom"].column, "twist.twist.linear.x"),
        bag["/truth/odom"].joints,
        bag["/truth/odom"].points,
        bag["/truth/odom"].statuses,
        lambda: bag["/truth/contacts"].times,
    ):
        with pytest.raises(UnknownTopicInBagError):
            ask()
    assert bag["/truth/odom"].fields()[0] == "pose.pose.position.x"


def test_of_a_topic_that_is_of_another_type_no_status_is_read() -> None:
    with pytest.raises(UnknownTopicInBagError, match="a status on /drive/status"):
        Messages("/drive/status", "sensor_msgs/msg/JointState", [0], [cdr(JointState())]).statuses()


def test_a_bag_without_a_description_before_its_messages_is_refused(tmp_path: Path) -> None:
    BagWriter(tmp_path / "bag", []).close({})
    with pytest.raises(IncompleteConfigError, match=r"configuration\.json"):
        read_for_summary(tmp_path / "bag")
    assert read_beginning(REFERENCE).attachments.keys() == read_bag(REFERENCE).attachments.keys()


@settings(max_examples=50, deadline=None)
@given(st.data())
def test_joints_are_those_of_all_messages_however_they_are_cut(data: Any) -> None:
    names = st.lists(st.sampled_from("abcd"), unique=True)
    states = []
    for number in range(data.draw(st.integers(1, 12))):
        state = JointState(name=data.draw(names))
        state.position = [float(number + 10 * ord(name)) for name in state.name]
        state.header.stamp.sec = number
        states.append(cdr(state))
    wanted = tuple(data.draw(st.sets(st.sampled_from("abcd"), min_size=1)))
    whole = Messages("/joints", "sensor_msgs/msg/JointState", list(range(len(states))), list(states))
    history = whole.joints()
    condensed = CondensedMessages(whole, Excerpt(("header.stamp.sec",), joints=wanted, is_stamped=True, is_dated=True))
    begin = 0
    while begin < len(states):
        end = data.draw(st.integers(begin + 1, len(states)))
        piece = Messages("/joints", whole.type, list(range(begin, end)), states[begin:end])
        condensed.take(piece)
        assert not len(piece)
        begin = end
    found = condensed.joints()
    assert set(found.names) == set(history.names) & set(wanted)
    for name in found.names:
        np.testing.assert_array_equal(found.position[:, found.index(name)], history.position[:, history.index(name)])
    assert len(condensed) == len(whole) and list(condensed.log_times) == list(whole.log_times)
    np.testing.assert_array_equal(condensed.times, whole.times)
    np.testing.assert_array_equal(condensed.column("header.stamp.sec"), whole.column("header.stamp.sec"))
