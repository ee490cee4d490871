"""Bearing capacity and bulldozing against published numbers and limits."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_machine.errors import InvalidValueError
from sojourn_physics.soil.bearing import bearing_factors, bulldozing_resistance

LRV_SINKAGE = (3.0 * 253.0 / (2.0 * (1400.0 + 0.229 * 820e3) * math.sqrt(0.813))) ** (2.0 / 3.0)


@pytest.mark.published("Terzaghi 1943")
def test_terzaghi_factors_at_33_degrees() -> None:
    factors = bearing_factors(math.radians(33.0))
    assert factors.n_q == pytest.approx(32.23, rel=1e-3)
    assert factors.n_c == pytest.approx(48.09, rel=1e-3)
    assert factors.n_gamma == pytest.approx(33.27, rel=1e-3)
    assert factors.k_c == pytest.approx(33.37, rel=1e-3)
    assert factors.k_gamma == pytest.approx(72.77, rel=1e-3)


@pytest.mark.published
@pytest.mark.parametrize(
    ("degrees", "n_c", "n_q"),
    [(0, 5.7, 1.0), (10, 9.6, 2.7), (20, 17.7, 7.4), (30, 37.2, 22.5), (40, 95.7, 81.3)],
)
def test_terzaghi_table_of_the_textbooks(degrees: float, n_c: float, n_q: float) -> None:
    """Terzaghi's table for general shear, as in Bowles, Foundation Analysis and Design, table 4-2."""
    factors = bearing_factors(math.radians(degrees))
    assert factors.n_c == pytest.approx(n_c, abs=0.06)
    assert factors.n_q == pytest.approx(n_q, abs=0.06)


@settings(max_examples=60, deadline=None)
@given(st.floats(0.0, 0.85), st.floats(1e-9, 1e-2))
def test_factors_are_finite_continuous_and_grow_with_friction(angle: float, more: float) -> None:
    low, high = bearing_factors(angle), bearing_factors(angle + more)
    assert high.n_q >= low.n_q and high.n_gamma >= low.n_gamma
    assert high.n_c >= low.n_c - 1e-6 * low.n_c
    assert high.n_c - low.n_c < 1e4 * more + 1e-6 * low.n_c


def test_bulldozing_of_the_lunar_roving_vehicle() -> None:
    approach = math.acos(1.0 - 2.0 * LRV_SINKAGE / 0.813)
    assert approach == pytest.approx(0.29059, rel=1e-3)
    resistance = bulldozing_resistance(math.radians(33.0), 170.0, 2470.0, 0.229, 0.813, LRV_SINKAGE)
    assert resistance == pytest.approx(89.19, rel=2e-3)
    assert bulldozing_resistance(math.radians(33.0), 170.0, 2470.0, 0.229, 0.813, 0.0) == 0.0


@settings(max_examples=40, deadline=None)
@given(st.floats(0.0, 0.8), st.floats(0.0, 2000.0), st.floats(0.0, 2e4), st.floats(1e-4, 0.1))
def test_bulldozing_is_finite_and_grows_with_sinkage(
    angle: float, cohesion: float, unit_weight: float, sinkage: float
) -> None:
    force = bulldozing_resistance(angle, cohesion, unit_weight, 0.1, 0.25, sinkage)
    deeper = bulldozing_resistance(angle, cohesion, unit_weight, 0.1, 0.25, sinkage * 1.05)
    assert math.isfinite(force)
    assert 0.0 <= force <= deeper


@pytest.mark.parametrize("angle", [-0.1, 1.1, float("nan")])
def test_bad_friction_angle_is_refused(angle: float) -> None:
    with pytest.raises(InvalidValueError, match="friction_angle"):
        bearing_factors(angle)


@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        ((0.5, -1.0, 2470.0, 0.2, 0.8, 0.01), "cohesion"),
        ((0.5, 1.0, float("nan"), 0.2, 0.8, 0.01), "unit_weight"),
        ((0.5, 1.0, 1.0, 0.0, 0.8, 0.01), "width"),
        ((0.5, 1.0, 1.0, 0.2, -0.8, 0.01), "diameter"),
        ((0.5, 1.0, 1.0, 0.2, 0.8, 0.41), "sinkage"),
        ((0.5, 1.0, 1.0, 0.2, 0.8, float("nan")), "sinkage"),
    ],
)
def test_bad_wheel_is_refused(arguments: tuple[float, ...], name: str) -> None:
    with pytest.raises(InvalidValueError, match=name):
        bulldozing_resistance(*arguments)
