"""The IMU of every machine has been levelled before a run, or its first acceleration is taken for a tilt."""

import pytest

from sojourn_config.machine_reader import joined_machine
from sojourn_config.paths import available
from sojourn_physics.sensors.imu import ImuParams


@pytest.mark.parametrize("machine", available("machines"))
def test_the_levelling_is_in_its_steady_state_at_the_start(machine: str) -> None:
    imu = joined_machine(machine).sensors.first(ImuParams)
    assert imu.alignment_time * imu.attitude_gain >= 1.0
