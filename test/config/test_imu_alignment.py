"""Every rover's IMU has been levelled before a run, or its first acceleration is taken for a tilt."""

import pytest

from sojourn_config.paths import available
from sojourn_config.scenario import load_scenario


@pytest.mark.parametrize("rover", available("rovers"))
def test_the_levelling_is_in_its_steady_state_at_the_start(rover: str) -> None:
    imu = load_scenario("flat_drive", [f"rover={rover}"]).sensors.imu
    assert imu.alignment_time * imu.attitude_gain >= 1.0
