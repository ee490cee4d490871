"""Encoders: bounds of the quantisation, wraps, and the rate."""

from math import pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from sojourn_physics.sensors import encoder
from sojourn_physics.sensors.encoder import EncoderParams

OUTPUT = EncoderParams(bits=12, side="output")
MOTOR = EncoderParams(bits=10, side="motor", gear_ratio=150.0, rate_window=4)


def read(params: EncoderParams, positions: list[float], dt: float) -> tuple[list[float], list[float]]:
    bank = encoder.bank((params,))
    state = encoder.initial_state(bank, np.array(positions[:1]))
    measured, rates = [], []
    for position in positions[1:]:
        state, angle, rate = encoder.step(bank, state, np.array([position]), dt)
        measured.append(float(angle[0]))
        rates.append(float(rate[0]))
    return measured, rates


def test_resolution_at_the_joint() -> None:
    assert OUTPUT.resolution == pytest.approx(2 * pi / 4096)
    assert MOTOR.resolution == pytest.approx(2 * pi / 1024 / 150)


@settings(max_examples=100, deadline=None)
@given(position=st.floats(-1e4, 1e4), bits=st.integers(4, 24), ratio=st.floats(1.0, 3000.0))
def test_position_is_within_half_a_count_with_either_sign(position: float, bits: int, ratio: float) -> None:
    params = EncoderParams(bits=bits, side="motor", gear_ratio=ratio)
    measured, _ = read(params, [0.0, position], 0.02)
    assert abs(measured[0] - position) <= 0.5 * params.resolution * (1 + 1e-6) + 1e-15 * abs(position)
    count = measured[0] / params.resolution
    assert abs(count - round(count)) < 1e-6 + 1e-15 * abs(count)


@settings(max_examples=60, deadline=None)
@given(count=st.integers(0, 4095), turns=st.integers(-50, 50))
def test_a_whole_turn_adds_a_whole_turn(count: int, turns: int) -> None:
    position = (count + 0.25) * OUTPUT.resolution
    measured, _ = read(OUTPUT, [0.0, position, position + 2 * pi * turns], 0.02)
    assert measured[1] - measured[0] == pytest.approx(2 * pi * turns, abs=1e-9)


@settings(max_examples=60, deadline=None)
@given(
    start=st.floats(-20.0, 20.0),
    rate=st.floats(-3.0, 3.0),
    window=st.integers(1, 10),
    periods=st.integers(1, 30),
)
def test_rate_of_a_steady_joint_is_within_a_count_of_the_window(
    start: float, rate: float, window: int, periods: int
) -> None:
    params, dt = EncoderParams(bits=12, side="output", rate_window=window), 0.02
    _, rates = read(params, [start + rate * dt * k for k in range(periods + 1)], dt)
    for k, measured in enumerate(rates):
        bound = params.resolution / (min(window, k + 1) * dt)
        assert abs(measured - rate) <= bound * (1 + 1e-6)


def test_rate_of_an_accelerating_joint_is_the_mean_of_the_window() -> None:
    dt, window = 0.02, 4
    fine = EncoderParams(bits=32, side="output", rate_window=window)
    times = [dt * k for k in range(50)]
    _, rates = read(fine, [0.5 * 2.0 * t**2 for t in times], dt)
    expected = 2.0 * (times[-1] - 0.5 * window * dt)
    assert rates[-1] == pytest.approx(expected, abs=1e-6)


def test_a_joint_that_rests_on_an_edge_reads_the_same_every_time() -> None:
    measured, rates = read(OUTPUT, [0.5 * OUTPUT.resolution] * 10, 0.02)
    assert len(set(measured)) == 1 and set(rates) == {0.0}


def test_joints_of_a_bank_do_not_mix() -> None:
    bank = encoder.bank((OUTPUT, MOTOR))
    state = encoder.initial_state(bank, np.zeros(2))
    before = state.history.copy()
    for k in range(1, 8):
        after, angle, rate = encoder.step(bank, state, np.array([0.1 * k, -0.01 * k]), 0.02)
        assert np.array_equal(state.history, before)
        state, before = after, after.history.copy()
    alone, _ = read(MOTOR, [-0.01 * k for k in range(8)], 0.02)
    assert angle[1] == alone[-1]
    assert rate == pytest.approx([5.0, -0.5], abs=0.08)


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"bits": 2, "side": "output"}, "bits"),
        ({"bits": 12, "side": "both"}, "side"),
        ({"bits": 12, "side": "output", "gear_ratio": 50.0}, "output side"),
        ({"bits": 12, "side": "motor", "gear_ratio": 0.5}, "gear_ratio"),
        ({"bits": 12, "side": "motor", "rate_window": 0}, "rate_window"),
    ],
)
def test_bad_parameters_are_refused(values: dict[str, object], words: str) -> None:
    with pytest.raises(ValidationError, match=words):
        EncoderParams.model_validate(values)
