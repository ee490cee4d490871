"""The IMU of every machine on wheels has been levelled before a run, or its first acceleration is taken for a tilt."""

from pathlib import Path

import pytest
import yaml

from sojourn_physics.sensors.imu import ImuParams

ROOT = Path(__file__).parents[2]
ROVERS = [
    path.stem
    for path in sorted((ROOT / "config/rovers").glob("*.yaml"))
    if yaml.safe_load(path.read_text(encoding="utf-8")).get("wheels")
]


@pytest.mark.parametrize("rover", ROVERS)
def test_the_levelling_is_in_its_steady_state_at_the_start(rover: str) -> None:
    name = yaml.safe_load((ROOT / f"config/rovers/{rover}.yaml").read_text(encoding="utf-8"))["sensors"]
    imu = ImuParams(**yaml.safe_load((ROOT / f"config/sensors/{name}.yaml").read_text(encoding="utf-8"))["imu"])
    assert imu.alignment_time * imu.attitude_gain >= 1.0
