"""Slew limits: never exceeded, centre of rotation kept, stop-steer-go at a change of mode."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_flight.mobility.kinematics import wheels_from_twist
from sojourn_flight.mobility.rate_limiter import LimiterState, SteeringPace, limit_steering, stopping_speed
from sojourn_flight.mobility.steering_geometry import SteeringGeometryParams
from sojourn_flight.mobility.twist import PlanarTwist
from sojourn_flight.mobility.wheel_commands import command_wheels
from sojourn_flight.mobility.wheel_twist import twist_from_wheels
from sojourn_flight.supervision.params import DriveParams
from sojourn_machine.params import FloatArray
from wheel_drive import rolling_limits

DT = 0.02
twists = st.tuples(st.floats(-0.1, 0.1), st.just(0.0), st.floats(-0.1, 0.1))


@settings(max_examples=40, deadline=None)
@given(st.lists(st.tuples(twists, st.integers(1, 40)), min_size=1, max_size=6), st.floats(0.0, 0.3))
def test_limits_are_never_exceeded_and_the_end_is_reached(
    drive_params: DriveParams, explorer: SteeringGeometryParams, wishes: list, lag: float
) -> None:
    table, limits, transition = explorer.table(), rolling_limits(drive_params), drive_params.mobility.transition
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
            changes = np.abs(new.steer_rates - state.steer_rates)
            assert changes.max() <= limits.max_steer_acceleration * DT + 1e-12
            if rolling and np.abs(wheels.steer_angles - state.steer_angles).max() >= transition.stop_error:
                slower = np.maximum(np.abs(state.steer_rates) - 0.999 * limits.max_steer_acceleration * DT, 0.0)
                fastest = np.argmax(np.abs(state.steer_rates))
                assert abs(new.steer_rates[fastest]) <= slower[fastest] + 1e-12, "it comes to rest, then waits"
            state = new
            if last and np.array_equal(wheels.wheel_rates, new.wheel_rates):
                break
    np.testing.assert_allclose(state.wheel_rates, wheels.wheel_rates, atol=1e-9)
    if twist != (0.0, 0.0, 0.0):
        np.testing.assert_allclose(state.steer_angles, wheels.steer_angles, atol=transition.full_speed_error)


@settings(max_examples=60, deadline=None)
@given(st.floats(0.001, 0.3), st.floats(0.1, 3.0), st.floats(0.005, 0.05))
def test_steering_arrives_without_overshoot_in_the_least_time(
    drive_params: DriveParams, explorer: SteeringGeometryParams, angle: float, acceleration: float, dt: float
) -> None:
    """Against the closed form of a trapezoid of rates: m / w + w / a, or 2 sqrt(m / a) where it never gets to w."""
    table, transition = explorer.table(), drive_params.mobility.transition
    state, wanted = LimiterState.at_rest(np.zeros(6)), angle * np.array([1.0, 0.5, 0.0, 0.0, -0.5, -1.0])
    pace, angles = SteeringPace(0.3, acceleration), [np.zeros(6)]
    while not np.array_equal(angles[-1], wanted):
        step = limit_steering(table, pace, transition, state, wanted, state.steer_angles, dt)
        np.testing.assert_allclose(step.angles, wanted * step.angles[0] / angle, atol=1e-12)
        state = LimiterState(step.angles, state.wheel_rates, step.rates)
        angles.append(step.angles)
    moves = np.diff([row[0] for row in angles])
    assert moves.min() >= -1e-12
    assert np.abs(np.diff(moves, append=0.0)).max() <= acceleration * dt**2 * (1.0 + 1e-9)
    reaches = angle >= pace.rate**2 / acceleration
    least = angle / pace.rate + pace.rate / acceleration if reaches else 2.0 * np.sqrt(angle / acceleration)
    assert (len(angles) - 1) * dt <= 1.02 * least + 4.0 * dt


def run(
    params: DriveParams, table: FloatArray, state: LimiterState, twist: PlanarTwist, periods: int
) -> list[LimiterState]:
    states = []
    for _ in range(periods):
        result = command_wheels(
            table, rolling_limits(params), params.mobility.transition, state, twist, state.steer_angles, DT
        )
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
    assert np.abs(at_start).max() * 0.125 <= drive_params.mobility.transition.rolling_speed + 0.2 * DT
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
    result = command_wheels(
        table, rolling_limits(drive_params), drive_params.mobility.transition, state, turn, stuck, DT
    )
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
