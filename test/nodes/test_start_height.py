"""How high the drive believes its machine to stand at the start, against where the plant puts it."""

import pytest

from sojourn_config.scenario import load_flight, load_scenario
from sojourn_drive.app import DriveApp
from sojourn_plant.start import build_plant


@pytest.mark.parametrize(
    ("scenario", "overrides"),
    [
        ("flat_drive", []),
        ("lunar_route", ["seed=311"]),
        ("lunar_route", ["seed=312", "start.x=8.0", "start.y=-5.0", "start.yaw=2.0"]),
        ("lunar_route", ["seed=313", "machine=skid"]),
        ("lunar_route", ["seed=314", "machine=micro"]),
        ("lunar_route", ["seed=315", "machine=lunokhod"]),
        ("lunar_route", ["seed=316", "machine=tracked"]),
        ("lunar_route", ["seed=317", "machine=articulated"]),
        ("lunar_curves", ["seed=318"]),
        ("parked_slope", []),
    ],
)
def test_it_is_within_its_stated_error(scenario: str, overrides: list[str]) -> None:
    loaded = load_scenario(scenario, overrides)
    app = DriveApp.of(loaded)
    output = app.initial_state().output
    _, truth = build_plant(loaded)
    sigma = float(output.pose_covariance[2, 2]) ** 0.5
    assert abs(output.odometry.z - truth.configuration[2]) < 2.0 * sigma < 0.2
    assert load_flight(scenario, overrides).start_height() == output.odometry.z


def test_it_needs_no_soil_to_tell() -> None:
    assert load_flight("flat_drive", ["soil=none_of_ours"]).start_height() == load_flight("flat_drive").start_height()
