"""Rules on a whole run: stamps, answers, heartbeats, counters, rates. Each test breaks one thing in a clean run."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from clean_run import PERIOD, PERIODS, CleanRun, beats_of, explorer, kinds, set_stamp, value_of
from geometry_msgs.msg import PoseWithCovarianceStamped
from hypothesis import given, settings
from hypothesis import strategies as st
from nav_msgs.msg import Odometry
from sensor_msgs.msg import JointState

from sojourn_contract.barrier import awaited_inputs
from sojourn_contract.conformance.answers import missing_answers
from sojourn_contract.conformance.consistency import RateRule
from sojourn_contract.conformance.endpoints import Endpoint
from sojourn_contract.conformance.findings import Finding
from sojourn_contract.conformance.judge import Judge
from sojourn_contract.conformance.observation import Observation
from sojourn_contract.topics import ROLES, TOPICS, outputs_of, topic

AT = 40 * PERIOD


def counters_too(found: set[tuple[str, str, str]], name: str) -> set[tuple[str, str, str]]:
    """What is found, without the counter that tells of the same missing or surplus message."""
    return found - {("counter", "/diagnostics", f"status.values.published {name}")}


@pytest.mark.parametrize("name", ["/odom", "/drive_command", "/truth/odom", "/imu/data", "/power/switches", "/clock"])
def test_a_dropped_message_is_missed_by_name_and_stamp(name: str) -> None:
    run = CleanRun()
    run.drop(name, lambda entry: entry.stamp == AT)
    report = run.judge()
    assert counters_too(kinds(report), name) == {("answer", name, "header.stamp")}
    (violation,) = report.of_topic(name)[0].first
    assert (violation.stamp, violation.finding.value) == (AT, "missing")
    told = [group for group in report.groups if group.rule == "counter"]
    assert len(told) == 1, "its sender has counted it"


def test_an_answer_cannot_come_where_nothing_was_asked() -> None:
    run = CleanRun()
    for name in ("/imu/data", "/odom", "/drive_command", "/arm_command"):
        run.drop(name, lambda entry: entry.stamp == AT)
    report = run.judge()
    answers = {group.topic for group in report.groups if group.rule == "answer"}
    assert answers == {"/imu/data"}, "drive and arm had nothing to answer"


def test_a_silent_role_is_found_on_each_of_its_topics() -> None:
    run = CleanRun()
    for name in ("/odom", "/drive_command", "/drive/status"):
        run.drop(name, lambda entry: entry.stamp > AT)
    report = run.judge()
    assert {group.topic for group in report.groups if group.rule == "answer"} == {
        "/odom",
        "/drive_command",
        "/drive/status",
    }
    counts = {group.topic: group.count for group in report.groups if group.rule == "answer"}
    assert counts["/odom"] == PERIODS - 1 - 40, "up to the period before the last, which may be under way"


def test_no_clock_at_all() -> None:
    run = CleanRun()
    run.drop("/clock", lambda entry: True)
    assert counters_too(kinds(run.judge()), "/clock") == {("answer", "/clock", "header.stamp")}
    assert ("rate", "/clock", "header.stamp") in kinds(run.judge(lockstep=False))


def test_a_message_twice() -> None:
    run = CleanRun()
    run.add("/imu/data", AT, run.one("/imu/data", 39))
    report = run.judge()
    assert counters_too(kinds(report), "/imu/data") == {("stamp", "/imu/data", "header.stamp")}
    assert "after 0.80 s" in next(report.lines())


def test_a_stale_stamp() -> None:
    """A message that carries the stamp of the period before: twice there, and none here."""
    run = CleanRun()
    entry = next(entry for entry in run.of("/drive_command") if entry.stamp == AT)
    set_stamp(entry.message, AT - PERIOD)
    found = kinds(run.judge())
    assert found == {
        ("stamp", "/drive_command", "header.stamp"),
        ("stamp", "/drive_command", "age"),
        ("answer", "/drive_command", "header.stamp"),
    }


def test_a_stamp_off_the_grid() -> None:
    run = CleanRun()
    entry = next(entry for entry in run.of("/odom") if entry.stamp == AT)
    set_stamp(entry.message, AT + 1_000_000)
    found = kinds(run.judge())
    # between its neighbours it is also a change in another time
    assert {("stamp", "/odom", "header.stamp"), ("answer", "/odom", "header.stamp")} <= found
    assert {topic for _, topic, _ in found} == {"/odom"}


def test_a_drifting_clock() -> None:
    run = CleanRun()
    for entry in run.of("/imu/data"):
        entry.stamp += entry.stamp // 1000
        set_stamp(entry.message, entry.stamp)
        entry.logged = entry.stamp
    assert ("stamp", "/imu/data", "header.stamp") in kinds(run.judge())


def test_a_slow_topic_off_its_own_grid() -> None:
    run = CleanRun()
    entry = run.of("/power/switches")[3]
    set_stamp(entry.message, entry.stamp + PERIOD)
    line = next(run.judge().lines())
    assert line.startswith("/power/switches") and "a multiple of 0.1 s" in line


def test_a_message_filed_late() -> None:
    run = CleanRun()
    run.of("/odom")[50].logged += 3 * PERIOD
    # after younger ones, in the order of the file
    assert kinds(run.judge()) >= {("stamp", "/odom", "age"), ("stamp", "/odom", "header.stamp")}


def test_a_stamp_ahead_of_the_plant() -> None:
    run = CleanRun()
    entry = run.of("/operator/tick")[5]
    set_stamp(entry.message, entry.stamp + 50 * PERIOD)
    line = next(run.judge().lines())
    assert "by /clock" in line


@pytest.mark.parametrize("role", ROLES)
def test_a_missing_heartbeat(role: str) -> None:
    run = CleanRun()
    run.drop("/diagnostics", lambda entry: entry.message.status[0].name == role and entry.stamp == 50 * PERIOD)
    report = run.judge()
    found = {group.first[0].finding.field for group in report.groups if group.rule == "heartbeat"}
    assert found == {f"header.stamp of {role}"}


def test_no_heartbeat_at_all() -> None:
    run = CleanRun()
    run.drop("/diagnostics", lambda entry: True)
    (kind,) = kinds(run.judge())
    assert kind == ("heartbeat", "/diagnostics", "header.stamp")


def test_heartbeats_of_nobody() -> None:
    run = CleanRun()
    next(beats_of(run, "drive")).status[0].name = "driver"
    found = kinds(run.judge())
    assert ("heartbeat", "/diagnostics", "status.name") in found
    assert ("heartbeat", "/diagnostics", "header.stamp") in found


@pytest.mark.parametrize("count", ["49", "51", "0"])
def test_a_counter_that_does_not_match(count: str) -> None:
    run = CleanRun()
    value_of(next(beats_of(run, "drive")), "published /odom").value = count
    found = kinds(run.judge())
    assert found == {("counter", "/diagnostics", "status.values.published /odom")}


def test_a_counter_that_falls() -> None:
    run = CleanRun()
    _, second = beats_of(run, "sensors")
    value_of(second, "published /imu/data").value = "7"
    assert "50 or more, as said before" in next(run.judge().lines())


def test_ticks_whose_count_falls() -> None:
    run = CleanRun()
    run.one("/operator/tick", 9).frame_id = ""
    assert kinds(run.judge()) == {("tick", "/operator/tick", "frame_id")}


def test_rates_that_do_not_agree_with_their_positions() -> None:
    for name, field, edit in (
        ("/odom", "twist.twist.angular.z", lambda m: setattr(m.twist.twist.angular, "z", 5.73)),
        ("/odom", "twist.twist.linear.x", lambda m: setattr(m.twist.twist.linear, "x", -0.05)),
        ("/imu/data", "angular_velocity.z", lambda m: setattr(m.angular_velocity, "z", -5.73)),
        ("/joint_states", "velocity", lambda m: setattr(m, "velocity", [-rate for rate in m.velocity])),
    ):
        run = CleanRun()
        for entry in run.of(name):
            edit(entry.message)
        assert kinds(run.judge()) == {("rate of change", name, field)}, name


def swinging(window: int, sign: float = 1.0) -> CleanRun:
    """A joint that swings at 5 Hz, its rate taken from the change of position over a window of periods."""
    run = CleanRun()
    for number, entry in enumerate(run.of("/joint_states")):
        angles = [0.01 * math.sin(2.0 * math.pi * 0.1 * n) for n in (number, number - window)]
        entry.message.position = [angles[0]] * len(entry.message.name)
        entry.message.velocity = [sign * (angles[0] - angles[1]) / (window * 0.02)] * len(entry.message.name)
    return run


def test_rates_may_be_taken_over_a_window_of_periods() -> None:
    """An encoder's rate over five periods lags by two and a half: at the edge of a rut that was told as a violation."""
    for window in (1, 2, 5):
        assert not list(swinging(window).judge().lines()), window
    assert kinds(swinging(1, sign=-1.0).judge()) == {("rate of change", "/joint_states", "velocity")}


@pytest.mark.parametrize(("told_at", "wrong"), [(AT, False), (AT + 2 * PERIOD, True), (AT - 10 * PERIOD, True)])
def test_the_estimate_may_jump_where_an_operator_says_where_it_is(told_at: int, wrong: bool) -> None:
    run = CleanRun()
    for entry in run.of("/odom"):
        if entry.stamp >= AT:
            entry.message.pose.pose.position.y += 3.0
    word = PoseWithCovarianceStamped()
    word.pose.pose.orientation.w = 1.0
    word.header.frame_id = "map"
    set_stamp(word, told_at)
    run.add("/initialpose", told_at, word)
    run.entries.insert(0, run.entries.pop())  # a goal stands before the answer of its period
    jumps = {("rate of change", "/odom", f"twist.twist.linear.{axis}") for axis in "xy"}
    assert kinds(run.judge()) == (jumps if wrong else set())


def bumped(told: float, speed: float) -> list[Finding]:
    """Of a rover that goes ahead at 2 m/s, says `speed`, and is 2 mm higher after one period of ten, as by an edge.

    Args:
        told: what it says that its velocity has been off within each period [m/s].
    """
    row, found = topic("/truth/odom"), []
    rule = RateRule(row)
    for period in range(1, 11):
        message = Odometry()
        message.pose.pose.position.x, message.pose.pose.position.z = 2.0 * 0.02 * period, 0.002 * (period > 5)
        message.pose.pose.orientation.w = 1.0
        message.twist.twist.linear.x = speed
        message.twist.covariance = np.diag(np.full(6, told**2)).ravel()
        found += rule.judge(Observation(row, message, period * PERIOD, None, period * PERIOD))
    return found


def test_a_jolt_within_a_period_is_fair_where_it_is_told() -> None:
    (finding,) = bumped(0.0, 2.0)
    assert finding.field == "twist.twist.linear.z"
    assert not bumped(0.1, 2.0)


@pytest.mark.parametrize("told", [0.0, 0.1, 9.0])
@pytest.mark.parametrize("speed", [-2.0, 2.0 * math.degrees(1.0), 1.0, 3.0])
def test_no_spread_hides_a_rate_that_is_wrong(told: float, speed: float) -> None:
    assert {"twist.twist.linear.x"} <= {finding.field for finding in bumped(told, speed)}


def rocking(told: Callable[[float], float], pulse: float, steady: float = 0.0, wheel: float = 0.9) -> list[Finding]:
    """Of a bogie that turns steadily, and in one period of ten besides as over the edge of a rut: its rate goes up to
    `pulse` and back to where it was, on straight lines, within the period.

    Args:
        told: of its rate at the end of a period, what it says. wheel: the rate of a wheel [rad/s].
    """
    row, found, angle = topic("/truth/joint_states"), [], 0.0
    rule = RateRule(row, ["wheel_front_left_joint"])
    for period in range(1, 11):
        angle += 0.02 * (steady + 0.5 * pulse * (period == 6))
        message = JointState(name=["bogie_left_joint", "wheel_front_left_joint"])
        message.position, message.velocity = [angle, wheel * 0.02 * period], [told(steady), wheel]
        found += rule.judge(Observation(row, message, period * PERIOD, None, period * PERIOD))
    return found


@given(pulse=st.floats(0.11, 0.6), steady=st.floats(-0.3, 0.3), sign=st.sampled_from([-1.0, 1.0]))
@settings(max_examples=50, deadline=None)
def test_a_wheel_at_the_edge_of_a_rut_jolts_its_bogie(pulse: float, steady: float, sign: float) -> None:
    """On 0.5 degrees, in the ruts of a turn, a bogie's rate went from 0 to 0.12 rad/s and back to 0 within a period."""
    assert not rocking(lambda rate: rate, sign * pulse, steady)
    assert not rocking(lambda rate: rate, sign * pulse, -steady)


@pytest.mark.parametrize("pulse,wheel", [(0.14, 0.0), (0.14, 0.02), (2.0, 0.9)])
def test_without_a_turning_wheel_or_beyond_its_edge_there_is_no_such_jolt(pulse: float, wheel: float) -> None:
    (finding,) = rocking(lambda rate: rate, pulse, wheel=wheel)
    assert finding.field == "velocity[bogie_left_joint]"


@given(steady=st.floats(0.06, 1.0), pulse=st.floats(-0.6, 0.6), sign=st.sampled_from([-1.0, 1.0]))
@settings(max_examples=50, deadline=None)
def test_no_jolt_hides_a_rate_that_is_wrong(steady: float, pulse: float, sign: float) -> None:
    for wrong in (-1.0, math.degrees(1.0), 3.0):
        assert rocking(lambda rate, factor=wrong: factor * rate, pulse, sign * steady)


def test_roles_that_are_not_judged_are_listened_to() -> None:
    run = CleanRun()
    run.one("/imu/data").header.frame_id = "wrong"
    run.one("/odom").header.frame_id = "wrong"
    report = run.judge(roles=("drive",))
    assert kinds(report) == {("frame", "/odom", "header.frame_id")}
    assert set(report.messages) == {row.name for row in outputs_of("drive")} | {"/diagnostics"}
    assert report.messages["/diagnostics"] == 2


def realtime(unwanted: Any = None, name: str = "/imu/data") -> CleanRun:
    run = CleanRun(lockstep=False)
    if unwanted is not None:
        run.drop(name, unwanted)
    return run


def test_a_clean_run_in_real_time() -> None:
    assert not list(realtime().judge().lines())


def test_a_lost_message_is_no_violation_of_the_rate_but_of_the_count() -> None:
    found = kinds(realtime(lambda entry: entry.stamp == AT).judge())
    assert found == {("counter", "/diagnostics", "status.values.published /imu/data")}


def test_a_gap_and_a_low_rate() -> None:
    found = kinds(realtime(lambda entry: AT < entry.stamp <= AT + 6 * PERIOD).judge())
    assert counters_too(found, "/imu/data") == {("rate", "/imu/data", "header.stamp")}
    found = kinds(realtime(lambda entry: entry.stamp // PERIOD % 2 == 0).judge())
    assert counters_too(found, "/imu/data") == {("rate", "/imu/data", "rate")}


def test_age_by_the_clock() -> None:
    """Without log times, as in a live check, the age of a message is that by /clock when it comes."""
    run = realtime()
    for entry in run.entries:
        entry.logged = None
    assert not list(run.judge().lines())
    late = next(entry for entry in run.of("/odom") if entry.stamp == AT)
    run.entries.remove(late)
    run.entries.insert(run.entries.index(next(e for e in run.of("/clock") if e.stamp == AT + 8 * PERIOD)) + 1, late)
    found = kinds(run.judge())
    assert ("stamp", "/odom", "age") in found and {name for _, name, _ in found} == {"/odom"}


def judge(lockstep: bool = True) -> Judge:
    return Judge(explorer(), lockstep=lockstep, participants=ROLES)


@pytest.mark.parametrize(
    ("name", "endpoint", "field"),
    [
        ("/odom", Endpoint("geometry_msgs/PoseStamped"), "type"),
        ("/odom", Endpoint("nav_msgs/Odometry", reliability="best_effort"), "qos.reliability"),
        ("/imu/data", Endpoint("sensor_msgs/Imu", durability="transient_local", publishes=False), "qos.durability"),
        ("/imu/data", Endpoint("sensor_msgs/Imu", deadline_s=0.02, publishes=False), "qos.deadline"),
        ("/imu/data", Endpoint("sensor_msgs/Imu", liveliness="manual_by_topic", publishes=False), "qos.liveliness"),
    ],
)
def test_endpoints_that_do_not_meet(name: str, endpoint: Endpoint, field: str) -> None:
    court = judge()
    court.endpoint(name, endpoint)
    assert kinds(court.report) == {("endpoint", name, field)}


@pytest.mark.parametrize("row", TOPICS, ids=lambda row: row.name)
def test_endpoints_of_the_contract_meet(row: Any) -> None:
    court = judge()
    court.endpoint(row.name, Endpoint(row.type))
    court.endpoint(row.name, Endpoint(row.type, reliability="best_effort", publishes=False))
    court.endpoint(row.name, Endpoint(row.type, durability="transient_local"))  # offers more than is asked for
    assert not court.report.violations


def test_the_clock_in_real_time_is_best_effort() -> None:
    court = judge(lockstep=False)
    court.endpoint("/clock", Endpoint("rosgraph_msgs/Clock", reliability="best_effort"))
    assert not court.report.violations
    court.endpoint("/clock", Endpoint("rosgraph_msgs/Clock", publishes=False))
    assert kinds(court.report) == {("endpoint", "/clock", "qos.reliability")}


def test_messages_of_a_wrong_type_are_counted_and_not_judged() -> None:
    court = judge()
    court.endpoint("/odom", Endpoint("std_msgs/Header"))
    court.take("/odom", object())
    assert court.report.messages == {"/odom": 1} and court.report.violations == 1


@given(st.sets(st.integers(1, PERIODS - 1), max_size=6), st.sampled_from(["/odom", "/arm_command", "/truth/contacts"]))
@settings(max_examples=30, deadline=None)
def test_exactly_the_dropped_stamps_are_missing(dropped: set[int], name: str) -> None:
    rows = [row for row in TOPICS if not row.is_event and row.publisher != "all" and row.logged]
    stamps = {
        row.name: [
            period * PERIOD
            for period in range(row.every, PERIODS + 1, row.every)
            if row.name != name or period not in dropped
        ]
        for row in rows
    }
    awaited = {role: awaited_inputs(role, ROLES) for role in ROLES}
    missing = list(missing_answers(rows, stamps, awaited, 0, (PERIODS - 1) * PERIOD))
    assert [(row.name, stamp // PERIOD) for row, stamp, _ in missing] == [(name, period) for period in sorted(dropped)]
    assert topic(name) in rows
