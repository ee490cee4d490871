"""Kinds of angle sensors: each against what it cannot lose, its closed form, or the statistics that it is given."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from sojourn_machine.params import FloatArray
from sojourn_physics.sensors import angle_sensor, encoder, joints
from sojourn_physics.sensors.absolute_encoder import AbsoluteEncoderParams
from sojourn_physics.sensors.angle_sensor import TURN, AngleSensorParams
from sojourn_physics.sensors.encoder import EncoderParams
from sojourn_physics.sensors.incremental_encoder import IncrementalEncoderParams
from sojourn_physics.sensors.joints import JointTruth
from sojourn_physics.sensors.params import JointGroupParams
from sojourn_physics.sensors.potentiometer import PotentiometerParams
from sojourn_physics.sensors.resolver import ResolverParams, Windings
from sojourn_physics.sensors.tachometer import TachometerParams

DT = 0.02
WALKS = st.lists(st.floats(-2.0, 2.0), min_size=1, max_size=40)


def read(params: AngleSensorParams, angles: Any, seed: int = 1) -> tuple[FloatArray, FloatArray]:
    """Angles and rates that are told of a joint, from the second angle on."""
    state = angle_sensor.initial_state(params, seed, "angle.joint", float(angles[0]))
    told = []
    for angle in angles[1:]:
        state, *reading = angle_sensor.step(params, state, float(angle), DT)
        told.append(reading)
    return np.array(told)[:, 0], np.array(told)[:, 1]


def angles_of(walk: list[float], start: float = 0.0) -> FloatArray:
    return start + np.concatenate([[0.0], np.cumsum(walk)])


@settings(max_examples=60)
@given(WALKS, st.integers(1, 6), st.integers(4, 20))
def test_an_absolute_encoder_without_errors_is_the_encoder_of_all_joints(
    walk: list[float], window: int, b: int
) -> None:
    angles = angles_of(walk)
    bank = encoder.bank((EncoderParams(bits=b, side="motor", gear_ratio=50.0, rate_window=window),))
    state, expected = encoder.initial_state(bank, angles[:1]), []
    for angle in angles[1:]:
        state, told, rate = encoder.step(bank, state, np.array([angle]), DT)
        expected.append((told[0], rate[0]))
    found = read(AbsoluteEncoderParams(bits=b, side="motor", gear_ratio=50.0, rate_window=window), angles)
    step = TURN / 2**b / 50.0
    assert np.abs(found[0] - np.array(expected)[:, 0]).max() < 1.001 * step  # an angle on an edge may fall either way
    assert np.abs(found[1] - np.array(expected)[:, 1]).max() < 2.01 * step / DT


@settings(max_examples=60)
@given(st.floats(-40.0, 40.0), WALKS)
def test_an_absolute_encoder_that_forgets_turns_is_off_by_whole_ones(start: float, walk: list[float]) -> None:
    angles = angles_of(walk, start)
    told, _ = read(AbsoluteEncoderParams(bits=16, side="motor", gear_ratio=10.0, keeps_turns=False), angles)
    off = (told - angles[1:]) * 10.0 / TURN
    assert np.abs(off - round(off[0])).max() < 2.0**-16
    assert abs(read(AbsoluteEncoderParams(bits=16, side="output", keeps_turns=False), [1.0, 1.0])[0][0] - 1.0) < 1e-4


def test_eccentricity_is_once_a_turn() -> None:
    angles = np.linspace(0.0, TURN, 721)
    told, _ = read(AbsoluteEncoderParams(bits=24, side="output", eccentricity=0.01), angles)
    spectrum = np.abs(np.fft.rfft(told - angles[1:])) / 360.0
    assert spectrum[1] == pytest.approx(0.01, rel=1e-3) and spectrum[2:20].max() < 1e-5


@settings(max_examples=100)
@given(WALKS, st.integers(1, 5000), st.floats(1.0, 200.0), st.floats(-3.0, 3.0))
def test_an_incremental_encoder_never_loses_more_than_a_count(
    walk: list[float], lines: int, ratio: float, start: float
) -> None:
    params = IncrementalEncoderParams(lines=lines, side="motor", gear_ratio=ratio, index_deg=30.0)
    angles = angles_of(walk, start)
    told, _ = read(params, angles)
    count = params.count / ratio
    assert np.abs(told - angles[1:]).max() <= count * (1 + 1e-6) + 1e-12
    assert np.abs(np.diff(told) - np.diff(angles[1:])).max(initial=0.0) <= count * (1 + 1e-6) + 1e-12


@settings(max_examples=100)
@given(st.integers(0, 10**6), st.floats(-0.4, 0.4))
def test_its_zero_is_unknown_until_the_index_has_been_passed(seed: int, start: float) -> None:
    params = IncrementalEncoderParams(lines=1000, side="output", zero_error=0.3, index_deg=90.0)
    angles = np.concatenate([np.linspace(start, 1.5, 20), np.linspace(1.6, 2.5, 10)])
    told, _ = read(params, angles, seed)
    off = told - angles[1:]
    drawn = off[0]
    assert np.abs(off[:19] - drawn).max() <= params.count * (1 + 1e-6), "before the index always the same"
    assert np.abs(off[19:]).max() <= params.count * (1 + 1e-6), "and after it none"


def test_behind_a_gear_the_index_leaves_whole_turns_of_the_shaft() -> None:
    params = IncrementalEncoderParams(lines=100, side="motor", gear_ratio=20.0, zero_error=0.5)
    left = []
    for seed in range(200):
        told, _ = read(params, [-0.01, 0.2], seed)
        left.append((told[0] - 0.2) * 20.0 / TURN)
    assert np.abs(np.array(left) - np.round(left)).max() < 0.01 and np.ptp(left) > 1.0
    spread = np.std(left) * TURN / 20.0
    assert spread == pytest.approx(math.hypot(0.5, TURN / 20.0 / math.sqrt(12.0)), rel=0.12)


@settings(max_examples=100)
@given(*[st.floats(-0.05, 0.05)] * 4, st.floats(-50.0, 50.0))
def test_the_error_of_a_resolver_is_that_of_its_two_voltages(
    a: float, p: float, o_s: float, o_c: float, x: float
) -> None:
    u, v = (1 + a) * math.sin(x) + o_s, math.cos(x + p) + o_c
    found = Windings(a, p, o_s, o_c).error(x)
    assert math.remainder(math.atan2(u, v) - x - found, TURN) == pytest.approx(0.0, abs=1e-9)
    first = a / 2 * math.sin(2 * x) + p / 2 * (1 - math.cos(2 * x)) + o_s * math.cos(x) - o_c * math.sin(x)
    assert found == pytest.approx(first, abs=4 * (abs(a) + abs(p) + abs(o_s) + abs(o_c)) ** 2 + 1e-12)


@pytest.mark.parametrize(
    ("errors", "harmonics"),
    [
        ({"amplitude_error": 1e-3}, {2: "a"}),
        ({"phase_error": 1e-3}, {0: "p", 2: "p"}),
        ({"offset_error": 1e-3}, {1: "o"}),
    ],
)
def test_each_error_of_a_resolver_has_its_harmonic(errors: dict[str, float], harmonics: dict[int, str]) -> None:
    """Amplitude a/2 at twice, phase p/2 at none and twice, offsets at once the electrical angle; 4 pairs of poles."""
    params = ResolverParams(side="output", pole_pairs=4, bits=24, **errors)
    angles = np.linspace(0.0, TURN, 1025)
    told, _ = read(params, angles)
    spectrum = np.abs(np.fft.rfft((told - angles[1:]) * 4.0)) / 512.0
    spectrum[0] *= 0.5
    drawn = np.abs(angle_sensor.draw(angle_sensor.initial_stream(1, "angle.joint", 4))[1]) * 1e-3
    sizes = {"a": drawn[0] / 2, "p": drawn[1] / 2, "o": math.hypot(drawn[2], drawn[3])}
    for harmonic, of in harmonics.items():
        assert spectrum[4 * harmonic] == pytest.approx(sizes[of], rel=0.02)
        spectrum[4 * harmonic] = 0.0
    assert spectrum[:200].max() < 3e-6


def test_noise_of_a_resolver_is_that_of_its_data_sheet() -> None:
    told, _ = read(ResolverParams(side="motor", gear_ratio=100.0, bits=14, noise=1e-3), np.full(4001, 0.3))
    step = TURN / 2**14 / 100.0
    assert told.std() == pytest.approx(math.hypot(1e-5, step / math.sqrt(12.0)), rel=0.05)


@settings(max_examples=60)
@given(st.integers(0, 10**6), st.floats(0.0, 0.02))
def test_a_potentiometer_is_as_straight_as_it_says_and_open_between_its_ends(seed: int, linearity: float) -> None:
    params = PotentiometerParams(side="output", linearity=linearity, bits=20, centre_deg=10.0)
    travel, centre = math.radians(340.0), math.radians(10.0)
    inside = np.linspace(centre - 0.499 * travel, centre + 0.499 * travel, 200)
    told, _ = read(params, inside, seed)
    assert np.abs(told - inside[1:]).max() <= travel * (linearity + 2.0**-20)
    open_, _ = read(params, centre + math.pi * np.array([0.99, 0.97, 1.01, 1.03, -0.98]), seed)
    assert open_ == pytest.approx([centre - 0.5 * travel] * 4)


def test_noise_of_a_potentiometer_is_a_part_of_its_travel() -> None:
    told, _ = read(PotentiometerParams(side="output", noise=1e-3, bits=12), np.full(4001, 0.3))
    travel = math.radians(340.0)
    assert told.std() == pytest.approx(travel * math.hypot(1e-3, 2.0**-12 / math.sqrt(12.0)), rel=0.05)


@settings(max_examples=60)
@given(st.lists(st.floats(-0.05, 0.05), min_size=1, max_size=30))
def test_a_tachometer_without_errors_tells_the_mean_rate_and_adds_it_up(walk: list[float]) -> None:
    params = TachometerParams(side="motor", gear_ratio=100.0, resolution=1e-3)
    angles = angles_of(walk, 0.7)
    told, rates = read(params, angles)
    assert np.abs(rates - np.diff(angles) / DT).max() <= 0.5 * 1e-5 + 1e-9
    assert np.abs(told - angles[1:]).max() <= 0.5 * 1e-5 * DT * len(walk) + 1e-9


def test_a_tachometer_has_ripple_and_drifts() -> None:
    steady = TachometerParams(side="output", resolution=1e-6, ripple=0.02, ripples=11)
    angles = np.linspace(0.0, TURN, 2201)
    _, rates = read(steady, angles)
    relative = rates / (TURN / 2200 / DT) - 1.0
    spectrum = np.abs(np.fft.rfft(relative)) / 1100.0
    assert spectrum[11] == pytest.approx(0.02, rel=1e-3) and spectrum.argmax() == 11
    drifting = TachometerParams(side="output", resolution=1e-6, offset_error=1e-3)
    offsets = [read(drifting, np.zeros(501), seed)[0][-1] / (500 * DT) for seed in range(300)]
    assert np.std(offsets) == pytest.approx(1e-3, rel=0.1)


GROUPS = {
    "wheels": {"joints": ["a", "b"], "encoder": {"bits": 12, "side": "motor", "gear_ratio": 100.0}},
    "steer": {"joints": ["c"], "encoder": {"kind": "resolver", "side": "output", "amplitude_error": 1e-3, "bits": 14}},
    "arm": {"joints": ["d"], "encoder": {"kind": "potentiometer", "side": "output", "noise": 1e-3}},
}  # fmt: skip


def groups(*names: str) -> dict[str, JointGroupParams]:
    effort = {"effort_resolution": 0.05, "effort_noise": 0.1}
    return {name: JointGroupParams.model_validate(GROUPS[name] | effort) for name in names}


def measured(of: dict[str, JointGroupParams], count: int = 30) -> list[FloatArray]:
    zeros = np.zeros(4)
    state = joints.initial_state(of, 7, ("d", "a", "c", "b"), JointTruth(zeros, zeros))
    found = []
    for period in range(1, count):
        state, reading = joints.step(state, JointTruth(0.01 * period * np.array([1.0, 2.0, -3.0, 4.0]), zeros), DT)
        found.append(np.array([reading.position, reading.velocity, reading.effort]))
    return found


def test_kinds_stand_side_by_side_in_the_order_of_the_truth() -> None:
    mixed, wheels = measured(groups("wheels", "steer", "arm")), measured(groups("wheels"))
    for period, (all_, alone) in enumerate(zip(mixed, wheels, strict=True), start=1):
        assert np.array_equal(all_[:, [1, 3]], alone)
        assert all_[0] == pytest.approx(0.01 * period * np.array([1.0, 2.0, -3.0, 4.0]), abs=0.04)


def test_one_group_changes_no_number_of_another() -> None:
    without = measured(groups("steer", "wheels"))
    assert np.array_equal(np.array(measured(groups("wheels", "steer", "arm")))[:, :, 1:], np.array(without))


def test_an_encoder_is_written_down_as_it_always_was() -> None:
    group = groups("wheels")["wheels"]
    assert group.model_dump()["encoder"] == {"bits": 12, "side": "motor", "gear_ratio": 100.0, "rate_window": 1}
    other = groups("steer")["steer"]
    assert JointGroupParams.model_validate(other.model_dump()) == other


@pytest.mark.parametrize(
    ("encoder_", "words"),
    [
        ({"kind": "resolvr", "side": "output"}, "kind of angle sensor 'resolvr' is unknown.*did you mean resolver"),
        ({"kind": "resolver", "side": "output", "bits": 4}, "bits"),
        ({"kind": "potentiometer", "side": "motor", "gear_ratio": 10.0}, "does not count turns of a gear"),
        ({"kind": "tachometer", "side": "output"}, "resolution"),
        ({"kind": "absolute_encoder", "side": "output", "bits": 12, "gear_ratio": 3.0}, "output side"),
        ({"kind": "incremental_encoder", "side": "output", "lines": 0}, "lines"),
        ({"bits": 12, "side": "output", "lines": 3}, "lines"),
    ],
)
def test_a_sensor_that_cannot_be_is_refused(encoder_: dict[str, object], words: str) -> None:
    group = {"joints": ["a"], "encoder": encoder_, "effort_resolution": 0.1, "effort_noise": 0.1}
    with pytest.raises(ValidationError, match=words):
        JointGroupParams.model_validate(group)
