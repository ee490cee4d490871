"""Truth and belief: what a run does to the machine, and what the machine's own computer goes by."""

from dataclasses import fields
from typing import get_type_hints

import pytest

from sojourn_arm.app import ArmApp
from sojourn_config.errors import ConfigError
from sojourn_config.flight import FlightScenario
from sojourn_config.paths import available
from sojourn_config.scenario import load_flight, load_scenario
from sojourn_drive.app import DriveApp
from sojourn_power.app import PowerApp

TRUTH = {"soil", "rock_soil", "extra_soils", "soils", "config", "raster", "digests", "belief", "overrides", "terrain"}
"""What the plant is made of and no computer on board knows."""


def test_without_overrides_they_are_one() -> None:
    scenario = load_scenario("flat_drive", ["soil=jsc_1a", "drive.limits.max_speed=0.05"])
    known = scenario.as_believed()
    assert scenario.belief is None and scenario.drive.limits.max_speed == 0.05
    assert all(value is getattr(known, name) for name, value in scenario.known_fields().items())


@pytest.mark.parametrize("name", available("scenarios"))
def test_what_the_flight_side_loads_is_what_is_believed(name: str) -> None:
    """Read alone, from fewer files, it is the same."""
    known, loaded = load_flight(name), load_scenario(name).as_believed()
    assert known.urdf.text == loaded.urdf.text
    named = [field.name for field in fields(known) if field.name != "start_height"]
    differing = [name for name in named if getattr(known, name) != getattr(loaded, name)]
    assert differing in ([], ["urdf"])  # of which each loading makes another object
    assert known.start_height() == loaded.start_height()


@pytest.mark.parametrize(
    "overrides", [["battery.capacity_ah=1.5"], ["belief.battery.capacity_ah=1.5", "blind_drive=true"]]
)
def test_what_is_set_apart_is_loaded_apart(overrides: list[str]) -> None:
    known, loaded = load_flight("lunar_sample", overrides), load_scenario("lunar_sample", overrides).as_believed()
    assert known.power == loaded.power and known.power_manager == loaded.power_manager and known.drive == loaded.drive
    believed = 1.5 if overrides[0].startswith("belief") else load_scenario("lunar_sample").power.battery.capacity_ah
    assert known.power.battery.capacity_ah == believed


def test_no_truth_can_be_reached_from_it() -> None:
    known = load_scenario("lunar_sample", ["battery.capacity_ah=1.5"]).as_believed()
    assert not TRUTH & set(dir(known)) and set(dir(load_scenario("lunar_sample"))) >= TRUTH
    reached = " ".join(repr(getattr(known, field.name)) for field in fields(known))
    assert "capacity_ah=1.5" not in reached and "cohesion=" not in reached
    for app in (DriveApp, ArmApp, PowerApp):
        assert set(get_type_hints(app.__init__)) == {"known", "return"}
        assert get_type_hints(app.__init__)["known"] is FlightScenario


def test_the_flight_side_reads_no_file_of_the_ground() -> None:
    """Such as are not there, or make no sense, do not matter to it."""
    overrides = ["soil=none_of_ours", "rock_soil=none_of_ours", "soil.cohesion=-1"]
    with pytest.raises(ConfigError, match="none_of_ours"):
        load_scenario("flat_drive", overrides)
    assert load_flight("flat_drive", overrides).machine == load_scenario("flat_drive").machine


def test_a_battery_that_has_aged_is_not_known_to_the_power_manager() -> None:
    scenario = load_scenario("flat_drive", ["battery.capacity_ah=1.5", "bus.lockout_voltage=23.0"])
    known = scenario.as_believed()
    assert scenario.power.battery.capacity_ah == 1.5 and scenario.power.bus.lockout_voltage == 23.0
    assert known.power == load_scenario("flat_drive").power == PowerApp(scenario.as_believed()).params.power
    assert known.power_manager == load_scenario("flat_drive").power_manager
    assert known.machine == scenario.machine and known.drive == scenario.drive


def test_a_belief_changes_nothing_true() -> None:
    beliefs = ["belief.battery.capacity_ah=1.5", "belief.body.gravitational_parameter=4.5e+12"]
    scenario = load_scenario("flat_drive", beliefs)
    assert scenario.power == load_scenario("flat_drive").power
    assert scenario.gravity == load_scenario("flat_drive").gravity
    assert PowerApp(scenario.as_believed()).params.power.battery.capacity_ah == 1.5
    assert scenario.as_believed().gravity < 0.95 * scenario.gravity


def test_both_may_be_set_apart_and_both_drive_blind() -> None:
    given = ["battery.capacity_ah=1.5", "belief.battery.capacity_ah=2.5", "blind_drive=true"]
    scenario = load_scenario("lunar_sample", given)
    assert scenario.power.battery.capacity_ah == 1.5
    assert scenario.as_believed().power_manager.power.battery.capacity_ah == 2.5
    assert scenario.drive.obstacles is None and scenario.as_believed().drive.obstacles is None
    DriveApp(scenario.as_believed()), ArmApp(scenario.as_believed())


@pytest.mark.parametrize(
    ("belief", "words"),
    [
        ("belief.start.x=1", "battery, body, bus"),
        ("belief.machine=1", "belief.FILE.KEY=VALUE"),
        ("belief.battery.capacity_ah=-1", "capacity_ah"),
        ("belief.battery.capacty_ah=1", "capacty_ah"),
    ],
)
def test_a_belief_that_makes_no_sense_is_refused(belief: str, words: str) -> None:
    with pytest.raises(ConfigError, match=r"belief|capac") as told:
        load_scenario("flat_drive", [belief])
    assert words in str(told.value)
