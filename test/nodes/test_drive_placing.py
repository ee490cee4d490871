"""An operator's word where the rover is: the estimate goes on from there, or the word is refused with the reason."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sojourn_config.scenario import load_flight
from sojourn_contract.app import Period
from sojourn_contract.heartbeat import status_values
from sojourn_contract.values import PoseStamped, PoseWithCovarianceStamped
from sojourn_drive.app import DriveApp
from sojourn_drive.memory import DriveAppState
from sojourn_drive.placing import LEAST_SIGMA
from sojourn_flight.odometry.turn_drift import downhill_of
from sojourn_operator.goal_messages import place_message

AT = 3_000_000_000
WHOLE = 4_000_000_000
"""A stamp with a status [ns]."""


@pytest.fixture(scope="module")
def app() -> DriveApp:
    return DriveApp(load_flight("flat_drive", ["steps=[]"]))


def lost(app: DriveApp) -> DriveAppState:
    return app.started_again(app.initial_state(), AT, None)


def told(app: DriveApp, state: DriveAppState, message: PoseWithCovarianceStamped) -> tuple[DriveAppState, Any]:
    return app.step(state, Period(WHOLE, {}, [("/initialpose", message)]))


def word(**changes: Any) -> PoseWithCovarianceStamped:
    return place_message(WHOLE, (3.0, -2.0), 1.2, 0.1)._replace(**changes)


@given(
    x=st.floats(-1e3, 1e3), y=st.floats(-1e3, 1e3), yaw=st.floats(-math.pi, math.pi), within=st.floats(1e-3, 10.0)
)  # fmt: skip
def test_the_estimate_is_where_the_operator_says_and_as_sure(x: float, y: float, yaw: float, within: float) -> None:
    app = DRIVE
    before = lost(app)
    state, answer = told(app, before, place_message(WHOLE, (x, y), yaw, within))
    assert not list(answer.refusals) and not state.is_lost and not state.alarm
    estimate, old = state.drive.odometry, before.drive.odometry
    assert (estimate.x, estimate.y) == (x, y)
    assert math.remainder(estimate.yaw - yaw, 2.0 * math.pi) == pytest.approx(0.0, abs=1e-12)
    assert np.diag(estimate.covariance)[:3] == pytest.approx([within**2 + LEAST_SIGMA**2] * 3)
    assert np.linalg.eigvalsh(estimate.covariance)[0] >= 0.0
    assert np.array_equal(estimate.covariance[3:6, 3:6], old.covariance[3:6, 3:6])
    assert not estimate.covariance[:3, 3:6].any()


def test_the_way_to_a_goal_begins_there(app: DriveApp) -> None:
    goal = PoseStamped(WHOLE, "map", np.array([4.0, -2.0, 0.0]))
    state, answer = app.step(lost(app), Period(WHOLE, {}, [("/initialpose", word()), ("/goal_pose", goal)]))
    assert state.asked.last.state == "moving" and state.asked.pending is not None
    assert not list(answer.refusals)
    status = status_values(dict(answer.messages)["/drive/status"])
    assert (status["placed_state"], status["placed_stamp"], status["placed_reason"]) == ("done", str(WHOLE), "")


def test_what_it_has_learnt_stays_and_what_hangs_on_the_old_pose_goes(app: DriveApp) -> None:
    before = lost(app)
    estimate = replace(before.drive.odometry, z=0.4, roll=0.1, gyro_bias=1e-4, distance=12.0)
    before = replace(before, drive=replace(before.drive, odometry=estimate))
    after = told(app, before, word())[0].drive
    kept = after.odometry
    assert (kept.z, kept.roll, kept.gyro_bias, kept.distance) == (0.4, 0.1, 1e-4, 12.0)
    assert kept.downhill == downhill_of(0.1, kept.pitch, kept.yaw), "the heading is another, and so is the way downhill"
    assert after.avoidance is not None and after.avoidance.map.x0 < 3.0 < after.avoidance.map.x0 + 12.0
    if kept.keys is not None:
        assert kept.keys == pytest.approx(np.array([[3.0, -2.0, 1.2]]))


SKEW = np.zeros(36)
SKEW[[0, 7, 35, 1]] = 1.0
NEGATIVE = np.zeros(36)
NEGATIVE[0] = -1.0


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"frame": "base_link"}, "'base_link': allowed is one of map, odom"),
        ({"orientation": np.zeros(4)}, "a heading"),
        ({"position": np.array([1e308, 0.0, 0.0])}, "(1e+308, 0): allowed is at most 100000 m"),
        ({"position": np.array([0.0, -1.1e5, 0.0])}, "at most 100000 m"),
        ({"covariance": SKEW}, "symmetric"),
        ({"covariance": NEGATIVE}, "without a negative variance"),
        ({"covariance": np.full(36, 1e9)}, "symmetric, of x, y and heading"),
    ],
)
def test_a_word_that_cannot_be_is_refused_and_nothing_changes(
    app: DriveApp, changes: dict[str, Any], reason: str
) -> None:
    before = lost(app)
    state, answer = told(app, before, word(**changes))
    ((name, refusal),) = answer.refusals
    assert name == "/initialpose" and reason in refusal
    assert state.drive.odometry is before.drive.odometry and state.is_lost
    assert (state.asked.placed.state, state.asked.placed.stamp) == ("refused", WHOLE)


def test_it_is_refused_on_the_way(app: DriveApp) -> None:
    state = app.initial_state()
    state = replace(state, drive=replace(state.drive, mode="waypoints"))
    _, answer = told(app, state, word())
    assert "none while it drives: stop it first" in answer.refusals[0][1]


DRIVE = DriveApp(load_flight("flat_drive", ["steps=[]"]))
