"""How often a page is shown on machines on which scenes cost little, and on those on which they cost much."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sojourn_console.frames import FEWEST, FRAMES, PART, SMOOTHED, Frames


@given(st.floats(0.0, 1.0), st.integers(1, 64))
def test_scenes_take_no_more_of_the_processors_than_they_may(cost: float, processors: int) -> None:
    """Or are the fewest that a page must have."""
    frames = Frames(PART * processors)
    for _ in range(20 * SMOOTHED):
        interval = frames.interval_s(cost)
    assert 1.0 / FRAMES <= interval <= 1.0 / FEWEST
    assert cost / interval <= PART * processors * (1.0 + 1e-6) or interval == 1.0 / FEWEST
    assert interval == 1.0 / FRAMES or cost / interval >= PART * processors * (1.0 - 1e-6)


def test_one_scene_that_costs_much_does_not_hold_up_the_next() -> None:
    frames = Frames(2 * PART)
    assert [frames.interval_s(0.003) for _ in range(10)] == [1.0 / FRAMES] * 10
    assert frames.interval_s(0.3) == 1.0 / FEWEST
    after = [frames.interval_s(0.002) for _ in range(3 * SMOOTHED)]
    assert sum(after) < 2 * 3 * SMOOTHED / FRAMES and after[-1] == pytest.approx(1.0 / FRAMES)
