"""What the verdict says of the power manager: its modes and the charge, where it has not been NOMINAL all along."""

from pathlib import Path

import pytest
from synthetic import PERIOD, SyntheticRun

from sojourn_bags.power_modes import ModeChange, mode_changes, power_words
from sojourn_bags.reading import Bag, read_bag
from sojourn_bags.summary import summarise
from sojourn_contract.heartbeat import status_message

CHARGE = [0.6, 0.131, 0.19]


def recorded(folder: Path, modes: list[str]) -> Bag:
    """A run whose power manager says a mode each second."""
    run = SyntheticRun(folder)
    for second, mode in enumerate(modes, start=1):
        stamp = second * 50 * PERIOD
        run.write("/power/status", stamp, status_message(stamp, "power", {"mode": mode}))
    run.close(len(modes) * 50 * PERIOD)
    return read_bag(folder)


def test_each_change_is_found_once(tmp_path: Path) -> None:
    bag = recorded(tmp_path / "bag", ["NOMINAL", "NOMINAL", "LOW", "LOW", "SAFE", "NOMINAL"])
    told = [ModeChange(1.0, "NOMINAL"), ModeChange(3.0, "LOW"), ModeChange(5.0, "SAFE"), ModeChange(6.0, "NOMINAL")]
    assert mode_changes(bag) == told
    summary = summarise(bag)
    assert summary["power_modes"][1] == {"time_s": 3.0, "mode": "LOW"}
    assert "Power: NOMINAL from 1 s on, LOW from 3 s on, SAFE from 5 s on, NOMINAL from 6 s on." in summary["verdict"]


def test_nothing_is_said_of_a_run_that_was_nominal(tmp_path: Path) -> None:
    bag = recorded(tmp_path / "bag", ["NOMINAL"] * 3)
    assert "Power" not in summarise(bag)["verdict"]
    assert power_words([], CHARGE) == ""


def test_a_bag_without_a_power_manager_has_no_modes(reference_without_power: Bag) -> None:
    assert mode_changes(reference_without_power) == []


@pytest.fixture
def reference_without_power(tmp_path: Path) -> Bag:
    run = SyntheticRun(tmp_path / "silent")
    run.close(PERIOD, "plant,sensors,drive,arm,operator,recorder")
    return read_bag(tmp_path / "silent")


def test_a_sleep_is_told_with_its_charge_and_long_times_in_hours() -> None:
    asleep = power_words([ModeChange(1.0, "NOMINAL"), ModeChange(9000.0, "SLEEP")], CHARGE)
    assert asleep == (
        "Power: NOMINAL from 1 s on, SLEEP from 2.5 h on; charge 60% at the start, 13% at least, 19% at the end."
    )


def test_of_many_changes_the_first_are_told_and_the_last() -> None:
    modes = [ModeChange(float(at), "LOW" if at % 2 else "NOMINAL") for at in range(1, 8)]
    assert power_words(modes, []) == (
        "Power: LOW from 1 s on, NOMINAL from 2 s on, LOW from 3 s on, NOMINAL from 4 s on, "
        "3 more changes and LOW at the end."
    )
