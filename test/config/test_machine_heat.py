"""thermal.yaml of a machine: read where it is there, and held against its loads, its stores and its body."""

import shutil
from pathlib import Path

import pytest
import yaml

from sojourn_config.errors import ConfigError
from sojourn_config.paths import config_folder
from sojourn_config.scenario import LoadedScenario, load_scenario


def night(*overrides: str) -> LoadedScenario:
    return load_scenario("lunar_night", list(overrides))


def test_a_machine_without_the_file_has_no_heat() -> None:
    assert load_scenario("flat_drive").thermal is None
    thermal = night().thermal
    assert thermal is not None and list(thermal.nodes) == ["box", "shell", "radiator"]


def test_overrides_reach_it() -> None:
    thermal = night("thermal.nodes.box.heat_capacity=1000.0", "thermal.radioisotope_heaters=[]").thermal
    assert thermal is not None and thermal.nodes["box"].heat_capacity == 1000.0
    assert thermal.radioisotope_heaters == ()


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("thermal.warms.computr=box", ["warms.computr", "is no load, store or source", "did you mean computer"]),
        ("thermal.warms.computer=bx", ["warms.computer", "bx", "did you mean box"]),
        ("thermal.heaters.survival_heater.power_w=11.0", ["survival_heater.power_w", "the 10 W of the load"]),
        (
            "thermal.heaters={drive: {node: box, power_w: 10.0, on_below: 250.0, off_above: 260.0}}",
            ["heaters.drive", "constant_power or resistive"],
        ),
        (
            "thermal.heaters={furnace: {node: box, power_w: 10.0, on_below: 250.0, off_above: 260.0}}",
            ["heaters.furnace", "has no load that feeds it"],
        ),
        ("thermal.heaters.survival_heater.off_above=250.0", ["off_above = 250", "above on_below"]),
        (
            "thermal.nodes.lost={heat_capacity: 10.0, temperature: 200.0}",
            ["nodes.lost", "gives its heat to nothing"],
        ),
        ("thermal.nodes.box.temperature=-3.0", ["nodes.box.temperature", "-3"]),
        ("body=ceres", ["regolith"]),
    ],
)  # fmt: skip
def test_what_does_not_fit_is_refused_with_its_place(override: str, words: list[str]) -> None:
    with pytest.raises(ConfigError) as refused:
        night(override)
    for word in words:
        assert word in str(refused.value), str(refused.value)


def test_a_mistake_in_the_file_is_told_with_its_line(tmp_path: Path) -> None:
    machine = tmp_path / "cold"
    shutil.copytree(config_folder() / "machines" / "explorer_night", machine)
    text = (machine / "thermal.yaml").read_text("utf-8").replace("node: box, count: 20", "node: boxx, count: 20")
    (machine / "thermal.yaml").write_text(text, "utf-8")
    for name in ("machine", "flight", "power", "sensors"):
        file = machine / f"{name}.yaml"
        above = config_folder() / "machines"
        tables = yaml.safe_load(file.read_text("utf-8"))
        extends = str((above / "explorer_night" / tables["extends"]).resolve())
        file.write_text(yaml.safe_dump(tables | {"extends": extends}), "utf-8")
    with pytest.raises(ConfigError, match=r"thermal.yaml.*boxx.*box"):
        night(f"machine={machine}")
