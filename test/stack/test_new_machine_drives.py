"""A machine that scripts/new_machine has written climbs its slope and reaches its goal, as it is."""

from pathlib import Path

import numpy as np
import pytest

from sojourn_config.new_machine import main
from sojourn_stack import run as direct

ROLES = ("plant", "sensors", "drive", "power", "operator")


@pytest.mark.parametrize("options", [("--steer", "skid"), ("--steer", "all", "--wheels", "6", "--body", "mars")])
def test_it_climbs_its_slope(options: tuple[str, ...], tmp_path: Path) -> None:
    assert main(["mine", "--folder", str(tmp_path), *options]) == 0
    result = direct.run(direct.RunSpec(str(tmp_path / "mine" / "slope.yaml"), ROLES))
    (step,) = result.steps
    assert step.outcome == "reached", step.reason
    truth = result.state.roles["operator"].app.truth
    goal = float(step.step.partition("(")[2].partition(",")[0])
    assert np.hypot(truth.position[0] - goal, truth.position[1]) < 0.1 * goal
    assert truth.position[2] > 0.4  # it is up
