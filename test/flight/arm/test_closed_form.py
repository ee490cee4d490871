"""Closed-form inverse kinematics: every branch is right, none is missing, and the numerical search agrees."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from sojourn_config.arms import load_arm
from sojourn_flight.arm.closed_form import (
    has_spherical_wrist,
    is_planar_with_yaw,
    planar_yaw_branches,
    spherical_wrist_branches,
)
from sojourn_flight.arm.dh import DhTable
from sojourn_flight.arm.dh_urdf import urdf_from_dh
from sojourn_flight.arm.inverse import pose_goal
from sojourn_flight.arm.kinematics import forward_kinematics
from sojourn_flight.arm.serial_arm import SerialArm, build_serial_arm

SEEDS = st.integers(min_value=0, max_value=2**32 - 1)
PUMA, EXPLORER = load_arm("puma560"), load_arm("explorer_arm")


def _turns_apart(a: NDArray[np.float64], b: NDArray[np.float64]) -> float:
    return float(np.max(np.abs(np.angle(np.exp(1j * (a - b))))))


def _spherical(generator: np.random.Generator) -> SerialArm:
    """A random arm of the PUMA's kind: any lengths, senses of the axes, base and tool."""

    def sense() -> float:
        return float(generator.choice([90.0, -90.0]))

    twists = [sense(), float(generator.choice([0.0, 180.0])), sense(), sense(), sense(), 0.0]
    lengths = [generator.uniform(-0.2, 0.2), generator.uniform(0.3, 0.6), generator.uniform(-0.1, 0.1), 0, 0, 0]
    offsets = [0.4, generator.uniform(-0.2, 0.2), generator.uniform(-0.2, 0.2), generator.uniform(0.3, 0.6), 0, 0.1]
    joints = [
        {
            "name": f"j{i}", "theta_deg": generator.uniform(-90, 90), "d": offsets[i], "a": lengths[i],
            "alpha_deg": twists[i], "lower": -180, "upper": 180, "velocity": 1, "effort": 1,
        }
        for i in range(6)
    ]  # fmt: skip
    table = {
        "name": "random", "convention": "standard", "joints": joints, "base_xyz": (0.3, -0.2, 0.1),
        "base_rpy_deg": (20, -30, 40), "tool_xyz": (0.05, -0.02, 0.1), "tool_rpy_deg": (15, 25, 35),
    }  # fmt: skip
    return build_serial_arm(urdf_from_dh(DhTable.model_validate(table), "test"))


@given(seed=SEEDS)
@settings(max_examples=60, deadline=None)
def test_spherical_wrist_all_branches(seed: int) -> None:
    generator = np.random.default_rng(seed)
    arm = PUMA if seed % 2 else _spherical(generator)
    assert has_spherical_wrist(arm)
    q = generator.uniform(-math.pi, math.pi, 6)
    tip = forward_kinematics(arm, q)
    branches = spherical_wrist_branches(arm, tip.position, tip.rotation)
    assert len(branches) in (2, 4, 6, 8)
    for branch in branches:
        reached = forward_kinematics(arm, branch.positions)
        np.testing.assert_allclose(reached.position, tip.position, atol=1e-7)
        np.testing.assert_allclose(reached.rotation, tip.rotation, atol=1e-7)
        within = np.all(branch.positions >= arm.lower) and np.all(branch.positions <= arm.upper)
        assert branch.inside == bool(within)
    assert min(_turns_apart(branch.positions, q) for branch in branches) < 1e-4
    for one, other in pairwise(branches):
        assert _turns_apart(one.positions, other.positions) > 1e-9


def test_a_pose_in_the_midst_of_the_reach_has_eight_branches_and_the_search_finds_one() -> None:
    tip = forward_kinematics(PUMA, np.array([0.0, math.pi / 4, -math.pi, 0.3, math.pi / 4, 0.0]))
    branches = spherical_wrist_branches(PUMA, tip.position, tip.rotation)
    assert len(branches) == 8 and any(branch.inside for branch in branches)
    found = pose_goal(PUMA, tip.position, tip.rotation)
    assert min(_turns_apart(branch.positions, found.positions) for branch in branches) < 1e-4


def test_the_search_solves_just_what_the_closed_form_solves() -> None:
    """Poses anywhere about the arm, reachable or not: two methods that share no formula."""
    generator, solved = np.random.default_rng(0), 0
    for _ in range(300):
        rotation = Rotation.random(rng=generator).as_matrix()
        place = np.array([0.0, 0.0, 0.672]) + generator.uniform(-0.8, 0.8, 3)
        inside = any(branch.inside for branch in spherical_wrist_branches(PUMA, place, rotation))
        assert pose_goal(PUMA, place, rotation).reached == inside
        solved += inside
    assert 50 < solved < 250


def test_a_stretched_wrist_is_marked_and_follows_the_reference() -> None:
    tip = forward_kinematics(PUMA, np.array([0.2, 0.7, -2.4, 0.3, 0.0, 0.4]))
    reference = np.array([0.2, 0.7, -2.4, 1.1, 0.0, 0.0])
    branches = spherical_wrist_branches(PUMA, tip.position, tip.rotation, reference)
    stretched = [branch for branch in branches if branch.singular]
    assert stretched
    for branch in stretched:
        assert branch.positions[3] == pytest.approx(1.1)
        reached = forward_kinematics(PUMA, branch.positions)
        np.testing.assert_allclose(reached.rotation, tip.rotation, atol=1e-7)


def test_out_of_reach_has_no_branches() -> None:
    assert spherical_wrist_branches(PUMA, np.array([2.0, 0.0, 0.0]), np.eye(3)) == ()
    assert planar_yaw_branches(EXPLORER, np.array([5.0, 0.0, 0.0]), np.array([0.0, 0.0, -1.0])) == ()


def _planar(generator: np.random.Generator) -> SerialArm:
    """A random arm of the explorer's kind, with a lateral offset and senses of the axes that the explorer has not."""
    first, last = (float(generator.choice([90.0, -90.0])) for _ in range(2))
    flat = [float(generator.choice([0.0, 180.0])) for _ in range(2)]
    twists = [0.0, first, *flat, last]
    lengths = [0, generator.uniform(-0.1, 0.1), generator.uniform(0.3, 0.5), generator.uniform(0.3, 0.5), 0.1]
    offsets = [0.2, *generator.uniform(-0.1, 0.1, 3), generator.uniform(0.05, 0.2)]
    joints = [
        {
            "name": f"j{i}", "theta_deg": generator.uniform(-90, 90), "d": offsets[i], "a": lengths[i],
            "alpha_deg": twists[i], "lower": -180, "upper": 180, "velocity": 1, "effort": 1,
        }
        for i in range(5)
    ]  # fmt: skip
    table = {
        "name": "random", "convention": "modified", "joints": joints, "base_xyz": (0.3, -0.2, 0.1),
        "base_rpy_deg": (20, -30, 40), "tool_xyz": (0.1, 0, 0.05), "tool_rpy_deg": (0, 90, 0),
    }  # fmt: skip
    return build_serial_arm(urdf_from_dh(DhTable.model_validate(table), "test"))


@given(seed=SEEDS)
@settings(max_examples=60, deadline=None)
def test_planar_with_yaw_all_branches(seed: int) -> None:
    generator = np.random.default_rng(seed)
    arm = EXPLORER if seed % 2 else _planar(generator)
    assert is_planar_with_yaw(arm)
    q = generator.uniform(-math.pi, math.pi, 5)
    tip = forward_kinematics(arm, q)
    branches = planar_yaw_branches(arm, tip.position, tip.tool_direction)
    assert len(branches) in (1, 2, 3, 4, 5, 6, 7, 8)
    for branch in branches:
        reached = forward_kinematics(arm, branch.positions)
        np.testing.assert_allclose(reached.position, tip.position, atol=1e-7)
        np.testing.assert_allclose(reached.tool_direction, tip.tool_direction, atol=1e-7)
    assert min(_turns_apart(branch.positions, q) for branch in branches) < 1e-4


def test_arms_of_other_kinds_are_told() -> None:
    for name in ("srms", "ssrms", "scara", "explorer_arm"):
        assert not has_spherical_wrist(load_arm(name))
    for name in ("puma560", "scara", "srms"):
        assert not is_planar_with_yaw(load_arm(name))
