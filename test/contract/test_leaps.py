"""Leaps of the clock: which periods a run has, and that whoever waits acts on these, in whatever order he hears."""

import itertools
from bisect import bisect
from dataclasses import replace
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_contract.barrier import Barrier, awaited_inputs, is_due, stamp_due
from sojourn_contract.conformance.answers import missing_answers
from sojourn_contract.delivery import Delivery
from sojourn_contract.errors import LeapError
from sojourn_contract.events import format_tick, parse_tick, rests_until
from sojourn_contract.leaps import BEGIN, NO_LEAPS, Leaps, landing_grid, leaps_of
from sojourn_contract.repeats import KEPT
from sojourn_contract.stamps import CONTROL_PERIOD_NS
from sojourn_contract.topics import ROLES, STANDARD, topic

GRID = landing_grid(STANDARD)
LEAPS = Leaps(((2 * BEGIN, GRID), (GRID, 3 * GRID), (3 * GRID + BEGIN, 4 * GRID)))
LAST = 4 * GRID + 60
APART = 40
"""Periods that one publisher is ahead of a role at most."""
PERIODS = [period for period in range(1, LAST + 1) if not any(a < period < b for a, b in LEAPS.gaps)]
"""Those that the run has, one by one."""
who_waits = pytest.mark.parametrize("role", ["sensors", "drive", "arm", "power", "operator"])


@st.composite
def some_leaps(draw: st.DrawFn) -> tuple[Leaps, list[int]]:
    """Leaps, and the periods of a short run with them."""
    edges = sorted(draw(st.sets(st.integers(1, 120), max_size=8)))
    gaps = tuple((a, b) for a, b in zip(edges[::2], edges[1::2], strict=False) if b > a + 1)
    return Leaps(gaps), [period for period in range(1, 131) if not any(a < period < b for a, b in gaps)]


@given(some_leaps(), st.integers(1, 7), st.integers(-3, 130))
def test_what_is_asked_of_leaps_is_what_the_list_of_periods_says(
    run: tuple[Leaps, list[int]], every: int, period: int
) -> None:
    leaps, periods = run
    on_grid = [each for each in periods if each % every == 0]
    assert leaps.newest(period, every) == max((each for each in on_grid if each <= period), default=0)
    assert leaps.count(period, every) == sum(each <= period for each in on_grid)
    assert (leaps.newest(period) == period) == (period in periods or period == 0)
    for before, after in itertools.pairwise(periods):
        assert leaps.after(before) == after and leaps.before(after) == before
    ns = CONTROL_PERIOD_NS
    assert [each // ns for each in leaps.stamps(every, 17 * ns, 99 * ns)] == [
        each for each in on_grid if 17 < each < 100
    ]
    known = leaps_of(each * ns for each in periods)
    assert known == Leaps(tuple(gap for gap in leaps.gaps if not gap[0] % BEGIN and not gap[1] % BEGIN))


@who_waits
@settings(max_examples=10, deadline=None)
@given(seed=st.integers(0, 2**32))
def test_a_role_finds_the_leaps_by_what_it_hears(role: str, seed: int) -> None:
    """Messages of a topic come in their order, those of different topics in any, as far apart as nodes may be."""
    chance, awaited = Random(seed), awaited_inputs(role, ROLES)
    barrier: Barrier[str] = Barrier(awaited, longest_leap=4 * GRID)
    waiting = {row: [period for period in PERIODS if period % row.every == 0] for row in awaited}
    acted = [0]
    while any(waiting.values()):
        horizon = PERIODS[min(bisect(PERIODS, acted[-1]) + APART, len(PERIODS) - 1)]
        row = chance.choice([row for row, left in waiting.items() if left and left[0] <= horizon])
        stamp = waiting[row].pop(0) * CONTROL_PERIOD_NS
        assert barrier.refusal(row, stamp) is None
        barrier.offer(row, stamp, f"{row.name}@{stamp}")
        while barrier.is_complete():
            acted.append(barrier.period)
            due = {each.name: stamp_due(each, acted[-1], LEAPS) for each in awaited if is_due(each, acted[-1])}
            assert barrier.take() == {name: f"{name}@{at}" for name, at in due.items()}
    assert acted[1:] == [period for period in PERIODS if period % barrier.stride == 0]
    assert barrier.leaps == LEAPS


@who_waits
@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 2**32))
def test_what_is_lost_is_no_leap_and_is_waited_for(role: str, seed: int) -> None:
    """A bundle that was lost was taken for a leap: its period was passed over, and no role stood still for it."""
    chance, awaited = Random(seed), awaited_inputs(role, ROLES)
    barrier: Barrier[int] = Barrier(awaited, longest_leap=4 * GRID)
    acted, lost, losses = [], list[int](), 0

    def hear(period: int) -> None:
        for row in awaited:
            if period % row.every == 0 and barrier.lacks(row, period * CONTROL_PERIOD_NS):
                barrier.offer(row, period * CONTROL_PERIOD_NS, period)
        while barrier.is_complete():
            acted.append(barrier.period)
            barrier.take()

    chained = {end for _, end in LEAPS.gaps} & {begin for begin, _ in LEAPS.gaps}  # lost they would not be missed
    for place, period in enumerate(PERIODS):
        near_a_leap = any(abs(period - edge) < 5 for gap in LEAPS.gaps for edge in gap)
        if place and period not in chained and chance.random() < (0.5 if near_a_leap else 0.01):
            lost.append(period)
        else:
            hear(period)
        if lost and place - PERIODS.index(lost[0]) >= KEPT // 2:
            missed = next((each for each in lost if each % barrier.stride == 0), LAST + 1)
            assert all(each < missed for each in acted)  # it stands still
            losses += len(lost)
            for each in lost:
                hear(each)
            lost.clear()
    for each in lost:
        hear(each)
    assert acted == [period for period in PERIODS if period % barrier.stride == 0] and losses
    assert barrier.leaps == LEAPS


@settings(max_examples=30)
@given(st.sampled_from(["power", "drive"]), st.sampled_from([2 * BEGIN, GRID, 3 * GRID]) | st.sampled_from(PERIODS))
def test_who_goes_on_from_a_period_acts_on_those_that_follow(role: str, begin: int) -> None:
    awaited, known = awaited_inputs(role, ROLES), Leaps(tuple(gap for gap in LEAPS.gaps if gap[0] <= begin))
    barrier: Barrier[int] = Barrier(awaited, longest_leap=4 * GRID)
    last = max((period for period in PERIODS if period <= begin and period % barrier.stride == 0), default=0)
    barrier.go_on(last, known)
    oldest = {row.name: stamp_due(row, barrier.period, known) for row in awaited}
    acted = []
    for period in PERIODS:
        stamp = period * CONTROL_PERIOD_NS
        for row in awaited:
            if period % row.every == 0 and (period > begin or stamp >= oldest[row.name]):
                barrier.offer(row, stamp, period)
        while period > begin and barrier.is_complete():
            acted.append(barrier.period)
            barrier.take()
    assert acted == [period for period in PERIODS if period > last and period % barrier.stride == 0]
    assert barrier.leaps == LEAPS


def test_what_lags_is_the_newest_of_before_the_leap() -> None:
    tick = topic("/recorder/tick")
    assert stamp_due(tick, GRID, LEAPS) == 2 * BEGIN * CONTROL_PERIOD_NS
    assert stamp_due(tick, 3 * GRID + 5, LEAPS) == GRID * CONTROL_PERIOD_NS
    assert stamp_due(tick, 3 * GRID + tick.lag, LEAPS) == 3 * GRID * CONTROL_PERIOD_NS
    assert stamp_due(tick, 2 * BEGIN, LEAPS) == stamp_due(tick, 2 * BEGIN) == (2 * BEGIN - tick.lag) * CONTROL_PERIOD_NS


def test_who_would_not_hear_of_a_leap_is_named() -> None:
    late = tuple(row for row in awaited_inputs("power", ROLES) if row.lag)
    with pytest.raises(LeapError, match="would not be told by /operator/tick"):
        Barrier(late, longest_leap=GRID)


def test_a_gap_is_an_answer_that_is_missing_unless_the_clock_leaps() -> None:
    row, ns = topic("/truth/odom"), CONTROL_PERIOD_NS
    stamps, end = {row.name: [period * ns for period in PERIODS]}, LAST * ns
    assert not list(missing_answers([row], stamps, {"plant": ()}, 0, end, LEAPS))
    assert len(list(missing_answers([row], stamps, {"plant": ()}, 0, end))) == LAST - len(PERIODS)
    lost = {row.name: [stamp for stamp in stamps[row.name] if stamp != GRID * ns]}
    assert [stamp for _, stamp, _ in missing_answers([row], lost, {"plant": ()}, 0, end, LEAPS)] == [GRID * ns]


@pytest.mark.parametrize(
    ("change", "what"),
    [({"every": 7}, "comes each 0.14 s"), ({"delivery": Delivery(5, latency=1)}, "is heard later than it is measured")],
)
def test_a_row_that_lets_no_clock_leap_is_named(change: dict[str, object], what: str) -> None:
    with pytest.raises(LeapError, match=f"/imu/data {what}"):
        landing_grid([replace(topic("/imu/data"), **change)])  # type: ignore[arg-type]


@given(st.integers(0, 10**9), st.booleans())
def test_the_operators_rest_is_in_its_tick(until: int, end: bool) -> None:
    text = format_tick({"/goal_pose": 3}, end, until)
    assert parse_tick(text) == ({"/goal_pose": 3}, end) and rests_until(text) == until
    assert rests_until(format_tick({}, end)) == rests_until("rests_until=soon") == 0


def test_the_clock_of_a_run_tells_its_leaps_also_where_it_lacks_a_message() -> None:
    lost = {1, 2 * BEGIN - 1, 3 * GRID + 7}
    assert leaps_of(period * CONTROL_PERIOD_NS for period in PERIODS if period not in lost) == LEAPS


def test_a_run_without_leaps_has_every_period() -> None:
    assert NO_LEAPS.newest(17) == NO_LEAPS.before(18) == 17 and NO_LEAPS.count(17, 5) == 3
