"""Limit switches: where they operate and release, bounce, repeatability."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_machine.errors import InvalidValueError
from sojourn_physics.sensors import limit_switch
from sojourn_physics.sensors.limit_switch import LimitSwitchParams

DT = 0.02


def way(params: LimitSwitchParams, beyond: list[float], seed: int = 1) -> list[bool]:
    """Contacts of an upper switch along a way, the lower one far off."""
    ends = [np.array([[-9.0, x]]) for x in beyond]
    state, told = limit_switch.initial_state(params, seed, ("a",), ends[0]), []
    for into in ends[1:]:
        state, closed = limit_switch.step(params, state, into, DT)
        assert not closed[0, 0]
        told.append(bool(closed[0, 1]))
    return told


def test_it_operates_before_the_limit_and_releases_after_its_hysteresis() -> None:
    params = LimitSwitchParams(before=0.05, hysteresis=0.02)
    assert way(params, [-1.0, -0.06, -0.045, 0.0, -0.06, -0.068, -0.072, -0.06]) == [0, 1, 1, 1, 1, 0, 0]


@settings(max_examples=100)
@given(st.lists(st.floats(-0.2, 0.2), min_size=2, max_size=60), st.floats(0.0, 0.05), st.floats(0.001, 0.05))
def test_it_never_changes_back_within_its_hysteresis(walk: list[float], before: float, hysteresis: float) -> None:
    told = way(LimitSwitchParams(before=before, hysteresis=hysteresis), [-1.0, *walk])
    at = [place for place in range(1, len(told)) if told[place] != told[place - 1]]
    for first, then in pairwise(at):
        seen = walk[first : then + 1]
        assert max(seen) - min(seen) >= hysteresis * (1 - 1e-9)
    for place, closed in zip(walk, told, strict=True):
        assert closed or place < -before
        assert not closed or place > -before - hysteresis


def test_contacts_chatter_for_their_time_and_then_hold() -> None:
    params = LimitSwitchParams(before=0.0, hysteresis=0.1, bounce_time=1.0)
    open_ = np.array([way(params, [-1.0, *[0.5] * 60], seed)[:50] for seed in range(40)])
    assert open_[:, :49].mean() == pytest.approx(0.5, abs=0.05)
    assert all(all(way(params, [-1.0, *[0.5] * 60], seed)[51:]) for seed in range(5))
    assert not any(way(params, [-1.0] * 20))


def test_where_it_operates_is_repeatable_within_its_standard_deviation() -> None:
    params = LimitSwitchParams(before=0.05, hysteresis=0.02, repeatability=0.004)
    ramp = np.linspace(-0.08, -0.02, 1201)
    found = [ramp[1:][way(params, [-0.08, *ramp[1:]], seed).index(True)] for seed in range(150)]
    assert np.mean(found) == pytest.approx(-0.05, abs=0.002) and np.std(found) == pytest.approx(0.004, rel=0.2)


def test_a_way_that_is_none_is_refused() -> None:
    params = LimitSwitchParams(before=0.05, hysteresis=0.02)
    state = limit_switch.initial_state(params, 1, ("a",), np.zeros((1, 2)))
    with pytest.raises(InvalidValueError, match="beyond the limits"):
        limit_switch.step(params, state, np.array([[np.nan, 0.0]]), DT)
