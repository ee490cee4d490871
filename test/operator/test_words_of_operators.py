"""Steps that are no goal to wait for: velocities, words that are said once, and a step that is begun and left."""

from typing import Any

import numpy as np
import pytest

from sojourn_config.errors import ConfigError
from sojourn_config.scenario import load_scenario
from sojourn_config.steps import StepConfig
from sojourn_contract.heartbeat import status_values
from sojourn_contract.stamps import CONTROL_PERIOD_NS, NANOSECONDS
from sojourn_operator.scenario_steps import needed_roles, script_steps
from sojourn_operator.script import OperatorScript, ScriptState
from sojourn_operator.steps.step import LEAD_NS, GoalReport, RunFacts

LOOK = 5 * CONTROL_PERIOD_NS
JOINTS = tuple(f"joint_{number}" for number in range(5))


def step(words: dict[str, Any]) -> Any:
    return StepConfig.model_validate(words).action


def said(words: dict[str, Any], looks: int, reports: dict[str, GoalReport] | None = None) -> tuple[list[Any], Any]:
    """What a step says at its looks, None where nothing, until it ends; and the result of the first step."""
    script = OperatorScript([(step(words), None)], 1000.0, RunFacts(JOINTS))
    state: ScriptState = script.begin()
    found = []
    for number in range(1, looks + 1):
        state, goal = script.look(state, number * LOOK, reports or {})
        if state.results:
            return found, state.results[0]
        found.append(goal)
    return found, None


def test_a_velocity_is_said_again_and_then_no_more() -> None:
    """It stops coming: no word brings the machine to rest but the drive's own time-out."""
    goals, result = said({"drive_velocity": {"forward": 0.5, "left": -0.1, "turn": 0.2, "seconds": 1.0}}, 100)
    assert [goal is not None for goal in goals] == [True] * 10 + [False] * 20
    assert all(
        goal.topic == "/cmd_vel" and goal.message.stamp == LOOK * (n + 1) + LEAD_NS for n, goal in enumerate(goals[:10])
    )
    assert goals[0].message.linear.tolist() == [0.5, -0.1, 0.0] and goals[0].message.angular.tolist() == [0.0, 0.0, 0.2]
    assert result.outcome == "jogged" and result.end_s == pytest.approx(3.1)


def test_a_velocity_that_is_refused_ends_at_once() -> None:
    refused = {"drive": GoalReport("refused", LOOK + LEAD_NS, "the arm is out")}
    goals, result = said({"drive_velocity": {"forward": 0.5, "seconds": 1.0}}, 100, refused)
    assert len(goals) == 1 and (result.outcome, result.reason) == ("refused", "the arm is out")
    before = {"drive": GoalReport("refused", LEAD_NS, "another")}
    assert said({"drive_velocity": {"forward": 0.5, "seconds": 1.0}}, 100, before)[1].outcome == "jogged"


@pytest.mark.parametrize(
    ("words", "topic"),
    [
        ({"arm_stop": {}}, "/arm/stop"),
        ({"place": {"x": 1.0, "y": 2.0, "yaw": 0.5}}, "/initialpose"),
        ({"drive_question": {"points": [{"x": 1.0, "y": 2.0}]}}, "/drive/question"),
        ({"power_request": {"loads": {"cameras": "off"}}}, "/power/request"),
    ],
)
def test_a_word_is_said_once(words: dict[str, Any], topic: str) -> None:
    goals, result = said(words, 100)
    assert [None if goal is None else goal.topic for goal in goals] == [topic] + [None] * 11
    assert goals[0].message.stamp == LOOK + LEAD_NS and result.outcome == "done"


def test_a_word_says_what_the_file_says() -> None:
    (request, *_), _ = said({"power_request": {"loads": {"cameras": "off", "science": "on"}}}, 1)
    assert status_values(request.message) == {"cameras": "off", "science": "on"}
    (place, *_), _ = said({"place": {"x": 1.0, "y": 2.0, "yaw": 0.5, "within": 0.1}}, 1)
    assert place.message.position.tolist() == [1.0, 2.0, 0.0]
    assert np.diag(place.message.covariance.reshape(6, 6)) == pytest.approx([0.01, 0.01, 0.0, 0.0, 0.0, 0.01])
    (question, *_), _ = said({"drive_question": {"points": [{"x": 1.0, "y": 2.0}, {"x": 3.0, "y": 0.0}]}}, 1)
    assert [pose.position.tolist() for pose in question.message.poses] == [[1.0, 2.0, 0.0], [3.0, 0.0, 0.0]]


def test_a_trajectory_has_its_times() -> None:
    points = [{"positions": [0.1] * 5, "at": 1.5}, {"positions": [0.2] * 5, "at": 3.0}]
    (goal, *_), _ = said({"arm_trajectory": {"points": points}}, 1)
    assert goal.topic == "/arm/joint_trajectory" and goal.message.names == JOINTS
    assert [point.time_from_start for point in goal.message.points] == [3 * NANOSECONDS // 2, 3 * NANOSECONDS]
    assert goal.message.points[1].positions.tolist() == [0.2] * 5


def test_a_step_that_is_begun_is_left_after_its_time() -> None:
    words = {"begin": {"step": {"drive_to": {"x": 1.0, "y": 0.0}}, "seconds": 2.0}}
    goals, result = said(words, 100, {"drive": GoalReport("failed", LOOK + LEAD_NS)})
    assert goals[0].topic == "/goal_pose" and goals[1:] == [None] * 19
    assert result.outcome == "done" and result.step.startswith("begin: drive to")


def test_a_step_that_is_begun_needs_its_role() -> None:
    begun = "steps=[{begin: {step: {arm_joints: {name: unfold}}, seconds: 2.0}}]"
    scenario = load_scenario("flat_drive", [begun])
    assert needed_roles(scenario) == ("arm",) and script_steps(scenario)[0][0].topic == "/arm/joint_goal"


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("{begin: {step: {arm_joints: {name: wave}}, seconds: 2.0}}", "wave"),
        ("{begin: {step: {drive_to: {x: 1.0, y: 0.0}, timeout_s: 3.0}, seconds: 2.0}}", "nobody waits"),
        ("{begin: {step: {drive_to: {x: 1000.0, y: 0.0}}, seconds: 2.0}}", "off the terrain"),
        ("{begin: {step: {dance: {}}, seconds: 2.0}}", "dance"),
        ("{arm_trajectory: {points: [{positions: [0.1], at: 1.0}]}}", "has 1 values"),
        (
            "{arm_trajectory: {points: [{positions: [0, 0, 0, 0, 0], at: 2.0}, {positions: [0, 0, 0, 0, 1], at: 1}]}}",
            "later than the one before",
        ),
        ("{power_request: {loads: {cameras: perhaps}}}", "loads.cameras"),
        ("{power_request: {loads: {}}}", "loads"),
        ("{drive_velocity: {forward: 0.1}}", "seconds"),
        ("{place: {x: 0.0, y: 0.0}}", "yaw"),
        ("{arm_stop: {hard: true}}", "hard"),
    ],
)
def test_a_mistake_is_told_before_the_run(text: str, told: str) -> None:
    with pytest.raises(ConfigError, match=told):
        load_scenario("flat_drive", [f"steps=[{text}]"])
