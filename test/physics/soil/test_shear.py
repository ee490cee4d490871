"""Shear stress over displacement: limits, peak and residual, and the thrust as an integral."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from sojourn_machine.errors import InvalidValueError
from sojourn_physics.soil.shear import contact_thrust, shear_limit, shear_stress


def test_mohr_coulomb_and_janosi() -> None:
    limit = shear_limit(170.0, math.radians(35.0), 5000.0)
    assert limit == pytest.approx(170.0 + 5000.0 * 0.70021, rel=1e-5)
    assert shear_stress(limit, 3.0 * 0.0178, 0.0178) == pytest.approx(0.9502 * limit, rel=1e-4)
    assert shear_stress(limit, 0.0, 0.0178) == 0.0


@given(st.floats(0.3, 1.0), st.floats(0.0, 30.0))
def test_wong_hump_as_it_is_published(residual: float, ratio: float) -> None:
    bracket = 1.0 + (1.0 / (residual * (1.0 - 1.0 / math.e)) - 1.0) * math.exp(1.0 - ratio)
    expected = residual * bracket * (1.0 - math.exp(-ratio))
    assert shear_stress(1.0, 0.02 * ratio, 0.02, residual) == pytest.approx(expected, abs=1e-12)
    assert 0.0 <= expected <= 1.06


def test_hump_has_its_limit_at_the_modulus_and_ends_at_the_residual() -> None:
    assert shear_stress(1.0, 0.02, 0.02, 0.66) == pytest.approx(1.0)
    assert max(shear_stress(1.0, 0.0002 * k, 0.02, 0.66) for k in range(500)) == pytest.approx(1.0, abs=2e-3)
    assert shear_stress(1.0, 1.0, 0.02, 0.66) == pytest.approx(0.66)


@given(st.floats(1e-9, 1.0), st.floats(0.01, 1.0), st.floats(0.002, 0.1))
def test_thrust_is_the_integral_of_the_stress(slip: float, length: float, modulus: float) -> None:
    expected = quad(lambda x: shear_stress(1.0, slip * x, modulus), 0.0, length, epsabs=0.0, epsrel=1e-9)[0] / length
    assert contact_thrust(1.0, length, slip, modulus) == pytest.approx(expected, rel=1e-5)


def test_refused() -> None:
    for call in (
        lambda: shear_limit(-1.0, 0.5, 1.0),
        lambda: shear_limit(1.0, math.pi, 1.0),
        lambda: shear_stress(1.0, -1.0, 0.02),
        lambda: shear_stress(1.0, 1.0, 0.0),
        lambda: shear_stress(1.0, 1.0, 0.02, 1.5),
        lambda: contact_thrust(1.0, 1.0, 1.5, 0.02),
    ):
        with pytest.raises(InvalidValueError):
            call()
