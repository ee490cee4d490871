"""Strain gauges in a bridge: the bridge's closed form, errors of their given size, creep, range."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray
from sojourn_physics.sensors import strain_gauge
from sojourn_physics.sensors.strain_gauge import StrainGaugeParams

FINE = {"rated_torque": 100.0, "bits": 24}


def gauge(**more: object) -> StrainGaugeParams:
    return StrainGaugeParams.model_validate(FINE | more)


def reading(of: StrainGaugeParams, torque: float, seed: int = 1, temperature: float | None = None) -> float:
    state = strain_gauge.initial_state(of, seed, ("a",))
    return float(strain_gauge.step(of, state, np.array([torque]), 0.02, temperature)[1][0])


@given(st.sampled_from([("quarter", 1), ("half", 2), ("full", 4)]), st.floats(-0.05, 0.05))
def test_the_bridge_is_that_of_its_four_resistors(kind: tuple[str, int], relative: float) -> None:
    """Two dividers: neighbours change with opposite signs, arms across with the same."""
    name, arms = kind
    r = [1.0 + sign * relative * (place < arms) for place, sign in enumerate((1, -1, -1, 1))]
    volts = r[0] / (r[0] + r[1]) - r[2] / (r[2] + r[3])
    found = strain_gauge.output(gauge(bridge=name), np.array([relative]))[0]
    assert found == pytest.approx(volts, abs=1e-12)


def test_a_full_bridge_has_two_millivolts_a_volt_at_a_thousand_microstrain() -> None:
    """Gauge factor 2, 1000e-6: the 2 mV/V of load cells."""
    assert strain_gauge.output(gauge(), np.array([2.0 * 1e-3]))[0] == pytest.approx(2e-3)


@settings(max_examples=60)
@given(st.floats(-150.0, 150.0), st.sampled_from(["half", "full"]))
def test_without_errors_the_torque_is_told(torque: float, bridge: str) -> None:
    assert reading(gauge(bridge=bridge), torque) == pytest.approx(torque, abs=1e-4)


@settings(max_examples=60)
@given(st.floats(-100.0, 100.0))
def test_a_quarter_bridge_is_off_by_its_curve(torque: float) -> None:
    """u/u_r for x = g e: (x/x_r) (4 + 2 x_r)/(4 + 2 x)."""
    of, x_r = gauge(bridge="quarter", gauge_factor=20.0, full_scale=0.02), 0.02
    x = x_r * torque / 100.0
    assert reading(of, torque) == pytest.approx(torque * (4 + 2 * x_r) / (4 + 2 * x), abs=2e-4)


@pytest.mark.parametrize(
    ("errors", "torque", "spread"),
    [({"gain_error": 0.01}, 50.0, 0.5), ({"zero_error": 0.02}, 0.0, 2.0), ({"noise": 1e-5}, 20.0, 0.5)],
)
def test_errors_have_their_standard_deviation(errors: dict[str, float], torque: float, spread: float) -> None:
    of = gauge(**errors)
    told = np.array([reading(of, torque, seed) for seed in range(500)])
    assert told.std() == pytest.approx(spread, rel=0.1) and told.mean() == pytest.approx(torque, abs=0.2 * spread)


def test_warm_gauges_show_a_strain_that_is_none() -> None:
    """1e-6/K over 50 K are 50 microstrain: 5 % of the rated 1000 where one arm sees it, a tenth of that in a bridge."""
    for bridge, part in (("quarter", 1.0), ("full", 0.1)):
        of = gauge(bridge=bridge, apparent_strain=1e-6, matched=0.1)
        told = np.array([reading(of, 0.0, seed, 343.15) for seed in range(500)])
        assert told.std() == pytest.approx(5.0 * part, rel=0.1)
        assert reading(of, 0.0, 1, 293.15) == reading(of, 0.0) == pytest.approx(0.0, abs=1e-4)


@settings(max_examples=40)
@given(st.floats(0.1, 2000.0), st.integers(1, 5))
def test_creep_follows_its_closed_form_in_any_steps(time: float, steps: int) -> None:
    of = gauge(creep=0.01, creep_time=300.0)
    state = strain_gauge.initial_state(of, 1, ("a",))
    for _ in range(steps):
        state, told = strain_gauge.step(of, state, np.array([80.0]), time / steps)
    assert told[0] == pytest.approx(80.0 * (1.0 + 0.01 * (1.0 - math.exp(-time / 300.0))), abs=1e-4)


def test_the_converter_holds_its_ends_and_counts() -> None:
    of = gauge(bits=12)
    assert reading(of, 1e4) == pytest.approx(200.0, abs=0.2) and reading(of, -1e4) == pytest.approx(-200.0)
    told = np.unique([reading(of, torque) for torque in np.linspace(0.0, 10.0, 2001)])
    assert np.diff(told) == pytest.approx(400.0 / 4096)


def test_joints_have_streams_of_their_own() -> None:
    of = gauge(gain_error=0.1, noise=1e-5)

    def readings(*names: str) -> FloatArray:
        state = strain_gauge.initial_state(of, 3, names)
        return strain_gauge.step(of, state, np.full(len(names), 10.0), 0.02)[1]

    assert readings("a", "b", "c")[[0, 2]].tolist() == readings("a", "c").tolist()
    assert len(set(readings("a", "b", "c").tolist())) == 3


def test_what_cannot_be_is_refused() -> None:
    state = strain_gauge.initial_state(gauge(), 1, ("a",))
    with pytest.raises(InvalidValueError, match="torque of the joints"):
        strain_gauge.step(gauge(), state, np.array([math.nan]), 0.02)
    with pytest.raises(InvalidValueError, match="dt"):
        strain_gauge.step(gauge(), state, np.zeros(1), -0.02)
    with pytest.raises(ValidationError, match="bridge"):
        gauge(bridge="third")
