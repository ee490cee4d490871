"""What is kept of a goal, and how soon."""

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sojourn_contract.kept_data import KEEP_EVERY_NS, Kept
from sojourn_contract.kept_goal import GOAL, MOVING, KeptGoal, kept_goal, newly_kept
from sojourn_machine.errors import InvalidValueError

GOALS = st.builds(
    KeptGoal, st.sampled_from(["idle", MOVING, "reached", "refused", "stopped", "failed"]), st.text(), st.integers(0)
)


@given(GOALS)
def test_a_goal_is_read_as_it_was_kept(goal: KeptGoal) -> None:
    assert kept_goal(json.loads(json.dumps({GOAL: goal._asdict()}))) == goal
    after = goal.after("restarted")
    assert after.stamp == goal.stamp and after.state == ("failed" if goal.state == MOVING else goal.state)
    assert after.reason


@given(GOALS, GOALS, st.integers(0, 3 * KEEP_EVERY_NS))
def test_another_goal_is_kept_at_once(before: KeptGoal, now: KeptGoal, waited: int) -> None:
    last, values = Kept(1, {GOAL: before._asdict()}), {GOAL: now._asdict()}
    is_due = before != now or waited >= KEEP_EVERY_NS
    assert newly_kept(last, 1 + waited, lambda: values) == (Kept(1 + waited, values) if is_due else None)


@given(st.integers(0, 3 * KEEP_EVERY_NS))
def test_what_has_no_goal_is_kept_every_fifth_of_a_second(waited: int) -> None:
    asked = list[int]()

    def to_keep() -> dict[str, int]:
        asked.append(waited)
        return {"all": waited}

    assert newly_kept(None, 1, to_keep) == Kept(1, {"all": waited}) and newly_kept(None, 1, lambda: None) is None
    is_due = waited >= KEEP_EVERY_NS
    assert (newly_kept(Kept(1, {"all": 0}), 1 + waited, to_keep) is not None) is is_due
    assert len(asked) == 1 + is_due  # or to put it together would cost every period


@pytest.mark.parametrize(
    "values", [{}, {GOAL: 7}, {GOAL: {"state": "idle"}}, {GOAL: {**KeptGoal("", "", 0)._asdict(), "stamp": "x"}}]
)
def test_what_is_no_goal_is_refused(values: dict[str, object]) -> None:
    with pytest.raises(InvalidValueError, match="a state, a reason and a stamp"):
        kept_goal(values)
