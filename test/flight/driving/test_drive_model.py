"""The drive as the node calls it: goals, pre-emption, timeouts, power, bad input."""

import copy
import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from sojourn_flight.mobility.twist import PlanarTwist
from sojourn_flight.planning.goal import Goal, GoalOutcome
from sojourn_flight.supervision.drive_types import DriveState, TwistCommand
from sojourn_machine.errors import MachineError
from wheel_drive import WheelDrive, WheelInput, WheelOutput

DT = 0.02


def forward(age: float = 0.0) -> TwistCommand:
    return TwistCommand(PlanarTwist(0.08, 0.0, 0.0), age)


def until_idle(
    model: WheelDrive, machine, state: DriveState, goal: Goal, dt: float = 0.05
) -> tuple[DriveState, WheelOutput, GoalOutcome]:
    """Drives until the goal has ended."""
    state, output = machine.run(state, dt, dt=dt, goal=goal)
    for _ in range(20_000):
        if output.outcomes:
            return state, output, output.outcomes[0]
        state, output = machine.run(state, dt, dt=dt)
    raise AssertionError(output.status)


@pytest.mark.parametrize("goal", [Goal.at(3.0, 1.0, 2.0, "rock"), Goal.at(-1.5, -0.5), Goal.at(0.0, 0.05)])
def test_goals_are_reached_in_truth(model: WheelDrive, machine: Callable, goal: Goal) -> None:
    rover = machine(gyro_bias=2e-5)
    state, _ = rover.run(model.initial_state(), 2.0)
    state, output, outcome = until_idle(model, rover, state, goal)
    assert outcome.kind == "reached", outcome.reason
    # what became of a goal is said by state, goal_stamp and reason, which the role adds
    assert not {"text", "goal", "outcome", "outcome_goal", "outcome_reason", "state", "reason"} & set(output.status)
    assert state.mode == "idle"
    assert math.dist((rover.x, rover.y), goal.points[-1]) <= 0.1
    if goal.yaw is not None:
        assert math.remainder(rover.yaw - goal.yaw, 2 * math.pi) == pytest.approx(0.0, abs=0.06)
    assert outcome.goal.number == goal.number
    np.testing.assert_array_equal(rover.run(state, 1.0)[1].wheel_rates, np.zeros(6))


def test_waypoints_are_driven_and_counted(model: WheelDrive, machine: Callable) -> None:
    rover = machine()
    goal = Goal.along([(1.0, 0.0), (2.0, 0.5), (3.0, 0.5)], number=7)
    state, output = rover.run(model.initial_state(), 14.0, goal=goal)
    assert state.mode == "waypoints"
    assert output.status["waypoint"] == 1.0
    assert output.status["waypoints"] == 3.0
    assert state.follower is not None and 0.0 < state.follower.distance_to_go < 2.6
    state, _, outcome = until_idle(model, rover, state, goal)
    assert outcome.kind == "stopped"  # the same goal again ends the first
    assert outcome.reason == "pre-empted by a newer goal"


def test_slip_does_not_keep_the_drive_from_its_goal_in_odom(model: WheelDrive, machine: Callable) -> None:
    # Wheel odometry cannot see slip: the goal is met in odom, and truth is inside the stated error.
    rover = machine(slip=0.1)
    state, output, outcome = until_idle(model, rover, model.initial_state(), Goal.at(4.0, 0.0))
    assert outcome.kind == "reached"
    error = np.array([rover.x - output.odometry.x, rover.y - output.odometry.y])
    covariance = output.pose_covariance[:2, :2]
    assert np.hypot(*error) > 0.3
    assert error @ np.linalg.solve(covariance, error) < 5.991  # 95 % of two degrees of freedom
    assert state.follower is None


def test_newer_goal_ends_the_older(model: WheelDrive, machine: Callable) -> None:
    rover = machine()
    state, _ = rover.run(model.initial_state(), 3.0, goal=Goal.at(5.0, 0.0, number=1))
    state, output = rover.run(state, DT, goal=Goal.at(2.0, 2.0, number=2))
    (outcome,) = output.outcomes
    assert (outcome.kind, outcome.reason, outcome.goal.number) == (
        "stopped",
        "pre-empted by a newer goal",
        1,
    )
    assert outcome.distance_to_go == pytest.approx(4.8, abs=0.2)
    assert state.follower is not None and state.follower.goal.number == 2
    assert state.mode == "goal"


def test_refused_goal_leaves_the_present_one_alone(model: WheelDrive, machine: Callable) -> None:
    rover = machine()
    state, _ = rover.run(model.initial_state(), 3.0, goal=Goal.at(5.0, 0.0, number=1))
    state, output = rover.run(state, DT, goal=Goal.at(math.nan, 0.0, number=2))
    (outcome,) = output.outcomes
    assert (outcome.kind, outcome.goal.number) == ("refused", 2)
    assert state.follower is not None and state.follower.goal.number == 1
    state, output = rover.run(model.initial_state(), DT, goal=Goal.at(1e6, 0.0))
    assert state.mode == "idle"
    assert state.text.startswith("refused: the path is")


def test_a_velocity_of_nothing_is_the_stop_of_an_operator(model: WheelDrive, machine: Callable) -> None:
    rover = machine()
    state, _ = rover.run(model.initial_state(), 1.0, goal=Goal.at(5.0, 0.0))
    state, output = rover.run(state, DT, twist=TwistCommand(PlanarTwist(0.0, 0.0, 0.0), 0.0))
    assert [(o.kind, o.reason) for o in output.outcomes] == [("stopped", "stopped by operator")]


def test_cmd_vel_ends_a_goal_but_only_if_it_is_newer(model: WheelDrive, machine: Callable) -> None:
    rover = machine()
    state, _ = rover.run(model.initial_state(), 1.0, goal=Goal.at(5.0, 0.0))
    state, output = rover.run(state, DT, twist=forward(age=0.15))
    assert state.mode == "cmd_vel"
    assert [(o.kind, o.reason) for o in output.outcomes] == [("stopped", "pre-empted by /cmd_vel")]
    # the same message is still fresh when a new goal arrives: the goal is newer and wins
    state, output = rover.run(state, DT, twist=forward(age=0.1), goal=Goal.at(3.0, 0.0))
    assert state.mode == "goal"
    state, output = rover.run(state, DT, twist=forward(age=0.1 + DT))
    assert state.mode == "goal"
    state, output = rover.run(state, DT, twist=forward(age=0.0))
    assert state.mode == "cmd_vel"


def test_cmd_vel_drives_and_its_age_stops_the_rover(model: WheelDrive, machine: Callable) -> None:
    rover = machine()
    state, output = rover.run(model.initial_state(), 3.0, twist=forward())
    assert state.mode == "cmd_vel"
    np.testing.assert_allclose(output.wheel_rates, 0.08 / 0.125)
    assert output.odometry.v_x == pytest.approx(0.08)
    state, output = rover.run(state, DT, twist=forward(0.2))
    assert state.mode == "cmd_vel"
    periods = 0
    while output.wheel_rates.any():
        state, output = rover.run(state, DT, twist=forward(0.22 + periods * DT))
        periods += 1
        assert periods < 100
    assert periods * DT == pytest.approx(0.08 / model.params.limits.max_deceleration, abs=2 * DT)
    assert state.mode == "idle"
    assert "older than 0.20 s" in state.text


def test_stop_request_ends_goal_and_older_twist(model: WheelDrive, machine: Callable) -> None:
    rover = machine()
    state, _ = rover.run(model.initial_state(), 3.0, goal=Goal.at(5.0, 0.0))
    state, output = rover.run(state, DT, stop=True, twist=forward(0.1))
    assert [(o.kind, o.reason) for o in output.outcomes] == [("stopped", "stop requested")]
    assert output.outcomes[0].distance_to_go > 4.0
    state, output = rover.run(state, DT, twist=forward(0.1 + DT))
    assert state.mode == "idle"
    state, output = rover.run(state, 1.0)
    assert not output.wheel_rates.any()
    state, output = rover.run(state, DT, twist=forward(0.0))
    assert state.mode == "cmd_vel"


def test_power_manager_limits_the_speed_and_the_curve_stays(model: WheelDrive, machine: Callable) -> None:
    command = TwistCommand(PlanarTwist(0.1, 0.0, 0.05), 0.0)
    rover = machine()
    state, full = rover.run(model.initial_state(), 5.0, twist=command)
    rover = machine()
    state, half = rover.run(model.initial_state(), 5.0, twist=command)
    for _ in range(200):
        state, half = model.step(state, replace(rover.measure(twist=command), power_limit=0.5), DT)
        rover.move(half, DT)
    np.testing.assert_allclose(half.steer_angles, full.steer_angles, atol=1e-9)
    assert half.odometry.v_x == pytest.approx(0.5 * full.odometry.v_x)
    assert np.abs(half.wheel_rates).max() <= 0.5 * model.mobility.limits.max_wheel_rate + 1e-12
    ratio = half.wheel_rates / full.wheel_rates
    np.testing.assert_allclose(ratio, ratio[0])


def test_no_power_waits_and_goes_on(model: WheelDrive, machine: Callable) -> None:
    rover = machine()
    state, _ = rover.run(model.initial_state(), 3.0, goal=Goal.at(2.0, 0.0))
    state, output = rover.run(state, 200.0, dt=0.1, power_limit=0.0)
    assert not output.wheel_rates.any()
    assert (state.text, state.waits) == ("waiting for power", True)
    state, output = rover.run(state, 40.0, dt=0.1)
    assert state.last_outcome is not None
    assert state.last_outcome.kind == "reached"


def test_steering_that_does_not_move_ends_the_goal_by_name(model: WheelDrive, machine: Callable) -> None:
    rover = machine(stuck_steering=True)
    _, output, outcome = until_idle(model, rover, model.initial_state(), Goal.at(-2.0, 0.0))
    assert outcome.kind == "stopped"
    assert outcome.reason == "no steering follows its command: front_left, front_right, rear_left, rear_right"
    assert not output.wheel_rates.any()


def test_steering_is_taken_over_where_it_is(model: WheelDrive, machine: Callable) -> None:
    rover = machine()
    rover.steer_angles = np.array([0.4, 0.2, 0.0, 0.0, -0.4, -0.2])
    _, output = rover.run(model.initial_state(), 1.0)
    np.testing.assert_array_equal(output.steer_angles, rover.steer_angles)
    np.testing.assert_array_equal(output.steer_rates, np.zeros(6))


def test_motor_commands_stay_inside_the_limits(model: WheelDrive, machine: Callable) -> None:
    rover, limits = machine(), model.mobility.limits
    generator = np.random.default_rng(7)
    state, last = model.initial_state(), None
    for index in range(1500):
        if index % 100 == 0:
            command = TwistCommand(PlanarTwist(*generator.uniform(-1.0, 1.0, 3)), 0.0)
        state, output = model.step(state, rover.measure(twist=command), DT)
        rover.move(output, DT)
        assert np.abs(output.wheel_rates).max() <= limits.max_wheel_rate + 1e-9
        assert np.abs(output.steer_rates).max() <= limits.max_steer_rate + 1e-9
        assert np.abs(output.steer_angles).max() <= 1.6
        if last is not None:
            change = np.abs(output.wheel_rates - last.wheel_rates).max() * 0.125 / DT
            assert change <= max(limits.max_acceleration, limits.max_deceleration) + 1e-9
        last = output


def bad(**changes: object) -> dict[str, object]:
    still = np.zeros(6)
    return {"wheel_positions": still, "wheel_rates": still, "steer_angles": still, **changes}


@pytest.mark.parametrize(
    ("inputs", "dt", "message"),
    [
        (bad(wheel_positions=np.array([0, 0, math.nan, 0, 0, 0])), DT, "position of middle_left = nan"),
        (bad(wheel_rates=np.array([0, 0, 0, 0, 0, math.inf])), DT, "rate of rear_right = inf"),
        (bad(steer_angles=np.array([math.nan, 0, 0, 0, 0, 0])), DT, "position of front_left = nan"),
        (bad(wheel_rates=np.zeros(5)), DT, "shape of joint rate"),
        (bad(gyro=(0.0, 0.0, math.nan)), DT, "gyro"),
        (bad(roll_pitch=(math.inf, 0.0)), DT, "roll and pitch"),
        (bad(roll_pitch=(0.0, 1.5)), DT, "pitch"),
        (bad(power_limit=1.1), DT, "power_limit = 1.1"),
        (bad(power_limit=math.nan), DT, "power_limit = nan"),
        (bad(), 0.0, "dt = 0.0"),
        (bad(), math.nan, "dt = nan"),
    ],
)
def test_bad_measurements_are_refused_by_name_and_change_nothing(
    model: WheelDrive, machine: Callable, inputs: dict, dt: float, message: str
) -> None:
    rover = machine()
    state, _ = rover.run(model.initial_state(), 2.0, goal=Goal.at(5.0, 1.0))
    before = copy.deepcopy(state)
    with pytest.raises(MachineError, match=message):
        model.step(state, WheelInput(**inputs), dt)
    after, expected = (model.step(s, rover.measure(), DT)[1] for s in (state, before))
    np.testing.assert_array_equal(after.wheel_rates, expected.wheel_rates)
    assert after.status == expected.status


@pytest.mark.parametrize(
    ("twist", "age", "message"),
    [
        ((math.nan, 0.0, 0.0), 0.0, "cmd_vel v_x = nan"),
        ((0.0, 0.0, math.inf), 0.0, "cmd_vel yaw_rate = inf"),
        ((0.0, 0.0, 0.0), -0.1, "cmd_vel age"),
        ((0.0, 0.0, 0.0), math.nan, "cmd_vel age"),
    ],
)
def test_bad_twist_commands_cannot_be_made(twist: tuple[float, float, float], age: float, message: str) -> None:
    with pytest.raises(MachineError, match=message):
        TwistCommand(PlanarTwist(*twist), age)


def test_a_copied_state_goes_on_identically_and_inputs_are_not_kept(model: WheelDrive, machine: Callable) -> None:
    rover = machine(slip=0.2, gyro_bias=1e-5)
    state, _ = rover.run(model.initial_state(), 4.0, goal=Goal.at(2.0, 1.0, 0.5))
    copied, rovers = copy.deepcopy(state), (rover, copy.deepcopy(rover))
    (one, first), (other, second) = (r.run(s, 6.0) for r, s in zip(rovers, (state, copied), strict=True))
    assert first.status == second.status
    np.testing.assert_array_equal(first.wheel_rates, second.wheel_rates)
    np.testing.assert_array_equal(first.pose_covariance, second.pose_covariance)
    assert (one.odometry.x, one.odometry.yaw) == (other.odometry.x, other.odometry.yaw)
    # a shell that reuses its buffers does not change what the state remembers
    inputs = rover.measure()
    buffers = [inputs.wheel_positions.copy(), inputs.wheel_rates.copy(), inputs.steer_angles.copy()]
    state, _ = model.step(one, WheelInput(*buffers), DT)
    for buffer in buffers:
        buffer += 1.0
    np.testing.assert_array_equal(state.mobility.measured.positions, inputs.wheel_positions)


def test_status_has_words_and_finite_numbers(model: WheelDrive, machine: Callable) -> None:
    rover = machine()
    for commands in ({}, {"goal": Goal.at(1.0, 1.0)}, {"stop": True}, {"twist": forward()}):
        _, output = rover.run(model.initial_state(), 0.5, **commands)
        for key, value in output.status.items():
            assert isinstance(value, str | float), key
            assert isinstance(value, str) or math.isfinite(value), key


def test_what_it_turns_while_nothing_is_read_is_told_by_the_wheels(model: WheelDrive, machine: Callable) -> None:
    """A busy machine: half a second of a turn on the spot without a reading, and the gyro's next one at rest again."""
    rover = machine()
    turning = TwistCommand(PlanarTwist(0.0, 0.0, 0.1), 0.0)
    state, output = rover.run(model.initial_state(), 15.0, twist=turning)
    begun = rover.yaw
    for _ in range(25):
        rover.move(output, DT)
    assert rover.yaw - begun > 0.03
    rover.yaw_rate = 0.0
    state, output = model.step(state, rover.measure(), 25 * DT)
    assert output.odometry.yaw == pytest.approx(rover.yaw, abs=0.3 * (rover.yaw - begun))
