"""A spacecraft from its files, in a whole run: its hand reaches places in space, momentum is kept, wings go dark."""

from pathlib import Path

import numpy as np
import pytest

from sojourn_bags.afloat import base_motion, momenta
from sojourn_bags.judging import judge_bag
from sojourn_bags.machine import TrueMachine
from sojourn_bags.page.page import write_page
from sojourn_bags.reading import Bag, read_bag
from sojourn_bags.report import write_report
from sojourn_bags.summary import summarise
from sojourn_bags.summary_reading import read_for_summary
from sojourn_config.errors import ConfigError
from sojourn_config.scenario import load_scenario
from sojourn_stack import run as direct

ROLES = ("plant", "sensors", "arm", "power", "operator", "recorder")


def run(folder: Path, *overrides: str) -> Bag:
    direct.run(direct.RunSpec("servicer_course", ROLES, overrides, bag=folder))
    return read_bag(folder)


@pytest.fixture(scope="module")
def flown(tmp_path_factory: pytest.TempPathFactory) -> Bag:
    """Turned, ahead of the middle of map, with other noise than in the course."""
    changed = ("seed=7", "start={x: 3.0, yaw: 0.6}")
    return run(tmp_path_factory.mktemp("flown") / "bag", *changed)


def test_its_hand_reaches_places_in_space_although_the_base_gives_way(flown: Bag) -> None:
    summary = summarise(flown)
    assert summary["all_met"] and summary["complete"], summary["verdict"]
    assert summary["arm_error_m"] < 0.003 < summary["base_moved_m"]
    assert summary["base_turned_deg"] > 1.0 and summary["centre_of_mass_moved_m"] < 0.001
    assert summary["max_tilt_deg"] is None and summary["distance_m"] is None
    assert judge_bag(flown)[0].violations == 0
    assert summarise(read_for_summary(flown.path)) == summary
    said = flown["/arm/status"].statuses()[-1]
    assert float(said["base_turned_deg"]) >= 0.0 and "corrections" in said


def test_what_the_arm_has_of_momentum_the_base_takes_up(flown: Bag) -> None:
    scenario = load_scenario("servicer_course")
    _, found = momenta(flown)
    motion = base_motion(flown, TrueMachine(flown, scenario.urdf_xml))
    speeds = np.linalg.norm(np.diff(motion.base, axis=0), axis=1) / np.diff(motion.times)
    rates = np.abs(np.diff(motion.turn)) / np.diff(motion.times)
    given_linear, given_angular = 500.0 * speeds.max(), 120.0 * rates.max()  # to the base alone
    assert np.linalg.norm(found[:, :3], axis=1).max() < 2e-3 * given_linear
    # against map, which turns with the orbit: inertia that has changed turns with it at another rate
    assert np.linalg.norm(found[:, 3:], axis=1).max() < 2e-3 * given_angular


def test_reports_tell_of_the_base(flown: Bag, tmp_path: Path) -> None:
    write_page(flown, tmp_path / "page.html", judged=False)
    page = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert "Turn of the base" in page and "Momentum of all links" in page and "tip-over" not in page
    write_report(flown, tmp_path / "report.png")
    assert (tmp_path / "report.png").stat().st_size > 50_000


@pytest.mark.parametrize(("elevation", "lit"), [(60.0, True), (-60.0, False)])
def test_its_wings_are_dark_behind_the_earth(elevation: float, lit: bool, tmp_path: Path) -> None:
    changes = (f"sun={{azimuth_deg: 270.0, elevation_deg: {elevation}}}", "steps=[{wait_s: 1.0}]")
    bag = run(tmp_path / "bag", *changes)
    power = np.array([float(status["source wings"]) for status in bag["/truth/loads"].statuses()])
    assert (power[1:] > 800.0).all() if lit else (power == 0.0).all()


@pytest.mark.parametrize(
    ("overrides", "words"),
    [
        (["body=moon"], ["body = 'moon'", "servicer floats free and would fall"]),
        (["steps=[{drive_to: {x: 1.0, y: 0.0}}]"], ["steps[0].drive_to", "floats free: it has no wheels"]),
        (["drive.goal_tolerance=1"], ["a spacecraft does not drive"]),
        (["machine.fixed_base=true"], ["fixed_base = true", "allowed is one of False"]),
        (["machine=puma560", "start.z=5"], ["start.z = 5", "puma560 does not float free"]),
        (["machine=puma560", "start.velocity=[0.1, 0.0, 0.0]"], ["start.velocity", "puma560 does not float free"]),
    ],
)
def test_what_does_not_fit_is_refused_in_words(overrides: list[str], words: list[str]) -> None:
    with pytest.raises(ConfigError) as refused:
        load_scenario("servicer_course", overrides)
    assert all(word in str(refused.value) for word in words), str(refused.value)
