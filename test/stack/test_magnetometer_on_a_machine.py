"""A magnetometer on a machine that names it, in a whole run; what is refused before it."""

import shutil
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sojourn_bags.judging import judge_bag
from sojourn_bags.reading import Bag, read_bag
from sojourn_config.errors import ConfigError
from sojourn_config.paths import config_folder
from sojourn_config.scenario import load_scenario
from sojourn_stack import run as direct

ROLES = ("plant", "sensors", "drive", "power", "operator", "recorder")
SENSORS = """
extends: {explorer}/sensors.yaml
compass: {{extends: hmr2300, link: hazcam_link, hard_iron: 0.0, soft_iron: 0.0, noise: 1.0e-9, resolution: 1.0e-10}}
powered_by: {{compass: cameras}}
"""
SITE = "site={latitude_deg: 40.0, longitude_deg: 30.0}"
PITCHED = Rotation.from_euler("y", 0.5)
"""The link, which looks down by 28.6 degrees."""


@pytest.fixture(scope="module")
def machine(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The explorer with one."""
    folder, explorer = tmp_path_factory.mktemp("machines") / "magnetic", config_folder() / "machines" / "explorer"
    shutil.copytree(explorer, folder)
    (folder / "sensors.yaml").write_text(SENSORS.format(explorer=explorer), encoding="utf-8")
    return folder


@pytest.fixture(scope="module")
def bag(machine: Path, tmp_path_factory: pytest.TempPathFactory) -> Bag:
    folder = tmp_path_factory.mktemp("run") / "bag"
    told = (f"machine={machine}", "body=ganymede", SITE, "start.yaw=0.8", "steps=[{wait_s: 1.0}]")
    direct.run(direct.RunSpec("flat_drive", ROLES, told, bag=folder))
    return read_bag(folder)


def test_it_reads_the_field_of_the_place_in_the_axes_of_its_link(bag: Bag, machine: Path) -> None:
    scenario = load_scenario("flat_drive", [f"machine={machine}", "body=ganymede", SITE])
    field = scenario.body.magnetic_field_over(scenario.site)
    assert 719e-9 < np.linalg.norm(field) < 2 * 719e-9 and field[1] > 0.0 and field[2] < 0.0  # north and down
    truth, readings = bag["/truth/odom"], bag["/magnetic_field/compass"]
    turns = np.column_stack([truth.column(f"pose.pose.orientation.{axis}")[-1] for axis in "xyzw"])
    expected = (Rotation.from_quat(turns[0]) * PITCHED).inv().apply(field)
    measured = np.column_stack([readings.column(f"magnetic_field.{axis}") for axis in "xyz"])
    assert len(measured) >= 9
    np.testing.assert_allclose(measured.mean(axis=0), expected, atol=2e-9)


def test_the_contract_is_kept(bag: Bag) -> None:
    assert not list(judge_bag(bag)[0].lines())


def test_bad_input_is_refused_before_the_run(machine: Path) -> None:
    with pytest.raises(ConfigError, match=r"site.*asked for by the sensor compass"):
        load_scenario("flat_drive", [f"machine={machine}", "body=earth"])
    with pytest.raises(ConfigError, match="hazcam_lnk"):
        load_scenario("flat_drive", [f"machine={machine}", "sensors.compass.link=hazcam_lnk"])
    with pytest.raises(ConfigError, match="frozen_stamp: allowed is a fault of its own"):
        load_scenario(
            "flat_drive", [f"machine={machine}", "sensors.compass.faults={a: {frozen_stamp: true, dead: true}}"]
        )
    load_scenario("flat_drive", [f"machine={machine}", "body=moon"])  # of which no dipole is known
