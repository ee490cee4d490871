"""Tasks over the arm's laws: one goal at a time, what ends a guided motion, and the force loop in its limits."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from sojourn_config.scenario import load_scenario
from sojourn_flight.arm.dynamics import rigid_effort
from sojourn_flight.arm.force_control import ForceControlParams, force_speed, hybrid_velocity, impedance_velocity
from sojourn_flight.arm.goal_events import ACCEPTED, GoalEvent
from sojourn_flight.arm.goals import JointGoal, NamedGoal, StopGoal
from sojourn_flight.arm.jogging import JogCommand
from sojourn_flight.arm.kinematics import forward_kinematics
from sojourn_flight.arm.model import build_arm_model
from sojourn_flight.arm.motion_load import motor_efforts, power_drawn
from sojourn_flight.arm.phases import Paused
from sojourn_flight.arm.state import ArmInput, Granted
from sojourn_flight.arm.tasks import task_control
from sojourn_flight.arm.tasks.contact_sense import sensor_rotation
from sojourn_flight.arm.tasks.guided_pace import GuidedPace, PaceLimits, next_pace
from sojourn_flight.arm.tasks.names import TASKS
from sojourn_flight.arm.tasks.requests import parse_task

SCENARIO = load_scenario("flat_drive")
PARAMS = SCENARIO.arm
ARM = build_arm_model(SCENARIO.urdf_xml, PARAMS)
GRAVITY = np.array([0.0, 0.0, -1.62])
DT = 0.02


class IdealArm:
    """Joints that are where they are told to be; the ground's force on the tool is given by hand."""

    def __init__(self) -> None:
        self.joints = np.array(PARAMS.named_poses["unfold"])
        self.rates = np.zeros(5)
        self.force = np.zeros(3)
        self.feels, self.allowed = True, True
        self.granted: float | None = None
        self.power: list[float] = []
        self.state = task_control.initial_state(PARAMS, ARM)
        self.tips: list[np.ndarray] = []
        self.events: list[GoalEvent] = []
        self.period()

    def period(self, goal: Any = None, task: Any = None, jog: JogCommand | None = None) -> None:
        tip = forward_kinematics(ARM, self.joints)
        self.tips.append(tip.position)
        wrench = self.state.sense.tool_load(ARM, tip, GRAVITY)
        wrench[:3] += sensor_rotation(ARM, tip).T @ self.force
        reason = "" if self.allowed else "a test"
        arm = ArmInput(self.joints, self.rates, GRAVITY, goal, self.allowed, reason, granted=Granted(self.granted))
        inputs = task_control.TaskInput(arm, task, wrench if self.feels else None, jog=jog)
        self.state, self.said, self.report = task_control.step(PARAMS, ARM, self.state, inputs, DT)
        self.events += self.said.events
        assert np.all(np.abs(self.said.velocities) <= ARM.max_velocity + 1e-9)
        assert np.all(np.abs(self.said.velocities - self.rates) <= 1.5 * ARM.max_acceleration * DT + 1e-9)
        self.joints, self.rates = self.said.positions.copy(), self.said.velocities.copy()
        outside = -tip.jacobian[:3].T @ self.force
        rigid = rigid_effort(ARM, self.joints, self.rates, np.zeros(5), GRAVITY) + outside
        motor = motor_efforts(PARAMS, rigid[None, :], self.rates[None, :])
        self.power.append(float(power_drawn(PARAMS, motor, self.rates[None, :])[0]))

    @property
    def outcomes(self) -> list[str]:
        """What has been told of the goals so far."""
        return [event.outcome for event in self.events]

    def run(self, seconds: float) -> None:
        for _ in range(round(seconds / DT)):
            self.period()

    def start(self, name: str, **numbers: Any) -> None:
        self.period(task=parse_task(name, numbers))


@pytest.fixture
def arm() -> IdealArm:
    return IdealArm()


def test_every_task_is_registered_by_its_own_name() -> None:
    assert len(TASKS.names()) >= 14
    for name in TASKS.names():
        assert TASKS.get(name).task == name


def test_a_guarded_move_runs_straight_at_its_speed(arm: IdealArm) -> None:
    arm.start("guarded_move", distance=0.08, speed=0.01)
    arm.run(5.0)
    tips = np.array(arm.tips[3:])
    steps = np.linalg.norm(np.diff(tips, axis=0), axis=1) / DT
    assert steps.max() <= 0.0101 and steps[20:].min() > 0.0099
    assert np.abs(tips[:, :2] - tips[0, :2]).max() < 1e-4
    assert arm.report.doing.state == "moving" and 0.5 < arm.report.doing.progress < 0.7


@pytest.mark.parametrize("goal", [StopGoal(), NamedGoal("stow")], ids=["stop", "goal"])
def test_a_goal_or_a_stop_replaces_a_task(arm: IdealArm, goal: Any) -> None:
    arm.start("guarded_move")
    arm.run(0.5)
    arm.period(goal=goal)
    assert arm.report is None and arm.said.status == "moving"
    arm.run(30.0)
    assert arm.said.status in ("stopped", "reached") and not arm.rates.any()


def test_a_second_task_is_refused_or_replaces_as_it_asks(arm: IdealArm) -> None:
    arm.start("guarded_move")
    arm.start("stow")
    assert arm.report.name == "guarded_move" and arm.outcomes.count("refused") == 1
    assert "guarded_move is under way" in arm.said.reason
    arm.start("stow", preempt=True)
    assert arm.report.name == "stow"
    arm.run(30.0)
    assert arm.report.doing.state == "reached"
    assert np.allclose(arm.joints, PARAMS.named_poses["stow"], atol=1e-3)
    assert arm.outcomes == ["accepted", "refused", "accepted", "reached"]


def test_too_much_force_is_given_way_to(arm: IdealArm) -> None:
    arm.start("guarded_move", force=60.0)
    arm.run(1.0)
    arm.force = np.array([0.0, 0.0, 90.0])
    arm.run(0.1)
    assert arm.report.doing.state == "failed" and "contact force 90 N" in arm.report.doing.reason
    height = arm.tips[-1][2]
    arm.run(1.0)
    assert arm.tips[-1][2] > height + 0.005, "away from what presses"


def test_without_leave_to_move_a_task_ends_and_the_arm_stops(arm: IdealArm) -> None:
    arm.start("guarded_move")
    arm.run(1.0)
    arm.allowed = False
    arm.run(1.0)
    assert arm.report.doing.state == "failed" and "not allowed to move: a test" in arm.report.doing.reason
    assert not arm.rates.any()
    arm.start("stow")
    assert arm.outcomes.count("refused") == 1


def test_a_pause_rests_in_the_middle_of_a_task_and_resuming_goes_on(arm: IdealArm) -> None:
    """Of a guided motion, and of one that a task has planned; another task meanwhile is refused."""
    arm.start("guarded_move", distance=0.08, speed=0.01)
    arm.run(2.0)
    arm.start("pause")
    arm.run(0.5)
    here = arm.tips[-1]
    assert arm.report is None and arm.said.status == "paused" and "resume goes on" in arm.said.reason
    arm.start("pause")
    assert "paused already" in arm.said.reason
    arm.start("stow")
    assert "guarded_move is under way" in arm.said.reason
    arm.run(5.0)
    assert arm.tips[-1] == pytest.approx(here, abs=1e-5)
    arm.start("resume")
    arm.run(2.0)
    assert arm.report is not None and arm.report.doing.state == "moving"
    assert 0.015 < here[2] - arm.tips[-1][2] < 0.021

    arm.start("stow", preempt=True)
    arm.run(1.0)
    arm.start("pause")
    arm.run(2.0)
    assert arm.said.status == "paused" and not arm.rates.any()
    arm.start("resume")
    arm.run(30.0)
    assert arm.report.name == "stow" and arm.report.doing.state == "reached"
    arm.start("resume")
    assert "no motion is paused" in arm.said.reason


def test_a_task_that_is_given_up_in_its_pause_has_failed(arm: IdealArm) -> None:
    """It was called paused for ever, and a resume was accepted that moved nothing."""
    arm.start("guarded_move", distance=0.08, speed=0.01)
    arm.run(1.0)
    arm.start("pause")
    arm.run(1.0)
    arm.allowed = False
    arm.run(1.0)
    assert arm.said.status == "stopped" and arm.outcomes == ["accepted", "accepted", "paused"]
    assert arm.report is not None and "not allowed to move: a test" in arm.report.doing.reason
    arm.allowed = True
    arm.start("resume")
    assert arm.events[-1].outcome == "refused" and "no motion is paused" in arm.events[-1].reason


def test_a_task_replaces_a_motion_that_is_paused(arm: IdealArm) -> None:
    """The arm used to stay in its pause, and the task was called reached."""
    arm.period(goal=NamedGoal("stow"))
    arm.run(1.0)
    arm.start("pause")
    arm.run(3.0)
    assert isinstance(arm.state.arm.phase, Paused) and arm.outcomes == ["accepted", "accepted", "paused"]
    arm.start("guarded_move", preempt=True, distance=0.05, speed=0.01)
    arm.run(1.0)
    assert arm.report is not None and arm.report.doing.state == "moving" and arm.rates.any()
    arm.run(10.0)
    assert arm.outcomes[3:] == ["accepted", "failed"], "nothing is met on 5 cm"


@pytest.mark.parametrize("name", ["guarded_move", "hold_force"])
@pytest.mark.parametrize("before", ["goal", "jog"])
def test_the_way_of_a_task_is_counted_from_where_the_arm_has_come_to_rest(
    arm: IdealArm, name: str, before: str
) -> None:
    """It used to be counted, and its line looked at, from where the moving arm was asked: the stop carries it on."""
    for period in range(60):
        if before == "jog":
            arm.period(jog=JogCommand((0.0, 0.03, 0.0), (0.0, 0.0, 0.0)))
        else:
            arm.period(goal=NamedGoal("stow") if period == 0 else None)
    asked = arm.tips[-1]
    arm.start(name, preempt=True, distance=0.05, direction="0 0 1", force=30.0)
    while arm.said.velocities.any() and "rest first" in arm.report.doing.reason:
        arm.period()
    begun = forward_kinematics(ARM, arm.joints).position
    assert np.linalg.norm(begun - asked) > (0.05 if before == "goal" else 0.002)
    arm.run(30.0)
    assert arm.report.doing.state == "failed" and "within 50 mm" in arm.report.doing.reason
    assert arm.tips[-1] - begun == pytest.approx([0.0, 0.0, 0.05], abs=1.5e-3)
    assert arm.outcomes[-2:] == ["accepted", "failed"] and np.abs(arm.rates).max() < 1e-9


def test_a_task_does_not_begin_where_its_line_was_not_looked_at(arm: IdealArm) -> None:
    arm.period(goal=NamedGoal("stow"))
    arm.run(1.0)
    arm.start("guarded_move", preempt=True)
    held = arm.joints.copy()
    for _ in range(100):
        arm.joints = held.copy()  # something holds it
        arm.period()
    assert arm.report.doing.state == "failed" and "from where it was to begin" in arm.report.doing.reason


@pytest.mark.parametrize(("name", "ends"), [("tare", "reached"), ("weigh", "failed")])
def test_a_task_that_moves_nothing_stops_the_motion_that_it_replaces(arm: IdealArm, name: str, ends: str) -> None:
    """The arm used to go on to the old goal. Nobody tells the joints' torques here, so that weighing fails at once."""
    arm.period(goal=NamedGoal("stow"))
    arm.run(1.0)
    arm.start(name, preempt=True)
    for _ in range(100):
        arm.force = np.full(3, 2.0 if arm.rates.any() else 0.0)  # as the tool's inertia, which is no bias
        arm.period()
    assert not arm.rates.any() and arm.said.status in ("holding", "stopped")
    here = arm.joints
    arm.run(5.0)
    np.testing.assert_array_equal(arm.joints, here)
    assert arm.report is not None and arm.report.doing.state == ends
    assert arm.outcomes == ["accepted", "accepted", ends]
    np.testing.assert_allclose(arm.state.sense.bias, 0.0, atol=1e-9)


def test_a_goal_that_is_refused_during_a_task_says_why(arm: IdealArm) -> None:
    """The reason used to be lost, as the task went on in the same period."""
    arm.start("guarded_move", distance=0.08, speed=0.01)
    arm.run(0.5)
    arm.period(goal=JointGoal(("no_joint",), (0.0,)))
    assert arm.report is not None and arm.report.name == "guarded_move"
    assert arm.events[0] == ACCEPTED
    assert arm.outcomes == ["accepted", "refused"] and "unknown joint no_joint" in arm.events[1].reason


_ASKED = ("goal", "bad goal", "stop", "pause", "resume", "stow", "guarded_move", "tare")


@given(asked=st.lists(st.tuples(st.sampled_from(_ASKED), st.integers(1, 120)), min_size=1, max_size=8))
@example([("stow", 13), ("goal", 1), ("guarded_move", 1)])
@settings(max_examples=8, deadline=None)
def test_every_goal_is_answered_once_and_ends_once_at_most(asked: list[tuple[str, int]]) -> None:
    arm = IdealArm()
    goals = {
        "goal": JointGoal((PARAMS.joint_names[0],), (0.1,)),
        "bad goal": JointGoal((PARAMS.joint_names[0],), (100.0,)),
        "stop": StopGoal(),
    }
    for name, periods in asked:
        before = len(arm.events)
        if name in goals:
            arm.period(goal=goals[name])
        else:
            numbers = {"distance": 0.05, "speed": 0.01} if name == "guarded_move" else {}
            arm.start(name, **numbers, **({} if name in ("pause", "resume") else {"preempt": True}))
        answers = [event for event in arm.events[before:] if event.is_answer]
        assert len(answers) == 1, "in the same period"
        for _ in range(periods):
            arm.period()
    arm.run(40.0)
    assert len([event for event in arm.events if event.is_answer]) == len(asked)
    open_goal = False
    for event in arm.events:
        assert event.is_answer or open_goal, f"{event} of no goal"
        open_goal = event.outcome == "accepted" or (open_goal and event.outcome == "refused")
    assert not open_goal, "the last one has come to an end"


def test_a_lost_contact_is_sought_with_bounded_speed(arm: IdealArm) -> None:
    arm.start("hold_force", force=20.0, distance=0.1)
    arm.force = np.array([0.0, 0.0, 20.0])
    arm.run(0.5)
    here = arm.tips[-1][2]
    arm.run(0.5)
    assert arm.tips[-1][2] == pytest.approx(here, abs=1e-5)
    arm.force = np.zeros(3)
    arm.run(2.0)
    assert 0.003 < here - arm.tips[-1][2] < 2.0 * PARAMS.force_control.max_speed


def test_a_sensor_that_falls_silent_ends_the_task(arm: IdealArm) -> None:
    arm.start("guarded_move")
    arm.run(0.5)
    arm.feels = False
    arm.run(0.5)
    assert arm.report.doing.state == "failed" and "says nothing" in arm.report.doing.reason
    assert not arm.rates.any()


def test_a_tare_takes_the_bias_out(arm: IdealArm) -> None:
    arm.force = np.array([0.4, -0.3, 0.5])  # of the sensor, the tool hanging free
    arm.start("tare", seconds=0.5)
    arm.run(1.0)
    assert arm.report.doing.state == "reached"
    arm.start("guarded_move", force=5.0)
    arm.run(0.5)
    assert arm.report.doing.figures["contact_force_n"] == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize(("ratio", "stable"), [(0.9, True), (1.1, False)])
def test_the_force_loop_is_stable_up_to_its_bound(ratio: float, stable: bool) -> None:
    """k T/D < π/2 for a contact of stiffness k with a dead time T: by simulation of small errors."""
    params = ForceControlParams(damping=1000.0, deadband=0.0, max_speed=1.0)
    delay, dt = 200, 1e-3
    stiffness = ratio * 0.5 * math.pi * params.damping / (delay * dt)
    place, old = 0.0, [1.0] * delay
    errors = []
    for _ in range(20000):
        place += dt * force_speed(params, 10.0, old[0])
        old = [*old[1:], stiffness * place]
        errors.append(abs(stiffness * place - 10.0))
    assert (max(errors[-2000:]) < 0.5 * max(errors[2000:4000])) == stable


def test_hybrid_control_keeps_force_and_motion_apart() -> None:
    params, direction = ForceControlParams(), np.array([0.0, 0.6, -0.8])
    along = np.array([0.01, 0.02, 0.03])
    velocity = hybrid_velocity(params, direction, 20.0, -20.0 * direction, along)
    assert velocity @ direction == pytest.approx(0.0, abs=1e-15)
    assert velocity == pytest.approx(along - (along @ direction) * direction)
    pressing = hybrid_velocity(params, direction, 20.0, np.zeros(3), np.zeros(3))
    assert pressing == pytest.approx((20.0 - params.deadband) / params.damping * direction)


def test_impedance_is_that_of_mass_spring_and_damper() -> None:
    """Against the closed form of the step response, critically damped."""
    mass, stiffness, force, dt = 2.0, 200.0, 10.0, 1e-4
    damping = 2.0 * math.sqrt(mass * stiffness)
    place = speed = 0.0
    for _ in range(3000):
        speed = impedance_velocity(mass, damping, stiffness, place, speed, force, dt)
        place += dt * speed
    time, rate = 3000 * dt, math.sqrt(stiffness / mass)
    assert place == pytest.approx(force / stiffness * (1.0 - (1.0 + rate * time) * math.exp(-rate * time)), rel=2e-3)


def test_a_guided_motion_is_slower_while_less_power_is_granted(arm: IdealArm) -> None:
    """It used to run at its speed whatever was granted."""
    arm.start("guarded_move", distance=0.2, speed=0.02, direction="0 0 1")
    arm.run(2.0)
    full, still = max(arm.power), arm.power[0]
    arm.granted = still + 0.4 * (full - still)
    arm.run(0.5)
    first = len(arm.power)
    arm.run(3.0)
    assert max(arm.power[first:]) <= arm.granted * 1.001
    speeds = np.linalg.norm(np.diff(arm.tips, axis=0), axis=1) / DT
    assert 0.15 * 0.02 < speeds[first:].max() < 0.8 * 0.02
    share = speeds[-1] / 0.02
    assert f"slower, at {100.0 * share:.0f} % of the speed planned" in arm.report.doing.reason
    arm.granted = 0.5 * still
    arm.run(1.0)
    assert "waits" in arm.report.doing.reason and np.abs(arm.rates).max() < 1e-9 and arm.report.doing.state == "moving"
    arm.granted = None
    arm.run(10.0)
    assert arm.report.doing.reason == "no contact of 10 N within 200 mm"
    assert np.abs(np.array(arm.tips)[:, :2] - arm.tips[0][:2]).max() < 2e-4, "on its line all the way"


def test_an_arm_that_must_give_way_is_not_held_up_by_the_power_granted(arm: IdealArm) -> None:
    arm.start("guarded_move", force=60.0)
    arm.run(1.0)
    arm.granted = 1e-6
    arm.force = np.array([0.0, 0.0, 90.0])
    arm.run(0.1)
    height = arm.tips[-1][2]
    arm.run(1.0)
    assert arm.tips[-1][2] > height + 0.005


def test_pausing_going_on_and_slowing_a_guided_motion_keeps_the_jerk_of_the_joints(arm: IdealArm) -> None:
    """A pause used to be a step of acceleration: third differences of the reference,
    to which the gears' twist and play are added."""
    arm.start("guarded_move", distance=0.3, speed=0.04, direction="0 0 1")
    arm.run(1.5)
    places = [arm.state.arm.reference.position]
    full, still = max(arm.power), arm.power[0]
    for task, granted in (("pause", None), ("resume", None), ("", still + 0.4 * (full - still)), ("", None)):
        arm.granted = granted
        if task:
            arm.start(task)
            places.append(arm.state.arm.reference.position)
        for _ in range(60):
            arm.period()
            places.append(arm.state.arm.reference.position)
        if task == "pause":
            assert np.abs(arm.rates).max() < 1e-9
    assert np.all(np.abs(np.diff(places, 2, axis=0)) / DT**2 <= ARM.max_acceleration)
    assert np.all(np.abs(np.diff(places, 3, axis=0)) / DT**3 <= ARM.max_jerk)
    speeds = np.linalg.norm(np.diff(arm.tips, axis=0), axis=1) / DT
    assert speeds[-1] == pytest.approx(0.04, rel=1e-3)


@given(
    wanted=st.lists(st.tuples(st.floats(0.0, 1.0), st.integers(1, 80)), min_size=1, max_size=8),
    change=st.floats(0.2, 10.0),
    sharpness=st.floats(0.5, 100.0),
)
@settings(max_examples=100, deadline=None)
def test_the_pace_of_a_guided_motion_comes_to_what_is_wanted_within_its_limits(
    wanted: Any, change: float, sharpness: float
) -> None:
    pace, limits = GuidedPace(), PaceLimits(change, sharpness)
    rows = [1.0] * 3
    for share, periods in (*wanted, (wanted[-1][0], 1500)):
        for _ in range(periods):
            pace = next_pace(pace, share, limits, DT)
            rows.append(pace.share)
    assert pace == GuidedPace(wanted[-1][0], 0.0)
    assert np.abs(np.diff(rows)).max() <= change * DT * (1.0 + 1e-9)
    assert np.abs(np.diff(rows, 2)).max() <= sharpness * DT**2 * (1.0 + 1e-6) + 1e-9
    assert min(rows) >= 0.0 and max(rows) <= 1.0
