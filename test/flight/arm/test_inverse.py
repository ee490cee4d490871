"""Inverse kinematics of every arm: what is reachable is reached, and what is not is told apart."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from sojourn_config.arms import load_arm
from sojourn_flight.arm.inverse import InverseAnswer, pointing_goal, pose_goal, position_goal
from sojourn_flight.arm.inverse_search import spread
from sojourn_flight.arm.kinematics import TipPose, forward_kinematics
from sojourn_flight.arm.serial_arm import SerialArm
from sojourn_machine.errors import InvalidValueError


def _ask(arm: SerialArm, tip: TipPose) -> InverseAnswer:
    """Five joints: position and pointing direction; else the whole pose."""
    if arm.joint_count == 5:
        return pointing_goal(arm, tip.position, tip.tool_direction)
    return pose_goal(arm, tip.position, tip.rotation)


def test_random_reachable_poses_are_solved(named_arm: SerialArm) -> None:
    """A small count; scripts/bench asks 10^4."""
    generator = np.random.default_rng(8)
    for _ in range(150):
        wanted = forward_kinematics(named_arm, generator.uniform(named_arm.lower, named_arm.upper))
        answer = _ask(named_arm, wanted)
        assert answer.reached, answer.message
        assert np.all(answer.positions >= named_arm.lower) and np.all(answer.positions <= named_arm.upper)
        tip = forward_kinematics(named_arm, answer.positions)
        assert float(np.linalg.norm(tip.position - wanted.position)) < 1.01e-6 * named_arm.reach
        if named_arm.joint_count == 5:
            assert float(np.linalg.norm(tip.tool_direction - wanted.tool_direction)) < 1.1e-6
        else:
            assert Rotation.from_matrix(tip.rotation @ wanted.rotation.T).magnitude() < 1.01e-6


def test_the_same_question_has_the_same_answer_and_a_start_is_heeded(named_arm: SerialArm) -> None:
    posture = 0.5 * (named_arm.lower + named_arm.upper) + 0.3 * (named_arm.upper - named_arm.lower) * 0.7
    tip = forward_kinematics(named_arm, posture)
    np.testing.assert_array_equal(_ask(named_arm, tip).positions, _ask(named_arm, tip).positions)
    answer = (
        pointing_goal(named_arm, tip.position, tip.tool_direction, start=posture + 1e-3)
        if named_arm.joint_count == 5
        else pose_goal(named_arm, tip.position, tip.rotation, start=posture + 1e-3)
    )
    assert answer.reached and float(np.max(np.abs(answer.positions - posture))) < 0.05


def test_too_far_is_unreachable_with_the_nearest_approach() -> None:
    puma = load_arm("puma560")
    target = np.array([3.0, 0.0, 0.672])
    answer = position_goal(puma, target)
    assert answer.status == "unreachable" and not answer.reached
    # stretched out: shoulder offset aside, upper arm and forearm in one line
    stretch = math.hypot(0.4318 + math.hypot(0.4318, 0.0203), 0.15005)
    assert answer.position_error == pytest.approx(3.0 - stretch, abs=2e-3)
    assert f"nearest approach is {answer.position_error:.4g} m" in answer.message


def test_joint_limits_are_named() -> None:
    puma = load_arm("puma560")
    beyond = np.array([0.0, 0.6, -2.8, 0.3, 0.8, 0.0])
    beyond[4] = math.radians(125.0)  # the wrist bends to 100 degrees
    tip = forward_kinematics(puma, beyond)
    assert pose_goal(puma, tip.position, tip.rotation).reached  # another branch is within the limits
    gantry = load_arm("cartesian")
    tip = forward_kinematics(gantry, np.array([1.5, 0.4, 0.3]))
    answer = pose_goal(gantry, tip.position, tip.rotation)
    assert answer.status == "limits" and answer.position_error == pytest.approx(0.3, abs=1e-5)
    assert "x_joint would be 1.5 (limits 0 to 1.2)" in answer.message


def test_a_pose_that_only_a_singular_posture_reaches_is_marked() -> None:
    puma = load_arm("puma560")
    elbow = -math.pi / 2 - math.atan2(0.0203, 0.4318)
    stretched = np.array([0.4, 0.5, elbow + 2 * math.atan2(0.0203, 0.4318), 0.3, 0.7, 0.2])
    tip = forward_kinematics(puma, stretched)
    wrist = np.linalg.norm(tip.position - [0, 0, 0.672])
    assert wrist == pytest.approx(math.hypot(0.4318 + math.hypot(0.4318, 0.0203), 0.15005), abs=1e-9)
    answer = pose_goal(puma, tip.position, tip.rotation)
    assert answer.status == "singular" and answer.reached and answer.smallest_singular_value < 1e-3
    bent = forward_kinematics(puma, np.array([0.4, 0.5, -2.5, 0.3, 0.7, 0.2]))
    assert pose_goal(puma, bent.position, bent.rotation).status == "solved"


@given(seed=st.integers(min_value=0, max_value=2**32 - 1))
@settings(max_examples=30, deadline=None)
def test_no_target_gives_an_answer_that_is_not_there(seed: int) -> None:
    """Whatever is asked for: 'solved' is true, and positions are within the limits."""
    generator = np.random.default_rng(seed)
    arm = load_arm("explorer_arm")
    target = generator.uniform(-2.0, 2.0, 3)
    direction = generator.normal(size=3)
    direction /= np.linalg.norm(direction)
    answer = pointing_goal(arm, target, direction)
    tip = forward_kinematics(arm, answer.positions)
    assert answer.position_error == pytest.approx(float(np.linalg.norm(tip.position - target)), abs=1e-9)
    assert answer.reached == (answer.position_error < 1e-6 * arm.reach and answer.angle_error < 1e-6)
    assert np.all(answer.positions >= arm.lower) and np.all(answer.positions <= arm.upper)


def test_half_a_turn_off_is_no_trap() -> None:
    """The rotation error is largest, and its axis is not unique, just there."""
    srms = load_arm("srms")
    tip = forward_kinematics(srms, np.array([0.3, 1.0, -1.2, 0.4, 0.2, 0.0]))
    turned = tip.rotation @ Rotation.from_euler("x", math.pi).as_matrix()
    start = np.array([0.3, 1.0, -1.2, 0.4, 0.2, 0.0])
    answer = pose_goal(srms, tip.position, turned, start)
    assert answer.reached


def test_starts_are_spread_and_the_middle_is_first() -> None:
    points = spread(6, 64)
    np.testing.assert_array_equal(points[0], 0.5)
    assert np.all(np.abs(points.mean(axis=0) - 0.5) < 0.05)


def test_numbers_that_are_none_are_refused() -> None:
    with pytest.raises(InvalidValueError, match="target"):
        position_goal(load_arm("scara"), np.array([np.nan, 0.0, 0.0]))
