"""The step that says whatever an operator may say, right or wrong."""

import math

import numpy as np
import pytest
from pydantic import ValidationError

from sojourn_config.steps import StepConfig
from sojourn_contract.goal_topics import GOAL_TOPICS
from sojourn_contract.values import DiagnosticArray, DiagnosticStatus, Path
from sojourn_operator.steps.say import SayStep, message_of
from sojourn_operator.steps.step import LEAD_NS, RunFacts, View

SECOND = 1_000_000_000


def view(now: int) -> View:
    return View(SECOND, now, {}, RunFacts())


def test_what_is_wrong_is_said_as_it_stands() -> None:
    said = SayStep(to="/arm/task", fields={"status": [{"name": "dig", "values": {"depth": "deep"}}]}).say(view(SECOND))
    assert said == DiagnosticArray(SECOND + LEAD_NS, (DiagnosticStatus("dig", (("depth", "deep"),)),))
    twist = message_of("geometry_msgs/TwistStamped", {"frame": "", "linear": ["nan", 0, 0], "angular": [0, 0, 0]}, 7)
    assert twist.stamp == 7 and math.isnan(twist.linear[0]) and twist.linear.dtype == np.float64


def test_messages_within_messages_are_made_and_stamped() -> None:
    path = message_of("nav_msgs/Path", {"frame": "map", "poses": [{"frame": "arc", "position": [1, 2, 3]}]}, 9)
    assert isinstance(path, Path) and path.poses[0].stamp == 9 and path.poses[0].frame == "arc"
    assert path.poses[0].position.tolist() == [1.0, 2.0, 3.0]
    motion = {"names": ["a"], "points": [{"positions": [1], "time_from_start": SECOND}]}
    assert message_of("trajectory_msgs/JointTrajectory", motion, 0).points[0].time_from_start == SECOND


def test_it_is_said_once_and_nobody_waits_for_an_answer() -> None:
    step = SayStep(to="/arm/stop", fields={}, seconds=0.3)
    assert step.role == "arm" and step.topic == "/arm/stop"
    assert step.say(view(SECOND)) is not None and step.say(view(SECOND + 100_000_000)) is None
    assert step.end(view(SECOND + 200_000_000)) is None
    assert step.end(view(SECOND + 300_000_000)) == ("done", "")


def test_every_topic_of_goals_can_be_said() -> None:
    for row in GOAL_TOPICS:
        with pytest.raises((ValueError, TypeError)):
            message_of(row.type, {"no_such_field": 1}, 0)


@pytest.mark.parametrize("number", ["nan", "inf", "-inf"])
def test_numbers_that_json_does_not_have_come_back_from_a_recorded_step(number: str) -> None:
    fields = {"frame": "base_link", "linear": [float(number), 0.0, 0.0], "angular": [0.0, 0.0, 0.0]}
    step = StepConfig.model_validate({"say": {"to": "/cmd_vel", "fields": fields}})
    recorded = step.model_dump_json()
    assert StepConfig.model_validate_json(recorded) == step
    assert step.action.fields["linear"] == [number, 0.0, 0.0]  # as the file may spell it
    np.testing.assert_array_equal(step.action.goal(view(SECOND)).linear, [float(number), 0.0, 0.0])


@pytest.mark.parametrize(
    ("to", "fields", "says"),
    [
        ("/odom", {}, "/goal_pose"),
        ("/arm/taks", {}, "did you mean /arm/task"),
        ("/goal_pose", {"frame": "map", "place": [0, 0, 0]}, "did you mean frame|position"),
        ("/goal_pose", {"position": [0, 0, 0]}, "geometry_msgs/PoseStamped: missing: frame"),
        ("/cmd_vel", {"linear": [0.1, 0, 0]}, "fields of geometry_msgs/TwistStamped: missing: frame, angular"),
        ("/arm/path", {"frame": "map", "poses": [{"position": [0, 0, 0]}]}, "nav_msgs/Path: missing: frame"),
        ("/arm/path", {"frame": "map", "poses": [7]}, "nav_msgs/Path: 7: allowed is fields by their names"),
        ("/goal_pose", {"frame": "map", "position": ["far", 0, 0]}, "far"),
    ],
)
def test_what_is_no_message_at_all_is_refused_before_a_run(to: str, fields: dict[str, object], says: str) -> None:
    with pytest.raises(ValidationError, match=says):
        SayStep(to=to, fields=fields)
