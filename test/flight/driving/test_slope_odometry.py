"""What odometry makes of slopes: drift downhill in turns, errors that grow with the slope, height at the start."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_flight.mobility.mobility import BodyMotion
from sojourn_flight.odometry.odometry import (
    OdometryInput,
    OdometryState,
    initial_odometry,
    message_covariances,
    step_odometry,
)
from sojourn_flight.odometry.odometry_params import OdometryParams
from sojourn_flight.supervision.params import DriveParams

DT = 0.02
RATE = 0.2
"""Of turns [rad/s]."""
FADES_NEVER = 1e9


@pytest.fixture(scope="module")
def params(drive_params: DriveParams) -> OdometryParams:
    """Of a machine that slides as it turns, without any other error that grows on the spot."""
    return drive_params.odometry.model_copy(
        update={"turn_drift_per_grade": 1.5, "turn_sigma": 0.0, "travel_sigma": 1e-9, "slip_length": FADES_NEVER}
    )


def tilted(slope: float, yaw: float) -> tuple[float, float]:
    """Roll and pitch of a body at a heading on a plane that rises along x [rad]: of its axes as rotations have them."""
    up = np.array((-math.sin(slope), 0.0, math.cos(slope)))
    ahead = np.array((math.cos(yaw), math.sin(yaw), 0.0))
    ahead -= (ahead @ up) / up[2] * np.array((0.0, 0.0, 1.0))  # over the same heading, in the plane
    ahead /= np.linalg.norm(ahead)
    left = np.cross(up, ahead)
    return math.atan2(left[2], up[2]), -math.asin(ahead[2])


def turned(params: OdometryParams, slope: float, angle: float, v_x: float = 0.0, rate: float = RATE) -> OdometryState:
    state = initial_odometry(params)
    still = OdometryInput(BodyMotion(0.0, 0.0, 0.0, 0.0, 0.0, True, 0), None, tilted(slope, 0.0))
    for _ in range(round(2.0 * params.standing_time / DT)):
        state = step_odometry(params, state, still, DT)
    for _ in range(round(abs(angle / rate) / DT)):
        roll_pitch = tilted(slope, state.yaw)
        # on a plane it turns about the plane's normal, which is its own z axis
        motion = BodyMotion(v_x, 0.0, rate, 0.0, 1.0, False, 0)
        measured = OdometryInput(motion, (0.0, 0.0, rate), roll_pitch)
        state = step_odometry(params, state, measured, DT)
    return state


@settings(max_examples=10, deadline=None)
@given(st.floats(0.01, 0.3), st.sampled_from([1, 2]), st.sampled_from([RATE, -RATE]))
def test_once_round_on_a_slope_it_has_gone_straight_downhill(
    params: OdometryParams, slope: float, rounds: int, rate: float
) -> None:
    """In map its velocity is the same at all headings: c |w| sin(slope) down the slope."""
    angle = 2.0 * math.pi * rounds
    end = turned(params, slope, angle, rate=rate)
    down = 1.5 * angle * math.sin(slope)
    assert end.x == pytest.approx(-down * math.cos(slope), rel=1e-3)
    assert end.y == pytest.approx(0.0, abs=5e-3 * down)
    assert end.z == pytest.approx(-down * math.sin(slope), rel=1e-3)


def test_on_the_level_a_turn_moves_nothing(params: OdometryParams) -> None:
    end = turned(params, 0.0, 3.0)
    assert (end.x, end.y, end.z, end.turn_drift) == (0.0, 0.0, 0.0, 0.0)


def test_a_body_that_leans_in_a_turn_on_the_level_stays_where_it_is(params: OdometryParams) -> None:
    """Lunokhod's springs let it lean by three degrees when it turns."""
    state = initial_odometry(params)
    leaning = BodyMotion(0.0, 0.0, RATE, 0.0, 1.0, False, 0)
    for _ in range(100):
        state = step_odometry(params, state, OdometryInput(leaning, (0.0, 0.0, RATE), (0.05, 0.0)), DT)
    assert math.hypot(state.x, state.y) == 0.0


def test_the_slope_is_that_of_the_way_it_has_come(params: OdometryParams) -> None:
    state, ahead = initial_odometry(params, yaw=0.5), BodyMotion(0.1, 0.0, 0.0, 0.0, 1.0, False, 0)
    for _ in range(2000):
        state = step_odometry(params, state, OdometryInput(ahead, (0.0, 0.0, 0.0), tilted(0.15, state.yaw)), DT)
    assert state.downhill == pytest.approx((-math.sin(0.15), 0.0), abs=2e-3)


def test_a_machine_whose_drift_is_not_known_keeps_its_place(params: OdometryParams) -> None:
    end = turned(params.model_copy(update={"turn_drift_per_grade": 0.0}), 0.2, 3.0)
    assert math.hypot(end.x, end.y) == 0.0 and end.turn_drift == 0.0


def test_on_a_wide_curve_little_of_it_is_left(params: OdometryParams) -> None:
    """c |w| (c w)^2 / ((c w)^2 + v^2): the tenth of it at three times the speed of the slide."""
    firm = params.model_copy(update={"slip_per_grade": 0.0, "side_slip_per_grade": 0.0, "mean_slip": 0.0})
    on_the_spot, wide = (turned(firm, 0.1, 2.0 * math.pi, v_x) for v_x in (0.0, 3.0 * 1.5 * RATE))
    assert wide.turn_drift == pytest.approx(0.1 * on_the_spot.turn_drift, rel=0.01)


@pytest.mark.parametrize("rounds", [1, 3])
def test_its_error_is_of_one_sign(params: OdometryParams, rounds: int) -> None:
    """Soil that lets it drift further does so in every turn: the deviation is a part of all of the drift."""
    end = turned(params, 0.1, 2.0 * math.pi * rounds)
    none = turned(params.model_copy(update={"slope_error": 0.0}), 0.1, 2.0 * math.pi * rounds)
    grown = end.covariance[:2, :2] - none.covariance[:2, :2]
    assert grown == pytest.approx(np.eye(2) * (params.slope_error * end.turn_drift) ** 2, rel=1e-6, abs=1e-9)


@pytest.mark.parametrize(("roll", "pitch", "place", "key"), [(0.2, 0.0, 4, "side_slip"), (0.0, -0.2, 3, "slip")])
def test_what_a_slope_does_is_less_sure_the_steeper_it_is(
    params: OdometryParams, roll: float, pitch: float, place: int, key: str
) -> None:
    known = params.model_copy(update={"slip_per_grade": 0.9, "side_slip_per_grade": 0.9})
    motion = BodyMotion(0.1, 0.0, 0.0, 0.0, 1.0, False, 0)
    level = step_odometry(known, initial_odometry(known), OdometryInput(motion), DT)
    tilt = step_odometry(known, initial_odometry(known), OdometryInput(motion, None, (roll, pitch)), DT)
    usual = getattr(known, f"{key}_sigma")
    assert math.sqrt(level.covariance[place, place]) == pytest.approx(usual)
    more = known.slope_error * 0.9 * math.sin(0.2)
    assert math.sqrt(tilt.covariance[place, place]) == pytest.approx(math.hypot(usual, more))
    back = step_odometry(known, tilt, OdometryInput(motion), DT)
    assert math.sqrt(back.covariance[place, place]) == pytest.approx(usual)


def test_the_height_at_the_start_is_told_with_its_error(params: OdometryParams) -> None:
    start = initial_odometry(params, 1.0, 2.0, 0.3, 0.47)
    pose, _ = message_covariances(params, start, DT)
    assert start.z == 0.47 and pose[2, 2] == pytest.approx(params.start_height_sigma**2)
    gone, _ = message_covariances(params, replace(start, distance=10.0), DT)
    assert gone[2, 2] == pytest.approx(params.start_height_sigma**2 + (10.0 * params.tilt_sigma) ** 2)
