"""An arm whose process was started again: it knows of its dead joints, and its goal is lost and says so."""

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from sojourn_arm.app import ArmApp, ArmAppState
from sojourn_arm.goals import LastGoal
from sojourn_arm.restart import RESTARTED
from sojourn_config.scenario import load_flight
from sojourn_contract.app import Period
from sojourn_contract.heartbeat import status_values
from sojourn_contract.kept_data import Kept
from sojourn_contract.values import JointState, PoseStamped
from sojourn_flight.arm.dead_joints import known_dead

AT = 5_000_000_000
"""Stamp at which it kept its state [ns]."""


@pytest.fixture(scope="module")
def app() -> ArmApp:
    return ArmApp(load_flight("flat_drive", ["steps=[]"]))


def on_its_way(app: ArmApp) -> ArmAppState:
    """To a goal, with two joints that do not do as they are told."""
    state = app.initial_state()
    dead = known_dead((), app.model, 2, -1.774, True)
    dead = known_dead(dead, app.model, 1, 0.25, False)
    tasks = replace(state.tasks, arm=replace(state.tasks.arm, dead=dead))
    return replace(state, tasks=tasks, goal=replace(state.goal, state="moving", stamp=77))


def kept_of(app: ArmApp, state: ArmAppState) -> Kept:
    return Kept(AT, json.loads(json.dumps(app.to_keep(state))))


def test_it_knows_the_joints_that_do_not_move_and_its_goal_is_lost(app: ArmApp) -> None:
    before = on_its_way(app)
    after = app.started_again(app.initial_state(), AT, kept_of(app, before))
    assert after.tasks.arm.dead == before.tasks.arm.dead
    _, answer = app.step(after, Period(5 * AT, {}, []))
    told = next(status_values(message) for name, message in answer.messages if name == "/arm/status")
    assert (told["state"], told["goal_stamp"]) == ("failed", "77")
    assert told["reason"] == f"goal lost: {RESTARTED}"


def test_a_goal_that_was_over_stays_so(app: ArmApp) -> None:
    before = app.initial_state()
    kept = kept_of(app, replace(before, goal=LastGoal("reached", "", 77)))
    told = app.started_again(app.initial_state(), 9, kept).goal.status(None)
    assert told == {"state": "reached", "goal_stamp": "77", "reason": RESTARTED}


def test_at_rest_it_says_that_it_was_restarted_and_no_goal_is_lost(app: ArmApp) -> None:
    for kept in (None, kept_of(app, app.initial_state())):
        after = app.started_again(app.initial_state(), AT, kept)
        assert (after.goal.state, after.goal.reason, after.tasks.arm.dead) == ("idle", RESTARTED, ())


def test_its_heartbeat_has_the_alarm_until_it_takes_a_goal(app: ArmApp) -> None:
    assert app.heartbeat_values(app.initial_state(), AT) == {}
    for kept in (None, kept_of(app, on_its_way(app)), kept_of(app, app.initial_state())):
        after = app.started_again(app.initial_state(), AT, kept)
        refused, _ = app.step(after, Period(AT, {}, [("/arm/goal_pose", PoseStamped(AT, "nowhere", np.zeros(3)))]))
        for state in (after, refused):
            assert app.heartbeat_values(state, AT) == {"alarm": RESTARTED}
        taken, _ = app.step(after, Period(AT, {}, [("/arm/joint_goal", JointState(AT, (), frame="unfold"))]))
        assert app.heartbeat_values(taken, AT) == {}


@pytest.mark.parametrize(
    "spoilt",
    [
        {"dead": None},
        {"dead": [{"name": "no_joint", "position": 0.0, "holds": True}]},
        {"dead": [{"name": "arm_elbow_joint", "position": float("nan"), "holds": True}]},
        {"dead": [{"name": "arm_elbow_joint", "holds": True}]},
        {"goal": {}},
        {"goal": 7},
    ],
)
def test_kept_data_that_cannot_be_used_are_left_and_named(app: ArmApp, spoilt: dict[str, Any]) -> None:
    kept = kept_of(app, on_its_way(app))
    after = app.started_again(app.initial_state(), AT, Kept(AT, {**kept.values, **spoilt}))
    assert after.tasks.arm.dead == () and after.goal.state == "idle"
    assert "what was kept cannot be used" in after.goal.reason
    assert app.heartbeat_values(after, AT) == {"alarm": after.goal.reason}
