"""The barrier: whatever the order of arrival, the same periods with the same messages, and nothing that is not due."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_contract.barrier import MAX_PENDING_PERIODS, Barrier, awaited_inputs, is_due, stamp_due
from sojourn_contract.stamps import CONTROL_PERIOD_NS
from sojourn_contract.topics import OPERATOR_LAG, RECORDER_LAG, ROLES, topic

EVERYBODY = ROLES
PERIODS = 31


def stamped(period: int) -> int:
    return period * CONTROL_PERIOD_NS


def due_messages(barrier: Barrier[str], periods: int) -> list[tuple[str, int]]:
    """Every message that the barrier needs for its first `periods` periods."""
    return sorted(
        {
            (row.name, stamp_due(row, period))
            for period in range(1, periods + 1)
            for row in barrier.awaited
            if is_due(row, period)
        }
    )


def run(barrier: Barrier[str], arrivals: list[tuple[str, int]]) -> list[tuple[int, dict[str, str]]]:
    """Offer messages in this order and take every period that is complete, up to PERIODS."""
    taken = []
    for name, stamp in arrivals:
        row = next(row for row in barrier.awaited if row.name == name)
        assert barrier.refusal(row, stamp) is None
        barrier.offer(row, stamp, f"{name}@{stamp}")
        while not barrier.missing() and barrier.period <= PERIODS:
            assert barrier.is_complete()
            taken.append((barrier.period, dict(barrier.take())))
        assert barrier.is_complete() == (not barrier.missing())
    return taken


@pytest.mark.parametrize("role", ["plant", "drive", "power", "operator"])
@settings(max_examples=15, deadline=None)
@given(data=st.data())
def test_order_of_arrival_does_not_matter(role: str, data: st.DataObject) -> None:
    awaited = awaited_inputs(role, EVERYBODY)
    messages = due_messages(Barrier(awaited, role == "plant"), PERIODS)
    taken = run(Barrier(awaited, role == "plant"), data.draw(st.permutations(messages)))
    stride = taken[0][0]
    assert [period for period, _ in taken] == list(range(stride, PERIODS + 1, stride))
    for period, inputs in taken:
        assert inputs == {row.name: f"{row.name}@{stamp_due(row, period)}" for row in awaited if is_due(row, period)}
    assert stride == (5 if role == "power" else 1)


def test_rows_with_a_lag_are_waited_for_later() -> None:
    tick = topic("/recorder/tick")
    barrier: Barrier[str] = Barrier((tick,), every_period=True)
    for period in range(1, RECORDER_LAG + 5):
        assert barrier.period == period and not barrier.missing()
        barrier.take()
    assert barrier.missing() == [tick]
    barrier.offer(tick, stamped(5), "written")
    assert barrier.peek(tick) == "written"
    assert barrier.take() == {"/recorder/tick": "written"}
    assert not barrier.missing()


def test_a_message_with_a_lag_is_taken_from_its_first_stamp_on() -> None:
    tick = topic("/operator/tick")
    barrier: Barrier[str] = Barrier((tick,), every_period=True)
    assert tick.lag == OPERATOR_LAG
    assert barrier.refusal(tick, 0) is not None, "the first period is stamped one period, not zero"
    assert barrier.refusal(tick, -stamped(5)) is not None
    assert barrier.refusal(tick, stamped(5)) is None


@pytest.mark.parametrize(
    "stamp",
    [
        stamped(9),
        stamped(10),
        0,
        -stamped(1),
        stamped(11) + 1,
        stamped(12) - 1,
        stamped(12) + CONTROL_PERIOD_NS // 2,
        stamped(12 + MAX_PENDING_PERIODS),
        1_700_000_000 * 10**9,
    ],
)
def test_stamps_that_are_late_off_the_grid_or_from_another_clock_are_refused(stamp: int) -> None:
    rows = awaited_inputs("drive", ("sensors", "drive"))
    barrier: Barrier[str] = Barrier(rows)
    for period in range(1, 11):
        for row in rows:
            barrier.offer(row, stamped(period), "")
        barrier.take()
    assert barrier.period == 11
    assert barrier.refusal(rows[0], stamp) is not None
    assert barrier.refusal(rows[0], stamped(11)) is None
    assert barrier.refusal(rows[0], stamped(11 + MAX_PENDING_PERIODS)) is None


def test_a_stamp_comes_once() -> None:
    row = awaited_inputs("drive", ("sensors",))[0]
    barrier: Barrier[str] = Barrier((row,))
    barrier.offer(row, stamped(3), "first")
    assert barrier.refusal(row, stamped(3)) is not None


def test_a_slow_row_is_refused_between_its_stamps() -> None:
    """It would wait for ever in a place where nobody looks."""
    switches = topic("/power/switches")
    barrier: Barrier[str] = Barrier((switches,), every_period=True)
    assert [p for p in range(1, 21) if barrier.refusal(switches, stamped(p)) is None] == [5, 10, 15, 20]


def test_only_participants_are_awaited() -> None:
    assert awaited_inputs("plant", ("plant",)) == ()
    assert {row.name for row in awaited_inputs("plant", ("plant", "drive"))} == {"/drive_command"}
    assert all(row.lag == 0 for row in awaited_inputs("recorder", EVERYBODY))
    assert not any(row.is_event for role in ROLES for row in awaited_inputs(role, EVERYBODY))
