"""Kinematics by independent routes: finite differences, round trips, the rotation library of scipy."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from sojourn_flight.arm.kinematics import (
    direction_from_quaternion,
    forward_kinematics,
    inverse_kinematics,
)
from sojourn_flight.arm.model import build_arm_model
from sojourn_flight.arm.params import ArmParams
from sojourn_flight.arm.planning import solve_pose
from sojourn_machine.errors import InvalidValueError

SEEDS = st.integers(min_value=0, max_value=2**32 - 1)


def _check_jacobian(model: Any, posture: Any) -> None:
    pose = forward_kinematics(model, posture)
    h = 1e-6
    for i in range(model.joint_count):
        step = np.zeros(model.joint_count)
        step[i] = h
        ahead, behind = forward_kinematics(model, posture + step), forward_kinematics(model, posture - step)
        linear = (ahead.position - behind.position) / (2.0 * h)
        angular = Rotation.from_matrix(ahead.rotation @ behind.rotation.T).as_rotvec() / (2.0 * h)
        np.testing.assert_allclose(pose.jacobian[:3, i], linear, atol=1e-8)
        np.testing.assert_allclose(pose.jacobian[3:, i], angular, atol=1e-8)


@given(seed=SEEDS)
@settings(max_examples=30, deadline=None)
def test_jacobian_is_the_derivative_of_the_pose(small: Any, explorer: Any, seed: int) -> None:
    for arm in (small, explorer):
        _check_jacobian(arm.model, arm.random_posture(np.random.default_rng(seed)))


def test_prismatic_joint_moves_along_its_axis(small_urdf: str, small_values: dict[str, Any]) -> None:
    urdf = small_urdf.replace('"fore_joint" type="revolute"', '"fore_joint" type="prismatic"')
    model = build_arm_model(urdf, ArmParams(**small_values))
    posture = np.array([0.3, -0.2, 0.1, 0.4, 0.5])
    _check_jacobian(model, posture)
    moved = forward_kinematics(model, posture + np.array([0.0, 0.0, 0.25, 0.0, 0.0])).position
    assert np.linalg.norm(moved - forward_kinematics(model, posture).position) == pytest.approx(0.25)


def test_every_reachable_pose_is_found_again(arm: Any) -> None:
    generator = np.random.default_rng(11)
    start = np.array(arm.params.named_poses["unfold"])
    missed = 0
    for _ in range(300):
        pose = forward_kinematics(arm.model, arm.random_posture(generator))
        found = inverse_kinematics(arm.params, arm.model, pose.position, pose.tool_direction, start)
        if found.status != "solved":
            missed += 1
            continue
        for solution in found.solutions:
            again = forward_kinematics(arm.model, solution)
            assert np.linalg.norm(again.position - pose.position) <= 1.0e-5
            assert math.acos(min(1.0, float(again.tool_direction @ pose.tool_direction))) <= 2.0e-4
            assert np.all(solution >= arm.model.lower) and np.all(solution <= arm.model.upper)
    assert missed <= 3


def test_every_reachable_position_is_found_with_pointing_free(arm: Any) -> None:
    generator = np.random.default_rng(12)
    start = np.array(arm.params.named_poses["unfold"])
    for _ in range(100):
        position = forward_kinematics(arm.model, arm.random_posture(generator)).position
        found = inverse_kinematics(arm.params, arm.model, position, None, start)
        assert found.status == "solved"
        assert np.linalg.norm(forward_kinematics(arm.model, found.solutions[0]).position - position) <= 1.0e-5


def test_nearest_solution_comes_first(explorer: Any) -> None:
    start = np.array(explorer.params.named_poses["unfold"])
    pose = forward_kinematics(explorer.model, start + 0.02)
    found = inverse_kinematics(explorer.params, explorer.model, pose.position, pose.tool_direction, start)
    distances = [float(np.max(np.abs(q - start))) for q in found.solutions]
    assert distances == sorted(distances)
    assert distances[0] <= 0.0201


def test_beyond_the_reach_the_nearest_distance_is_told(small: Any) -> None:
    # The azimuth axis is 0.45 m ahead, the elevation axis 0.05 m off it. The farthest
    # the tip gets from the elevation axis is along upper and fore arm, then the straight line to the tip.
    reach = 0.05 + 0.8 + math.hypot(0.1, 0.1)
    target = np.array([0.45 + reach + 0.3, -0.1, 0.05])
    found = inverse_kinematics(small.params, small.model, target, None, np.zeros(5))
    assert found.status == "unreachable"
    assert found.position_error == pytest.approx(0.3, abs=1e-3)
    assert "nearest approach 300" in found.message or "nearest approach 299" in found.message


def test_beyond_the_limits_names_the_joint(small: Any, small_urdf: str, small_values: dict[str, Any]) -> None:
    posture = np.array([1.2, -0.5, 1.0, 0.3, 0.2])
    pose = forward_kinematics(small.model, posture)
    narrow = small_urdf.replace('lower="-2.5" upper="2.5"', 'lower="-0.2" upper="0.2"')
    poses = {"stow": (0.0, -0.4, 2.4, 0.0, 0.0), "unfold": small_values["named_poses"]["unfold"]}
    params = ArmParams(**{**small_values, "named_poses": poses})
    model = build_arm_model(narrow, params)
    found = inverse_kinematics(params, model, pose.position, pose.tool_direction, np.zeros(5))
    assert found.status == "limits"
    assert "shoulder_joint would be" in found.message and "-0.200 to 0.200" in found.message


def test_a_reachable_point_with_an_impossible_direction_says_so(explorer: Any) -> None:
    # At the end of the reach ahead the tool cannot point back at the rover.
    tip = forward_kinematics(explorer.model, np.zeros(5)).position - np.array([0.005, 0.0, 0.0])
    found = inverse_kinematics(explorer.params, explorer.model, tip, np.array([-1.0, 0.0, 0.0]), np.zeros(5))
    assert found.status == "unreachable"
    assert "the position alone can be reached" in found.message


def test_a_target_inside_the_body_collides_and_names_the_links(small: Any) -> None:
    found = solve_pose(small.params, small.model, np.array([0.2, -0.1, 0.0]), None, np.zeros(5))
    assert found.status == "collision"
    assert "base_link" in found.message and "collision of" in found.message


@given(seed=SEEDS)
@settings(max_examples=30, deadline=None)
def test_quaternion_turns_the_tool_axis(explorer: Any, seed: int) -> None:
    rotation = Rotation.from_quat(np.random.default_rng(seed).normal(size=4))
    direction = direction_from_quaternion(explorer.params, rotation.as_quat())
    np.testing.assert_allclose(direction, rotation.apply(explorer.params.tool_axis), atol=1e-12)


def test_identity_and_zero_quaternion_leave_pointing_free(explorer: Any) -> None:
    assert direction_from_quaternion(explorer.params, np.array([0.0, 0.0, 0.0, 1.0])) is None
    assert direction_from_quaternion(explorer.params, np.array([0.0, 0.0, 0.0, -1.0])) is None
    assert direction_from_quaternion(explorer.params, np.zeros(4)) is None


@pytest.mark.parametrize("quaternion", [[1.0, 0.0, 0.0, 1.0], [math.nan, 0.0, 0.0, 1.0], [0.0, 0.0, 1.0]])
def test_bad_quaternions_are_refused(explorer: Any, quaternion: list[float]) -> None:
    with pytest.raises(InvalidValueError, match="orientation"):
        direction_from_quaternion(explorer.params, np.array(quaternion))
