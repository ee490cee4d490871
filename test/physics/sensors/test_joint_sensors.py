"""Encoders and efforts of all joints: their order, independent random streams, values that can be saved, refusal of bad
truth.
"""

import copy
from dataclasses import replace
from math import inf, nan
from typing import Any
from zlib import crc32

import numpy as np
import pytest
from pydantic import ValidationError

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray
from sojourn_physics.sensors import joints, noise
from sojourn_physics.sensors.joints import JointMeasurement, JointSensorState, JointTruth
from sojourn_physics.sensors.params import SensorSuiteParams

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


def start(params: SensorSuiteParams = PARAMS, seed: int = 4) -> JointSensorState:
    return joints.initial_state(params.joint_groups, seed, JOINTS, JointTruth(np.zeros(4), np.zeros(4)))


def truth(k: int = 0) -> JointTruth:
    return JointTruth(np.array([0.1, 0.2, -0.3, 0.4]) * (1 + k), np.array([1.0, 2.0, 3.0, 4.0]))


def numbers(read: JointMeasurement) -> FloatArray:
    return np.concatenate([read.position, read.velocity, read.effort])


def run(state: JointSensorState, count: int) -> tuple[JointSensorState, FloatArray]:
    rows = []
    for k in range(count):
        state, read = joints.step(state, truth(k), 0.02)
        rows.append(numbers(read))
    return state, np.array(rows)


def test_measured_joints_keep_the_order_of_the_truth() -> None:
    state, read = joints.step(start(), truth(), 0.02)
    assert state.layout.joint_names == ("wheel_a", "elbow", "wheel_b")
    assert read.position == pytest.approx([0.1, -0.3, 0.4], abs=1e-4)
    assert read.velocity == pytest.approx([5.0, -15.0, 20.0], abs=1e-2)
    assert read.effort == pytest.approx([1.0, 3.0, 4.0], abs=1.0)


def test_an_encoder_on_the_motor_reads_the_motor() -> None:
    _, read = joints.step(start(), replace(truth(), motor_position=truth().position + 0.01), 0.02)
    assert read.position == pytest.approx([0.11, -0.3, 0.41], abs=1e-4)


def test_effort_has_the_noise_and_resolution_of_its_group() -> None:
    _, rows = run(start(), 2000)
    effort = rows[:, 6:9]
    assert effort.mean(axis=0) == pytest.approx([1.0, 3.0, 4.0], abs=0.02)
    assert effort.std(axis=0) == pytest.approx([0.2, 0.05, 0.2], rel=0.07)
    assert np.allclose(effort[:, 0] / 0.05, np.round(effort[:, 0] / 0.05))


def test_the_same_seed_gives_the_same_readings_and_another_gives_others() -> None:
    _, first = run(start(), 600)
    _, second = run(start(), 600)
    _, other = run(start(seed=5), 600)
    assert np.array_equal(first, second)
    assert not np.array_equal(first[:, 6:9], other[:, 6:9])


def test_a_saved_state_goes_on_as_the_original_and_stepping_changes_no_old_state() -> None:
    state, _ = run(start(), 250)  # a block of random rows ends between the two runs
    saved = copy.deepcopy(state)
    _, first = run(state, 300)
    _, again = run(state, 300)
    _, restored = run(saved, 300)
    assert np.array_equal(first, again)
    assert np.array_equal(first, restored)


def test_a_new_group_changes_no_number_of_the_others() -> None:
    more = copy.deepcopy(VALUES)
    groups = more["joint_groups"]
    assert isinstance(groups, dict)
    groups["suspension"] = {
        "joints": ["rocker"],
        "encoder": {"bits": 12, "side": "output"},
        "effort_resolution": 0.1,
        "effort_noise": 0.1,
    }
    _, small = run(start(), 300)
    _, large = run(start(SensorSuiteParams.model_validate(more)), 300)
    kept = [column + 4 * block for block in range(3) for column in (0, 2, 3)]
    assert np.array_equal(small, large[:, kept])


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
@pytest.mark.parametrize("name", ["position", "effort", "motor_position"])
def test_truth_that_is_no_number_is_refused_by_name(name: str, bad: float) -> None:
    value = truth().position.copy()
    value[-1] = bad
    with pytest.raises(InvalidValueError, match=rf"truth \w*{name}.*finite"):
        joints.step(start(), replace(truth(), **{name: value}), 0.02)


def test_truth_of_the_wrong_length_is_refused_by_name() -> None:
    with pytest.raises(InvalidValueError, match=r"shape of truth joint_effort.*\(4,\)"):
        joints.step(start(), replace(truth(), effort=np.zeros(3)), 0.02)


def test_bad_starts_and_steps_are_refused() -> None:
    for dt in (0.0, -0.02, nan):
        with pytest.raises(InvalidValueError, match="dt"):
            joints.step(start(), truth(), dt)
    with pytest.raises(InvalidValueError, match=r"'elbow'.*one of wheel_a, wheel_b"):
        joints.initial_state(PARAMS.joint_groups, 4, ("wheel_a", "wheel_b"), JointTruth(np.zeros(2), np.zeros(2)))
    with pytest.raises(InvalidValueError, match="joint_position"):
        bad = JointTruth(np.array([0.0, nan, 0.0, 0.0]), np.zeros(4))
        joints.initial_state(PARAMS.joint_groups, 4, JOINTS, bad)


def test_a_joint_in_two_groups_is_refused() -> None:
    twice = copy.deepcopy(VALUES)
    groups = twice["joint_groups"]
    assert isinstance(groups, dict)
    groups["arm"]["joints"] = ["elbow", "wheel_a"]
    with pytest.raises(ValidationError, match="'wheel_a' is in 'drive' and 'arm'"):
        SensorSuiteParams.model_validate(twice)


SUN: dict[str, Any] = {"link": "deck", "field_of_view_deg": 60.0, "noise_deg": 0.1, "misalignment_deg": 0.1}


def test_a_sensor_is_of_the_kind_of_its_name_unless_it_says_another() -> None:
    suite = SensorSuiteParams.model_validate({**VALUES, "sun": SUN, "sun_rear": {**SUN, "kind": "sun"}, "wrist": None})
    assert {name: params.kind for name, params in suite.named.items()} == {
        "imu": "imu", "bus": "bus", "sun": "sun", "sun_rear": "sun",
    }  # fmt: skip
    assert suite.first_on("/sun_direction") is suite.named["sun"] and suite.first_on("/wrist/wrench") is None
    assert SensorSuiteParams.model_validate_json(suite.model_dump_json()) == suite


@pytest.mark.parametrize(
    ("change", "place", "reason"),
    [
        ({"sunn": SUN}, ("sunn", "kind"), "sunn.*did you mean sun"),
        ({"sun": {**SUN, "noise_deg": "0.1"}}, ("sun", "noise_deg"), "number"),
        ({"sun": {**SUN, "colour": 1}}, ("sun", "colour"), "not permitted"),
        ({"sun": 3}, ("sun",), "dictionary"),
        ({"imu": None}, ("imu",), "required"),
        ({"bus": None}, ("bus",), "required"),
        ({"bus_b": {**VALUES["bus"], "kind": "bus"}}, (), "one sensor of the kind 'bus'"),  # type: ignore[dict-item]
        ({"2nd sun": {**SUN, "kind": "sun"}}, (), "'2nd sun'"),
    ],
)
def test_what_is_no_sensor_is_refused_with_its_place(
    change: dict[str, Any], place: tuple[str, ...], reason: str
) -> None:
    with pytest.raises(ValidationError, match=f"(?s){reason}") as raised:
        SensorSuiteParams.model_validate({**VALUES, **change})
    assert [error["loc"] for error in raised.value.errors()] == [place]
