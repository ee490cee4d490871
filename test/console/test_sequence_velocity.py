"""A velocity of a sequence on the page, which is looked at as often as the page is drawn."""

import pytest
from deaf_feed import DeafFeed

from sojourn_console.sequence_board import SequenceBoard
from sojourn_console.world import World
from sojourn_operator.sequence.runner import ENDED

VELOCITY = "steps:\n  - drive_velocity: {forward: 0.05, seconds: 2.0}\n"


@pytest.mark.parametrize(("apart_s", "outcome"), [(0.1, "jogged"), (0.4, "failed")])
def test_a_velocity_beside_a_stack_that_is_too_fast_is_told_as_failed(
    apart_s: float, outcome: str, world: World, feed: DeafFeed
) -> None:
    board = SequenceBoard(world, feed, "Ada")
    board.begin(VELOCITY)
    for _ in range(100):
        board.hear([])
        feed.now += round(apart_s * 1e9)
    assert board.state.phase == ENDED
    (entry,) = board.history
    assert entry.outcome == outcome and ("--realtime" in entry.reason) is (outcome == "failed")
