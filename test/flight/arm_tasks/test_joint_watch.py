"""A joint that dies while a task guides the tip, or while it is jogged: found, named, and planned around afterwards."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from sojourn_flight.arm.goals import JointGoal
from sojourn_flight.arm.jogging import JogCommand
from sojourn_flight.arm.tasks.requests import parse_task
from sojourn_physics.faults.acting import ActingFault, FaultyPlant
from sojourn_physics.faults.joint_seized import JointSeized

ELBOW = "arm_elbow_joint"


def seize(rover: Any, joint: str) -> None:
    """From now on it does not turn."""
    fault = JointSeized(joint=joint, at=0.0)
    rover.model = FaultyPlant(rover.model).model((ActingFault(fault, "seized"),))


@pytest.mark.parametrize("seed", range(3))
def test_a_joint_that_dies_under_a_task_is_named_and_the_others_do_the_next_goal(
    rover_arm: Callable[..., Any], seed: int
) -> None:
    """Moved down in the air, from a place of the seed's."""
    draw = np.random.default_rng(seed)
    rover = rover_arm("soil=rigid_rock", f"seed={seed + 11}")
    rover.over_ground(1.15 + draw.uniform(-0.05, 0.05), draw.uniform(-0.1, 0.1), 0.4)
    rover.period(task=parse_task("guarded_move", {"distance": 0.35, "speed": 0.05}))
    rover.run(1.0)
    seize(rover, ELBOW)
    for _ in range(600):
        if rover.report.doing.state != "moving":
            break
        rover.period()
    assert rover.report.doing.state == "failed"
    assert f"{ELBOW} does not move: held at" in rover.report.doing.reason
    rover.run(4.0)
    assert f"{ELBOW} does not move" in rover.said.failed_joints
    (found,) = rover.tasks.arm.dead
    held = rover.plant.joints[0, rover.model.reference_rows([ELBOW])[0]]
    assert found.position == pytest.approx(held, abs=0.02), "the reference has come back to where it is"
    rover.period(goal=JointGoal(("arm_azimuth_joint", "arm_elevation_joint"), (0.3, -0.8)))
    for _ in range(2000):
        rover.period()
        if rover.said.status != "moving":
            break
    assert rover.said.status == "reached", rover.said.reason


def test_a_joint_that_dies_under_a_jog_is_named(rover_arm: Callable[..., Any]) -> None:
    rover = rover_arm("soil=rigid_rock")
    seize(rover, ELBOW)
    for _ in range(1000):
        rover.period(jog=JogCommand((0.0, 0.0, -0.03), (0.0, 0.0, 0.0)))
        if rover.said.failed_joints:
            break
    assert f"{ELBOW} does not move" in rover.said.failed_joints
    rover.run(2.0)
    assert rover.log[-1]["speed"] < 0.02, "the arm rests"


def test_a_tool_that_presses_is_no_joint_that_has_died(rover_arm: Callable[..., Any]) -> None:
    """Held by the ground, whatever it presses with, no joint is taken for dead."""
    rover = rover_arm("soil=rigid_rock")
    rover.over_ground(1.2, 0.0, 0.02)
    assert rover.task("guarded_move", 20.0, force=30.0, speed=0.02).doing.state == "reached"
    rover.run(5.0)
    assert not rover.said.failed_joints and not rover.tasks.arm.dead
