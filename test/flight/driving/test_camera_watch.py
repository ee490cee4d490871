"""A hazard camera that does not see: recognised from its clouds, and from nothing else."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_flight.hazards.camera_watch import (
    BLIND,
    DIM,
    FROZEN,
    WELL,
    CameraState,
    CameraWatchParams,
    in_words,
    speed_left,
    usable,
    watched,
)

PARAMS = CameraWatchParams()


def clouds(counts: list[int], seed: int = 1) -> list[np.ndarray]:
    chance = np.random.default_rng(seed)
    return [chance.normal(size=(count, 3)) for count in counts]


def after(shown: list[np.ndarray]) -> CameraState:
    state = CameraState()
    for cloud in shown:
        state = watched(PARAMS, watched(PARAMS, state, cloud), None)
    return state


@pytest.mark.parametrize(
    ("counts", "found"),
    [
        ([400] * 10, WELL),
        ([400, 380, 250, 410, 230, 220], WELL),
        ([400] * 5 + [190] * 2, WELL),  # a crest for two clouds
        ([400] * 5 + [190] * 3, DIM),
        ([400] * 5 + [190] * 30, DIM),  # it does not get used to it
        ([400] * 5 + [20] * 3, BLIND),
        ([400] * 5 + [0] * 3, BLIND),
        ([0] * 3, BLIND),
        ([400] * 5 + [0] * 5 + [390], WELL),
    ],
)
def test_what_a_camera_is_taken_for(counts: list[int], found: str) -> None:
    state = after(clouds(counts))
    assert state.found == found
    assert bool(in_words(state)) == bool(found)
    assert speed_left(PARAMS, state) == (PARAMS.slow_part if found else 1.0)


def test_the_same_cloud_again_is_no_cloud() -> None:
    shown = clouds([300] * 4)
    state = after([*shown, shown[-1], shown[-1], shown[-1]])
    assert state.found == FROZEN
    assert usable(state, shown[-1]) is None
    (fresh,) = clouds([300], seed=2)
    again = watched(PARAMS, state, fresh)
    assert again.found == WELL
    assert usable(again, fresh) is fresh


def test_what_a_blind_camera_says_is_not_used_from_the_first_cloud_on() -> None:
    (blind,) = clouds([3])
    state = watched(PARAMS, after(clouds([300] * 3)), blind)
    assert state.found == WELL  # not sure yet
    assert usable(state, blind) is None


@settings(max_examples=50, deadline=None)
@given(st.lists(st.integers(min_value=210, max_value=400), min_size=1, max_size=40), st.integers(0, 100))
def test_a_camera_that_gives_half_of_its_points_or_more_is_well(counts: list[int], seed: int) -> None:
    assert after(clouds(counts, seed)).found == WELL
