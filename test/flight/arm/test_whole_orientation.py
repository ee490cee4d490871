"""Goals that ask for the whole orientation of the tip, roll about the tool included."""

import math
from dataclasses import dataclass

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sojourn_config.arm_config import ArmConfig
from sojourn_config.load import load_params
from sojourn_config.scenario import load_scenario
from sojourn_flight.arm.collision import check_posture
from sojourn_flight.arm.goals import PoseGoal, pose_goal, pose_target
from sojourn_flight.arm.kinematics import forward_kinematics, inverse_kinematics
from sojourn_flight.arm.model import ArmModel, build_arm_model
from sojourn_flight.arm.params import ArmParams
from sojourn_flight.arm.planning import plan_goal
from sojourn_flight.arm.refusal import GoalRefusedError
from sojourn_flight.arm.trajectory import at_rest
from sojourn_flight.arm.ways import Departure


@dataclass
class Arm:
    params: ArmParams
    model: ArmModel


@pytest.fixture(scope="module")
def puma() -> Arm:
    scenario = load_scenario("puma560_course")
    return Arm(scenario.carried_arm(), build_arm_model(scenario.urdf_xml, scenario.carried_arm()))


def test_the_quaternion_of_a_goal_is_the_whole_orientation_or_a_direction_as_the_arm_has_it(puma: Arm) -> None:
    quaternion = Rotation.from_rotvec([0.3, -0.5, 1.1]).as_quat()
    whole = pose_goal(puma.params, [0.4, 0.1, 0.6], quaternion)
    _, aim = pose_target(whole)
    np.testing.assert_allclose(aim, Rotation.from_quat(quaternion).as_matrix(), atol=1e-12)
    explorer = load_params("arms", "explorer_arm", ArmConfig)
    _, aim = pose_target(pose_goal(explorer, [0.4, 0.1, 0.6], quaternion))
    np.testing.assert_allclose(aim, Rotation.from_quat(quaternion).apply([0.0, 0.0, 1.0]), atol=1e-12)
    for free in ([0.0, 0.0, 0.0, 1.0], [0.0] * 4):
        assert pose_goal(puma.params, [0.4, 0.1, 0.6], free) == PoseGoal((0.4, 0.1, 0.6))


def test_every_reachable_pose_of_six_joints_is_found_with_its_roll(puma: Arm) -> None:
    generator = np.random.default_rng(5)
    start = np.array(puma.params.named_poses["unfold"])
    for _ in range(100):
        wanted = forward_kinematics(puma.model, generator.uniform(puma.model.lower, puma.model.upper))
        found = inverse_kinematics(puma.params, puma.model, wanted.position, wanted.rotation, start)
        assert found.status == "solved"
        for solution in found.solutions:
            there = forward_kinematics(puma.model, solution)
            assert np.linalg.norm(there.position - wanted.position) < 1e-5
            turn = Rotation.from_matrix(wanted.rotation.T @ there.rotation).magnitude()
            assert turn < 2e-4


def test_a_plan_ends_with_the_orientation_that_was_asked_for(puma: Arm) -> None:
    generator, start = np.random.default_rng(6), np.array(puma.params.named_poses["unfold"])
    planned = 0
    for _ in range(20):
        posture = generator.uniform(puma.model.lower, puma.model.upper)
        if check_posture(puma.params, puma.model, posture, None) is not None:
            continue
        wanted = forward_kinematics(puma.model, posture)
        quaternion = tuple(Rotation.from_matrix(wanted.rotation).as_quat())
        goal = PoseGoal(tuple(wanted.position), orientation=quaternion)
        try:
            plan = plan_goal(puma.params, puma.model, goal, Departure(at_rest(start), start))
        except GoalRefusedError as error:
            assert "collision" in str(error)
            continue
        there = forward_kinematics(puma.model, plan.target)
        assert Rotation.from_matrix(wanted.rotation.T @ there.rotation).magnitude() < 2e-4
        planned += 1
    assert planned > 10


def test_out_of_reach_in_orientation_alone_is_said(puma: Arm) -> None:
    # a shorter range of the wrist: the flange, upright over the shoulder, cannot turn its back on it
    stretched = forward_kinematics(puma.model, np.array([0.0, 0.8, -1.57, 0.0, 0.0, 0.0]))
    away = stretched.rotation @ Rotation.from_rotvec([0.0, math.pi, 0.0]).as_matrix()
    beyond = stretched.position * np.array([0.0, 0.0, 1.0]) + np.array([0.85, 0.15, 0.0])
    found = inverse_kinematics(puma.params, puma.model, beyond, away, np.zeros(6))
    assert found.status in ("unreachable", "limits")
    assert "deg" in found.message


def test_a_quaternion_of_no_length_is_refused() -> None:
    with pytest.raises(GoalRefusedError, match="has a length"):
        pose_target(PoseGoal((0.4, 0.0, 0.6), orientation=(0.0, 0.0, 0.0, 0.0)))
