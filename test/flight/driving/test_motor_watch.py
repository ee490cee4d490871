"""Failed motors: recognised in time, nobody blamed who is well, and the machine driven with what is left."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from kinds import MACHINES

from sojourn_flight.mobility.motor_watch import MotorState, believable, dragging_sigma, shortcoming
from sojourn_flight.mobility.twist import PlanarTwist
from sojourn_flight.mobility.wheel_table import WheelTableColumn
from sojourn_flight.planning.goal import Goal
from sojourn_flight.supervision.drive_types import TwistCommand
from sojourn_flight.supervision.params import DriveParams
from sojourn_machine.params import FloatArray
from wheel_drive import WheelDrive, WheelInput, WheelMeasured, initial_wheels, step_wheels

DT = 0.02
FRONT_LEFT = 0


class Motors:
    """Motors that follow with a lag, but for those that have failed; nothing is known of the ground."""

    def __init__(self, model: WheelDrive, lag: float = 0.5) -> None:
        self.model, self.lag = model, lag
        count = len(model.table)
        self.positions, self.rates, self.angles = np.zeros(count), np.zeros(count), np.zeros(count)
        self.efforts: FloatArray | None = None
        self.locked: dict[int, float] = {}
        self.ground_turns: dict[int, float] = {}
        """Part of the commanded rate at which wheels without a motor are turned."""
        self.weak = 1.0
        """Part of the commanded rate that all wheels reach."""
        self.state = model.initial_state()

    def drive(
        self, twist: PlanarTwist | None, seconds: float, goal: Goal | None = None, power: float = 1.0
    ) -> dict[str, str | float]:
        """Status at the end. No twist leaves the rover to its goal."""
        for _ in range(round(seconds / DT)):
            inputs = WheelInput(
                self.positions,
                self.rates,
                self.angles,
                wheel_efforts=self.efforts,
                gyro=(0.0, 0.0, 0.0),
                twist=None if twist is None else TwistCommand(twist, 0.0),
                goal=goal,
                power_limit=power,
            )
            goal = None
            self.state, output = self.model.step(self.state, inputs, DT)
            self.output = output
            self.angles = self.angles + (1.0 - self.lag) * (output.steer_angles - self.angles)
            self.rates = self.rates + (1.0 - self.lag) * (self.weak * output.wheel_rates - self.rates)
            for place, angle in self.locked.items():
                self.angles[place] = angle
            for place, part in self.ground_turns.items():
                self.rates[place] = part * output.wheel_rates[place]
            self.positions = self.positions + self.rates * DT
        return output.status


AHEAD, CURVE = PlanarTwist(0.08, 0.0, 0.0), PlanarTwist(0.08, 0.0, 0.04)


@settings(max_examples=25, deadline=None)
@given(
    st.lists(st.tuples(st.floats(-0.1, 0.1), st.floats(-0.1, 0.1)), min_size=1, max_size=5),
    st.floats(0.0, 0.8),
    st.floats(0.1, 1.0),
)
def test_motors_that_are_well_are_never_blamed(
    model: WheelDrive, wishes: list[tuple[float, float]], lag: float, power: float
) -> None:
    motors = Motors(model, lag)
    for v_x, yaw_rate in wishes:
        status = motors.drive(PlanarTwist(v_x, 0.0, yaw_rate), 4.0, power=power)
        assert status["failed_motors"] == ""


def test_a_locked_steering_is_recognised_in_its_time_and_left_alone(model: WheelDrive) -> None:
    motors = Motors(model)
    motors.drive(AHEAD, 3.0)
    motors.locked[FRONT_LEFT] = math.radians(20.0)
    waiting = motors.drive(AHEAD, 2.9)
    assert waiting["failed_motors"] == ""
    status = motors.drive(AHEAD, 0.3)  # steer_time is 3 s
    assert status["failed_motors"] == "steering of front_left stands at 20.0 degrees"
    motors.drive(CURVE, 10.0)
    assert motors.output.steer_angles[FRONT_LEFT] == pytest.approx(math.radians(20.0))
    # the others turn about the centre that is wanted, at the speed that is wanted
    well = Motors(model)
    well.drive(CURVE, 10.0)
    np.testing.assert_allclose(motors.output.steer_angles[1:], well.output.steer_angles[1:], atol=1e-9)
    np.testing.assert_allclose(motors.output.wheel_rates[1:], well.output.wheel_rates[1:], atol=1e-9)
    # it rolls with the part of its velocity that is along it
    off = well.output.steer_angles[FRONT_LEFT] - math.radians(20.0)
    expected = well.output.wheel_rates[FRONT_LEFT] * math.cos(off)
    assert motors.output.wheel_rates[FRONT_LEFT] == pytest.approx(expected)
    # and what it is dragged sideways is told
    dragged = abs(well.output.wheel_rates[FRONT_LEFT] * model.table[FRONT_LEFT, 2] * math.sin(off))
    assert motors.output.status["steering_residual_m_s"] == pytest.approx(dragged)
    assert dragged > 0.005


def test_a_new_goal_gives_the_steering_another_try(model: WheelDrive) -> None:
    motors = Motors(model)
    motors.locked[FRONT_LEFT] = 0.5
    assert motors.drive(AHEAD, 5.0)["failed_motors"] != ""
    del motors.locked[FRONT_LEFT]
    assert motors.drive(AHEAD, 5.0)["failed_motors"] != ""
    assert motors.drive(None, 5.0, Goal.at(5.0, 0.0))["failed_motors"] == ""
    assert motors.angles[FRONT_LEFT] == pytest.approx(motors.output.steer_angles[FRONT_LEFT], abs=0.01)
    assert abs(motors.angles[FRONT_LEFT]) < 0.1


@pytest.mark.parametrize(
    ("part", "efforts", "found"),
    [
        (0.0, None, True),  # it stands
        (0.85, None, True),  # loose soil: it skids
        (0.96, None, False),  # firm ground, nothing to tell it by
        (0.96, [-2.0, 3.0, 3.0, 3.0, 3.0, 3.0], True),  # firm ground, and it is seen to be pulled
        (0.96, [-2.0, -3.0, -3.0, -3.0, -3.0, 1.0], False),  # downhill, all of them hold back
        (1.0, [-2.0, 3.0, 3.0, 3.0, 3.0, 3.0], False),  # down from a rock, at the rate commanded
    ],
)
def test_a_drive_that_does_not_follow_is_recognised(
    model: WheelDrive, part: float, efforts: list[float] | None, found: bool
) -> None:
    motors = Motors(model)
    motors.efforts = None if efforts is None else np.array(efforts)
    motors.drive(AHEAD, 3.0)
    motors.ground_turns[FRONT_LEFT] = part
    assert motors.drive(AHEAD, 1.9)["failed_motors"] == ""
    status = motors.drive(AHEAD, 0.3)  # drive_time is 2 s
    assert status["failed_motors"] == ("drive of front_left does not follow" if found else "")
    motors.drive(PlanarTwist(0.0, 0.0, 0.0), 5.0)
    assert motors.state.mobility.motors.any_failed == found  # at a stand nothing is learnt
    motors.ground_turns.clear()
    motors.efforts = None
    assert motors.drive(AHEAD, 4.5)["failed_motors"] == ""  # a wheel that was held up is taken back


def test_weakness_of_all_is_not_the_failure_of_one(model: WheelDrive) -> None:
    motors = Motors(model)
    motors.weak = 0.6
    assert motors.drive(AHEAD, 10.0)["failed_motors"] == ""


@pytest.mark.parametrize("part", [0.0, 0.7])
@pytest.mark.parametrize("machine", ["4 skid", "8 skid"])
def test_half_of_the_drives_can_fail_at_once(machine: str, part: float, drive_params: DriveParams) -> None:
    model = WheelDrive(drive_params, MACHINES[machine][0])
    motors = Motors(model)
    motors.drive(AHEAD, 3.0)
    half = range(0, len(model.table), 2)
    motors.ground_turns.update(dict.fromkeys(half, part))
    assert motors.drive(AHEAD, 1.9)["failed_motors"] == ""
    motors.drive(AHEAD, 0.3)  # drive_time is 2 s
    assert np.flatnonzero(motors.state.mobility.motors.drive_failed).tolist() == list(half)
    motors.ground_turns.clear()
    assert motors.drive(AHEAD, 4.5)["failed_motors"] == ""


def test_what_failed_wheels_say_is_not_believed(model: WheelDrive) -> None:
    motors = Motors(model)
    motors.drive(AHEAD, 3.0)
    motors.locked[FRONT_LEFT] = 0.35
    motors.ground_turns[5] = 0.2
    motors.drive(AHEAD, 8.0)
    table = believable(model.table, motors.state.mobility.motors)
    weights = table[:, [WheelTableColumn.ROLL_WEIGHT, WheelTableColumn.SLIDE_WEIGHT]]
    np.testing.assert_array_equal(weights, [[1, 0], [1, 1], [1, 1], [1, 1], [1, 1], [0, 1]])
    assert motors.output.odometry.v_x == pytest.approx(0.08, rel=1e-3)
    assert motors.output.odometry.v_y == pytest.approx(0.0, abs=1e-4)


def test_a_dead_wheel_makes_turns_doubtful(model: WheelDrive) -> None:
    """Half of its distance from the middle for a radian; variances of the position grow with the angle."""
    well = MotorState.unsuspected(6)
    failed = np.arange(6) == FRONT_LEFT
    assert dragging_sigma(model.table, well) == 0.0
    expected = 0.5 * math.hypot(0.705, 0.53)
    assert dragging_sigma(model.table, well._replace(drive_failed=failed)) == pytest.approx(expected)
    params, table = model.params.odometry, model.table
    turned = {}
    for sigma in (0.0, expected):
        odometry = initial_wheels(params, 0.0, 0.0, 0.0)
        for _ in range(500):
            still = np.zeros(6)
            turning = WheelMeasured(still, still + 1.0, still, (0.0, 0.0, 0.1), turn_sigma=sigma)
            odometry = step_wheels(params, table, odometry, turning, DT)
        turned[sigma] = odometry.covariance[:2, :2]
    np.testing.assert_allclose(turned[expected] - turned[0.0], np.eye(2) * expected**2 * 1.0, rtol=1e-3, atol=1e-6)


def test_a_joint_between_two_bodies_fails_as_one(drive_params: DriveParams) -> None:
    model = WheelDrive(drive_params, MACHINES["articulated"][0])
    motors = Motors(model)
    motors.locked.update({2: 0.2, 3: 0.2})
    status = motors.drive(AHEAD, 5.0)
    assert status["failed_motors"].count("stands at 11.5 degrees") == 2
    assert "no steering follows" in shortcoming(model.table, motors.state.mobility.motors, model.geometry.names)
    motors.drive(AHEAD, 3.0)
    # it drives on, in the curve that the joint leaves it
    assert motors.output.wheel_rates[0] > motors.output.wheel_rates[1] > 0.0


def test_a_goal_ends_where_too_little_is_left(model: WheelDrive) -> None:
    motors = Motors(model)
    motors.drive(None, 3.0, Goal.at(9.0, 0.0))
    for place in (0, 2, 3):
        motors.ground_turns[place] = 0.0
        motors.drive(None, 3.0)
        assert motors.state.follower is not None
    motors.ground_turns[5] = 0.0
    motors.drive(None, 3.0)
    outcome = motors.state.last_outcome
    assert outcome is not None
    assert outcome.kind == "stopped"
    assert outcome.reason == "most wheels have no drive: front_left, middle_left, middle_right, rear_right"
