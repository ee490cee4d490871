"""The suite: order of joints, independent random streams, values that can be saved, refusal of bad truth."""

import copy
from dataclasses import replace
from math import inf, nan
from zlib import crc32

import numpy as np
import pytest
from pydantic import ValidationError

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray
from sojourn_physics.sensors import noise, suite
from sojourn_physics.sensors.params import SensorSuiteParams
from sojourn_physics.sensors.suite import SensorMeasurements, SensorSuiteState, SensorTruth

CHANNEL = {"resolution": 0.01, "noise": 0.02, "offset": 0.02, "minimum": -50.0, "maximum": 400.0}
VALUES: dict[str, object] = {
    "joint_groups": {
        "drive": {
            "joints": ["wheel_b", "wheel_a"],
            "encoder": {"bits": 12, "side": "motor", "gear_ratio": 100.0},
            "effort_resolution": 0.05,
            "effort_noise": 0.2,
        },
        "arm": {
            "joints": ["elbow"],
            "encoder": {"bits": 18, "side": "output", "rate_window": 3},
            "effort_resolution": 0.01,
            "effort_noise": 0.05,
        },
    },
    "imu": {
        "gyro_arw_deg_per_sqrt_hour": 0.07,
        "gyro_bias_deg_per_hour": 1.0,
        "accelerometer_noise_micro_g_per_sqrt_hz": 35.0,
        "accelerometer_bias_micro_g": 300.0,
        "attitude_gain": 0.01,
        "attitude_gate": 0.1,
    },
    "bus": {"voltage": CHANNEL, "current": CHANNEL, "temperature": CHANNEL},
}
PARAMS = SensorSuiteParams.model_validate(VALUES)
JOINTS = ("wheel_a", "rocker", "elbow", "wheel_b")
LEVEL = np.array([0.0, 0.0, 0.0, 1.0])


def start(params: SensorSuiteParams = PARAMS, seed: int = 4) -> SensorSuiteState:
    return suite.initial_state(params, seed, JOINTS, np.zeros(4), ("main",), LEVEL, 1.62)


def truth(k: int = 0) -> SensorTruth:
    return SensorTruth(
        joint_position=np.array([0.1, 0.2, -0.3, 0.4]) * (1 + k),
        joint_effort=np.array([1.0, 2.0, 3.0, 4.0]),
        angular_velocity_imu_in_imu=np.array([0.0, 0.0, 0.01]),
        specific_force_imu_in_imu=np.array([0.0, 0.0, 1.62]),
        bus_voltage=np.array([28.0]),
        bus_current=np.array([3.0]),
        bus_temperature=np.array([290.0]),
    )


def numbers(out: SensorMeasurements) -> FloatArray:
    return np.concatenate(
        [
            out.joint_position,
            out.joint_velocity,
            out.joint_effort,
            out.imu.angular_velocity,
            out.imu.specific_force,
            out.imu.orientation,
            out.bus_voltage,
            out.bus_current,
            out.bus_temperature,
        ]
    )


def run(params: SensorSuiteParams, state: SensorSuiteState, count: int) -> tuple[SensorSuiteState, FloatArray]:
    rows = []
    for k in range(count):
        state, out = suite.step(params, state, truth(k), 0.02)
        rows.append(numbers(out))
    return state, np.array(rows)


def test_measured_joints_keep_the_order_of_the_truth() -> None:
    state, out = suite.step(PARAMS, start(), truth(), 0.02)
    assert state.layout.joint_names == ("wheel_a", "elbow", "wheel_b")
    assert out.joint_position == pytest.approx([0.1, -0.3, 0.4], abs=1e-4)
    assert out.joint_velocity == pytest.approx([5.0, -15.0, 20.0], abs=1e-2)
    assert out.joint_effort == pytest.approx([1.0, 3.0, 4.0], abs=1.0)


def test_effort_has_the_noise_and_resolution_of_its_group() -> None:
    _, rows = run(PARAMS, start(), 2000)
    effort = rows[:, 6:9]
    assert effort.mean(axis=0) == pytest.approx([1.0, 3.0, 4.0], abs=0.02)
    assert effort.std(axis=0) == pytest.approx([0.2, 0.05, 0.2], rel=0.07)
    assert np.allclose(effort[:, 0] / 0.05, np.round(effort[:, 0] / 0.05))


def test_the_same_seed_gives_the_same_readings_and_another_gives_others() -> None:
    _, first = run(PARAMS, start(), 600)
    _, second = run(PARAMS, start(), 600)
    _, other = run(PARAMS, start(seed=5), 600)
    assert np.array_equal(first, second)
    assert not np.array_equal(first[:, 9:12], other[:, 9:12])


def test_a_saved_state_goes_on_as_the_original_and_stepping_changes_no_old_state() -> None:
    state, _ = run(PARAMS, start(), 250)  # a block of random rows ends between the two runs
    saved = copy.deepcopy(state)
    _, first = run(PARAMS, state, 300)
    _, again = run(PARAMS, state, 300)
    _, restored = run(PARAMS, saved, 300)
    assert np.array_equal(first, again)
    assert np.array_equal(first, restored)


def test_a_new_sensor_changes_no_number_of_the_others() -> None:
    more = copy.deepcopy(VALUES)
    groups = more["joint_groups"]
    assert isinstance(groups, dict)
    groups["suspension"] = {
        "joints": ["rocker"],
        "encoder": {"bits": 12, "side": "output"},
        "effort_resolution": 0.1,
        "effort_noise": 0.1,
    }
    bigger = SensorSuiteParams.model_validate(more)
    state, small = start(), []
    large_state, large = start(bigger), []
    for k in range(300):
        state, out = suite.step(PARAMS, state, truth(k), 0.02)
        large_state, wide = suite.step(bigger, large_state, truth(k), 0.02)
        small.append(numbers(out))
        keep = [0, 2, 3]
        large.append(
            numbers(
                replace(
                    wide,
                    joint_position=wide.joint_position[keep],
                    joint_velocity=wide.joint_velocity[keep],
                    joint_effort=wide.joint_effort[keep],
                )
            )
        )
    assert np.array_equal(small, large)


def test_a_stream_is_the_numpy_sequence_of_its_seed_and_name() -> None:
    stream, rows = noise.initial_stream(42, "imu", 6), []
    for _ in range(noise.ROWS + 10):
        stream, row = noise.draw(stream)
        rows.append(row)
    words = np.random.SeedSequence([42, crc32(b"imu")])
    expected = np.random.Generator(np.random.PCG64(words)).standard_normal((noise.ROWS + 10, 6))
    assert np.array_equal(rows, expected)


def test_streams_side_by_side_are_each_its_own() -> None:
    widths = {"imu": 6, "wrist": 1, "effort.arm": 3}
    together, alone = noise.initial_streams(42, widths), [noise.initial_stream(42, *one) for one in widths.items()]
    for _ in range(2 * noise.ROWS + 10):
        together, row = noise.draw(together)
        drawn = [noise.draw(stream) for stream in alone]
        alone = [stream for stream, _ in drawn]
        assert row.tolist() == [number for _, part in drawn for number in part.tolist()]


@pytest.mark.parametrize("bad", [nan, inf, -inf])
@pytest.mark.parametrize(
    "name",
    [
        "joint_position",
        "joint_effort",
        "angular_velocity_imu_in_imu",
        "specific_force_imu_in_imu",
        "bus_voltage",
        "bus_current",
        "bus_temperature",
    ],
)
def test_truth_that_is_no_number_is_refused_by_name(name: str, bad: float) -> None:
    value = getattr(truth(), name).copy()
    value[-1] = bad
    with pytest.raises(InvalidValueError, match=f"truth {name}.*finite"):
        suite.step(PARAMS, start(), replace(truth(), **{name: value}), 0.02)


def test_truth_of_the_wrong_length_is_refused_by_name() -> None:
    with pytest.raises(InvalidValueError, match=r"shape of truth joint_effort.*\(4,\)"):
        suite.step(PARAMS, start(), replace(truth(), joint_effort=np.zeros(3)), 0.02)
    with pytest.raises(InvalidValueError, match="shape of truth bus_voltage"):
        suite.step(PARAMS, start(), replace(truth(), bus_voltage=np.zeros(2)), 0.02)


def test_bad_starts_and_steps_are_refused() -> None:
    for dt in (0.0, -0.02, nan):
        with pytest.raises(InvalidValueError, match="dt"):
            suite.step(PARAMS, start(), truth(), dt)
    with pytest.raises(InvalidValueError, match=r"'elbow'.*one of wheel_a, wheel_b"):
        suite.initial_state(PARAMS, 4, ("wheel_a", "wheel_b"), np.zeros(2), ("main",), LEVEL, 1.62)
    with pytest.raises(InvalidValueError, match="joint_position"):
        suite.initial_state(PARAMS, 4, JOINTS, np.array([0.0, nan, 0.0, 0.0]), ("main",), LEVEL, 1.62)
    with pytest.raises(InvalidValueError, match="orientation_imu_in_world"):
        suite.initial_state(PARAMS, 4, JOINTS, np.zeros(4), ("main",), np.zeros(3), 1.62)


def test_a_joint_in_two_groups_is_refused() -> None:
    twice = copy.deepcopy(VALUES)
    groups = twice["joint_groups"]
    assert isinstance(groups, dict)
    groups["arm"]["joints"] = ["elbow", "wheel_a"]
    with pytest.raises(ValidationError, match="'wheel_a' is in 'drive' and 'arm'"):
        SensorSuiteParams.model_validate(twice)
