"""Unloading and reloading against Bekker's loop, integrated by hand."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_physics.soil.repeated_loading import equivalent_law, rut_depth

moduli = st.floats(1e4, 1e8)
exponents = st.floats(0.3, 1.6)
depths = st.floats(1e-4, 0.2)
A_U = 503.0e6


def loop_pressure(modulus: float, n: float, greatest: float, rut: float, z: float) -> float:
    """Bekker's loading path of soil that was at `greatest` before and keeps a rut."""
    if z <= rut:
        return 0.0
    if z < greatest:
        return modulus * greatest**n * (z - rut) / (greatest - rut)
    return modulus * z**n


def test_rut_of_lunar_soil_by_hand() -> None:
    """k = 834e3 N/m3, z_u = 20 mm: p_u = 16.68 kPa, k_u = 10.06 MN/m3, so that 1.658 mm spring back."""
    assert rut_depth(834.0e3, 1.0, 0.02, 0.0, A_U) == pytest.approx(0.02 - 16.68e3 / 10.06e6, rel=1e-12)
    assert rut_depth(834.0e3, 1.0, 0.02, 5.0e6, 0.0) == pytest.approx(0.02 - 16.68e3 / 5.0e6, rel=1e-12)


@settings(max_examples=200, deadline=None)
@given(moduli, exponents, depths, st.floats(0.0, 1e9), st.floats(0.0, 1e10))
def test_rut_lies_between_the_old_surface_and_the_greatest_sinkage(
    modulus: float, n: float, greatest: float, stiffness: float, per_sinkage: float
) -> None:
    rut = rut_depth(modulus, n, greatest, stiffness, per_sinkage)
    assert 0.0 <= rut <= greatest
    # unloading is nowhere softer than the virgin curve at the point where it begins
    rebound = greatest - rut
    assert modulus * greatest**n / rebound >= n * modulus * greatest ** (n - 1.0) * (1.0 - 1e-9)


def test_no_history_no_rut() -> None:
    assert rut_depth(1e6, 1.0, 0.0, 1e9, 1e9) == 0.0
    assert rut_depth(0.0, 1.0, 0.01, 1e9, 1e9) == 0.0
    assert equivalent_law(1e6, 0.8, 0.0, 0.0, 0.01) == (1e6, 0.8)


@settings(max_examples=150, deadline=None)
@given(moduli, exponents, depths, st.floats(0.05, 0.95), st.floats(0.02, 5.0))
def test_law_in_a_rut_has_the_pressure_and_the_work_of_the_loop(
    modulus: float, n: float, greatest: float, share: float, deeper: float
) -> None:
    rut = share * greatest
    depth = deeper * (greatest - rut)
    k, power = equivalent_law(modulus, n, greatest, rut, depth)
    assert k * depth**power == pytest.approx(loop_pressure(modulus, n, greatest, rut, rut + depth), rel=1e-9)
    if power > 0.0501:
        z = np.linspace(0.0, depth, 40001)
        pressures = np.array([loop_pressure(modulus, n, greatest, rut, rut + h) for h in z])
        work = float(np.sum(0.5 * (pressures[1:] + pressures[:-1])) * (z[1] - z[0]))
        assert k * depth ** (power + 1.0) / (power + 1.0) == pytest.approx(work, rel=1e-5)


@settings(max_examples=100, deadline=None)
@given(moduli, exponents, depths, st.floats(0.1, 0.9))
def test_law_is_continuous_where_virgin_soil_begins(modulus: float, n: float, greatest: float, share: float) -> None:
    rut = share * greatest
    rebound = greatest - rut
    below = equivalent_law(modulus, n, greatest, rut, rebound * (1.0 - 1e-9))
    above = equivalent_law(modulus, n, greatest, rut, rebound * (1.0 + 1e-9))
    assert above[1] == pytest.approx(below[1], rel=1e-6)
    assert math.log(above[0]) == pytest.approx(math.log(below[0]), rel=1e-6)


def test_far_below_the_rut_the_soil_is_virgin() -> None:
    k, power = equivalent_law(8.0e5, 1.1, 0.002, 0.0015, 0.5)
    assert power == pytest.approx(1.1, abs=0.01)
    assert k * 0.5**power == pytest.approx(8.0e5 * 0.5015**1.1, rel=1e-9)
