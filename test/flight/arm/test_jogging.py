"""Jogging the tip: its direction, the limits of the joints, and where it rests by itself."""

import math
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from sojourn_config.scenario import load_scenario
from sojourn_flight.arm.collision import check_posture
from sojourn_flight.arm.dynamics import rigid_effort
from sojourn_flight.arm.goals import ArmGoal, JointGoal, NamedGoal, PoseGoal, StopGoal
from sojourn_flight.arm.ground_plane import GroundPlane
from sojourn_flight.arm.jogging import JogCommand, Surroundings, begin_jog, jog_on
from sojourn_flight.arm.kinematics import forward_kinematics
from sojourn_flight.arm.model import build_arm_model
from sojourn_flight.arm.motion_load import motor_efforts, power_drawn
from sojourn_flight.arm.refusal import GoalRefusedError
from sojourn_flight.arm.state import ArmInput, Granted
from sojourn_flight.arm.tasks import task_control
from sojourn_flight.arm.tasks.requests import TaskRequest, parse_task
from sojourn_flight.arm.trajectory import at_rest
from sojourn_machine.params import FloatArray

DT = 0.02
SCENARIO = load_scenario("flat_drive")
PARAMS = SCENARIO.carried_arm().model_copy(update={"gear_compliance": (), "gear_backlash": (), "bearing_friction": ()})
MODEL = build_arm_model(SCENARIO.urdf_xml, PARAMS)
UNFOLD = np.array(PARAMS.named_poses["unfold"])
MOON = np.array([0.0, 0.0, -1.62])
GROUND = GroundPlane(-0.55)
SPEED = PARAMS.jog.speed
velocity = st.tuples(*(st.floats(-1.0, 1.0),) * 3).filter(lambda v: math.hypot(*v) > 0.1)


def along(direction: Any, speed: float = SPEED, **more: Any) -> JogCommand:
    x, y, z = (float(value) for value in speed * np.array(direction) / np.linalg.norm(direction))
    return JogCommand((x, y, z), (0.0, 0.0, 0.0), **more)


def jogged(commands: Callable[[int], JogCommand], periods: int, around: Surroundings) -> tuple[FloatArray, str]:
    """Joint positions of all periods (k, n), and the last reason; a new command every tenth of a second."""
    here, jog, rows = at_rest(UNFOLD), begin_jog(PARAMS, MODEL, commands(0), UNFOLD, around.ground), [UNFOLD] * 4
    for period in range(periods):
        if period % 5 == 0:
            fresh = begin_jog(PARAMS, MODEL, commands(period), here.position, around.ground)
            jog = replace(fresh, share=jog.share, held=jog.held)
        jog, here = jog_on(PARAMS, MODEL, jog, here, around, DT)
        rows.append(here.position)
    return np.array(rows), jog.reason


def tips(rows: FloatArray) -> FloatArray:
    return np.array([forward_kinematics(MODEL, row).position for row in rows])


def assert_within_limits(rows: FloatArray) -> None:
    for order, limit in ((1, MODEL.max_velocity), (2, MODEL.max_acceleration), (3, MODEL.max_jerk)):
        assert np.all(np.abs(np.diff(rows, order, axis=0)) / DT**order <= limit * (1.0 + 1e-4))
    assert np.all(rows >= MODEL.lower - 1e-9) and np.all(rows <= MODEL.upper + 1e-9)


@pytest.mark.parametrize("direction", [(1, 0, 0), (0, 1, 0), (0, 0, 1), (-1, 1, -1)])
def test_the_tip_goes_the_way_it_is_told_and_keeps_its_tool_s_direction(direction: Any) -> None:
    rows, reason = jogged(lambda _: along(direction), 200, Surroundings(None, MOON))
    assert reason == ""
    assert_within_limits(rows)
    way, line = tips(rows) - tips(rows[:1]), np.array(direction) / np.linalg.norm(direction)
    assert np.max(np.linalg.norm(way - np.outer(way @ line, line), axis=1)) < 1e-3  # over 15 cm
    assert float((way[-1] - way[-2]) @ line) == pytest.approx(SPEED * DT, rel=0.01)
    tool = [forward_kinematics(MODEL, row).tool_direction for row in rows[[0, -1]]]
    assert math.acos(min(float(tool[0] @ tool[1]), 1.0)) < 2e-3


def test_a_command_in_the_tool_s_frame_moves_it_along_the_tool() -> None:
    rows, _ = jogged(lambda _: along((0, 0, 1), of_tool=True), 100, Surroundings(None, MOON))
    way = tips(rows)[-1] - tips(rows)[0]
    tool = forward_kinematics(MODEL, UNFOLD).tool_direction
    assert float(way @ tool) / np.linalg.norm(way) == pytest.approx(1.0, abs=1e-4)


def test_turning_keeps_the_tip_in_its_place() -> None:
    rows, _ = jogged(lambda _: JogCommand((0.0,) * 3, (0.0, 0.15, 0.0)), 150, Surroundings(None, MOON))
    assert_within_limits(rows)
    assert np.max(np.linalg.norm(tips(rows) - tips(rows)[0], axis=1)) < 2e-3
    tool = [forward_kinematics(MODEL, row).tool_direction for row in rows[[0, -1]]]
    assert 0.25 < math.acos(float(tool[0] @ tool[1])) < 0.15 * 150 * DT


@given(ways=st.lists(velocity, min_size=1, max_size=4), low=st.booleans())
@example(ways=[(0.0, 0.0, -0.6645388992247998), (0.0, 0.0, -0.3713514259784282), (-1.0, 0.0, 0.0)], low=True)  # braking
@settings(max_examples=12, deadline=None)
def test_whatever_is_told_limits_hold_and_nothing_is_touched(ways: Any, low: bool) -> None:
    around = Surroundings(GroundPlane(-0.35) if low else GROUND, MOON)
    rows, _ = jogged(lambda period: along(ways[period // 200 % len(ways)]), 200 * len(ways) + 60, around)
    assert_within_limits(rows)
    for row in rows[::10]:
        assert check_posture(PARAMS, MODEL, row, around.ground) is None


@pytest.mark.parametrize(
    ("direction", "words", "least"),
    [
        ((0, 0, -1), "a collision of arm_wrist_link and ground", 0.3),
        ((1, 0, 0), "a singular posture", 0.2),
        ((-1, 0, 0), "the limit of arm_elbow_joint", 0.2),
    ],
)
def test_it_rests_before_what_is_in_the_way_and_can_be_jogged_back(direction: Any, words: str, least: float) -> None:
    back = tuple(-value for value in direction)
    periods = 900
    rows, reason = jogged(lambda _: along(direction), periods, Surroundings(GROUND, MOON))
    assert reason == f"held before {words}"
    assert np.linalg.norm(tips(rows)[-1] - tips(rows)[0]) > least
    assert np.max(np.abs(rows[-1] - rows[-50])) < 1e-3  # at rest, or all but
    both, reason = jogged(
        lambda period: along(direction if period < periods else back), periods + 150, Surroundings(GROUND, MOON)
    )
    assert_within_limits(both)
    assert float((tips(both)[-1] - tips(rows)[-1]) @ np.array(back)) > 0.03


def test_commands_that_cannot_be_are_refused() -> None:
    for command, words in (
        (JogCommand((0.5, 0.0, 0.0), (0.0,) * 3), "linear velocity of 0.500 m/s: allowed is at most 0.04"),
        (JogCommand((0.0,) * 3, (0.0, 0.0, 3.0)), "angular velocity of 3.000 rad/s: allowed is at most 0.2"),
        (JogCommand((0.0,) * 3, (0.0, 0.0, 0.1)), "about the tool's axis"),
        (JogCommand((0.0,) * 3, (0.0, 0.0, 0.1), of_tool=True), "about the tool's axis"),
    ):
        with pytest.raises(GoalRefusedError, match=words):
            begin_jog(PARAMS, MODEL, command, UNFOLD, None)


def test_few_joints_turn_the_tool_as_far_as_they_can() -> None:
    for name, turns in (("scara_course", True), ("cylindrical_course", False)):
        scenario = load_scenario(name)
        params = scenario.carried_arm()
        model = build_arm_model(scenario.urdf_xml, params)
        start = np.array(params.named_poses["unfold"])
        command = JogCommand((0.0,) * 3, (0.0, 0.0, 0.1))
        if not turns:
            with pytest.raises(GoalRefusedError, match="4 joints cannot turn the tool like that"):
                begin_jog(params, model, command, start, None)
            continue
        here, jog = at_rest(start), begin_jog(params, model, command, start, None)
        for _ in range(100):
            jog, here = jog_on(params, model, replace(jog, age=0.0), here, Surroundings(None, MOON), DT)
        assert jog.reason == ""
        first, last = (forward_kinematics(model, q) for q in (start, here.position))
        np.testing.assert_allclose(last.position, first.position, atol=2e-3)
        assert 0.1 < math.acos((np.trace(last.rotation @ first.rotation.T) - 1.0) / 2.0) < 0.2


@dataclass
class Arm:
    """An arm that is where its reference is, under its laws with tasks."""

    state: task_control.TaskState = field(default_factory=lambda: task_control.initial_state(PARAMS, MODEL))
    joints: FloatArray = field(default_factory=lambda: UNFOLD)
    wrench: FloatArray | None = None
    allowed: bool = True
    granted: float | None = None
    rows: list[FloatArray] = field(default_factory=lambda: [UNFOLD] * 4)
    power: list[float] = field(default_factory=list)
    refusal: str = ""
    out: Any = None
    report: Any = None
    counts: Counter[str] = field(default_factory=Counter)

    def period(
        self, goal: ArmGoal | None = None, jog: JogCommand | None = None, task: TaskRequest | None = None
    ) -> None:
        arm = ArmInput(
            self.joints, np.zeros(5), MOON, goal, self.allowed, "" if self.allowed else "the rover drives", GROUND,
            granted=Granted(self.granted),
        )  # fmt: skip
        asked = task_control.TaskInput(arm, task, self.wrench, jog=jog)
        self.state, self.out, self.report = task_control.step(PARAMS, MODEL, self.state, asked, DT)
        self.counts.update(event.outcome for event in self.out.events)
        reference = self.state.arm.reference
        self.joints = reference.position
        self.rows.append(self.joints)
        rigid = rigid_effort(MODEL, reference.position, reference.velocity, reference.acceleration, MOON)
        motor = motor_efforts(PARAMS, rigid[None, :], reference.velocity[None, :])
        self.power.append(float(power_drawn(PARAMS, motor, reference.velocity[None, :])[0]))

    def jog(self, command: JogCommand, periods: int) -> None:
        for period in range(periods):
            self.period(jog=command if period % 5 == 0 else None)
            if self.out.reason:
                self.refusal = self.out.reason

    def rest(self, periods: int = 100) -> None:
        for _ in range(periods):
            self.period()


def test_it_stops_softly_when_the_commands_stop_and_holds() -> None:
    arm = Arm()
    arm.jog(along((0, 1, 0)), 100)
    assert (arm.report.name, arm.report.doing.state) == ("jog", "moving")
    arm.rest()
    assert arm.report.doing.state == "stopped"
    assert arm.report.doing.reason == "stopped: /arm/cmd_vel is older than 0.20 s"
    assert_within_limits(np.array(arm.rows))
    assert arm.state.motion is None and not np.any(arm.out.velocities)
    assert arm.counts == {"accepted": 20, "stopped": 1}
    arm.period(goal=PoseGoal((1.2, 0.0, -0.2)))
    assert arm.report is None and arm.out.status == "moving"


def test_an_old_command_is_not_carried_out_for_as_long() -> None:
    fresh, old = Arm(), Arm()
    fresh.period(jog=along((0, 1, 0)))
    old.period(jog=along((0, 1, 0), age=0.15))
    for arm in (fresh, old):
        arm.rest()
    ways = [float(np.linalg.norm(tips(np.array(arm.rows))[-1] - tips(np.array(arm.rows))[0])) for arm in (fresh, old)]
    assert 0.0 < ways[1] < 0.3 * ways[0]


def test_it_takes_the_place_of_a_motion_and_a_goal_takes_its_place_without_a_jump() -> None:
    arm = Arm()
    arm.period(goal=NamedGoal("stow"))
    arm.rest(80)
    arm.jog(along((0, 0, 1)), 60)
    assert arm.report.doing.state == "moving"
    arm.period(goal=JointGoal(("arm_azimuth_joint",), (0.3,)))
    arm.rest(40)
    arm.jog(along((0, 1, 1)), 30)
    arm.period(goal=StopGoal())
    arm.rest()
    assert arm.out.status == "stopped" and arm.report is None
    assert_within_limits(np.array(arm.rows))


def test_a_task_and_a_pause_are_refused_while_it_goes_on() -> None:
    arm = Arm()
    arm.jog(along((0, 1, 0)), 50)
    arm.period(task=parse_task("unfold", {}))
    assert "jog is under way" in arm.out.reason and arm.counts["refused"] == 1
    arm.period(task=parse_task("pause", {}))
    assert "the arm is jogged" in arm.out.reason
    arm.rest()
    arm.period(task=parse_task("unfold", {}))
    assert arm.counts["refused"] == 2 and arm.report.name == "unfold"


def test_a_rover_that_drives_stops_it_and_it_is_refused() -> None:
    arm = Arm()
    arm.jog(along((0, 1, 0)), 60)
    arm.allowed = False
    arm.rest(5)
    assert arm.report.doing.reason == "not allowed to move: the rover drives"
    arm.jog(along((0, 1, 0)), 100)
    assert "not allowed to move" in arm.refusal and arm.counts["refused"] == 20
    assert_within_limits(np.array(arm.rows))
    assert np.max(np.abs(arm.rows[-1] - arm.rows[-20])) == 0.0


def test_a_contact_ends_it_and_only_a_pause_of_the_commands_lets_it_go_on() -> None:
    arm = Arm(wrench=np.zeros(6))
    arm.period()
    weight = -arm.state.sense.tool_load(MODEL, forward_kinematics(MODEL, UNFOLD), MOON)
    arm.wrench = -weight
    arm.jog(along((0, 1, 0)), 60)
    assert arm.report.doing.state == "moving", arm.report.doing.reason
    arm.wrench = -weight + np.array([0.0, 0.0, 25.0, 0.0, 0.0, 0.0])
    arm.period()
    assert arm.report.doing.state == "failed" and "the tool pressed with" in arm.report.doing.reason
    arm.wrench = -weight
    arm.jog(along((0, 1, 0)), 40)
    assert "no jog until the commands pause for 0.5 s" in arm.refusal
    arm.rest(30)
    arm.jog(along((0, -1, 0)), 20)
    assert arm.report.name == "jog" and arm.report.doing.state == "moving"


def test_less_power_makes_it_slower() -> None:
    free, poor = Arm(), Arm()
    free.jog(along((0, 0, 1)), 150)
    poor.granted = 0.5 * max(free.power)
    poor.jog(along((0, 0, 1)), 150)
    assert "slowed: the arm would draw" in poor.report.doing.reason
    assert max(poor.power) <= poor.granted * 1.02
    ways = [tips(np.array(arm.rows))[-1][2] - tips(np.array(arm.rows))[0][2] for arm in (free, poor)]
    assert 0.2 * ways[0] < ways[1] < 0.9 * ways[0]
