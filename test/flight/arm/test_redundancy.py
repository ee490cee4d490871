"""The seventh joint of the SSRMS: the tip stays while joints, manipulability or clearance get better."""

from typing import Any

import numpy as np
import pytest

from sojourn_config.arm_config import ArmConfig
from sojourn_config.arms import load_arm
from sojourn_config.load import load_params
from sojourn_config.paths import urdf_folder
from sojourn_flight.arm.kinematics import forward_kinematics
from sojourn_flight.arm.model import ArmModel, build_arm_model
from sojourn_flight.arm.params import ArmParams
from sojourn_flight.arm.planning import solve_pose
from sojourn_flight.arm.redundancy import (
    Measure,
    Sphere,
    better_posture,
    clearance,
    joint_centring,
    joint_origins,
    manipulability_measure,
    measure_of,
)

ARM = load_arm("ssrms")
POSTURE = np.array([0.4, -0.6, 0.5, -1.6, 0.9, 0.7, -0.3])
ELBOW = joint_origins(ARM, POSTURE)[4]
MEASURES = {
    "centring": joint_centring(ARM),
    "manipulability": manipulability_measure(ARM),
    "clearance": clearance(ARM, (Sphere(ELBOW + np.array([0.3, 0.4, 0.2]), 0.3),), 0.175),
}


@pytest.mark.parametrize("name", MEASURES)
def test_the_tip_stays_and_the_measure_gets_better(name: str) -> None:
    measure: Measure = MEASURES[name]
    # the SSRMS is most dexterous with its elbow as POSTURE has it; so that measure starts from another
    start = np.array([0.4, 0.1, 0.5, -0.3, 0.9, 0.2, -0.3]) if name == "manipulability" else POSTURE
    better = better_posture(ARM, start, measure, steps=40)
    assert measure(better) > measure(start) + 0.02 * abs(measure(start))
    before, after = forward_kinematics(ARM, start), forward_kinematics(ARM, better)
    np.testing.assert_allclose(after.position, before.position, atol=1e-6)
    np.testing.assert_allclose(after.rotation, before.rotation, atol=1e-7)
    assert np.all(better >= ARM.lower) and np.all(better <= ARM.upper)


def test_no_self_motion_betters_the_best_manipulability() -> None:
    measure = MEASURES["manipulability"]
    best = better_posture(ARM, np.array([0.4, 0.1, 0.5, -0.3, 0.9, 0.2, -0.3]), measure)
    spare = np.linalg.svd(forward_kinematics(ARM, best).jacobian)[2][-1]
    for size in (-0.05, 0.05):  # first order: the tip moves by the square of it
        assert measure(best + size * spare) < measure(best)


def test_an_elbow_inside_an_obstacle_gets_out() -> None:
    measure = MEASURES["clearance"]
    assert measure(POSTURE) < 0.1
    assert measure(better_posture(ARM, POSTURE, measure)) > 0.5


def test_joint_origins_end_at_the_tip() -> None:
    points = joint_origins(ARM, POSTURE)
    assert points.shape == (9, 3)
    np.testing.assert_allclose(points[-1], forward_kinematics(ARM, POSTURE).position, atol=1e-9)


def test_an_arm_with_nothing_to_spare_stays() -> None:
    puma = load_arm("puma560")
    posture = np.array([0.2, 0.7, -2.4, 0.3, 0.6, 0.4])
    np.testing.assert_allclose(better_posture(puma, posture, joint_centring(puma)), posture, atol=1e-6)


def _flown(**changes: Any) -> tuple[ArmParams, ArmModel]:
    """The SSRMS as its node has it."""
    params = load_params("arms", "ssrms", ArmConfig).model_copy(update=changes)
    return params, build_arm_model((urdf_folder() / "ssrms.urdf").read_text(encoding="utf-8"), params)


@pytest.mark.parametrize("task", ["centred", "manipulability", "clear"])
def test_a_pose_goal_of_the_node_is_met_as_the_secondary_task_prefers(task: Any) -> None:
    obstacles = ((4.0, 1.0, 2.0, 0.5),) if task == "clear" else ()
    plain, model = _flown()
    params, _ = _flown(secondary_task=task, obstacles=obstacles)
    start = np.array(params.named_poses["unfold"])
    tip = forward_kinematics(model, start + 0.2)
    first = solve_pose(plain, model, tip.position, tip.rotation, start).solutions[0]
    better = solve_pose(params, model, tip.position, tip.rotation, start).solutions[0]
    measure = measure_of(model, task, tuple(Sphere(np.array(ball[:3]), ball[3]) for ball in obstacles))
    assert measure(better) > measure(first)
    reached = forward_kinematics(model, better)
    np.testing.assert_allclose(reached.position, tip.position, atol=1e-4)
    np.testing.assert_allclose(reached.rotation, tip.rotation, atol=2e-4)


def test_keeping_clear_needs_something_to_keep_clear_of() -> None:
    params = load_params("arms", "ssrms", ArmConfig)
    with pytest.raises(ValueError, match="obstacles are needed"):
        ArmConfig.model_validate(params.model_dump() | {"secondary_task": "clear"})
