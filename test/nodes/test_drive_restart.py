"""A drive whose process was started again: it goes on from where it was, its goal is lost, or it is lost itself."""

import json
import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from sojourn_config.scenario import load_flight
from sojourn_contract.app import Period
from sojourn_contract.disturbed_app import disturbed, undisturbed
from sojourn_contract.kept_data import Kept
from sojourn_contract.stamps import CONTROL_PERIOD_NS
from sojourn_contract.topics import STANDARD
from sojourn_contract.values import PoseStamped
from sojourn_drive.app import DriveApp
from sojourn_drive.goals import GoalStatus
from sojourn_drive.memory import DriveAppState
from sojourn_drive.restart import LOST, unseen
from sojourn_machine.disturbance import Disturbance

AT = 5_000_000_000
"""Stamp at which it kept its state [ns]."""


@pytest.fixture(scope="module")
def app() -> DriveApp:
    return DriveApp(load_flight("flat_drive", ["steps=[]"]))


def been_somewhere(app: DriveApp) -> DriveAppState:
    """On its way to a goal, some metres from the start."""
    state = app.initial_state()
    estimate = state.drive.odometry
    covariance = estimate.covariance + 1e-3 * np.eye(len(estimate.covariance))
    estimate = replace(estimate, x=3.1, y=-1.7, z=0.2, yaw=2.5, distance=4.4, covariance=covariance, gyro_bias=1e-4)
    drive = replace(state.drive, odometry=estimate)
    return replace(state, drive=drive, asked=replace(state.asked, last=GoalStatus("moving", "", 77, 3)))


def kept_of(app: DriveApp, state: DriveAppState) -> Kept:
    return Kept(AT, json.loads(json.dumps(app.to_keep(state))))


def test_it_goes_on_from_where_it_was_and_is_as_unsure_as_it_may_have_moved(app: DriveApp) -> None:
    before = been_somewhere(app).drive.odometry
    for seconds in (0.02, 0.3, 60.0):
        state = app.started_again(app.initial_state(), AT + round(seconds * 1e9), kept_of(app, been_somewhere(app)))
        after = state.drive.odometry
        assert (after.x, after.y, after.z, after.yaw, after.distance) == (3.1, -1.7, 0.2, 2.5, 4.4)
        assert after.gyro_bias == before.gyro_bias and not state.is_lost
        way, turn = unseen(app.model.params.limits, seconds)
        assert way <= app.model.params.limits.max_speed * min(seconds, 2.0)
        grown = np.diag(after.covariance - before.covariance)
        assert grown[:3] == pytest.approx([way**2, way**2, turn**2]) and not grown[3:].any()
        assert (
            state.drive.avoidance is not None
            and state.drive.avoidance.map.x0 < 3.1 < state.drive.avoidance.map.x0 + 12.0
        )
        assert "the drive was restarted: it goes on from (3.10, -1.70) +- 0." in state.alarm


def test_its_goal_is_lost_and_says_so_under_its_own_stamp(app: DriveApp) -> None:
    state = app.started_again(app.initial_state(), AT, kept_of(app, been_somewhere(app)))
    last = state.asked.last
    assert (last.state, last.stamp) == ("failed", 77)
    assert last.reason.startswith("goal lost: the drive was restarted")
    assert app.heartbeat_values(state, AT) == {"alarm": state.alarm}
    at_rest = replace(been_somewhere(app), asked=app.initial_state().asked)
    last = app.started_again(app.initial_state(), AT, kept_of(app, at_rest)).asked.last
    assert last.state == "idle" and last.reason.startswith("the drive was restarted")


def test_a_goal_that_was_over_stays_so(app: DriveApp) -> None:
    """It was idle with no goal, before it had told how that had ended: a script waited for the word for ever."""
    before = been_somewhere(app)
    for ended in (GoalStatus("reached", "", 77, 1), GoalStatus("stopped", "by operator", 77, 1)):
        kept = kept_of(app, replace(before, asked=replace(before.asked, last=ended)))
        last = app.started_again(app.initial_state(), AT, kept).asked.last
        assert (last.state, last.stamp) == (ended.state, 77)
        assert last.reason == ended.reason or last.reason.startswith("the drive was restarted")


def test_a_goal_that_came_in_the_last_period_is_lost_and_says_so(app: DriveApp) -> None:
    """State was kept every 0.2 s alone: whoever had sent the goal never heard of it."""
    at = 11 * CONTROL_PERIOD_NS
    wrapped = disturbed(app, STANDARD, [Disturbance("restarted", "", "drive", at + CONTROL_PERIOD_NS)])
    state = wrapped.initial_state()
    for number in range(1, 15):
        stamp = number * CONTROL_PERIOD_NS
        goal = PoseStamped(at, "base_link", np.array([1.0, 0.0, 0.0]))
        state, _ = wrapped.step(state, Period(stamp, {}, [("/goal_pose", goal)] if stamp == at else []))
    last = undisturbed(state).asked.last
    assert (last.state, last.stamp) == ("failed", at) and last.reason.startswith("goal lost: the drive was restarted")


def test_a_first_process_has_no_alarm(app: DriveApp) -> None:
    assert app.heartbeat_values(app.initial_state(), 20_000_000) == {}


def spoilt(app: DriveApp, key: str, value: Any) -> Kept:
    kept = kept_of(app, been_somewhere(app))
    return Kept(kept.stamp, {**kept.values, "odometry": {**kept.values["odometry"], key: value}})


@pytest.mark.parametrize("case", ["nothing", "x", "yaw", "covariance", "lost"])
def test_without_a_pose_it_is_lost_and_takes_goals_in_its_own_frame_alone(app: DriveApp, case: str) -> None:
    kept = {
        "nothing": None,
        "x": spoilt(app, "x", "here"),
        "yaw": spoilt(app, "yaw", math.nan),
        "covariance": spoilt(app, "covariance", [[1.0]]),
        "lost": kept_of(app, replace(been_somewhere(app), is_lost=True)),
    }[case]
    state = app.started_again(app.initial_state(), AT, kept)
    assert state.is_lost and state.alarm == LOST and state.drive.odometry.covariance[0, 0] >= 1e4
    for frame, answer in (("map", "refused"), ("odom", "refused"), ("base_link", "moving")):
        goal = PoseStamped(AT, frame, np.array([1.0, 0.0, 0.0]))
        after, answered = app.step(state, Period(AT, {}, [("/goal_pose", goal)]))
        assert after.asked.last.state == answer
        assert (LOST in after.asked.last.reason) == (answer == "refused")
        assert len(list(answered.refusals)) == (answer == "refused")
        after, answered = app.step(state, Period(AT, {}, [("/drive/question", goal)]))
        assert bool(after.asked.questioned.refused) == (answer == "refused")
