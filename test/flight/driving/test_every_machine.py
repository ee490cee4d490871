"""Laws of steering over machines of every kind: there and back, closed forms of others, joints on their way."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from kinds import MACHINES, RADIUS, articulated, mecanum, odd, skid
from pydantic import ValidationError

from mecanum import kinematic_matrix
from sojourn_analysis.vehicle import articulated as two_bodies
from sojourn_flight.mobility.kinematics import allowed_twist, limited_twist, wheel_rates, wheels_from_twist
from sojourn_flight.mobility.rate_limiter import LimiterState
from sojourn_flight.mobility.steering_geometry import SteeringGeometryParams
from sojourn_flight.mobility.twist import PlanarTwist
from sojourn_flight.mobility.wheel_commands import command_wheels, expected_slip, is_articulated
from sojourn_flight.mobility.wheel_table import scrubs
from sojourn_flight.mobility.wheel_twist import twist_from_wheels, velocity_kernel
from sojourn_flight.supervision.params import DriveParams
from wheel_drive import rolling_limits, with_mobility

DT = 0.02


@settings(max_examples=300, deadline=None)
@given(
    st.sampled_from(sorted(MACHINES)),
    st.floats(-1.0, 1.0),
    st.floats(-1.0, 1.0),
    st.floats(-2.0, 2.0),
    st.floats(0.01, 1.0),
)
def test_there_and_back(name: str, v_x: float, v_y: float, yaw_rate: float, weight: float) -> None:
    geometry, ratio = MACHINES[name]
    table = geometry.table(ratio)
    if any(not row.steered and row.roller_angle is None for row in geometry.wheels):
        # fixed axles: the centre of rotation is on their line
        along = np.mean([w.x for w in geometry.wheels if not w.steered and w.roller_angle is None])
        v_y = -along * yaw_rate
    twist = PlanarTwist(v_x, v_y, yaw_rate)
    wheels = wheels_from_twist(table, twist, np.zeros(len(table)))
    back = twist_from_wheels(table, wheels.wheel_rates, wheels.steer_angles, weight)
    clipped = [
        w.steered and min(angle - w.steer_min, w.steer_max - angle) < 1e-9
        for w, angle in zip(geometry.wheels, wheels.steer_angles, strict=True)
    ]
    if any(clipped):  # the residual says by how much the wheels cannot
        if np.abs(wheels.residual).max() > 1e-6 and name != "articulated, tandem behind":
            assert back.residual > 0.0
        return
    if not scrubs(geometry.wheels) and _reachable(geometry, twist):
        assert np.abs(wheels.residual).max() < 1e-9
    if _reachable(geometry, twist):
        np.testing.assert_allclose(back, (*twist, 0.0), rtol=0.0, atol=1e-9)
        known = velocity_kernel(table, wheels.wheel_rates, wheels.steer_angles, 0.0 * wheels.residual, yaw_rate, weight)
        np.testing.assert_allclose(known, (v_x, v_y, 0.0), rtol=0.0, atol=1e-9)


def _reachable(geometry: SteeringGeometryParams, twist: PlanarTwist) -> bool:
    """A trailing arm finds its angle only where its pivot is fast enough."""
    for wheel in geometry.wheels:
        if wheel.steered:
            pivot_x, pivot_y = wheel.pivot
            speed = math.hypot(twist.v_x - twist.yaw_rate * pivot_y, twist.v_y + twist.yaw_rate * pivot_x)
            same = [w.x for w in geometry.wheels if w.steer_group == wheel.steer_group]
            if speed < abs((np.mean(same) - pivot_x) * twist.yaw_rate) + 1e-6:
                return False
    return True


@settings(max_examples=60, deadline=None)
@given(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0), st.floats(-2.0, 2.0))
def test_mecanum_rates_are_those_of_the_contact_law(v_x: float, v_y: float, yaw_rate: float) -> None:
    geometry = mecanum()
    places = [(wheel.x, wheel.y) for wheel in geometry.wheels]
    matrix = kinematic_matrix(places, [wheel.roller_angle or 0.0 for wheel in geometry.wheels], RADIUS)
    wheels = wheels_from_twist(geometry.table(), PlanarTwist(v_x, v_y, yaw_rate), np.zeros(4))
    np.testing.assert_allclose(wheels.wheel_rates, matrix @ [v_x, v_y, yaw_rate], atol=1e-12)
    np.testing.assert_array_equal(wheels.residual, np.zeros(4))


@settings(max_examples=60, deadline=None)
@given(st.floats(0.02, 0.6), st.sampled_from([1.0, -1.0]), st.sampled_from([0.3, -0.3]))
def test_articulation_is_that_of_the_turning_circle(angle: float, side: float, speed: float) -> None:
    table = articulated().table()
    radius, rear_radius = two_bodies.turning_radii(0.7, 0.9, side * angle)
    wheels = wheels_from_twist(table, PlanarTwist(speed, 0.0, speed / radius), np.zeros(4))
    # the second body turns to the other side than the centre of the curve
    np.testing.assert_allclose(wheels.steer_angles, [0.0, 0.0, -side * angle, -side * angle], atol=1e-9)
    np.testing.assert_allclose(wheels.wheel_rates[2:].mean() * RADIUS, speed * rear_radius / radius, atol=1e-9)
    np.testing.assert_allclose(wheels.residual, 0.0, atol=1e-12)


@settings(max_examples=60, deadline=None)
@given(st.floats(-0.7, 0.7), st.floats(-0.5, 0.5), st.floats(-0.4, 0.4))
def test_while_the_articulation_moves_nothing_slides(angle: float, rate: float, speed: float) -> None:
    table = articulated().table()
    angles, rates = np.array([0.0, 0.0, angle, angle]), np.array([0.0, 0.0, rate, rate])
    twist = allowed_twist(table, PlanarTwist(speed, 0.2, 0.1), angles, rates)
    assert twist.v_x == speed
    assert twist.v_y == pytest.approx(0.0, abs=1e-9)
    assert twist.yaw_rate == pytest.approx(two_bodies.yaw_rate(0.7, 0.9, speed, -angle, -rate), abs=1e-9)
    turning = wheel_rates(table, twist, angles, rates)
    back = twist_from_wheels(table, turning, angles, 1.0, rates)
    np.testing.assert_allclose(back, (*twist, 0.0), atol=1e-9)


def test_wheels_with_rollers_object_to_no_twist() -> None:
    twist = PlanarTwist(0.1, 0.2, 0.3)
    np.testing.assert_allclose(allowed_twist(mecanum().table(), twist, np.zeros(4), np.zeros(4)), twist, atol=1e-12)


def drive_to_rest(
    params: DriveParams, geometry: SteeringGeometryParams, twist: PlanarTwist, periods: int
) -> list[tuple[float, LimiterState]]:
    """Commands of each period, and by how much the wheels disagree [m/s]."""
    table = geometry.table()
    state = LimiterState.at_rest(np.zeros(len(table)))
    history = []
    for _ in range(periods):
        commands = command_wheels(
            table, rolling_limits(params), params.mobility.transition, state, twist, state.steer_angles, DT
        )
        state = commands.state
        found = twist_from_wheels(table, state.wheel_rates, state.steer_angles, 1.0, state.steer_rates)
        history.append((found.residual, state))
    return history


def test_two_bodies_fold_at_a_stand_without_dragging_a_wheel(drive_params: DriveParams) -> None:
    geometry = articulated()
    assert is_articulated(geometry.table())
    twist = PlanarTwist(0.1, 0.0, 0.05)
    history = drive_to_rest(drive_params, geometry, twist, 600)
    last = history[-1][1]
    wheels = wheels_from_twist(geometry.table(), twist, np.zeros(4))
    np.testing.assert_allclose(last.steer_angles, wheels.steer_angles, atol=1e-9)
    np.testing.assert_allclose(last.wheel_rates, wheels.wheel_rates, atol=1e-9)
    turning = [state for _, state in history if np.abs(state.steer_rates[2]) > 0.0]
    assert 0.15 < max(np.abs(state.steer_rates[2]) for state in turning) <= rolling_limits(drive_params).max_steer_rate
    assert turning[5].wheel_rates[0] * turning[5].wheel_rates[1] < 0.0  # the front body turns as the joint does
    # wheels at rest roll along with the joint; as they speed up, too, they lag by their own acceleration
    assert max(residual for residual, _ in history[:140]) < 1e-9
    assert max(residual for residual, _ in history) < 0.005


def test_steering_only_while_rolling(drive_params: DriveParams) -> None:
    rolling = drive_params.mobility.transition.model_copy(update={"steering_at_stand": False})
    params = with_mobility(drive_params, transition=rolling)
    geometry = MACHINES["explorer"][0]
    history = drive_to_rest(params, geometry, PlanarTwist(0.08, 0.0, 0.08), 1500)
    for (_, before), (_, after) in itertools.pairwise(history):
        if np.abs(before.wheel_rates).max() == 0.0:
            np.testing.assert_array_equal(after.steer_angles, before.steer_angles)
    wanted = wheels_from_twist(geometry.table(), PlanarTwist(0.08, 0.0, 0.08), np.zeros(6))
    np.testing.assert_allclose(history[-1][1].steer_angles, wanted.steer_angles, atol=1e-9)
    np.testing.assert_allclose(history[-1][1].wheel_rates, wanted.wheel_rates, atol=1e-6)
    still = drive_to_rest(params, geometry, PlanarTwist(0.0, 0.0, 0.08), 100)
    assert np.abs([state.steer_angles for _, state in still]).max() < 1e-12


def test_a_wheel_with_a_slower_motor_holds_all_of_them_back(drive_params: DriveParams) -> None:
    wheels = list(MACHINES["explorer"][0].wheels)
    wheels[0] = wheels[0].model_copy(update={"max_rate": 0.2, "max_steer_rate": 0.1})
    geometry = SteeringGeometryParams(wheels=tuple(wheels))
    table = geometry.table()
    _, factor = limited_twist(table, PlanarTwist(0.1, 0.0, 0.0), 0.1, 0.2, 5.0)
    assert factor == pytest.approx(0.2 * RADIUS / 0.1)
    history = drive_to_rest(drive_params, geometry, PlanarTwist(0.0, 0.0, 0.02), 40)
    rates = np.abs([state.steer_rates for _, state in history])
    assert rates[:, 0].max() == pytest.approx(0.1)
    assert rates.max() == pytest.approx(0.1)  # the others keep step with it


@settings(max_examples=40, deadline=None)
@given(st.sampled_from([0.1, -0.1]), st.floats(-0.15, 0.15))
def test_slip_that_is_expected_is_driven_out(drive_params: DriveParams, v_x: float, pitch: float) -> None:
    odometry = drive_params.odometry.model_copy(update={"mean_slip": 0.12, "slip_per_grade": 1.1})
    slip = expected_slip(odometry, pitch, v_x)
    assert slip == pytest.approx(0.12 - math.copysign(1.1, v_x) * math.sin(pitch))
    table, state = MACHINES["explorer"][0].table(), LimiterState.at_rest(np.zeros(6))
    ahead, settings_of = PlanarTwist(v_x, 0.0, 0.0), (rolling_limits(drive_params), drive_params.mobility.transition)
    for _ in range(200):
        state = command_wheels(table, *settings_of, state, ahead, np.zeros(6), DT, slip).state
    np.testing.assert_allclose(state.wheel_rates * RADIUS * (1.0 - slip), v_x, atol=1e-12)
    assert expected_slip(drive_params.odometry, pitch, v_x) == 0.0  # none known: none driven out


def test_rigid_wheels_in_a_row_act_as_one_axle() -> None:
    table = skid([0.9, 0.3, -0.3, -1.7]).table(1.5)
    twist = PlanarTwist(0.2, 0.0, 0.5)
    wheels = wheels_from_twist(table, twist, np.zeros(8))
    np.testing.assert_allclose(wheels.wheel_rates * RADIUS, 0.2 + np.tile([-0.3, 0.3], 4))
    found = twist_from_wheels(table, wheels.wheel_rates, np.zeros(8))
    np.testing.assert_allclose(found, (0.2, 0.1, 0.5, 0.0), atol=1e-12)  # the axle's middle is 0.2 m behind base_link


def test_motors_that_have_failed_leave_what_they_know_out() -> None:
    table = odd().table()
    blind = table.copy()
    blind[:, 11:13] = 0.0
    blind[0, 11] = 1.0
    found = twist_from_wheels(blind, np.ones(5), np.zeros(5))
    assert found.residual == pytest.approx(0.0, abs=1e-12)
    assert found.v_x - 0.5 * found.yaw_rate == pytest.approx(RADIUS)  # one line is all there is


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"roller_angle": 0.0}, "rollers carry no wheel"),
        ({"roller_angle": 0.7}, "leave a motion free"),
    ],
)
def test_rollers_that_cannot_hold_the_machine_are_refused(change: dict[str, float], message: str) -> None:
    wheels = [wheel.model_dump() | change for wheel in mecanum().wheels]
    with pytest.raises(ValidationError, match=message):
        SteeringGeometryParams.model_validate({"wheels": wheels})


def test_wheels_of_one_body_share_its_joint() -> None:
    wheels = [wheel.model_dump() for wheel in articulated().wheels]
    wheels[3]["pivot_x"] = -0.6
    with pytest.raises(ValidationError, match="rear_r_0: pivot and limits"):
        SteeringGeometryParams.model_validate({"wheels": wheels})
