"""Operator's goals: order and time of effect, refusal of stale stamps; the text of the tick."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.events import MAX_AHEAD_S, EventQueue, format_tick, parse_tick
from sojourn_contract.topics import TOPICS, topic

SECOND = 10**9
GOAL = topic("/goal_pose")
TWIST = topic("/cmd_vel")
EVENTS = [row.name for row in TOPICS if row.is_event]


def test_takes_effect_at_its_stamp_or_on_arrival() -> None:
    queue = EventQueue()
    queue = queue.offered(GOAL, 0, 2 * SECOND, "now")
    queue = queue.offered(GOAL, 5 * SECOND, 2 * SECOND, "later")
    queue = queue.offered(TWIST, int(1.9 * SECOND), 2 * SECOND, "just past")
    queue, taken = queue.taken(2 * SECOND)
    assert taken == [("/goal_pose", "now"), ("/cmd_vel", "just past")]
    assert queue.taken(5 * SECOND - 1) == (queue, [])
    after, taken = queue.taken(5 * SECOND)
    assert taken == [("/goal_pose", "later")]
    assert after.taken(6 * SECOND)[1] == []
    assert queue.taken(6 * SECOND)[1] == taken, "what was kept is as it was"


def test_of_two_that_take_effect_together_the_later_comes_last() -> None:
    queue = EventQueue()
    queue = queue.offered(GOAL, int(9.5 * SECOND), 10 * SECOND, "first, stamped in the past")
    queue = queue.offered(GOAL, 0, 10 * SECOND, "second, stamped zero")
    assert [message for _, message in queue.taken(11 * SECOND)[1]] == [
        "first, stamped in the past",
        "second, stamped zero",
    ]


@given(st.lists(st.integers(min_value=1, max_value=50), min_size=1, max_size=20))
def test_order_of_effect(stamps: list[int]) -> None:
    queue = EventQueue()
    for index, stamp in enumerate(stamps):
        queue = queue.offered(GOAL, stamp, 0, index)
    taken = [message for _, message in queue.taken(50)[1]]
    assert taken == sorted(range(len(stamps)), key=lambda index: (stamps[index], index))


@pytest.mark.parametrize("row", [GOAL, TWIST], ids=lambda row: row.name)
def test_a_stamp_from_the_past_is_refused(row) -> None:
    queue = EventQueue()
    now = 100 * SECOND
    queue = queue.offered(row, now - int(row.max_age_s * SECOND), now, "old enough")
    with pytest.raises(RefusedMessageError, match=rf"{row.name}\.header\.stamp") as refusal:
        queue = queue.offered(row, now - int(row.max_age_s * SECOND) - 1, now, "too old")
    assert refusal.value.topic == row.name
    assert len(queue.taken(now)[1]) == 1


def test_a_stamp_of_the_wall_clock_is_refused() -> None:
    """It would wait for years without a word."""
    queue = EventQueue()
    queue = queue.offered(GOAL, 10 * SECOND + int(MAX_AHEAD_S * SECOND), 10 * SECOND, "")
    with pytest.raises(RefusedMessageError, match="simulation time"):
        queue = queue.offered(GOAL, 1_700_000_000 * SECOND, 10 * SECOND, "")
    queue = queue.offered(GOAL, 20_000 * SECOND, 0, "a node that has just started does not know the time")


def test_counts_what_arrives() -> None:
    queue = EventQueue()
    assert queue.has_received({})
    assert not queue.has_received({"/goal_pose": 1})
    queue = queue.counted(GOAL)
    assert queue.has_received({"/goal_pose": 1})
    assert not queue.has_received({"/goal_pose": 1, "/cmd_vel": 1})


@given(st.dictionaries(st.sampled_from(EVENTS), st.integers(min_value=0, max_value=10**9)), st.booleans())
def test_tick_round_trip(counts: dict[str, int], end: bool) -> None:
    assert parse_tick(format_tick(counts, end)) == (counts, end)


@pytest.mark.parametrize("text", ["start", "/goal_pose=", "/goal_pose=-1", "/goal_pose=1.5", "a=²", "/goal_pose"])
def test_other_texts_of_the_tick_are_refused(text: str) -> None:
    with pytest.raises(RefusedMessageError, match=r"/operator/tick\.frame_id"):
        parse_tick(text)
