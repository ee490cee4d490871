"""The explorer's sensor set: complete for its joints, and of the published quality."""

import numpy as np
import pytest

from sojourn_config.machine_reader import joined_machine
from sojourn_physics.sensors import suite

EXPLORER = joined_machine("explorer")
PARAMS = EXPLORER.sensors


def test_every_joint_of_the_machine_is_measured_once() -> None:
    joints = [joint for group in PARAMS.joint_groups.values() for joint in group.joints]
    corners = ("front_left", "front_right", "rear_left", "rear_right")
    wheels = (*corners, "middle_left", "middle_right")
    expected = {f"wheel_{name}_joint" for name in wheels} | {f"steer_{name}_joint" for name in corners}
    expected |= {f"{part}_{side}_joint" for part in ("rocker", "bogie") for side in ("left", "right")}
    expected |= {f"arm_{name}_joint" for name in ("azimuth", "elevation", "elbow", "wrist", "turret")}
    assert len(joints) == 19 and set(joints) == expected


def test_the_imu_is_the_published_one() -> None:
    imu = PARAMS.imu
    assert (imu.gyro_arw_deg_per_sqrt_hour, imu.gyro_bias_deg_per_hour) == (0.07, 1.0)
    assert imu.accelerometer_noise_micro_g_per_sqrt_hz == 35.0
    assert imu.accelerometer_bias_micro_g == 300.0


def test_encoders_are_within_the_published_bits_and_fine_enough_to_work_with() -> None:
    for name, group in PARAMS.joint_groups.items():
        assert 12 <= group.encoder.bits <= 20
        rate_step = group.encoder.resolution / (group.encoder.rate_window * 0.02)
        assert rate_step < (0.01 if name == "suspension" else 1e-3)


def test_encoders_on_motors_count_with_the_gears_of_the_rover() -> None:
    ratios = {joint: drive.gear.ratio for drive in EXPLORER.config.drives for joint in drive.joints}
    compared = 0
    for group in PARAMS.joint_groups.values():
        if group.encoder.side == "motor":
            assert {ratios[joint] for joint in group.joints} == {group.encoder.gear_ratio}
            compared += len(group.joints)
    assert compared == len(ratios) == 15


def test_a_rover_at_rest_reads_as_at_rest() -> None:
    names = tuple(joint for group in PARAMS.joint_groups.values() for joint in group.joints)
    level = np.array([0.0, 0.0, 0.0, 1.0])
    state = suite.initial_state(PARAMS, 1, names, np.full(19, 0.3), ("battery",), level, 1.62)
    truth = suite.SensorTruth(
        joint_position=np.full(19, 0.3),
        joint_effort=np.zeros(19),
        angular_velocity_imu_in_imu=np.zeros(3),
        specific_force_imu_in_imu=np.array([0.0, 0.0, 1.62]),
        bus_voltage=np.array([29.0]),
        bus_current=np.array([2.0]),
        bus_temperature=np.array([288.0]),
    )
    for _ in range(50):
        state, out = suite.step(PARAMS, state, truth, 0.02)
    assert np.array_equal(out.joint_velocity, np.zeros(19))
    assert out.joint_position == pytest.approx(np.full(19, 0.3), abs=2e-4)
    assert np.abs(out.joint_effort).max() < 1.0
    assert out.bus_voltage[0] == pytest.approx(29.0, abs=0.15)
    assert out.bus_current[0] == pytest.approx(2.0, abs=0.15)
