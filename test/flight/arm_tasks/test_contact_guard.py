"""Contacts that nobody asked for, in the plant: felt by wrist or by torques, and yielded to; and no false alarms."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from sojourn_flight.arm.goals import ArmGoal, JointGoal, NamedGoal, PoseGoal

LEVEL = np.array([0.0, 0.0, -1.62])


def under_the_ground(rover: Any, depth: float) -> PoseGoal:
    """A place that a planner which knows of no ground takes for free."""
    down = rover.rotation().T @ np.array([0.0, 0.0, -1.0])
    return PoseGoal(tuple(rover.ground_below(1.2, 0.0) + depth * down))


def pressed(rover: Any, goal: ArmGoal, seconds: float) -> Any:
    """Size of the contact force in truth, in every period after a goal [N]."""
    start = len(rover.log)
    rover.period(goal=goal)
    assert rover.said.status == "moving", rover.said.reason
    rover.run(seconds)
    return np.linalg.norm(rover.since("force", start), axis=1)


@pytest.mark.parametrize(
    ("depth", "has_wrist", "peak"),
    [(0.03, True, 25.0), (0.1, True, 40.0), (0.03, False, 70.0)],
    ids=["at the approach's speed", "at full speed", "by torques alone"],
)
def test_the_arm_gives_way_to_a_rock_that_nobody_saw(
    rover_arm: Callable[..., Any], depth: float, has_wrist: bool, peak: float
) -> None:
    """It used to press with 95 N, to hold 89 N for good, and to say that it had reached its goal."""
    rover = rover_arm("soil=rigid_rock")
    before = rover.output.contacts[:6, 8].copy()
    rover.has_wrist = has_wrist
    force = pressed(rover, under_the_ground(rover, depth), 12.0)
    touch = int(np.argmax(force > 0.5))
    assert 0 < touch < len(force) - 200
    assert force.max() < peak
    assert force[touch + 200 :].max() < (3.0 if has_wrist else 20.0), (
        "torques tell no less than what the model may err by"
    )
    assert rover.report.doing.state == "failed" and "gives way" in rover.report.doing.reason
    if has_wrist:
        assert np.min(rover.output.contacts[:6, 8] / before) > 0.9


@pytest.mark.parametrize("depth", [0.03, 0.1], ids=["at the approach's speed", "at full speed"])
def test_the_arm_gives_way_to_loose_soil(rover_arm: Callable[..., Any], depth: float) -> None:
    """More slowly than to rock: soil that was pressed down comes back up under the tool."""
    rover = rover_arm("soil=lunar_nominal")
    force = pressed(rover, under_the_ground(rover, depth), 12.0)
    touch = int(np.argmax(force > 0.5))
    assert 0 < touch < len(force) - 200
    assert force.max() < 20.0
    assert force[touch + 100 :].max() < 9.0 and force[touch + 250 :].max() < 5.0, "9 N after 5 s with a stiffer law"
    assert rover.report.doing.state == "failed" and "gives way" in rover.report.doing.reason


def test_after_it_gave_way_the_arm_goes_where_it_is_told(rover_arm: Callable[..., Any]) -> None:
    rover = rover_arm("soil=rigid_rock")
    pressed(rover, under_the_ground(rover, 0.03), 12.0)
    pressed(rover, NamedGoal("unfold"), 12.0)
    assert rover.said.status == "reached" and rover.report is None


def test_an_arm_that_presses_on_purpose_may_leave(rover_arm: Callable[..., Any]) -> None:
    """What was felt when the motion began is no contact of that motion."""
    rover = rover_arm("soil=rigid_rock")
    rover.over_ground(1.2, 0.0, 0.02)
    held = rover.task("guarded_move", 20.0, force=40.0, speed=0.01)
    assert held.doing.state == "reached" and np.linalg.norm(rover.log[-1]["force"]) > 35.0
    pressed(rover, NamedGoal("unfold"), 12.0)
    assert rover.said.status == "reached", rover.said.reason


@pytest.mark.parametrize("has_wrist", [True, False])
def test_no_free_motion_is_taken_for_a_contact(rover_arm: Callable[..., Any], has_wrist: bool) -> None:
    rover = rover_arm("soil=rigid_rock")
    rover.has_wrist = has_wrist
    generator = np.random.default_rng(5)
    goals: list[ArmGoal] = [NamedGoal("stow"), NamedGoal("unfold")]
    names, at = rover.scenario.arm.joint_names, np.array(rover.scenario.arm.named_poses["unfold"])
    for _ in range(3):
        goals.append(JointGoal(names, tuple(at + generator.uniform(-0.5, 0.5, 5) * [1.0, 0.4, 0.4, 1.0, 1.0])))
    largest = 0.0
    for goal in goals:
        rover.period(goal=goal)
        for _ in range(1500):
            rover.period()
            largest = max(largest, float(np.max(np.abs(rover.tasks.observer.residual))))
            if rover.said.status != "moving":
                break
        assert rover.said.status == "reached", (rover.said, rover.report)
    assert largest < 0.7 * 0.05 * 60.0, "what the model does not know is well within what is allowed for it"


@pytest.mark.parametrize("force", [0.0, 30.0])
def test_the_loads_of_the_wheels_are_those_of_the_plant(rover_arm: Callable[..., Any], force: float) -> None:
    rover = rover_arm("soil=rigid_rock")
    rover.over_ground(1.2, 0.0, 0.02)
    if force:
        rover.task("guarded_move", 20.0, force=force, speed=0.01)
    rover.run(3.0)
    gravity = rover.rotation().T @ LEVEL
    loads = rover.wheel_loads(
        rover.plant.joints[0, rover.model.reference_rows(rover.scenario.arm.joint_names)], gravity
    )
    pressing = rover.rotation().T @ np.asarray(rover.log[-1]["force"])
    predicted, true = loads.rest + loads.per_force @ pressing, rover.output.contacts[:6, 8]
    assert np.sum(predicted) == pytest.approx(np.sum(true), rel=0.01)
    np.testing.assert_allclose(predicted, true, atol=0.07 * np.mean(true))
    _, share = loads.least_share(pressing)
    assert share == pytest.approx(1.0 if not force else np.min(predicted / loads.rest), abs=1e-9)


def test_a_tool_that_all_but_lifts_a_wheel_gives_way(rover_arm: Callable[..., Any]) -> None:
    """70 N on the tip take half of the load of the front wheels of a rover of 180 kg on the Moon."""
    rover = rover_arm("soil=rigid_rock", "arm.contact.least_wheel_load=0.7")
    rover.over_ground(1.2, 0.0, 0.02)
    gravity = rover.rotation().T @ LEVEL
    columns = rover.model.reference_rows(rover.scenario.arm.joint_names)
    rover = replace(rover, loads=rover.wheel_loads(rover.plant.joints[0, columns], gravity))
    report = rover.task("guarded_move", 20.0, force=60.0, speed=0.01)
    assert report.doing.state == "failed" and "of its load (at least 70 %)" in report.doing.reason, report
    rover.run(6.0)
    assert np.linalg.norm(rover.log[-1]["force"]) < 3.0
