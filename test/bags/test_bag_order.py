"""Order and account of a bag without ROS: every arrival order gives one file, and a gap is counted."""

import random

from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_bags.completeness import PublishedCounts, account, due_by
from sojourn_bags.order import HOLD_PERIODS, MAX_AHEAD_PERIODS, MOST_WAITING, Entry, PeriodOrder, WindowOrder
from sojourn_contract.heartbeat import ENDED, RUNNING, Heartbeat
from sojourn_contract.stamps import CONTROL_PERIOD_NS
from sojourn_contract.topic_types import Reliability, Topic
from sojourn_contract.topics import topic

FAST = Topic("/fast", "std_msgs/Header", "plant", (), 1, 0.1, "every period")
SLOW = Topic("/slow", "std_msgs/Header", "drive", (), 5, 0.1, "every fifth period")
GOAL, HEARTBEAT = 2, 3
PERIODS = 30


def order() -> PeriodOrder:
    """Two rows, heartbeats of two roles every 10 periods."""
    return PeriodOrder([(0, FAST), (1, SLOW)], frozenset({0, 1}), 10)


def feed(target: PeriodOrder, message: tuple[str, int, int]) -> list[tuple[int, list[Entry]]]:
    """Offer one message and release what is whole."""
    kind, period, rank = message
    stamp = period * CONTROL_PERIOD_NS
    data = f"{kind} {period} {rank}".encode()
    if kind == "heartbeat":
        target.offer_heartbeat(HEARTBEAT, stamp, rank, data)
    elif kind == "goal":
        target.offer_goal(GOAL, stamp, data)
    else:
        target.offer(0 if kind == "fast" else 1, stamp, data)
    while target.collect():
        pass
    released = []
    while (found := target.release()) is not None:
        released.append(found)
    return released


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 2**32), st.integers(1, 60))
def test_any_order_of_arrival_gives_one_file(seed: int, disorder: int) -> None:
    messages = [("fast", period, 0) for period in range(1, PERIODS + 1)]
    messages += [("slow", period, 0) for period in range(5, PERIODS + 1, 5)]
    messages += [("heartbeat", period, rank) for period in (10, 20, 30) for rank in (0, 1)]
    messages.sort(key=lambda message: message[1])
    expected = sorted(messages, key=lambda m: (m[1], ("fast", "slow", "goal", "heartbeat").index(m[0]), m[2]))
    shuffler = random.Random(seed)
    # Each message arrives at most so many places late; a heartbeat is waited for over HOLD_PERIODS periods
    # only.
    late = min(disorder, HOLD_PERIODS - 1)
    arrivals = sorted(messages, key=lambda message: message[1] + shuffler.uniform(0, late))
    target = order()
    written = [entry for message in arrivals for _, entries in feed(target, message) for entry in entries]
    written += target.release_all()
    assert [entry[5].decode() for entry in written] == [" ".join(map(str, message)) for message in expected]
    assert all(entry[0] == entry[4] for entry in written)


def test_period_waits_for_its_rows_and_names_them() -> None:
    target = order()
    for period in range(1, 5):
        assert feed(target, ("fast", period, 0))
    assert feed(target, ("fast", 5, 0)) == []
    assert [row.name for row in target.missing()] == ["/slow"]
    assert [period for period, _ in feed(target, ("slow", 5, 0))] == [5]


def test_goal_that_was_announced_is_waited_for() -> None:
    target = order()
    target.announce(2 * CONTROL_PERIOD_NS, {GOAL: 1})
    feed(target, ("fast", 1, 0))
    assert feed(target, ("fast", 2, 0)) == []
    # it is stamped for later and waits for its period, but period 2 may now go on
    assert [period for period, _ in feed(target, ("goal", 4, 0))] == [2]
    feed(target, ("fast", 3, 0))
    [(period, entries)] = feed(target, ("fast", 4, 0))
    assert period == 4 and [entry[1] for entry in entries] == [0, GOAL]


def test_heartbeat_that_never_comes_does_not_stop_the_file() -> None:
    target = order()
    released = [
        period
        for number in range(1, 10 + HOLD_PERIODS + 1)
        for message in [("fast", number, 0), *([("slow", number, 0)] if number % 5 == 0 else [])]
        for period, _ in feed(target, message)
    ]
    # period 10 was held until 20 was in, which is held for its own heartbeats
    assert released == list(range(1, 10 + HOLD_PERIODS))


def test_goal_for_now_late_and_doubled_messages_are_kept() -> None:
    target = order()
    for period in range(1, 4):
        feed(target, ("fast", period, 0))
    assert feed(target, ("goal", 0, 0)) == []
    feed(target, ("fast", 2, 7))
    feed(target, ("goal", 4 + MAX_AHEAD_PERIODS, 0))
    [(period, entries)] = feed(target, ("fast", 4, 0))
    assert period == 4
    assert {entry[5] for entry in entries} == {b"fast 2 7", b"goal 0 0", b"goal 516 0", b"fast 4 0"}
    assert {entry[0] for entry in entries} == {4 * CONTROL_PERIOD_NS}
    assert sorted(entry[4] // CONTROL_PERIOD_NS for entry in entries) == [0, 2, 4, 516]


@settings(max_examples=40, deadline=None)
@given(st.lists(st.tuples(st.integers(0, 400), st.integers(0, 3)), min_size=1, max_size=60))
def test_real_time_never_goes_back_and_loses_nothing(arrivals: list[tuple[int, int]]) -> None:
    window, written = WindowOrder(), []
    for number, (period, channel) in enumerate(arrivals):
        window.offer(channel, period * CONTROL_PERIOD_NS, 0, b"%d" % number)
        window.newest = max(window.newest, period * CONTROL_PERIOD_NS)
        written += window.release()
    written += window.release_all()
    assert sorted(int(entry[5]) for entry in written) == list(range(len(arrivals)))
    times = [entry[0] for entry in written]
    assert times == sorted(times)


def heartbeat(role: str, state: str, published: dict[str, int], stamp: int = 1) -> Heartbeat:
    """A heartbeat with counters."""
    return Heartbeat(role, state, "", stamp, published, {}, {})


def test_counters_of_a_node_that_starts_again_add_up() -> None:
    counts = PublishedCounts()
    counts.hear(heartbeat("drive", RUNNING, {"/odom": 50}))
    counts.hear(heartbeat("drive", RUNNING, {"/odom": 100}))
    counts.hear(heartbeat("drive", RUNNING, {"/odom": 20}))
    counts.hear(heartbeat("arm", RUNNING, {"/arm/status": 2, "/diagnostics": 4}))
    # some nodes count their farewell and some do not: it is no part of the record
    counts.hear(heartbeat("arm", ENDED, {"/arm/status": 3, "/diagnostics": 5}))
    counts.hear(heartbeat("drive", RUNNING, {"/odom": 30, "/diagnostics": 5}))
    assert counts.totals() == {"/odom": 130, "/arm/status": 3, "/diagnostics": 9}
    assert counts.has_ended(["arm"]) and not counts.has_ended(["arm", "drive"])


def test_gap_is_found_against_published_and_against_due() -> None:
    rows = [topic("/odom"), topic("/joint_states"), topic("/cmd_vel")]
    recorded = {"/odom": 99, "/joint_states": 99, "/cmd_vel": 3}
    found = account(rows, recorded, {"/odom": 100, "/joint_states": 99}, 100 * CONTROL_PERIOD_NS, rows[:2])
    assert set(found.gaps) == {"/odom", "/joint_states"}
    assert found.explain() == (
        "/odom: 99 recorded of 100 published, 100 due; /joint_states: 99 recorded of 99 published, 100 due"
    )
    assert found.counts["/cmd_vel"].published is None and found.counts["/cmd_vel"].lost == 0


def test_loss_that_quality_of_service_allows_is_counted_but_no_failure() -> None:
    clouds = Topic("/cloud", "sensor_msgs/PointCloud2", "sensors", (), 5, 1.0, "", reliability=Reliability.BEST_EFFORT)
    found = account([clouds, topic("/clock")], {"/cloud": 8, "/clock": 9}, {"/cloud": 10, "/clock": 10}, None)
    assert not found.gaps
    assert found.counts["/cloud"].lost == 2 and found.counts["/clock"].lost == 1


def test_last_ticks_of_the_operator_are_nobody_s_due() -> None:
    assert due_by(topic("/operator/tick"), 100 * CONTROL_PERIOD_NS) == 19
    assert due_by(topic("/odom"), 100 * CONTROL_PERIOD_NS) == 100


def test_what_others_have_said_is_counted_where_a_killed_publisher_cannot_explain_it() -> None:
    """A node that dies has counted no more than up to its last heartbeat: two seconds of messages are nobody's."""
    rows = [topic("/truth/odom"), topic("/goal_pose"), topic("/drive/status")]
    said = {"/truth/odom": 500, "/drive/status": 10, "/goal_pose": 1}
    honest = account(rows, said | {"/truth/odom": 601, "/drive/status": 13, "/goal_pose": 90}, said, None)
    assert honest.foreign == "" and "foreign" not in honest.as_record()
    flooded = account(rows, said | {"/truth/odom": 700}, said, None)
    assert flooded.foreign == flooded.as_record()["foreign"] == "/truth/odom (200 of 700)"
    assert not flooded.gaps


def test_where_no_clock_comes_the_oldest_are_written() -> None:
    """A flood on /clock keeps the plant's from the recorder: all that came waited in memory, 200 MB in 200 s."""
    window, written, waiting = WindowOrder(), list[Entry](), []
    window.newest = CONTROL_PERIOD_NS
    for number in range(4 * MOST_WAITING):
        window.offer(0, (number // 20 + 1) * CONTROL_PERIOD_NS, 0, b"%d" % number)
        if number % 20 == 0:
            written += window.release()
            waiting.append(number + 1 - len(written))
    written += window.release_all()
    assert max(waiting) <= MOST_WAITING
    assert sorted(int(entry[-1]) for entry in written) == list(range(4 * MOST_WAITING))
    assert [entry[0] for entry in written] == sorted(entry[0] for entry in written)
