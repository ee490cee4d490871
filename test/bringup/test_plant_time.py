"""How far a run is: what a false heartbeat of the plant does to it."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sojourn_bringup.plant_time import BEAT_NS, PlantTime

STAMPS = st.integers(1, 10**18)


@pytest.mark.parametrize("realtime", [False, True])
@given(false=STAMPS, after=st.integers(1, 30))
def test_a_single_false_one_moves_it_by_a_beat_at_most(realtime: bool, false: int, after: int) -> None:
    time = PlantTime(realtime=realtime)
    for beat in range(1, after + 1):
        time.hear(beat * BEAT_NS, float(beat))
    time.hear(false, after + 0.5)
    assert after * BEAT_NS <= time.now <= (after + 1) * BEAT_NS
    for beat in range(after + 1, after + 6):
        time.hear(beat * BEAT_NS, float(beat))
    assert time.now == (after + 5) * BEAT_NS


@given(st.lists(STAMPS, max_size=20))
def test_it_never_goes_back(stamps: list[int]) -> None:
    time, before = PlantTime(), 0
    for stamp in stamps:
        time.hear(stamp, 0.0)
        assert time.now >= before
        before = time.now


def test_who_comes_late_believes_the_second_beat() -> None:
    time = PlantTime()
    time.hear(600 * BEAT_NS, 0.0)
    assert time.now == 0
    time.hear(601 * BEAT_NS, 1.0)
    assert time.now == 601 * BEAT_NS


def test_a_clock_that_leaps_is_followed_as_far_as_it_may() -> None:
    time = PlantTime(longest_leap=600 * BEAT_NS)
    time.hear(BEAT_NS, 0.0)
    time.hear(601 * BEAT_NS, 0.0)
    assert time.now == 601 * BEAT_NS
    time.hear(2000 * BEAT_NS, 0.0)
    assert time.now == 601 * BEAT_NS


def test_in_real_time_no_flood_hastens_it() -> None:
    time = PlantTime(realtime=True)
    time.hear(BEAT_NS, 1.0)
    for beat in range(2, 1000):
        time.hear(beat * BEAT_NS, 1.0)
    assert time.now <= 2 * BEAT_NS


def test_a_run_that_goes_on_is_followed_from_there() -> None:
    time = PlantTime(begun=600 * BEAT_NS)
    time.hear(601 * BEAT_NS, 0.0)
    assert time.now == 601 * BEAT_NS
