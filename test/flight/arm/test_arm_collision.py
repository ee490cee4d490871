"""Collisions: the quick check along a path against the slow one, pairs named, ground, starts too near."""

import math
from typing import Any

import numpy as np
import pinocchio
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_flight.arm.collision import (
    check_path,
    check_posture,
    check_samples,
    path_samples,
)
from sojourn_flight.arm.ground_plane import GroundPlane
from sojourn_flight.arm.kinematics import forward_kinematics
from sojourn_flight.arm.trajectory import at_rest, point_to_point
from sojourn_machine.errors import InvalidValueError

SEEDS = st.integers(min_value=0, max_value=2**32 - 1)


def _slow_distances(model: Any, posture: Any) -> Any:
    pinocchio.updateGeometryPlacements(
        model.pinocchio_model, model.data, model.geometry_model, model.geometry_data, posture
    )
    pinocchio.computeDistances(model.geometry_model, model.geometry_data)
    return np.array([r.min_distance for r in model.geometry_data.distanceResults])


@given(seed=SEEDS)
@settings(max_examples=15, deadline=None)
def test_skipping_far_pairs_changes_nothing(small: Any, explorer: Any, seed: int) -> None:
    generator = np.random.default_rng(seed)
    for arm in (small, explorer):
        start, target = arm.random_posture(generator), arm.random_posture(generator)
        path = point_to_point(arm.model, at_rest(start), target)
        samples = path_samples(path, arm.params.collision_step)
        quick = check_samples(arm.params, arm.model, samples, None, allow_start=False)
        expected = None
        for k, posture in enumerate(samples):
            near = np.flatnonzero(_slow_distances(arm.model, posture) < arm.params.collision_clearance)
            if near.size:
                expected = (k, {frozenset(arm.model.pairs[i]) for i in near})
                break
        if expected is None:
            assert quick is None
        else:
            assert quick is not None
            assert quick.progress == pytest.approx(expected[0] / max(len(samples) - 1, 1))
            assert frozenset((quick.first, quick.second)) in expected[1]


@given(seed=SEEDS)
@settings(max_examples=30, deadline=None)
def test_samples_are_close_enough_and_include_both_ends(small: Any, seed: int) -> None:
    generator = np.random.default_rng(seed)
    start, target = small.random_posture(generator), small.random_posture(generator)
    samples = path_samples(point_to_point(small.model, at_rest(start), target), 0.02)
    assert float(np.max(np.abs(np.diff(samples, axis=0)))) <= 0.02
    np.testing.assert_allclose(samples[0], start, atol=1e-12)
    np.testing.assert_allclose(samples[-1], target, atol=1e-9)


def test_swinging_into_the_mast_names_the_pair(small: Any) -> None:
    start, target = np.array([0.0, -1.2, 0.6, 0.0, 0.0]), np.array([2.5, -1.2, 0.6, 0.0, 0.0])
    found = check_path(small.params, small.model, point_to_point(small.model, at_rest(start), target), None)
    assert found is not None
    assert "mast_link" in (found.first, found.second)
    assert 0.0 < found.progress < 1.0
    assert "mast_link" in found.text() and "10.0 mm" in found.text()


def test_named_poses_of_the_explorer_are_free_and_connected(explorer: Any) -> None:
    ground = GroundPlane(-0.47)
    stow, unfold = (np.array(explorer.params.named_poses[name]) for name in ("stow", "unfold"))
    for posture in (stow, unfold):
        assert check_posture(explorer.params, explorer.model, posture, ground) is None
    for start, end in ((stow, unfold), (unfold, stow)):
        path = point_to_point(explorer.model, at_rest(start), end)
        assert check_path(explorer.params, explorer.model, path, ground) is None
    assert forward_kinematics(explorer.model, unfold).tool_direction[2] == pytest.approx(-1.0, abs=1e-6)


def _mesh_height(model: Any, shape: int, normal: Any, height: float) -> float:
    """Lowest point of a shape over the plane from many points of its surface."""
    geometry = model.geometry_model.geometryObjects[shape].geometry
    placement = model.geometry_data.oMg[shape]
    angles = np.linspace(0.0, 2.0 * math.pi, 721)
    if type(geometry).__name__ == "Cylinder":
        ring = np.stack([np.cos(angles), np.sin(angles), np.zeros_like(angles)], axis=1) * geometry.radius
        points = np.vstack([ring + np.array([0.0, 0.0, s * geometry.halfLength]) for s in (-1.0, 1.0)])
    else:
        signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
        points = signs * geometry.halfSide
    world = points @ placement.rotation.T + placement.translation
    return float((world @ normal).min() - height)


@given(seed=SEEDS)
@settings(max_examples=25, deadline=None)
def test_ground_is_exact_for_tilted_planes(small: Any, seed: int) -> None:
    generator = np.random.default_rng(seed)
    posture = small.random_posture(generator)
    normal = np.array([0.0, 0.0, 1.0]) + generator.uniform(-0.4, 0.4, 3)
    normal /= np.linalg.norm(normal)
    _slow_distances(small.model, posture)
    lowest = {link: math.inf for _, link in small.model.arm_shapes}
    for shape, link in small.model.arm_shapes:
        lowest[link] = min(lowest[link], _mesh_height(small.model, shape, normal, 0.0))
    margin = {
        link: value - (-0.01 if link == "tool_link" else small.params.ground_clearance)
        for link, value in lowest.items()
    }
    limit = min(margin.values())
    free = small.params.model_copy(update={"collision_clearance": -10.0})
    below = GroundPlane(limit - 1e-4, tuple(normal))
    above = GroundPlane(limit + 1e-4, tuple(normal))
    assert check_posture(free, small.model, posture, below) is None
    found = check_posture(free, small.model, posture, above)
    assert found is not None and found.second == "ground"
    assert found.first == min(margin, key=lambda link: margin[link])


def test_a_pair_too_near_at_the_start_may_part_but_not_come_nearer(small: Any) -> None:
    # The upper arm lies nearly on the body; lifting is allowed, lowering is not.
    near = None
    for angle in np.linspace(-1.2, 0.5, 400):
        posture = np.array([-2.4, angle, 0.0, 0.0, 0.0])
        if check_posture(small.params, small.model, posture, None) is not None:
            near = posture
            break
    assert near is not None
    lifted, lowered = near.copy(), near.copy()
    lifted[1] -= 0.5
    lowered[1] += 0.05
    model = small.model
    assert check_path(small.params, model, point_to_point(model, at_rest(near), lifted), None) is None
    found = check_path(small.params, model, point_to_point(model, at_rest(near), lowered), None)
    assert found is not None


@pytest.mark.parametrize(("height", "normal"), [(math.nan, (0.0, 0.0, 1.0)), (0.0, (0.0, 0.0, 2.0))])
def test_bad_ground_is_refused(height: float, normal: tuple[float, float, float]) -> None:
    with pytest.raises(InvalidValueError, match="ground plane"):
        GroundPlane(height, normal)
