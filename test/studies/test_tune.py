"""scripts/tune: measures a machine in a folder of its own and writes what its drive goes by."""

import shutil
from pathlib import Path

import pytest
import yaml

from sojourn_config.command_errors import UsageError
from sojourn_config.measured_file import MEASURED
from sojourn_config.paths import config_folder
from sojourn_config.scenario import load_scenario
from sojourn_studies import tune


def test_a_machine_that_was_never_measured_is(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """From guesses the same comes out as from what was measured before."""
    machine = tmp_path / "mine"
    shutil.copytree(config_folder() / "machines" / "tracked", machine)
    before = yaml.safe_load((machine / MEASURED).read_text(encoding="utf-8"))
    (machine / MEASURED).unlink()
    assert tune.main([str(machine)]) == 0
    assert "measured.yaml written" in capsys.readouterr().out
    after = yaml.safe_load((machine / MEASURED).read_text(encoding="utf-8"))
    assert after["mobility"]["track_ratio"] == pytest.approx(before["mobility"]["track_ratio"], abs=0.02)
    assert after["odometry"] == pytest.approx(before["odometry"], abs=0.01)
    for key, value in before["energy"].items():
        assert after["energy"][key] == pytest.approx(value, rel=0.05, abs=0.5), key
    scenario = load_scenario("flat_drive", [f"machine={machine}"])
    assert scenario.drive.mobility.track_ratio == after["mobility"]["track_ratio"]
    assert scenario.drive.energy.house_power == after["energy"]["house_power"]


def test_a_machine_that_says_itself_what_would_be_measured_is_left_alone() -> None:
    with pytest.raises(UsageError, match=r"drive says mobility\.track_ratio.* itself"):
        tune.main(["lunokhod"])
    assert not (config_folder() / "machines" / "lunokhod" / MEASURED).exists()
    with pytest.raises(UsageError, match=r"machine\.yaml"):
        tune.main(["no_such_machine"])


@pytest.mark.parametrize(("rover", "tells"), [("articulated", True), ("skid", False), ("tracked", False)])
def test_torque_is_measured_where_it_tells_the_slip(rover: str, tells: bool) -> None:
    """Wheels that slide sideways in a curve need torque for that as well; a track's law has no curve of ours."""
    scenario = load_scenario("flat_drive", [f"machine={rover}"])
    assert tune.tells_slip(scenario, 0.9) == tells
    assert not tune.tells_slip(scenario, 0.04), "on rock no torque tells slip"
