"""Every arm has shapes on every link that is anything, pairs for all of them that are no neighbours, and free poses."""

from typing import Any

import numpy as np
import pytest

from sojourn_config.arms import load_arm
from sojourn_config.scenario import load_scenario
from sojourn_flight.arm.collision import check_posture
from sojourn_flight.arm.model import build_arm_model

COURSES = ("puma560", "scara", "cartesian", "cylindrical", "srms", "ssrms", "explorer_arm")


def on_its_course(name: str) -> tuple[Any, Any]:
    scenario = load_scenario(f"{name}_course")
    params = scenario.carried_arm()
    return params, build_arm_model(scenario.urdf_xml, params)


@pytest.mark.parametrize("name", COURSES)
def test_all_links_that_are_no_neighbours_are_held_against_each_other(name: str) -> None:
    params, model = on_its_course(name)
    carried = {joint for joint in range(1, model.joint_count + 1) if np.any(model.shape_parents == joint)}
    assert len(carried) >= model.joint_count - 1, "all but one link at most have a shape"
    parents = [sorted(model.shape_parents[list(pair)]) for pair in model.pair_shapes]
    apart = {(one, two) for one, two in parents}
    wanted = {(one, two) for one in carried for two in carried if two > one + 1}
    assert wanted <= apart, f"{name}: {sorted(wanted - apart)}"
    base = {two for one, two in apart if one == 0}
    assert base >= carried - {1}, "what carries the arm counts, too"
    for pose, positions in params.named_poses.items():
        found = check_posture(params, model, np.array(positions), None)
        assert found is None, f"{name} at {pose}: {found.text()}"


@pytest.mark.parametrize("name", COURSES[:4])
def test_a_good_part_of_its_range_is_free(name: str) -> None:
    """Shapes that stand in one another by mistake would leave nothing."""
    params, model = on_its_course(name)
    generator = np.random.default_rng(2)
    postures = generator.uniform(model.lower, model.upper, (100, model.joint_count))
    free = sum(check_posture(params, model, posture, None) is None for posture in postures)
    assert free >= (100 if name == "cartesian" else 50), f"{free} of 100"


def test_a_puma_does_not_reach_through_its_trunk() -> None:
    """Its URDF had two shapes and one pair: it was free to."""
    params, model = on_its_course("puma560")
    arm = load_arm("puma560")
    generator = np.random.default_rng(4)
    hits = set()
    for _ in range(300):
        posture = generator.uniform(arm.lower, arm.upper)
        found = check_posture(params, model, posture, None)
        if found is not None:
            hits |= {found.first, found.second}
    assert {"arm_base_link", "arm_elbow_link"} <= hits, "trunk and forearm"
