"""Slew limits: never exceeded, centre of rotation kept, stop-steer-go at a change of mode."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_mechanics.params import FloatArray
from sojourn_mechanics.steering.kinematics import PlanarTwist, wheels_from_twist
from sojourn_mechanics.steering.params import DriveParams, SteeringGeometryParams
from sojourn_mechanics.steering.rate_limiter import LimiterState, stopping_speed
from sojourn_mechanics.steering.wheel_commands import command_wheels
from sojourn_mechanics.steering.wheel_twist import twist_from_wheels

DT = 0.02
twists = st.tuples(st.floats(-0.1, 0.1), st.just(0.0), st.floats(-0.1, 0.1))


@settings(max_examples=40, deadline=None)
@given(st.lists(st.tuples(twists, st.integers(1, 40)), min_size=1, max_size=6), st.floats(0.0, 0.3))
def test_limits_are_never_exceeded_and_the_end_is_reached(
    drive_params: DriveParams, explorer: SteeringGeometryParams, wishes: list, lag: float
) -> None:
    table, limits, transition = explorer.table(), drive_params.limits, drive_params.transition
    state = LimiterState.at_rest(np.zeros(6))
    wheels = wheels_from_twist(table, PlanarTwist(*wishes[0][0]), state.steer_angles)
    fastest_change = max(limits.max_acceleration, limits.max_deceleration) * DT / 0.125
    measured = state.steer_angles
    for index, (twist, periods) in enumerate(wishes):
        last = index == len(wishes) - 1
        for _ in range(1500 if last else periods):
            wheels = wheels_from_twist(table, PlanarTwist(*twist), state.steer_angles)
            measured = measured + (1.0 - lag) * (state.steer_angles - measured)
            result = command_wheels(table, limits, transition, state, PlanarTwist(*twist), measured, DT)
            new = result.state
            turned = np.abs(new.steer_angles - state.steer_angles)
            assert turned.max() <= limits.max_steer_rate * DT + 1e-12
            assert np.abs(new.wheel_rates - state.wheel_rates).max() <= fastest_change + 1e-12
            np.testing.assert_allclose(new.steer_rates * DT, new.steer_angles - state.steer_angles, atol=1e-14)
            assert 0.0 <= result.speed_factor <= 1.0
            rolling = np.abs(state.wheel_rates).max() * 0.125 > transition.rolling_speed
            if rolling and np.abs(wheels.steer_angles - state.steer_angles).max() >= transition.stop_error:
                assert turned.max() == 0.0
            state = new
            if last and np.array_equal(wheels.wheel_rates, new.wheel_rates):
                break
    np.testing.assert_allclose(state.wheel_rates, wheels.wheel_rates, atol=1e-9)
    if twist != (0.0, 0.0, 0.0):
        np.testing.assert_allclose(state.steer_angles, wheels.steer_angles, atol=transition.full_speed_error)


def run(
    params: DriveParams, table: FloatArray, state: LimiterState, twist: PlanarTwist, periods: int
) -> list[LimiterState]:
    states = []
    for _ in range(periods):
        result = command_wheels(table, params.limits, params.transition, state, twist, state.steer_angles, DT)
        state = result.state
        states.append(state)
    return states


def test_start_in_a_curve_keeps_the_centre_of_rotation(
    drive_params: DriveParams, explorer: SteeringGeometryParams
) -> None:
    table = explorer.table()
    twist = PlanarTwist(0.08, 0.0, 0.04)
    angles = wheels_from_twist(table, twist, np.zeros(6)).steer_angles
    for state in run(drive_params, table, LimiterState.at_rest(angles), twist, 30):
        found = twist_from_wheels(table, state.wheel_rates, state.steer_angles)
        assert found.residual < 1e-12
        assert found.v_x / found.yaw_rate == pytest.approx(2.0)


def test_from_driving_to_point_turn_is_stop_steer_go(
    drive_params: DriveParams, explorer: SteeringGeometryParams
) -> None:
    table = explorer.table()
    straight = run(drive_params, table, LimiterState.at_rest(np.zeros(6)), PlanarTwist(0.1, 0.0, 0.0), 100)
    states = run(drive_params, table, straight[-1], PlanarTwist(0.0, 0.0, 0.1), 700)
    steering = [
        np.abs(after.steer_angles - before.steer_angles).max() > 0.0
        for before, after in zip([straight[-1], *states], states, strict=False)
    ]
    first, last = steering.index(True), len(steering) - 1 - steering[::-1].index(True)
    at_start = states[first].wheel_rates
    assert np.abs(at_start).max() * 0.125 <= drive_params.transition.rolling_speed + 0.2 * DT
    # full speed is back only when the steering has arrived
    np.testing.assert_allclose(states[-1].wheel_rates[1], 0.1 * np.hypot(0.705, 0.53) / 0.125)
    assert last < len(states) - 1
    # all corners arrive in the same period, none waits for another
    moves = np.diff([state.steer_angles for state in states[first : last + 1]], axis=0)
    assert (np.abs(moves[:, [0, 1, 4, 5]]) > 0.0).all()


def test_wheels_wait_for_a_steering_motor_that_does_not_follow(
    drive_params: DriveParams, explorer: SteeringGeometryParams
) -> None:
    table = explorer.table()
    turn = PlanarTwist(0.0, 0.0, 0.1)
    wheels = wheels_from_twist(table, turn, np.zeros(6))
    stuck = wheels.steer_angles.copy()
    stuck[0] = 0.0
    state = LimiterState.at_rest(wheels.steer_angles)
    result = command_wheels(table, drive_params.limits, drive_params.transition, state, turn, stuck, DT)
    assert result.speed_factor == 0.0
    assert result.steer_error == pytest.approx(abs(wheels.steer_angles[0]))
    np.testing.assert_array_equal(result.state.wheel_rates, np.zeros(6))


def test_nothing_wanted_turns_no_steering(drive_params: DriveParams, explorer: SteeringGeometryParams) -> None:
    angles = np.array([0.5, 0.3, 0.0, 0.0, -0.3, -0.5])
    states = run(
        drive_params,
        explorer.table(),
        LimiterState(angles, np.full(6, 0.4), np.zeros(6)),
        PlanarTwist(0.0, 0.0, 0.0),
        100,
    )
    np.testing.assert_array_equal(states[-1].steer_angles, angles)
    np.testing.assert_array_equal(states[-1].wheel_rates, np.zeros(6))


def test_braking_takes_the_time_of_the_deceleration(
    drive_params: DriveParams, explorer: SteeringGeometryParams
) -> None:
    start = LimiterState(np.zeros(6), np.full(6, 0.8), np.zeros(6))
    states = run(drive_params, explorer.table(), start, PlanarTwist(0.0, 0.0, 0.0), 60)
    moving = sum(np.abs(state.wheel_rates).max() > 1e-12 for state in states)
    assert moving * DT == pytest.approx(0.1 / drive_params.limits.max_deceleration, abs=1.5 * DT)


def test_stopping_speed_is_that_of_a_constant_deceleration() -> None:
    assert stopping_speed(0.25, 0.5) == pytest.approx(0.5)
    assert stopping_speed(-1.0, 0.5) == 0.0
