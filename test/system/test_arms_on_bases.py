"""Arms other than the explorer's, in lock-step over the topics: each reaches joint positions and poses in truth."""

import json
from pathlib import Path

import numpy as np
import pytest
from programs import chosen, demos, with_long

from sojourn_bags.judging import judge_bag
from sojourn_bags.reading import Bag, read_bag
from sojourn_config.scenario import load_scenario
from sojourn_flight.arm.kinematics import forward_kinematics
from sojourn_flight.arm.model import build_arm_model
from sojourn_flight.arm.orientation import from_quaternion
from sojourn_machine.params import FloatArray
from sojourn_operator.steps.arm_joints import ArmJointsStep
from sojourn_operator.steps.arm_to import ArmPoseStep

HERE = Path(__file__).parent
MOUNT = "machine.arm_mount={link: forward_link, xyz: [0.0, 0.0, 0.2]}"
COURSES: dict[str, tuple[str, tuple[str, ...]]] = {
    "ssrms": ("ssrms_course", ()),  # seven joints, without weight
    "puma560_on_lrv": (str(HERE / "foreign_arm.yaml"), ("machine.arm=puma560", MOUNT)),  # on springs, on soil
    "puma560": ("puma560_course", ()),
    "cylindrical": ("cylindrical_course", ()),  # two of four joints slide
}
"""Scenario and overrides."""
LONG = {"ssrms"}
"""Moves when all tests run: each of its places takes a minute; test/stack/test_spacecraft.py has such an arm, too."""
DISTANCE_M, ANGLE_RAD = 0.002, 0.0087
"""What the turret of the explorer is asked for, too: 2 mm and half a degree."""


@pytest.fixture(scope="module")
def runs(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> dict[str, tuple[int, str, Path]]:
    options = {}
    for course in chosen(request, "course"):
        scenario, overrides = COURSES[course]
        options[course] = ["--scenario", scenario, *(word for text in overrides for word in ("--set", text))]
    return demos(options, tmp_path_factory.mktemp("arms"))


def true_joints_at(bag: Bag, names: tuple[str, ...], time_s: float) -> FloatArray:
    """True positions of these joints at the last period up to a time."""
    states = bag["/truth/joint_states"]
    row = int(np.searchsorted(states.times, time_s, side="right")) - 1
    told = states.joints()
    return np.array([told.position[row, told.index(name)] for name in names])


@pytest.mark.parametrize("course", with_long(COURSES, LONG))
def test_it_reaches_its_goals_in_truth_and_keeps_the_contract(
    course: str, runs: dict[str, tuple[int, str, Path]]
) -> None:
    status, said, folder = runs[course]
    assert status == 0, said
    summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    assert summary["all_met"] and summary["complete"]
    bag, scenario = read_bag(folder), load_scenario(*COURSES[course])
    params = scenario.carried_arm()
    arm = build_arm_model(scenario.urdf_xml, params)
    poses = joints = 0
    for goal, step in zip(summary["goals"], scenario.config.steps, strict=True):
        there = true_joints_at(bag, params.joint_names, goal["end_s"])
        if isinstance(step.action, ArmJointsStep):
            wanted = step.action.positions or params.named_poses[str(step.action.name)]
            np.testing.assert_allclose(there, wanted, atol=2.0 * params.joint_tolerance)
            joints += 1
        elif isinstance(step.action, ArmPoseStep):
            tip = forward_kinematics(arm, there)
            place = step.action
            assert np.linalg.norm(tip.position - [place.x, place.y, place.z]) < DISTANCE_M
            turned = from_quaternion(np.array(place.orientation) / np.linalg.norm(place.orientation))
            cosine = 0.5 * (np.trace(turned.T @ tip.rotation) - 1.0)
            assert np.arccos(np.clip(cosine, -1.0, 1.0)) < ANGLE_RAD
            poses += 1
    assert poses >= 1 and joints >= 2
    report, _ = judge_bag(bag)
    assert report.violations == 0, report.groups
