"""The explorer's sensor set: complete for its joints, and of the published quality."""

import numpy as np
import pytest

from sojourn_config.machine_reader import joined_machine
from sojourn_physics.sensors import bus, joints
from sojourn_physics.sensors.bus import BusTelemetryParams
from sojourn_physics.sensors.imu import ImuParams
from sojourn_physics.sensors.joints import JointTruth

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
    imu = PARAMS.first(ImuParams)
    assert imu is not None
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
    true = JointTruth(np.full(19, 0.3), np.zeros(19))
    state = joints.initial_state(PARAMS.joint_groups, 1, names, true)
    telemetry = PARAMS.first(BusTelemetryParams)
    assert telemetry is not None
    channels = bus.initial_state(telemetry, 1, ("battery",))
    for _ in range(50):
        state, out = joints.step(state, true, 0.02)
        channels, read = bus.step(channels, np.array([[29.0, 2.0, 288.0]]))
    assert np.array_equal(out.velocity, np.zeros(19))
    assert out.position == pytest.approx(np.full(19, 0.3), abs=2e-4)
    assert np.abs(out.effort).max() < 1.0
    assert read[0, :2] == pytest.approx([29.0, 2.0], abs=0.15)
