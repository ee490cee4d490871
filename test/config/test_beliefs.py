"""Truth and belief: what a run does to the machine, and what the machine's own computer goes by."""

import pytest

from sojourn_arm.app import ArmApp
from sojourn_config.errors import ConfigError
from sojourn_config.scenario import load_scenario
from sojourn_drive.app import DriveApp
from sojourn_power.app import PowerApp


def test_without_overrides_they_are_one() -> None:
    scenario = load_scenario("flat_drive", ["soil=jsc_1a", "drive.limits.max_speed=0.05"])
    assert scenario.belief is None and scenario.as_believed() is scenario
    assert scenario.drive.limits.max_speed == 0.05


def test_a_battery_that_has_aged_is_not_known_to_the_power_manager() -> None:
    scenario = load_scenario("flat_drive", ["battery.capacity_ah=1.5", "bus.lockout_voltage=23.0"])
    known = scenario.as_believed()
    assert scenario.battery.capacity_ah == 1.5 and scenario.bus.lockout_voltage == 23.0
    assert known.battery == load_scenario("flat_drive").battery == PowerApp(scenario).params.battery
    assert known.power_manager == load_scenario("flat_drive").power_manager
    assert known.machine == scenario.machine and known.drive == scenario.drive


def test_a_belief_changes_nothing_true() -> None:
    beliefs = ["belief.battery.capacity_ah=1.5", "belief.body.gravitational_parameter=4.5e+12"]
    scenario = load_scenario("flat_drive", beliefs)
    assert scenario.battery == load_scenario("flat_drive").battery
    assert scenario.gravity == load_scenario("flat_drive").gravity
    assert PowerApp(scenario).params.battery.capacity_ah == 1.5
    assert scenario.as_believed().gravity < 0.95 * scenario.gravity


def test_both_may_be_set_apart_and_both_drive_blind() -> None:
    given = ["battery.capacity_ah=1.5", "belief.battery.capacity_ah=2.5", "blind_drive=true"]
    scenario = load_scenario("lunar_sample", given)
    assert scenario.battery.capacity_ah == 1.5
    assert scenario.as_believed().power_manager.battery.capacity_ah == 2.5
    assert scenario.drive.obstacles is None and scenario.as_believed().drive.obstacles is None
    DriveApp(scenario), ArmApp(scenario)  # both are made of what is believed


@pytest.mark.parametrize(
    ("belief", "words"),
    [
        ("belief.start.x=1", "battery, body, bus"),
        ("belief.battery=1", "belief.FILE.KEY=VALUE"),
        ("belief.battery.capacity_ah=-1", "capacity_ah"),
        ("belief.battery.capacty_ah=1", "capacty_ah"),
    ],
)
def test_a_belief_that_makes_no_sense_is_refused(belief: str, words: str) -> None:
    with pytest.raises(ConfigError, match=r"belief|capac") as told:
        load_scenario("flat_drive", [belief])
    assert words in str(told.value)
