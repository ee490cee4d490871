"""Wheel-and-gyro odometry against closed-form arcs, finite differences and rigid-body rotation on a slope."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from placements import geometry_from_placements
from sojourn_flight.mobility.kinematics import wheels_from_twist
from sojourn_flight.mobility.steering_geometry import SteeringGeometryParams
from sojourn_flight.mobility.twist import PlanarTwist
from sojourn_flight.odometry.odometry import OdometryState, message_covariances, wrap_angle
from sojourn_flight.odometry.odometry_kernels import START_YAW_VARIANCE
from sojourn_flight.odometry.odometry_params import OdometryParams
from sojourn_flight.supervision.params import DriveParams
from sojourn_machine.errors import MachineError
from sojourn_machine.params import FloatArray
from wheel_drive import WheelMeasured, initial_wheels, step_wheels

DT = 0.02


@pytest.fixture(scope="module")
def params(drive_params: DriveParams) -> OdometryParams:
    return drive_params.odometry


def drive(
    params: OdometryParams,
    table: FloatArray,
    state: OdometryState,
    twist: PlanarTwist,
    seconds: float,
    gyro_bias: float | None = 0.0,
    dt: float = DT,
) -> OdometryState:
    """Wheels that roll without slip; gyro_bias None is a rover without a gyro."""
    wheels = wheels_from_twist(table, twist, np.zeros(len(table)))
    position = np.zeros(len(table)) if state.wheel_positions is None else state.wheel_positions
    gyro = None if gyro_bias is None else (0.0, 0.0, twist.yaw_rate + gyro_bias)
    still = not wheels.wheel_rates.any()
    for _ in range(round(seconds / dt)):
        position = position + wheels.wheel_rates * dt
        measured = WheelMeasured(position, wheels.wheel_rates, wheels.steer_angles, gyro, None, still)
        state = step_wheels(params, table, state, measured, dt)
    return state


@settings(max_examples=25, deadline=None)
@given(st.floats(-0.1, 0.1), st.floats(-0.9, 0.9), st.floats(-3.0, 3.0), st.booleans())
def test_arcs_are_those_of_a_circle(
    params: OdometryParams,
    explorer: SteeringGeometryParams,
    v_x: float,
    curvature: float,
    yaw: float,
    gyro: bool,
) -> None:
    start, yaw_rate = initial_wheels(params, 2.0, -1.0, yaw), curvature * v_x
    twist = PlanarTwist(v_x, 0.0, yaw_rate)
    end = drive(params, explorer.table(), start, twist, 10.0, 0.0 if gyro else None, dt=0.1)
    angle = yaw_rate * 10.0
    # chord of the arc: length 2 R sin(angle / 2) = 10 v sinc(angle / 2), at half the turn
    chord = 10.0 * v_x * np.sinc(angle / 2.0 / np.pi)
    assert end.x == pytest.approx(2.0 + chord * math.cos(yaw + angle / 2.0), abs=1e-9)
    assert end.y == pytest.approx(-1.0 + chord * math.sin(yaw + angle / 2.0), abs=1e-9)
    assert wrap_angle(end.yaw - yaw - angle) == pytest.approx(0.0, abs=1e-9)
    assert end.distance == pytest.approx(10.0 * abs(v_x), rel=1e-4)


def test_full_circle_comes_back(params: OdometryParams, explorer: SteeringGeometryParams) -> None:
    yaw_rate = 2.0 * math.pi / 80.0
    start = initial_wheels(params)
    end = drive(params, explorer.table(), start, PlanarTwist(0.1, 0.0, yaw_rate), 80.0)
    assert math.hypot(end.x, end.y) < 1e-9
    assert end.distance == pytest.approx(8.0, rel=1e-6)


def test_crab_moves_sideways(params: OdometryParams) -> None:
    corners = [(0.7, 0.5), (0.7, -0.5), (-0.7, 0.5), (-0.7, -0.5)]
    table = geometry_from_placements(list("abcd"), corners, [0.2] * 4, [(-1.6, 1.6)] * 4).table()
    end = drive(params, table, initial_wheels(params, yaw=math.pi / 2), PlanarTwist(0.0, 0.1, 0.0), 10.0)
    np.testing.assert_allclose((end.x, end.y, end.v_y), (-1.0, 0.0, 0.1), atol=1e-9)


def test_gyro_rules_the_heading_when_wheels_slip(params: OdometryParams, explorer: SteeringGeometryParams) -> None:
    # The wheels say 0.1 rad/s, the gyro sees 0.07: a point turn with 30 % slip.
    end = drive(params, explorer.table(), initial_wheels(params), PlanarTwist(0.0, 0.0, 0.1), 10.0, gyro_bias=-0.03)
    assert end.yaw == pytest.approx(0.7)
    assert end.yaw_rate_difference == pytest.approx(0.03)
    assert math.hypot(end.x, end.y) < 1e-9


def test_mean_slip_shortens_the_way(params: OdometryParams, explorer: SteeringGeometryParams) -> None:
    slipping = params.model_copy(update={"mean_slip": 0.15})
    end = drive(slipping, explorer.table(), initial_wheels(slipping), PlanarTwist(0.1, 0.0, 0.0), 10.0)
    assert end.x == pytest.approx(0.85)


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_slip_grows_with_the_grade_that_is_climbed(
    params: OdometryParams, explorer: SteeringGeometryParams, sense: float
) -> None:
    graded = params.model_copy(update={"mean_slip": 0.1, "slip_per_grade": 1.5})
    state, table = initial_wheels(graded), explorer.table()
    for index in range(500):  # nose up by 0.1 rad: uphill forwards, downhill backwards
        position = np.full(6, sense * (index + 1) * 0.1 * DT / 0.125)
        measured = WheelMeasured(position, np.full(6, sense * 0.8), np.zeros(6), (0.0, 0.0, 0.0), (0.0, -0.1))
        state = step_wheels(graded, table, state, measured, DT)
    along = 1.0 - (0.1 + sense * 1.5 * math.sin(0.1))
    np.testing.assert_allclose((state.x, state.y), (sense * along * math.cos(0.1), 0.0), atol=1e-9)


@pytest.mark.parametrize(("roll", "sense"), [(0.1, 1.0), (-0.1, 1.0), (0.1, -1.0)])
def test_drift_is_downhill_whichever_way_it_drives(
    params: OdometryParams, explorer: SteeringGeometryParams, roll: float, sense: float
) -> None:
    drifting = params.model_copy(update={"side_slip_per_grade": 1.2})
    state, table = initial_wheels(drifting), explorer.table()
    for index in range(500):
        position = np.full(6, sense * (index + 1) * 0.1 * DT / 0.125)
        measured = WheelMeasured(position, np.full(6, sense * 0.8), np.zeros(6), (0.0, 0.0, 0.0), (roll, 0.0))
        state = step_wheels(drifting, table, state, measured, DT)
    # a positive roll lifts the left side: downhill is to the right, -y
    drift = -1.2 * math.sin(roll)
    np.testing.assert_allclose((state.x, state.y), (sense, drift * math.cos(roll)), atol=1e-9)
    assert state.z == pytest.approx(drift * math.sin(roll))
    assert state.z < 0.0


def test_uphill_way_is_projected(params: OdometryParams, explorer: SteeringGeometryParams) -> None:
    state, table = initial_wheels(params), explorer.table()
    for index in range(500):
        position = np.full(6, (index + 1) * 0.1 * DT / 0.125)
        measured = WheelMeasured(position, np.full(6, 0.8), np.zeros(6), (0.0, 0.0, 0.0), (0.0, -0.2))
        state = step_wheels(params, table, state, measured, DT)
    np.testing.assert_allclose((state.x, state.y, state.z), (math.cos(0.2), 0.0, math.sin(0.2)), atol=1e-9)


def test_circle_on_a_slope_is_the_rigid_body_motion(params: OdometryParams, explorer: SteeringGeometryParams) -> None:
    table = explorer.table()
    slope = Rotation.from_euler("XYZ", [0.25, -0.15, 0.0])
    yaw_rate, speed, periods = 0.1, 0.1, 2500
    wheels = wheels_from_twist(table, PlanarTwist(speed, 0.0, yaw_rate), np.zeros(6))
    yaw, pitch, roll = slope.as_euler("ZYX")
    state = initial_wheels(params, yaw=yaw)
    for index in range(periods):
        turned = slope * Rotation.from_euler("z", yaw_rate * DT * (index + 0.5))
        _, pitch, roll = turned.as_euler("ZYX")
        position = wheels.wheel_rates * DT * (index + 1)
        measured = WheelMeasured(position, wheels.wheel_rates, wheels.steer_angles, (0.0, 0.0, yaw_rate), (roll, pitch))
        state = step_wheels(params, table, state, measured, DT)
    angle, radius = yaw_rate * DT * periods, speed / yaw_rate
    on_slope = np.array([radius * math.sin(angle), radius * (1.0 - math.cos(angle)), 0.0])
    np.testing.assert_allclose((state.x, state.y, state.z), slope.apply(on_slope), atol=2e-3)
    expected_yaw = (slope * Rotation.from_euler("z", angle)).as_euler("ZYX")[0]
    assert wrap_angle(state.yaw - expected_yaw) == pytest.approx(0.0, abs=1e-3)


@settings(max_examples=15, deadline=None)
@given(
    st.lists(st.tuples(st.floats(0.01, 0.1), st.floats(-0.05, 0.05)), min_size=1, max_size=4),
    st.booleans(),
    st.booleans(),
)
def test_covariance_is_positive_definite_and_grows(
    params: OdometryParams,
    explorer: SteeringGeometryParams,
    parts: list[tuple[float, float]],
    gyro: bool,
    same_soil: bool,
) -> None:
    used = params.model_copy(update={"slip_length": 1e9}) if same_soil else params
    state, table = initial_wheels(used), explorer.table()
    for v_x, yaw_rate in parts:
        before = state.covariance
        state = drive(used, table, state, PlanarTwist(v_x, 0.0, yaw_rate), 4.0, 0.0 if gyro else None, dt=0.1)
        np.testing.assert_array_equal(state.covariance, state.covariance.T)
        assert np.linalg.eigvalsh(state.covariance).min() > 0.0
        assert state.covariance[2, 2] > before[2, 2]
        np.testing.assert_allclose(np.diag(state.covariance)[3:5], np.diag(before)[3:5])
        if same_soil:
            # det F = 1, so the volume of uncertainty can only grow, whatever turns the rover makes
            assert np.linalg.slogdet(state.covariance)[1] > np.linalg.slogdet(before)[1]
        for covariance in message_covariances(params, state, DT):
            assert covariance.shape == (6, 6)
            np.testing.assert_array_equal(covariance, covariance.T)
            assert np.linalg.eigvalsh(covariance).min() > 0.0


def test_lasting_slip_makes_the_error_grow_with_the_distance(
    params: OdometryParams, explorer: SteeringGeometryParams
) -> None:
    quiet = params.model_copy(update={"travel_sigma": 1e-6, "slip_length": 1e9})
    state, table, sigmas = initial_wheels(quiet), explorer.table(), []
    for _ in range(2):
        state = drive(quiet, table, state, PlanarTwist(0.1, 0.0, 0.0), 50.0)
        sigmas.append(math.sqrt(state.covariance[0, 0]))
    np.testing.assert_allclose(sigmas, [5.0 * params.slip_sigma, 10.0 * params.slip_sigma], rtol=1e-3)


@settings(max_examples=20, deadline=None)
@given(st.floats(0.0, 0.85), st.floats(0.005, 0.1))
def test_the_error_of_a_told_slip_is_a_part_of_the_travel_not_of_the_way(
    params: OdometryParams, explorer: SteeringGeometryParams, slip: float, sigma: float
) -> None:
    """By the way of a rover that slips by one sigma more; wheels that spin hold it against sliding aside no better."""
    quiet = params.model_copy(update={"travel_sigma": 1e-6, "slip_length": 1e9})
    rates, zero, table = np.full(6, 0.8), np.zeros(6), explorer.table()

    def way(told: float) -> OdometryState:
        state = initial_wheels(quiet)
        for period in range(401):
            measured = WheelMeasured(0.05 * period * rates, rates, zero, (0.0, 0.0, 0.0), None, False, told, sigma)
            state = step_wheels(quiet, table, state, measured, 0.05)
        return state

    end = way(slip)
    assert math.sqrt(end.covariance[0, 0]) == pytest.approx(end.x - way(slip + sigma).x, rel=0.01)
    assert math.sqrt(end.covariance[1, 1]) == pytest.approx(params.side_slip_sigma * 2.0, rel=0.01)  # of 2 m of travel


def test_slip_that_changes_with_the_soil_is_a_random_walk_in_the_long_run(
    params: OdometryParams, explorer: SteeringGeometryParams
) -> None:
    length, sigma, way = params.slip_length, params.slip_sigma, 30.0
    quiet = params.model_copy(update={"travel_sigma": 1e-6})
    end = drive(quiet, explorer.table(), initial_wheels(quiet), PlanarTwist(0.1, 0.0, 0.0), 300.0, dt=0.1)
    # integral of an exponentially correlated error over the way (Taylor 1921)
    expected = 2.0 * sigma**2 * length**2 * (way / length - 1.0 + math.exp(-way / length))
    assert end.covariance[0, 0] == pytest.approx(expected, rel=1e-3)


def test_random_errors_grow_with_the_root_of_the_distance(
    params: OdometryParams, explorer: SteeringGeometryParams
) -> None:
    nothing = {"slip_sigma": 1e-9, "side_slip_sigma": 1e-9, "gyro_bias_sigma": 1e-12, "gyro_bias_walk": 1e-12}
    rough = params.model_copy(update=nothing)
    state = drive(rough, explorer.table(), initial_wheels(rough), PlanarTwist(0.1, 0.0, 0.0), 100.0)
    assert math.sqrt(state.covariance[0, 0]) == pytest.approx(params.travel_sigma * math.sqrt(10.0), rel=0.01)
    assert math.sqrt(state.covariance[2, 2] - START_YAW_VARIANCE) == pytest.approx(
        params.gyro_random_walk * 10.0, rel=0.01
    )


def test_a_turn_on_the_spot_leaves_the_position_uncertain(
    params: OdometryParams, explorer: SteeringGeometryParams
) -> None:
    """The wheels scrub: a rover that has turned by 0.6 rad has moved by centimetres, which no wheel tells."""
    assert params.turn_sigma > 0.0
    end = drive(params, explorer.table(), initial_wheels(params), PlanarTwist(0.0, 0.0, 0.1), 6.0)
    assert math.sqrt(end.covariance[1, 1]) == pytest.approx(params.turn_sigma * math.sqrt(0.6), rel=0.01)


def test_covariance_follows_the_finite_differences_of_the_pose(
    params: OdometryParams, explorer: SteeringGeometryParams
) -> None:
    """One source of error at a time: P must be J J^T sigma^2 with J from runs with that error put in."""
    table = explorer.table()
    silent = params.model_copy(
        update={
            "slip_sigma": 1e-9,
            "side_slip_sigma": 1e-9,
            "travel_sigma": 1e-9,
            "turn_sigma": 0.0,
            "gyro_random_walk": 1e-12,
            "gyro_bias_walk": 1e-12,
            "gyro_bias_sigma": 1e-12,
            "slip_length": 1e9,
        }
    )

    def end(start_yaw: float = 0.3, slip: float = 0.0, bias: float = 0.0, **sigmas: float) -> OdometryState:
        used = silent.model_copy(update={"mean_slip": slip, **sigmas})
        state = initial_wheels(used, yaw=start_yaw)
        nothing = np.full((6, 6), 0.0)
        np.fill_diagonal(nothing, [1e-14, 1e-14, 1e-16, *np.diag(state.covariance)[3:]])
        state = replace(state, covariance=nothing)
        for v_x, yaw_rate in ((0.1, 0.05), (0.08, -0.03), (-0.05, 0.02)):
            state = drive(used, table, state, PlanarTwist(v_x, 0.0, yaw_rate), 10.0, bias, dt=0.1)
        return state

    def pose(state: OdometryState) -> FloatArray:
        return np.array([state.x, state.y, state.yaw])

    step = 1e-5
    by_slip = (pose(end(slip=step)) - pose(end(slip=-step))) / (2 * step)
    found = end(slip_sigma=0.1).covariance[:3, :3]
    np.testing.assert_allclose(found, 0.01 * np.outer(by_slip, by_slip), atol=1e-8)
    by_bias = (pose(end(bias=step)) - pose(end(bias=-step))) / (2 * step)
    found = end(gyro_bias_sigma=1e-3).covariance[:3, :3]
    np.testing.assert_allclose(found, 1e-6 * np.outer(by_bias, by_bias), rtol=1e-3, atol=1e-8)


def test_standing_still_measures_the_gyro_bias_and_freezes_the_pose(
    params: OdometryParams, explorer: SteeringGeometryParams
) -> None:
    generator, table, bias = np.random.default_rng(4), explorer.table(), 4e-5
    sigma = params.gyro_random_walk / math.sqrt(DT)
    state = initial_wheels(params)
    still = np.zeros(6)
    for _ in range(3000):
        gyro = (0.0, 0.0, bias + sigma * generator.standard_normal())
        state = step_wheels(params, table, state, WheelMeasured(still, still, still, gyro, None, True), DT)
    stated = math.sqrt(state.covariance[5, 5])
    # white noise averaged over a minute, together with what was known before
    expected = 1.0 / math.sqrt(60.0 / params.gyro_random_walk**2 + 1.0 / params.gyro_bias_sigma**2)
    assert stated == pytest.approx(expected, rel=0.02)
    assert abs(state.gyro_bias - bias) < 3.0 * stated
    assert (state.x, state.y, state.distance) == (0.0, 0.0, 0.0)
    assert abs(state.yaw) < 1e-4
    assert state.standing_for == pytest.approx(60.0)
    assert np.linalg.eigvalsh(state.covariance).min() > 0.0


def test_slow_creep_of_a_standing_rover_is_not_lost(params: OdometryParams, explorer: SteeringGeometryParams) -> None:
    state, table = initial_wheels(params), explorer.table()
    for index in range(3000):
        position = np.full(6, -0.001 * DT * (index + 1) / 0.125)
        measured = WheelMeasured(position, np.zeros(6), np.zeros(6), (0.0, 0.0, 0.0), None, True)
        state = step_wheels(params, table, state, measured, DT)
    assert state.x == pytest.approx(-0.06, abs=3e-4)


@pytest.mark.parametrize("gap", [0.2, 0.5, 1.0])
def test_what_a_machine_turns_while_no_gyro_is_read(
    gap: float, params: OdometryParams, explorer: SteeringGeometryParams
) -> None:
    """On a busy machine readings are missed: a turn in the gap was lost, without a doubt."""
    table, rate = explorer.table(), 0.1
    before = drive(params, table, initial_wheels(params), PlanarTwist(0.0, 0.0, rate), 1.0)
    turned = rate * (gap - DT)
    wheels = wheels_from_twist(table, PlanarTwist(0.0, 0.0, rate), np.zeros(6))
    position = before.wheel_positions + wheels.wheel_rates * (gap - DT)  # and stands at the end of it
    stopped = WheelMeasured(position, np.zeros(6), wheels.steer_angles, (0.0, 0.0, 0.0), None, True)
    after = step_wheels(params, table, before, stopped, gap, unread=gap - DT)
    error = after.yaw - before.yaw - turned
    sigma = math.sqrt(after.covariance[2, 2])
    assert abs(error) < 0.5 * turned
    assert abs(error) < 2.0 * sigma < 3.0 * turned


def test_an_encoder_that_jumps_is_bridged_by_its_rate(params: OdometryParams, explorer: SteeringGeometryParams) -> None:
    table = explorer.table()
    state = drive(params, table, initial_wheels(params), PlanarTwist(0.1, 0.0, 0.0), 1.0)
    rates = np.full(6, 0.8)
    position = state.wheel_positions + rates * DT
    position[2] = 0.0 + 1000.0
    measured = WheelMeasured(position, rates, np.zeros(6), (0.0, 0.0, 0.0))
    state = step_wheels(params, table, state, measured, DT)
    assert state.x == pytest.approx(0.1 * (1.0 + DT))
    assert state.encoder_jumps == 1
    later = step_wheels(params, table, state, replace(measured, wheel_positions=position + rates * DT), DT)
    assert later.x == pytest.approx(0.1 * (1.0 + 2.0 * DT))
    assert later.encoder_jumps == 1


def test_a_rover_on_its_nose_has_no_heading(params: OdometryParams, explorer: SteeringGeometryParams) -> None:
    still = np.zeros(6)
    with pytest.raises(MachineError, match="pitch"):
        step_wheels(
            params,
            explorer.table(),
            initial_wheels(params),
            WheelMeasured(still, still, still, None, (0.0, 1.5)),
            DT,
        )


@pytest.mark.parametrize(("angle", "wrapped"), [(3 * math.pi, math.pi), (-math.pi, math.pi), (7.0, 7.0 - 2 * math.pi)])
def test_wrapped_angles(angle: float, wrapped: float) -> None:
    assert wrap_angle(angle) == pytest.approx(wrapped)


def test_an_error_of_the_slip_keeps_its_part_of_what_is_believed(
    params: OdometryParams, explorer: SteeringGeometryParams
) -> None:
    """Mean and deviation alike, whether the slip that is believed is one that was estimated or the expected one."""
    table, wheels = explorer.table(), np.zeros(6)
    state = replace(initial_wheels(params), slip_error=0.05, wheel_positions=wheels, steer_angles=wheels)
    measured = WheelMeasured(wheels, wheels, wheels, (0.0, 0.0, 0.0), (0.0, 0.0), slip=0.2, slip_sigma=0.02)
    sure = step_wheels(params, table, state, measured, 0.02)
    sigma = 0.02 / 0.8  # of the way over ground
    part = sigma / params.slip_sigma
    assert sure.slip_error == pytest.approx(0.05 * part)
    assert math.sqrt(sure.covariance[3, 3]) == pytest.approx(sigma)
    back = step_wheels(params, table, sure, replace(measured, slip=None), 0.02)
    assert back.slip_error == pytest.approx(0.05)
    assert math.sqrt(back.covariance[3, 3]) == pytest.approx(params.slip_sigma)
