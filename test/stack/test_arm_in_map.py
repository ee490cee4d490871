"""A goal of the arm in map, where the rover stands on ground with relief: the tip ends there in truth."""

import json
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

from sojourn_bags.reading import read_bag
from sojourn_bags.summary import summarise
from sojourn_config.scenario import load_scenario
from sojourn_contract.topics import ROLES
from sojourn_plant.start import build_plant
from sojourn_stack.run import RunSpec, run

IN_BASE = (1.1, 0.1, -0.1)
SITE = ("seed=907", "start.yaw=0.8")


def test_the_tip_ends_at_a_place_that_is_given_in_map(tmp_path: Path) -> None:
    _, truth = build_plant(load_scenario("lunar_sample", SITE))
    place = pin.XYZQUATToSE3(truth.configuration[:7]).act(np.array(IN_BASE))
    goal = {**dict(zip("xyz", place.tolist(), strict=True)), "frame": "map"}
    steps = [{"arm_task": {"name": "unfold"}}, {"arm_to": goal}]
    told = (*SITE, f"steps={json.dumps(steps)}", "accept.arm_m=0.02", "duration_limit_s=120.0")
    scenario = load_scenario("lunar_sample", told)
    run(RunSpec("lunar_sample", tuple(role for role in ROLES if role != "recorder"), told, tmp_path / "bag", scenario))
    bag = read_bag(tmp_path / "bag")
    result = summarise(bag)["goals"][-1]
    assert result["met"] and result["outcome"] == "reached", result
    said = bag["/arm/status"].statuses()[-1]
    assert float(said["error_m"]) < 0.003, "the rest is what the drive does not know of its height"
    assert result["error_m"] == pytest.approx(0.0, abs=0.012)
