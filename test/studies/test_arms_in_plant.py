"""Arms on fixed bases with their laws in the plant, without ROS: places reached in truth, and refused goals."""

from functools import lru_cache

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sojourn_config.scenario import load_scenario
from sojourn_flight.arm.goals import ArmGoal, JointGoal, PoseGoal, pose_goal
from sojourn_flight.arm.kinematics import forward_kinematics
from sojourn_operator.steps.arm_joints import ArmJointsStep
from sojourn_operator.steps.arm_to import ArmPoseStep
from sojourn_studies.measure_arm import ANGLE_DEG, DISTANCE_M, Bench


@lru_cache
def bench(name: str, *overrides: str) -> Bench:
    return Bench(load_scenario(f"{name}_course", overrides))


def goals_of(name: str) -> list[ArmGoal]:
    """The joint positions and the poses of its course."""
    machine, goals = bench(name), []
    for step in load_scenario(f"{name}_course").config.steps:
        action = step.action
        if isinstance(action, ArmJointsStep) and action.positions is not None:
            goals.append(JointGoal(machine.params.joint_names, action.positions))
        elif isinstance(action, ArmPoseStep):
            place = (action.x, action.y, action.z)
            goals.append(pose_goal(machine.params, place, action.orientation))
    return goals


@pytest.mark.parametrize("name", ["scara", "cartesian", "srms", "explorer_arm"])  # the others run over the topics
def test_it_reaches_joint_positions_and_poses_in_truth(name: str) -> None:
    machine, goals = bench(name), goals_of(name)
    assert goals
    for goal in goals[:2]:
        answer = machine.go(goal)
        assert answer.status == "reached", answer.reason
        if isinstance(goal, JointGoal):
            np.testing.assert_allclose(machine.true_joints, goal.positions, atol=2.0 * machine.params.joint_tolerance)
        elif isinstance(goal, PoseGoal) and goal.orientation is not None:
            tip = forward_kinematics(machine.arm, machine.true_joints)
            assert np.linalg.norm(tip.position - goal.position) < DISTANCE_M
            turn = Rotation.from_quat(goal.orientation).inv() * Rotation.from_matrix(tip.rotation)
            assert np.degrees(turn.magnitude()) < ANGLE_DEG


def test_on_a_slope_gravity_of_the_tilted_base_is_made_up_for() -> None:
    tilted = bench("puma560", "terrain.kind=slope", "terrain.slope_deg=15", "terrain.slope_direction_deg=90")
    goal = PoseGoal((0.45, 0.25, 0.6), orientation=(0.0, 1.0, 0.0, 0.0))
    assert tilted.go(goal).status == "reached"
    tip = forward_kinematics(tilted.arm, tilted.true_joints)
    assert np.linalg.norm(tip.position - goal.position) < DISTANCE_M


@pytest.mark.parametrize(
    ("name", "goal", "words"),
    [
        ("scara", Rotation.from_euler("xy", [180, 20], degrees=True), ["deg", "not with this orientation"]),
        ("cartesian", Rotation.from_euler("xz", [180, 30], degrees=True), ["deg", "not with this orientation"]),
        ("explorer_arm", "arm_elbow_joint", ["arm_elbow_joint = 9.0000", "rad"]),
        ("cartesian", "arm_z_joint", ["arm_z_joint = 9.0000 is out of its limits 0.0000 to 0.6000 m"]),
    ],
)
def test_what_an_arm_cannot_do_is_refused_with_the_reason(name: str, goal: Rotation | str, words: list[str]) -> None:
    machine = bench(name)
    if isinstance(goal, str):
        asked: ArmGoal = JointGoal((goal,), (9.0,))
    else:
        place = forward_kinematics(machine.arm, np.array(machine.params.named_poses["unfold"])).position
        asked = pose_goal(machine.params, place.tolist(), goal.as_quat().tolist())
    answer = machine.period(asked)
    assert answer.status == "refused"
    for word in words:
        assert word in answer.reason
