"""A joint of the arm that does not move, in a whole run: found, and planned around where the others reach the goal."""

import json
from pathlib import Path
from typing import Any

import pytest

from sojourn_bags.detection import judge_faults
from sojourn_bags.reading import Bag, read_bag
from sojourn_config.scenario import load_scenario
from sojourn_contract.topics import ROLES
from sojourn_stack.run import RunSpec, run

PLACES = ((1.1, 0.1, -0.1), (1.2, -0.1, -0.1))
STEPS = [
    {"begin": {"step": {"arm_task": {"name": "unfold"}}, "seconds": 24.0}},
    {"begin": {"step": {"arm_to": dict(zip("xyz", PLACES[0], strict=True))}, "seconds": 20.0}},
    {"begin": {"step": {"arm_to": dict(zip("xyz", PLACES[1], strict=True))}, "seconds": 16.0}},
]


def ran(folder: Path, kind: str, joint: str, seed: int, says: str) -> Bag:
    expect = {"topic": "/arm/status", "field": "failed_joints", "says": f"{joint} {says}", "within": 16.0}
    fault: dict[str, Any] = {"kind": kind, "joint": joint, "at": 5.0, "expect": expect}
    told = (f"seed={seed}", f"steps={json.dumps(STEPS)}", f"faults={json.dumps([fault])}")
    scenario = load_scenario("flat_drive", told)
    run(RunSpec("flat_drive", tuple(role for role in ROLES if role != "recorder"), told, folder / "bag", scenario))
    bag = read_bag(folder / "bag")
    (result,) = judge_faults(bag, scenario.config.faults)
    assert result.outcome == "detected", result
    return bag


@pytest.mark.parametrize(
    ("kind", "joint", "seed"),
    [
        ("joint_seized", "arm_elbow_joint", 1),
        pytest.param("motor_dead", "arm_elbow_joint", 2, marks=pytest.mark.long),
        pytest.param("servo_locked", "arm_wrist_joint", 3, marks=pytest.mark.long),
    ],
)
def test_a_joint_that_does_not_move_is_found_and_the_others_reach_the_goals(
    tmp_path: Path, kind: str, joint: str, seed: int
) -> None:
    bag = ran(tmp_path, kind, joint, seed, "does not move")
    status = bag["/arm/status"].statuses()
    truth = bag["/truth/joint_states"].joints()
    column = truth.names.index(joint)
    for at in (44, 60):
        said = next(one for one, time in zip(status, bag["/arm/status"].times, strict=True) if round(time) == at)
        assert said["state"] == "reached" and float(said["error_m"]) < 0.003, said
        assert f"{joint} does not move" in said["reason"]
    still = truth.position[bag["/truth/joint_states"].times > 24.0, column]
    assert float(still.max() - still.min()) < 0.005, "the fault holds it, in truth"


def test_a_joint_without_which_the_goals_are_not_reached_is_named_in_the_refusal(tmp_path: Path) -> None:
    bag = ran(tmp_path, "joint_seized", "arm_azimuth_joint", 4, "does not move")
    ended = bag["/arm/status"].statuses()[-1]
    assert ended["state"] == "refused"
    assert "unreachable" in ended["reason"] and "arm_azimuth_joint does not move" in ended["reason"]


def test_with_a_joint_that_nothing_holds_no_motion_is_planned(tmp_path: Path) -> None:
    bag = ran(tmp_path, "joint_free", "arm_elevation_joint", 5, "moves by itself")
    ended = bag["/arm/status"].statuses()[-1]
    assert ended["state"] == "refused" and "arm_elevation_joint moves by itself" in ended["reason"]
