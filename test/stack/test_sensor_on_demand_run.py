"""A whole run with a camera that nobody looks through: the run without it, and a bag that is judged and replayed."""

from pathlib import Path

import pytest

from sojourn_bags.comparison import compare
from sojourn_bags.comparison_result import Verdict
from sojourn_bags.judging import judge_bag
from sojourn_bags.reading import Bag, read_bag
from sojourn_bags.run_configuration import run_configuration
from sojourn_stack import run as direct
from sojourn_stack.replay import app_of, replay

ROLES = ("plant", "sensors", "drive", "arm", "power", "operator", "recorder")
SETTINGS = (
    "machine=explorer_cameras",
    "drive.visual_odometry=null",
    "sensors.front=null",
    "sensors.rear=null",
    "sensors.belly=null",
    "steps=[{drive_to: {x: 0.2, y: 0.0}, timeout_s: 60.0}]",
)
ASKED = ("sensors.navcam.on_demand=true", "sensors.powered_by={hazcam: cameras, navcam: cameras}")


@pytest.fixture(scope="module")
def bag(tmp_path_factory: pytest.TempPathFactory) -> Bag:
    folder = tmp_path_factory.mktemp("asked") / "bag"
    direct.run(direct.RunSpec("flat_drive", ROLES, (*SETTINGS, *ASKED), bag=folder))
    return read_bag(folder)


def test_the_rest_of_the_run_is_as_without_it(bag: Bag, tmp_path: Path) -> None:
    without = ("sensors.navcam=null", "sensors.powered_by={hazcam: cameras}")
    direct.run(direct.RunSpec("flat_drive", ROLES, (*SETTINGS, *without), bag=tmp_path / "bag"))
    assert not [name for name in bag.topics if name.startswith("/navcam")]
    assert compare(bag.topics, read_bag(tmp_path / "bag").topics).verdict is Verdict.IDENTICAL


def test_the_contract_is_kept(bag: Bag) -> None:
    assert not list(judge_bag(bag)[0].lines())


@pytest.mark.parametrize("role", ["sensors", "drive"])
def test_its_roles_are_replayed(bag: Bag, role: str) -> None:
    with run_configuration(bag) as configuration:
        assert replay(bag, role, app_of(role, configuration)).comparison.verdict is Verdict.IDENTICAL
