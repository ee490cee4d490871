"""The scripted operator without ROS: which goal it sends when, and what it makes of the answers."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_config.scenario import load_scenario
from sojourn_contract.stamps import CONTROL_PERIOD_NS, NANOSECONDS
from sojourn_contract.topics import topic
from sojourn_contract.values import UPRIGHT, Odometry
from sojourn_operator.scenario_steps import script_steps
from sojourn_operator.script import GoalToSend, OperatorScript, StepResult, results_as_data, results_from_data
from sojourn_operator.steps.arm_jog import ArmJogStep
from sojourn_operator.steps.arm_joints import ArmJointsStep
from sojourn_operator.steps.arm_path import ArmPathStep
from sojourn_operator.steps.arm_task import ArmTaskStep
from sojourn_operator.steps.arm_to import ArmPoseStep
from sojourn_operator.steps.arm_to_ground import ArmGroundStep
from sojourn_operator.steps.drive_route import DriveRouteStep
from sojourn_operator.steps.drive_to import DriveGoalStep
from sojourn_operator.steps.step import FINAL_STATES, LEAD_NS, GoalReport, OperatorStep, RunFacts
from sojourn_operator.steps.wait import WaitStep

LOOK = 5 * CONTROL_PERIOD_NS
DRIVE, ARM, REACH = DriveGoalStep(x=3.0, y=1.0), ArmJointsStep(name="unfold"), ArmPoseStep(x=1.0, y=0.0, z=0.0)
ROUTE = DriveRouteStep.model_validate({"points": [{"x": 1.0, "y": 0.0}, {"x": 2.0, "y": 0.5}], "yaw": 0.5})
ALONG = ArmPathStep.model_validate(
    {
        "frame": "map",
        "points": [
            {"x": 1.0, "y": 0.2, "z": 0.0, "on_arc": True},
            {"x": 1.0, "y": 0.0, "z": 0.0, "orientation": (0, 1, 0, 0)},
        ],
    }
)


class Operator:
    """A script and how far it is."""

    def __init__(self, script: OperatorScript, done: Sequence[StepResult] = ()) -> None:
        self.script, self.state = script, script.begin(done)

    def look(self, now: int, reports: dict[str, GoalReport]) -> GoalToSend | None:
        self.state, goal = self.script.look(self.state, now, reports)
        return goal

    @property
    def results(self) -> list[StepResult]:
        return list(self.state.results)

    @property
    def finished(self) -> bool:
        return self.state.finished

    @property
    def succeeded(self) -> bool:
        return self.script.has_succeeded(self.state)


def script(*steps: OperatorStep, limit_s: float = 100.0, timeout_s: float | None = None) -> Operator:
    return Operator(OperatorScript([(step, timeout_s) for step in steps], limit_s))


def answer(goal: GoalToSend | None, state: str, reason: str = "") -> dict[str, GoalReport]:
    """A report of drive or arm about a goal."""
    assert goal is not None
    return {topic(goal.topic).subscribers[0]: GoalReport(state, goal.message.stamp, reason)}


def test_goals_go_out_one_after_another_five_periods_ahead() -> None:
    operator = script(DRIVE, ARM)
    first = operator.look(LOOK, {})
    assert first is not None and (first.topic, first.message.stamp) == ("/goal_pose", LOOK + LEAD_NS)
    assert tuple(first.message.position) == (3.0, 1.0, 0.0) and not first.message.orientation.any()
    assert LEAD_NS == 5 * CONTROL_PERIOD_NS
    assert operator.look(2 * LOOK, answer(first, "moving")) is None
    second = operator.look(3 * LOOK, answer(first, "reached"))
    assert second is not None and (second.topic, second.message.stamp) == ("/arm/joint_goal", 3 * LOOK + LEAD_NS)
    assert second.message.frame == "unfold" and not second.message.names
    assert not operator.finished
    assert operator.look(4 * LOOK, answer(second, "reached")) is None
    assert operator.finished and operator.succeeded
    assert [result.outcome for result in operator.results] == ["reached", "reached"]
    assert operator.results[0].start_s == pytest.approx(0.1) and operator.results[0].end_s == pytest.approx(0.3)


def test_each_kind_of_goal_has_its_topic() -> None:
    topics = []
    for step in (DRIVE, ROUTE, REACH, ARM, ALONG, JOG, ArmTaskStep(name="tare")):
        goal = script(step).look(LOOK, {})
        assert goal is not None
        topics.append(goal.topic)
    assert topics == [
        "/goal_pose",
        "/waypoints",
        "/arm/goal_pose",
        "/arm/joint_goal",
        "/arm/path",
        "/arm/cmd_vel",
        "/arm/task",
    ]


def sent_at_once(step: OperatorStep, *joints: str) -> Any:
    """The message with which a step begins, for an arm of these joints."""
    alone = OperatorScript([(step, None)], 100.0, RunFacts(joints))
    _, goal = alone.look(alone.begin(), LOOK, {})
    assert goal is not None
    return goal.message


def test_a_route_asks_for_its_heading_at_the_last_point_alone() -> None:
    route = sent_at_once(ROUTE)
    assert [tuple(pose.position) for pose in route.poses] == [(1.0, 0.0, 0.0), (2.0, 0.5, 0.0)]
    assert not route.poses[0].orientation.any()
    assert 2.0 * math.atan2(*route.poses[1].orientation[2:]) == pytest.approx(0.5)


def test_joint_positions_go_with_the_names_of_the_arm() -> None:
    goal = sent_at_once(ArmJointsStep(positions=(0.1, -0.2)), "shoulder", "elbow")
    assert (goal.names, tuple(goal.position), goal.frame) == (("shoulder", "elbow"), (0.1, -0.2), "")


def test_the_ground_has_to_be_there_for_a_step_that_looks_at_it() -> None:
    here = Odometry(LOOK, "map", "base_link", np.zeros(3), UPRIGHT, np.zeros(3), np.zeros(3))
    alone = OperatorScript([(ArmGroundStep(x=1.0, y=0.0), None)], 100.0)
    with pytest.raises(ValueError, match="looks_at_ground"):
        alone.look(alone.begin(), LOOK, {}, here)


def test_a_step_that_looks_at_the_ground_waits_until_it_is_known_where_from() -> None:
    alone = OperatorScript([(ArmGroundStep(x=1.0, y=0.0), None)], 100.0)
    state, goal = alone.look(alone.begin(), LOOK, {}, None)
    assert (state, goal) == (alone.begin(), None)


def test_a_path_of_the_tip_as_a_message_has_its_arcs_marked() -> None:
    path = sent_at_once(ALONG)
    assert (path.frame, path.stamp) == ("map", LOOK + LEAD_NS)
    assert [pose.frame for pose in path.poses] == ["arc", "map"]
    assert [tuple(pose.position[:2]) for pose in path.poses] == [(1.0, 0.2), (1.0, 0.0)]
    assert (path.poses[0].orientation[3], path.poses[1].orientation[1]) == (1.0, 1.0)


JOG = ArmJogStep(linear=(0.02, 0.0, 0.0), angular=(0.0, 0.0, 0.1), seconds=0.5, frame="map")


def test_a_jog_is_kept_up_until_its_end_and_then_zero_until_the_arm_rests() -> None:
    operator = script(JOG, ARM)
    sent = [operator.look(k * LOOK, {"arm": GoalReport("moving", k * LOOK)}) for k in range(1, 9)]
    twists = [goal.message for goal in sent if goal]
    assert [twist.stamp for twist in twists] == [k * LOOK + LEAD_NS for k in range(1, 9)]
    assert [bool(twist.linear.any()) for twist in twists] == 5 * [True] + 3 * [False]
    assert [(t.frame, *t.linear, *t.angular) for t in twists[4:6]] == [
        ("map", 0.02, 0.0, 0.0, 0.0, 0.0, 0.1),
        ("map", 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    ]
    early = {"arm": GoalReport("stopped", 5 * LOOK + LEAD_NS)}  # of a command before the end
    assert operator.look(9 * LOOK, early) is not None and not operator.results
    following = operator.look(10 * LOOK, answer(sent[-1], "stopped"))
    assert following is not None and following.topic == "/arm/joint_goal"
    assert (operator.results[0].outcome, operator.results[0].end_s) == ("jogged", pytest.approx(1.0))
    assert operator.results[0].good


def test_a_scenario_may_jog() -> None:
    step = "{arm_jog: {linear: [0.02, 0.0, 0.0], frame: arm_tip_link, seconds: 3.0}, timeout_s: 9.0}"
    ((jog, limit),) = script_steps(load_scenario("lunar_sample", [f"steps=[{step}]"]))
    assert jog == ArmJogStep(linear=(0.02, 0.0, 0.0), seconds=3.0, frame="arm_tip_link") and limit == 9.0


@pytest.mark.parametrize("state", ["refused", "failed"])
def test_a_jog_that_is_refused_or_meets_something_ends_the_script(state: str) -> None:
    operator = script(JOG, ARM)
    operator.look(LOOK, {"arm": GoalReport(state, LOOK)})  # of an earlier goal
    second = operator.look(2 * LOOK, {"arm": GoalReport(state, LOOK)})
    assert second is not None and not operator.results
    assert operator.look(3 * LOOK, answer(second, state, "in words")) is None
    assert operator.finished and not operator.succeeded
    assert (operator.results[0].outcome, operator.results[0].reason) == (state, "in words")


def test_an_answer_about_another_goal_ends_nothing() -> None:
    operator = script(DRIVE)
    goal = operator.look(LOOK, {})
    assert goal is not None
    for stamp in (0, goal.message.stamp - 1, goal.message.stamp + 1):
        operator.look(2 * LOOK, {"drive": GoalReport("reached", stamp)})
        assert operator.results == []
    operator.look(3 * LOOK, {"arm": GoalReport("reached", goal.message.stamp)})
    assert operator.results == []


@pytest.mark.parametrize("state", ["refused", "stopped", "failed"])
def test_a_step_that_fails_ends_the_script_with_its_reason(state: str) -> None:
    operator = script(DRIVE, ARM)
    goal = operator.look(LOOK, {})
    assert operator.look(2 * LOOK, answer(goal, state, "a rock")) is None
    assert operator.finished and not operator.succeeded
    assert [(result.outcome, result.reason) for result in operator.results] == [(state, "a rock")]
    assert operator.look(3 * LOOK, {}) is None


def test_a_wait_sends_nothing_and_lasts_as_long_as_it_says() -> None:
    operator = script(WaitStep(1.0), DRIVE)
    assert operator.look(LOOK, {}) is None
    stamps = [LOOK * number for number in range(2, 20)]
    goals = {stamp: operator.look(stamp, {}) for stamp in stamps}
    sent = [stamp for stamp, goal in goals.items() if goal is not None]
    assert sent == [LOOK + NANOSECONDS]
    assert operator.results[0].outcome == "waited"


def test_a_step_without_an_answer_times_out() -> None:
    operator = script(DRIVE, ARM, timeout_s=1.0)
    operator.look(LOOK, {})
    operator.look(LOOK + NANOSECONDS - LOOK, {})
    assert operator.results == []
    operator.look(LOOK + NANOSECONDS, {})
    assert operator.results[0].outcome == "timed out" and "1 s" in operator.results[0].reason
    assert operator.finished


def test_the_limit_of_the_run_ends_the_script() -> None:
    operator = script(DRIVE, limit_s=2.0)
    operator.look(LOOK, {})
    operator.look(2 * NANOSECONDS, {})
    assert operator.finished and operator.results[0].outcome == "timed out"
    late = script(DRIVE, limit_s=2.0)
    assert late.look(2 * NANOSECONDS, {}) is None
    assert late.finished and not late.succeeded


def test_an_empty_script_is_done_at_once() -> None:
    operator = script()
    assert operator.look(LOOK, {}) is None
    assert operator.finished and operator.succeeded


def test_an_operator_that_was_started_again_goes_on_where_the_first_stopped() -> None:
    first = script(DRIVE, ARM)
    goal = first.look(LOOK, {})
    first.look(2 * LOOK, answer(goal, "reached"))
    done = results_from_data(results_as_data(first.results))
    assert done == first.results
    second = Operator(first.script, done)
    resumed = second.look(20 * LOOK, {})
    assert resumed is not None and resumed.topic == "/arm/joint_goal"
    second.look(21 * LOOK, answer(resumed, "reached"))
    assert second.succeeded


def test_an_operator_started_again_after_a_failure_stays_ended() -> None:
    again = Operator(OperatorScript([(DRIVE, None)], 10.0), [StepResult("drive", "refused", "", 0.0, 1.0)])
    assert again.look(LOOK, {}) is None
    assert again.finished and not again.succeeded


_states = st.sampled_from(["idle", "moving", *FINAL_STATES])
_actions = st.sampled_from([DRIVE, ARM, REACH, WaitStep(0.3)])


@settings(max_examples=60, deadline=None)
@given(steps=st.lists(_actions, max_size=5), answers=st.lists(_states, min_size=1, max_size=60))
def test_whatever_is_answered_goals_are_in_order_and_the_script_ends(
    steps: list[OperatorStep], answers: list[str]
) -> None:
    """Never two goals at once, every goal later than the last, nothing after the end, at most one bad result."""
    operator = script(*steps, limit_s=30.0, timeout_s=2.0)
    reports: dict[str, GoalReport] = {}
    goals: list[GoalToSend] = []
    now = 0
    while not operator.finished and now < 40 * NANOSECONDS:
        now += LOOK
        goal = operator.look(now, reports)
        if goal is not None:
            goals.append(goal)
        if goals:
            state = answers[(now // LOOK) % len(answers)]
            reports.update(answer(goals[-1], state))
    assert operator.finished
    stamps = [goal.message.stamp for goal in goals]
    assert stamps == sorted(set(stamps))
    wanted = [step.topic for step in steps if not isinstance(step, WaitStep)]
    assert [goal.topic for goal in goals] == wanted[: len(goals)]
    assert all(result.good for result in operator.results[:-1])
    assert operator.succeeded == (len(operator.results) == len(steps) and all(r.good for r in operator.results))
    assert operator.look(now + LOOK, reports) is None
