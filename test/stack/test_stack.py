"""All roles as one value: a kept state is gone on from, who waits for nobody is named, refusals are counted."""

from typing import Any

import pytest

from sojourn_bags.reading import read_bag
from sojourn_config.scenario import load_scenario
from sojourn_contract.codecs import encode
from sojourn_contract.heartbeat import read_heartbeats
from sojourn_contract.stamps import CONTROL_PERIOD_NS
from sojourn_stack.apps import make_apps
from sojourn_stack.errors import WaitingError
from sojourn_stack.run import RunSpec, run
from sojourn_stack.stack import Stack, StackState

ROLES = ("plant", "sensors", "drive", "power", "operator")


@pytest.fixture(scope="module")
def stack() -> Stack:
    return Stack(make_apps(load_scenario("flat_drive"), ROLES), ROLES)


def gone_on(stack: Stack, state: StackState, periods: int) -> tuple[StackState, list[tuple[str, bytes]]]:
    """The state after some periods, and what was said in them, as bytes."""
    told = []
    for _ in range(periods):
        state, said = stack.step(state)
        told += [(row.name, encode(row, message)) for row, message in said]
    return state, told


@pytest.mark.parametrize("periods", [1, 49, 63])
def test_a_kept_state_is_gone_on_from_as_if_nothing_had_happened(stack: Stack, periods: int) -> None:
    state, _ = stack.begin()
    state, _ = gone_on(stack, state, periods)
    kept = state
    state, first = gone_on(stack, state, 12)
    gone_on(stack, state, 5)
    again, second = gone_on(stack, kept, 12)
    assert second == first and again.period == state.period == periods + 13
    assert {"/drive_command", "/truth/odom", "/joint_states"} <= {name for name, _ in first}


def test_goals_take_effect_and_heartbeats_count(stack: Stack) -> None:
    state, _ = stack.begin()
    state, told = gone_on(stack, state, 150)
    assert [name for name, _ in told].count("/goal_pose") == 1
    assert state.roles["drive"].app.drive.follower is not None
    assert state.now == 150 * CONTROL_PERIOD_NS
    beats = {beat.role: beat for _, message in stack.farewells(state) for beat in read_heartbeats(message)}
    assert set(beats) == set(ROLES)
    assert beats["drive"].published["/drive_command"] == 150
    assert beats["plant"].published["/clock"] == 151
    assert all(not beat.refused for beat in beats.values())


class Mute:
    """An app that answers nothing."""

    def __init__(self, app: Any) -> None:
        self._app = app

    def __getattr__(self, name: str) -> Any:
        return getattr(self._app, name)

    def step(self, state: Any, period: Any) -> Any:
        state, answer = self._app.step(state, period)
        return state, type(answer)()


def test_who_waits_for_a_role_that_says_nothing_is_named() -> None:
    apps = make_apps(load_scenario("flat_drive"), ROLES)
    mute = Stack({**apps, "sensors": Mute(apps["sensors"])}, ROLES)
    state, _ = mute.begin()
    with pytest.raises(WaitingError, match=r"drive waits for /joint_states stamped 0\.02 s, which nobody sends"):
        mute.step(state)


def test_a_run_with_a_bag_and_another_after_it(tmp_path: Any) -> None:
    spec = RunSpec("flat_drive", (*ROLES, "recorder"), ("duration_limit_s=1.0",), tmp_path / "bag")
    result = run(spec)
    assert [step.outcome for step in result.steps] == ["timed out"]
    assert result.completeness is not None and not result.completeness.gaps
    assert all(count.due == count.recorded for count in result.completeness.counts.values() if count.due is not None)
    bag = read_bag(tmp_path / "bag")
    assert bag.whole and len(bag["/drive_command"]) == len(bag["/clock"])
    again = run(RunSpec("flat_drive", ROLES, ("duration_limit_s=1.0",)))
    assert again.state.now == result.state.now and again.completeness is None


def test_a_run_ends_when_it_is_told_to(tmp_path: Any) -> None:
    spec = RunSpec("flat_drive", (*ROLES, "recorder"), bag=tmp_path / "bag")
    result = run(spec, lambda state: state.period < 20)
    assert result.state.period == 20 and not result.state.finished
    # truth of the period to come has been said, what others would have said in it has not
    assert result.completeness is not None and result.completeness.explain() == ""
