"""Pressure, sinkage and resistance against the published wheel and against each other."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_machine.errors import InvalidValueError
from sojourn_physics.soil.params import SoilParams
from sojourn_physics.soil.pressure_sinkage import (
    compaction_resistance,
    modulus,
    plate_sinkage,
    pressure,
    wheel_sinkage,
)


def soil(**changes: Any) -> SoilParams:
    values: dict[str, Any] = dict(
        name="lunar",
        citation="test",
        n=1.0,
        k_c=1400.0,
        k_phi=820e3,
        cohesion=170.0,
        friction_angle_deg=33.0,
        shear_modulus=0.0178,
        shear_modulus_lateral=0.0178,
        density=1520.9,
        theta_m_c1=0.4,
        theta_m_c2=0.2,
        contact_damping=0.0,
    )
    return SoilParams(**{**values, **changes})


def test_wheel_of_the_lunar_roving_vehicle() -> None:
    sinkage = wheel_sinkage(soil(), load=253.0, diameter=0.813, width=0.229)
    assert sinkage == pytest.approx(17.04e-3, rel=1e-3)
    assert compaction_resistance(soil(), 0.229, sinkage) == pytest.approx(27.47, rel=1e-3)


@settings(max_examples=60, deadline=None)
@given(st.floats(0.2, 1.6), st.floats(0.02, 0.5), st.floats(1e-4, 0.3), st.sampled_from(["bekker", "reece"]))
def test_pressure_is_the_formula_and_plate_sinkage_its_inverse(n: float, width: float, z: float, form: str) -> None:
    ground = soil(n=n, form=form)
    stated = (
        (ground.k_c / width + ground.k_phi) * z**n
        if form == "bekker"
        else (ground.k_c + width * ground.k_phi) * (z / width) ** n
    )
    assert pressure(ground, width, z) == pytest.approx(stated, rel=1e-12)
    assert plate_sinkage(ground, width, stated) == pytest.approx(z, rel=1e-9)


@settings(max_examples=40, deadline=None)
@given(st.floats(0.3, 1.6), st.floats(0.03, 0.4), st.floats(0.001, 0.1), st.sampled_from(["bekker", "reece"]))
def test_compaction_resistance_is_the_work_of_pressing_a_rut(n: float, width: float, z: float, form: str) -> None:
    ground = soil(n=n, form=form)
    depths = (np.arange(400) + 0.5) / 400 * z
    work_per_metre = width * sum(pressure(ground, width, float(depth)) for depth in depths) * z / 400
    assert compaction_resistance(ground, width, z) == pytest.approx(work_per_metre, rel=2e-3)


@settings(max_examples=40, deadline=None)
@given(st.floats(0.5, 1.2), st.floats(20.0, 400.0), st.floats(0.2, 1.0), st.floats(0.05, 0.4))
def test_wheel_sinkage_carries_the_load(n: float, load: float, diameter: float, width: float) -> None:
    """W = b k int p dx along the parabola, expanded as Bekker did: b k sqrt(D) z^(n + 1/2) (3 - n) / 3."""
    ground = soil(n=n)
    z = wheel_sinkage(ground, load, diameter, width)
    carried = width * modulus(ground, width) * diameter**0.5 * z ** (n + 0.5) * (3.0 - n) / 3.0
    assert carried == pytest.approx(load, rel=1e-9)


def test_for_n_one_the_wheel_integral_is_exact_for_a_parabola() -> None:
    """With n = 1 the expansion is exact: W = int_0^sqrt(z D) b k (z - x^2 / D) dx."""
    ground, width, diameter, load = soil(), 0.16, 0.25, 50.0
    z = wheel_sinkage(ground, load, diameter, width)
    end = (z * diameter) ** 0.5
    x = (np.arange(20000) + 0.5) / 20000 * end
    carried = float(np.sum(z - x * x / diameter)) * end / 20000 * width * modulus(ground, width)
    assert carried == pytest.approx(load, rel=1e-6)


def test_negative_cohesive_modulus_limits_the_width() -> None:
    kls = soil(name="kls_1", n=1.2594, k_c=-44.06e3, k_phi=3581.8e3)
    assert modulus(kls, 0.05) == pytest.approx(3581.8e3 - 44.06e3 / 0.05)
    with pytest.raises(InvalidValueError, match=r"0\.0123"):
        modulus(kls, 0.012)


@pytest.mark.parametrize("bad", [0.0, -1.0, float("nan"), float("inf")])
def test_bad_sizes_are_refused(bad: float) -> None:
    with pytest.raises(InvalidValueError, match="width"):
        pressure(soil(), bad, 0.01)
    with pytest.raises(InvalidValueError, match="diameter"):
        wheel_sinkage(soil(), 50.0, bad, 0.1)


@pytest.mark.parametrize("bad", [-1.0, float("nan"), float("inf")])
def test_bad_loads_are_refused(bad: float) -> None:
    with pytest.raises(InvalidValueError, match="load"):
        wheel_sinkage(soil(), bad, 0.3, 0.1)
    with pytest.raises(InvalidValueError, match="sinkage"):
        compaction_resistance(soil(), 0.1, bad)
    with pytest.raises(InvalidValueError, match="contact_pressure"):
        plate_sinkage(soil(), 0.1, bad)
    with pytest.raises(InvalidValueError, match="n = 3"):
        wheel_sinkage(soil(n=3.0), 50.0, 0.3, 0.1)
