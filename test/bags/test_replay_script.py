"""The script of a replay from a made-up bag, and when the next period may begin."""

import json

import pytest
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseStamped, Vector3Stamped
from hypothesis import given, settings
from hypothesis import strategies as st
from nav_msgs.msg import OccupancyGrid, Odometry, Path
from sensor_msgs.msg import BatteryState, Imu, JointState, PointCloud2
from std_msgs.msg import Header
from synthetic import CHANNELS, PERIOD, SyntheticRun, cdr

from ros_messages import ros_time
from sojourn_bags.completeness import RECORD
from sojourn_bags.definitions import RUN_RECORD
from sojourn_bags.errors import BagsError, IncompleteConfigError, OtherContractError, ReplayError
from sojourn_bags.provenance import run_attachment
from sojourn_bags.reading import Bag, read_bag
from sojourn_bags.replay_answers import MOST_LAG, Answers
from sojourn_bags.replay_script import script_of
from sojourn_contract.events import format_tick
from sojourn_contract.heartbeat import RUNNING, Counters, heartbeat_message

PERIODS = 60
ROLES = "plant,sensors,drive,power,operator,recorder"


def header(period: int, text: str) -> Header:
    return Header(stamp=ros_time(period * PERIOD), frame_id=text)


@pytest.fixture(scope="module")
def bag(tmp_path_factory: pytest.TempPathFactory) -> Bag:
    """Drive and its inputs; the operator sends a goal at period 10, somebody by hand at period 33."""
    run = SyntheticRun(tmp_path_factory.mktemp("replay") / "bag", "flat_drive")
    for period in range(1, PERIODS + 1):
        stamp = period * PERIOD
        run.truth(stamp, (0.0, 0.0, 0.0, 0.0), {"wheel_front_left_joint": 1.0}, 0.0)
        run.write("/joint_states", stamp, JointState())
        run.write("/imu/data", stamp, Imu())
        if period == 15:
            run.write("/goal_pose", stamp, PoseStamped())
        if period == 33:
            run.write("/goal_pose", 0, PoseStamped(), log_time=stamp)
        run.write("/odom", stamp, Odometry())
        run.write("/drive_command", stamp, JointState())
        if period % 5 == 0:
            run.write("/power/switches", stamp, DiagnosticArray())
            counts = {"/goal_pose": 1} if period >= 10 else {}
            tick = header(period, format_tick(counts, period == 55))
            run.writer.write(CHANNELS["/operator/tick"], stamp, stamp, cdr(tick))
        if period == 50:
            run.write("/hazcam/points", stamp, PointCloud2())
            run.write("/sun_direction", stamp, Vector3Stamped())
            run.write("/battery_state", stamp, BatteryState())
            run.status("/drive/status", stamp, "idle", 0)
            run.write("/plan", stamp, Path())
            run.write("/local_costmap/costmap", stamp, OccupancyGrid())
            for role in ("drive", "plant"):
                run.write("/diagnostics", stamp, heartbeat_message(role, RUNNING, stamp, Counters()))
    told = {"participants": ROLES, "lockstep": "true"}
    attached = run_attachment(told)
    run.writer._writer.add_attachment(0, 0, attached.name, attached.media_type, attached.data)
    run.writer.close({RUN_RECORD: told, RECORD: {"complete": "true"}})
    return read_bag(run.writer.path)


def with_run(bag: Bag, **told: str) -> Bag:
    """The same bag with other words about its run."""
    record = {**bag.records[RUN_RECORD], **told}
    return Bag(bag.path, bag.whole, bag.topics, bag.attachments, {**bag.records, RUN_RECORD: record})


def test_every_input_stands_in_the_step_of_its_stamp(bag: Bag) -> None:
    script = script_of(bag, "drive")
    assert [step.period for step in script.steps] == list(range(1, PERIODS + 1))
    names = [[name for name, _ in step.inputs] for step in script.steps]
    assert names[0] == ["/clock", "/joint_states", "/imu/data"]
    assert names[4] == ["/clock", "/joint_states", "/imu/data", "/power/switches", "/operator/tick"]
    seldom = {"/hazcam/points", "/sun_direction", "/battery_state"}
    assert set(names[49]) == {*names[4], *seldom} and len(names[49]) == len(names[4]) + len(seldom)
    assert {name: len(messages) for name, messages in script.recorded.items()} == {
        "/odom": 60, "/drive_command": 60, "/drive/status": 1, "/plan": 1, "/local_costmap/costmap": 1,
        "/diagnostics": 1,
    }  # fmt: skip


def test_goals_come_with_the_tick_that_announces_them_or_where_they_are_filed(bag: Bag) -> None:
    goals = {step.period: len(step.goals) for step in script_of(bag, "drive").steps if step.goals}
    assert goals == {10: 1, 33: 1}, "sent five periods ahead of its effect; sent by hand"


def test_answers_that_the_bag_does_not_hold_are_named(bag: Bag) -> None:
    with pytest.raises(ReplayError, match="lacks /truth/contacts of plant: there is nothing to compare"):
        script_of(bag, "plant")


def test_a_bag_cut_off_is_replayed_up_to_its_last_whole_period(bag: Bag) -> None:
    cut = Bag(bag.path, False, bag.topics, bag.attachments, {})
    script = script_of(cut, "drive")
    assert script.cut_off and len(script.steps) == PERIODS - 1
    assert script.participants == tuple(ROLES.split(","))


@pytest.mark.parametrize("missing", ["/imu/data", "/joint_states", "/power/switches", "/odom", "/drive_command"])
def test_a_topic_that_is_missing_is_named(bag: Bag, missing: str) -> None:
    topics = {name: messages for name, messages in bag.topics.items() if name != missing}
    with pytest.raises(ReplayError, match=f"lacks {missing}") as caught:
        script_of(Bag(bag.path, True, topics, bag.attachments, bag.records), "drive")
    assert "drive" in str(caught.value)


@pytest.mark.parametrize(
    ("told", "role", "words"),
    [
        ({}, "operator", "role 'operator' cannot be replayed, allowed is one of plant, sensors, drive, arm, power"),
        ({}, "camera", "role 'camera' cannot be replayed"),
        ({}, "arm", "is of a run without arm"),
        ({"lockstep": "false"}, "drive", "was recorded in real time"),
    ],
)
def test_what_cannot_be_replayed_is_said_in_a_sentence(bag: Bag, told: dict[str, str], role: str, words: str) -> None:
    with pytest.raises(ReplayError, match=words):
        script_of(with_run(bag, **told), role)


def test_bags_that_do_not_say_enough_are_refused(bag: Bag) -> None:
    silent = Bag(bag.path, True, bag.topics, {}, {})
    with pytest.raises(IncompleteConfigError, match="does not say which roles took part"):
        script_of(silent, "drive")
    old = {**bag.attachments, "versions.json": json.dumps({"sojourn_contract": "0.0.1"}).encode()}
    with pytest.raises(OtherContractError, match=r"recorded with version 0\.0\.1"):
        script_of(Bag(bag.path, True, bag.topics, old, bag.records), "drive")
    empty = Bag(bag.path, False, {}, bag.attachments, bag.records)
    with pytest.raises(BagsError, match="holds no whole period"):
        script_of(empty, "drive")


# When the next period may begin


def test_answers_are_waited_for_at_their_stamps_only() -> None:
    answers = Answers({"/odom": [PERIOD, 2 * PERIOD], "/drive/status": [2 * PERIOD]}, lead=0)
    assert answers.missing(1) == [("/odom", PERIOD)]
    answers.take("/odom", PERIOD, b"")
    assert not answers.missing(1)
    assert answers.missing(2) == [("/odom", 2 * PERIOD), ("/drive/status", 2 * PERIOD)]
    assert answers.missing(3) == answers.missing(2) and answers.unsettled()


def test_the_plants_answers_are_of_the_next_period() -> None:
    answers = Answers({"/clock": [PERIOD, 2 * PERIOD]}, lead=1)
    answers.take("/clock", PERIOD, b"")
    assert answers.missing(1) == [("/clock", 2 * PERIOD)]


def test_a_message_left_out_is_settled_by_a_later_one() -> None:
    answers = Answers({"/odom": [PERIOD, 2 * PERIOD]}, lead=0)
    answers.take("/odom", 2 * PERIOD, b"")
    assert not answers.missing(2) and not answers.unsettled()


def test_a_late_topic_is_let_lag_and_not_waited_for_each_time() -> None:
    answers = Answers({"/odom": [period * PERIOD for period in range(1, 20)]}, lead=0)
    assert answers.missing(1) and answers.be_patient(1) and not answers.missing(1)
    for period in range(2, 20):
        answers.take("/odom", (period - 1) * PERIOD, b"")
        assert not answers.missing(period)


def test_a_silent_candidate_is_not_waited_for_without_end() -> None:
    answers = Answers({"/odom": [period * PERIOD for period in range(1, 20)]}, lead=0)
    for period in range(1, MOST_LAG + 1):
        assert answers.missing(period) and answers.be_patient(period)
    period = MOST_LAG + 1
    assert answers.missing(period) == [("/odom", PERIOD)]
    assert not answers.be_patient(period)


@settings(max_examples=50, deadline=None)
@given(st.integers(0, 3), st.integers(1, 40))
def test_one_topic_that_never_comes_does_not_stop_the_others(seed: int, periods: int) -> None:
    due = {"/odom": [n * PERIOD for n in range(1, periods + 1)], "/drive_command": [seed * PERIOD + PERIOD]}
    answers = Answers(due, lead=0)
    moments = 0
    for period in range(1, periods + 1):
        answers.take("/odom", period * PERIOD, b"")
        while answers.missing(period):
            assert answers.be_patient(period)
            moments += 1
    assert moments <= MOST_LAG + 1
    assert len(answers.messages()["/odom"]) == periods
