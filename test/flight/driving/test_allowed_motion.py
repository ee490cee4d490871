"""What the wheels do not allow is refused with what the machine can do; what is accepted is done: every rover."""

import math
import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from kinds import MACHINES

from sojourn_config.scenario import load_scenario
from sojourn_flight.mobility.allowed_motion import FITTED, SLIDING, AllowedMotion
from sojourn_flight.mobility.kinematics import wheels_from_twist
from sojourn_flight.mobility.twist import PlanarTwist
from sojourn_flight.mobility.wheel_twist import twist_from_wheels
from sojourn_flight.planning.goal import Goal
from sojourn_flight.supervision.drive_types import TwistCommand
from wheel_drive import WheelDrive

ROVERS = ("explorer", "lrv", "lunokhod", "micro", "skid", "articulated", "omni")
CURVE = re.compile(r"sharpest curve planned is \d\.\d\d 1/m|turn(s)? on the spot|heading")
STOP = PlanarTwist(0.0, 0.0, 0.0)


def drive_of(rover: str) -> WheelDrive:
    """With no slip expected, and nothing that needs a camera."""
    scenario = load_scenario("flat_drive", [f"machine={rover}"])
    firm = {"mean_slip": 0.0, "slip_per_grade": 0.0, "side_slip_per_grade": 0.0, "turn_drift_per_grade": 0.0}
    odometry = scenario.drive.odometry.model_copy(update=firm)
    return WheelDrive(scenario.drive.model_copy(update={"odometry": odometry, "obstacles": None}), scenario.steering)


@settings(max_examples=300, deadline=None)
@given(st.sampled_from(sorted(MACHINES)), st.floats(-1.0, 1.0), st.floats(-1.0, 1.0), st.floats(-2.0, 2.0))
def test_what_is_accepted_is_what_the_wheels_then_do(name: str, v_x: float, v_y: float, yaw_rate: float) -> None:
    """By the least squares of the odometry from the wheels' angles and rates."""
    geometry, ratio = MACHINES[name]
    table = geometry.table(ratio)
    asked = PlanarTwist(v_x, v_y, yaw_rate)
    fitted, reason = AllowedMotion(table, geometry.names).fit(asked)
    if reason:
        assert fitted == STOP and "would be dragged" in reason and "this machine drives" in reason
        return
    reach = max(math.hypot(wheel.x, wheel.y) for wheel in geometry.wheels)
    fastest = math.hypot(v_x, v_y) + reach * abs(yaw_rate)
    assert (fitted.v_x, fitted.yaw_rate) == (v_x, yaw_rate)
    assert abs(fitted.v_y - v_y) <= FITTED * fastest + 1e-12
    wheels = wheels_from_twist(table, fitted, np.zeros(len(table)))
    done = twist_from_wheels(table, wheels.wheel_rates, wheels.steer_angles)
    assert done.residual <= SLIDING * fastest + 1e-9
    assert math.hypot(done.v_x - fitted.v_x, done.v_y - fitted.v_y) <= 5.0 * SLIDING * fastest + 1e-9
    assert abs(done.yaw_rate - yaw_rate) * reach <= 10.0 * SLIDING * fastest + 1e-9


@pytest.mark.parametrize(
    "rover, twist, allowed",
    [
        ("explorer", (0.05, 0.05, 0.0), "in any curve and on the spot, and not sideways"),
        ("explorer", (0.0, 0.05, 0.0), "not sideways"),
        ("explorer", (0.05, 0.0, 0.1), ""),
        ("explorer", (0.1, 0.004, 0.0), ""),
        ("lrv", (0.5, 0.4, 0.0), ""),
        ("lrv", (0.0, 0.5, 0.0), "up to 51 degrees aside"),
        ("lrv", (0.0, 0.0, 0.2), "m radius or wider, not on the spot, and up to 51 degrees aside"),
        ("lunokhod", (0.1, 0.1, 0.0), "in any curve and on the spot, and not sideways"),
        ("micro", (0.0, 0.02, 0.0), "in any curve and on the spot, and not sideways"),
        ("skid", (0.2, 0.1, 0.1), "in any curve and on the spot, and not sideways"),
        ("skid", (0.0, 0.0, 0.1), ""),
        ("articulated", (0.0, 0.0, 0.1), "m radius or wider, not on the spot, and not sideways"),
        ("articulated", (0.2, 0.0, 0.1), ""),
        ("omni", (0.0, 0.2, 0.1), ""),
    ],
)
def test_a_velocity_of_each_rover_is_driven_or_refused_with_what_it_can(
    rover: str, twist: tuple[float, float, float], allowed: str, kinematic_machine: type
) -> None:
    """In the drive: where it is refused nothing moves, neither wheels nor steering, and the status says why."""
    model = drive_of(rover)
    driven = kinematic_machine(model)
    state, output = driven.run(model.initial_state(), 3.0, twist=TwistCommand(PlanarTwist(*twist), 0.0))
    assert state.mode == "cmd_vel"
    text = state.text
    if allowed:
        assert text.startswith("/cmd_vel: ") and allowed in text and state.twist_refused
        assert (driven.x, driven.y, driven.yaw) == (0.0, 0.0, 0.0) and not driven.steer_angles.any()
        state, output = driven.run(state, 1.0, twist=TwistCommand(PlanarTwist(0.05, 0.0, 0.0), 0.0))
        assert not state.twist_refused and driven.x > 0.0, "the next that it can is driven"
        return
    assert text.startswith("driving by /cmd_vel") and not state.twist_refused
    wanted = model.mobility.fit(PlanarTwist(*twist))[0]
    limit = model.params.limits
    if math.hypot(*twist[:2]) <= limit.max_speed and abs(twist[2]) <= limit.max_yaw_rate:
        state, output = driven.run(state, 12.0, twist=TwistCommand(PlanarTwist(*twist), 0.0))
        found = (output.odometry.v_x, output.odometry.v_y, output.odometry.yaw_rate)
        factor = float(output.status["limit_factor"])
        np.testing.assert_allclose(found, factor * np.array(wanted), atol=0.02 * math.hypot(*wanted))


@pytest.mark.parametrize("rover", ROVERS)
@pytest.mark.parametrize(
    "goal",
    [
        Goal.at(2.5, 0.0),
        Goal.at(0.0, 2.0),
        Goal.at(-2.0, -0.6),
        Goal.at(3.0, 1.0, 2.2),
        Goal.at(0.0, 0.0, math.pi / 2),
        Goal.at(0.4, 0.3, 1.5),
    ],
    ids=["ahead", "beside", "behind", "turned", "turn where it stands", "near and turned"],
)
def test_a_goal_of_each_rover_is_reached_or_refused(rover: str, goal: Goal, kinematic_machine: type) -> None:
    """Never accepted and then not met: motors that obey, ground on which nothing slips."""
    model = drive_of(rover)
    driven = kinematic_machine(model)
    state, output = driven.run(model.initial_state(), 0.05, dt=0.05, goal=goal)
    for _ in range(12_000):
        if output.outcomes:
            break
        state, output = driven.run(state, 0.05, dt=0.05)
    outcome = output.outcomes[0]
    assert outcome.kind in ("reached", "refused"), outcome.reason
    if outcome.kind == "refused":
        assert driven.x == driven.y == driven.yaw == 0.0
        assert rover in ("lrv", "articulated") and CURVE.search(outcome.reason), outcome.reason
        return
    follower = model.params.follower
    assert math.dist((driven.x, driven.y), goal.points[-1]) <= follower.position_tolerance + 1e-3
    if goal.yaw is not None:
        assert abs(math.remainder(driven.yaw - goal.yaw, 2.0 * math.pi)) <= follower.yaw_tolerance + 1e-3
