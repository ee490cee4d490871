"""Stamps against the clock of a node in real time: one that lies blinds nobody, and a false clock is set anew."""

import math

from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_contract.stamps import CONTROL_PERIOD_NS
from sojourn_contract.timeline import AGREEING, PERSISTING_S, Timeline

MAX_AGE_S = 0.1
ANY_STAMP = st.integers(-(2**31) * 10**9, 2**31 * 10**9)
START = 1000


def good(timeline: Timeline, period: int, wall_s: float, rows: int = 2) -> list[str]:
    """The messages of a period; what is said of those that are refused."""
    heard = [timeline.hear(period * CONTROL_PERIOD_NS, CONTROL_PERIOD_NS, MAX_AGE_S, wall_s) for _ in range(rows)]
    return [refusal for refusal in heard if refusal is not None]


@settings(max_examples=200, deadline=None)
@given(st.integers(1, 20), ANY_STAMP, st.floats(0.02, 0.5))
def test_one_that_lies_blinds_nobody(after: int, lie: int, pace_s: float) -> None:
    """However far ahead or behind it is, and however slowly simulation time runs."""
    timeline = Timeline()
    for number in range(40):
        assert not good(timeline, START + number, number * pace_s)
        if number == after:
            timeline.hear(lie, CONTROL_PERIOD_NS, MAX_AGE_S, number * pace_s + 0.001)
    assert timeline.now == (START + 39) * CONTROL_PERIOD_NS and not timeline.resets


@settings(max_examples=200, deadline=None)
@given(st.lists(st.integers(2, 20), max_size=5), ANY_STAMP)
def test_one_that_lies_again_and_again_blinds_nobody(gaps: list[int], lie: int) -> None:
    timeline, liars = Timeline(), {sum(gaps[: number + 1]) for number in range(len(gaps))}
    for number in range(sum(gaps) + 10):
        assert not good(timeline, START + number, number * 0.02)
        if number in liars:
            timeline.hear(lie, CONTROL_PERIOD_NS, MAX_AGE_S, number * 0.02 + 0.001)


@settings(max_examples=200, deadline=None)
@given(ANY_STAMP)
def test_a_false_first_message_is_outvoted_at_once(lie: int) -> None:
    timeline = Timeline()
    assert timeline.hear(lie, CONTROL_PERIOD_NS, MAX_AGE_S, 0.0) is None
    refused = [refusal for number in range(10) for refusal in good(timeline, START + number, 0.02 * (number + 1))]
    assert len(refused) <= 1
    assert timeline.now == (START + 9) * CONTROL_PERIOD_NS


def test_who_may_be_of_any_age_does_not_keep_up_a_false_time() -> None:
    """The operator's ticks: where the first message was false they kept a node blind for good."""
    timeline = Timeline()
    timeline.hear(2 * 10**18, CONTROL_PERIOD_NS, MAX_AGE_S, 0.0)
    refused = 0
    for number in range(100):
        wall_s = 0.02 * (number + 1)
        if number % 5 == 0:
            assert timeline.hear((START + number) * CONTROL_PERIOD_NS, 5 * CONTROL_PERIOD_NS, math.inf, wall_s) is None
        refused += len(good(timeline, START + number, wall_s))
    assert refused <= 1 and timeline.now == (START + 99) * CONTROL_PERIOD_NS


@settings(max_examples=100, deadline=None)
@given(st.integers(-900, 10**6))
def test_a_clock_that_begins_elsewhere_is_followed_soon(shift: int) -> None:
    """A plant that is started again, or a machine of another run."""
    timeline = Timeline()
    for number in range(20):
        good(timeline, START + number, number * 0.02)
    refused = [bool(good(timeline, START + shift + number, (20 + number) * 0.02)) for number in range(50)]
    assert sum(refused) * 0.02 <= PERSISTING_S + 0.04 and not any(refused[AGREEING * 10 :])


def test_a_pause_of_the_plant_or_of_the_node_costs_nothing() -> None:
    timeline = Timeline()
    walls = [0.02 * n for n in range(10)] + [30.0 + 0.02 * n for n in range(10)]  # the plant was stopped
    walls += [90.0 + 0.0001 * n for n in range(10)]  # the node was, and its queue is full
    assert not [refusal for number, wall in enumerate(walls) for refusal in good(timeline, START + number, wall)]


def test_what_is_ahead_or_old_is_refused_with_what_is_allowed() -> None:
    timeline = Timeline()
    for number in range(5):
        good(timeline, START + number, number * 0.02)
    now = (START + 4) * CONTROL_PERIOD_NS
    assert (
        timeline.hear(now + 2 * CONTROL_PERIOD_NS + 1, CONTROL_PERIOD_NS, MAX_AGE_S, 0.08)
        == "simulation time, 20.120 s at most"
    )
    assert timeline.hear(now - CONTROL_PERIOD_NS * 6, CONTROL_PERIOD_NS, MAX_AGE_S, 0.08) == "19.980 s or later"


def test_a_topic_that_comes_alone_at_ten_hertz_keeps_the_time() -> None:
    """Two of its messages make the time: the next is two periods after it, and may be early."""
    timeline, period = Timeline(), 5 * CONTROL_PERIOD_NS
    for number in range(20):
        early = 0.03 if number % 3 == 2 else 0.0
        assert timeline.hear(number * period, period, 0.5, 0.1 * number - early) is None
