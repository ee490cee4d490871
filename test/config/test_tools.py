"""Tools of the arm: what the files of config/tools give, and what is refused before anything starts."""

import pytest

from sojourn_config.errors import ConfigError
from sojourn_config.paths import available
from sojourn_config.scenario import load_scenario


@pytest.mark.parametrize("name", available("tools"))
def test_every_tool_fits_the_explorer(name: str) -> None:
    scenario = load_scenario("flat_drive", [f"tool={name}"])
    assert scenario.tool is not None and scenario.tool.kind == name
    assert scenario.sensors.joint_groups["tool"].joints == ("tool_joint",)


def test_the_rover_names_its_tool_and_the_scenario_may_name_another() -> None:
    assert load_scenario("flat_drive").tool.kind == "scoop"
    assert load_scenario("drill_sample").tool.kind == "drill"
    assert load_scenario("flat_drive", ["machine=skid"]).tool is None
    assert load_scenario("flat_drive", ["tool.tool.capacity=1.0e-4"]).tool.capacity == 1e-4


@pytest.mark.parametrize(
    ("overrides", "reason"),
    [
        (["tool=drill", "soil=jsc_1a"], "specific_energy.*needed by the drill"),
        (["machine=skid", "tool=scoop"], "has no arm"),
        (["machine=skid", "tool.tool.radius=0.1"], "no tool"),
        (["tool=spoon"], "spoon"),
        (["tool.tool.pad=tip"], "no pad of the machine.*arm_tip"),
        (["tool.tool.capacity=-1.0"], "capacity.*-1"),
        (["objects=[{name: a, x: 90.0, y: 0.0, mass: 1.0, width: 0.03, height: 0.03, friction: 0.4}]"], "x = 90"),
    ],
)
def test_what_does_not_fit_is_refused_with_the_reason(overrides: list[str], reason: str) -> None:
    with pytest.raises(ConfigError, match=reason):
        load_scenario("flat_drive", overrides)
