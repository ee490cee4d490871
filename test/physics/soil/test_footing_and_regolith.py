"""Footings, wheels at rest, regolith over depth, relative density and spread, by independent routes."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from sojourn_analysis.soil import footing
from sojourn_config.load import load_params
from sojourn_machine.errors import InvalidValueError
from sojourn_physics.soil import regolith
from sojourn_physics.soil.bearing import bearing_factors
from sojourn_physics.soil.params import SoilParams
from sojourn_physics.soil.relative_density import density_at, relative_density_at
from sojourn_physics.soil.spread import draw_soils

MOON = 1.624


def soil(name: str = "lunar_nominal", **changes: object) -> SoilParams:
    return SoilParams.model_validate({**load_params("soils", name, SoilParams).model_dump(), **changes})


def test_strip_footing_is_terzaghi() -> None:
    lunar = soil()
    factors, weight = bearing_factors(lunar.friction_angle), lunar.unit_weight(MOON)
    expected = 170.0 * factors.n_c + 20.0 * factors.n_q + 0.5 * weight * 0.1 * factors.n_gamma
    assert footing.ultimate_pressure(lunar, 0.1, MOON, "strip", 20.0) == pytest.approx(expected)


@pytest.mark.published
def test_safe_load_of_a_landing_pad() -> None:
    """A 0.3 m pad on nominal lunar soil by hand: phi 35 deg, N_c 57.75, N_q 41.44 (Terzaghi's table)."""
    phi = math.radians(35)
    n_q = math.exp((1.5 * math.pi - phi) * math.tan(phi)) / (2 * math.cos(math.radians(62.5)) ** 2)
    n_c = (n_q - 1.0) / math.tan(math.radians(35))
    n_gamma = 2.0 * (n_q + 1.0) * math.tan(math.radians(35)) / (1.0 + 0.4 * math.sin(math.radians(140)))
    assert (n_q, n_c) == (pytest.approx(41.44, abs=0.01), pytest.approx(57.75, abs=0.01))
    pressure = 1.3 * 170.0 * n_c + 2470.0 * 0.02 * n_q + 0.3 * 2470.0 * 0.3 * n_gamma
    load = math.pi * 0.15**2 * pressure / 3.0
    assert footing.safe_load(soil(), 0.3, MOON, sinkage=0.02) == pytest.approx(load, rel=1e-4)
    loose = soil(bulldozing_failure="local")
    assert footing.safe_load(loose, 0.3, MOON) < 0.5 * footing.safe_load(soil(), 0.3, MOON)


def test_pad_sinks_until_the_pressure_is_its_own() -> None:
    lunar = soil()
    sinkage = footing.pad_sinkage(lunar, 100.0, 0.2)
    assert (1400.0 / 0.1 + 820e3) * sinkage * math.pi * 0.1**2 == pytest.approx(100.0)


@given(st.floats(0.5, 1.5), st.floats(0.02, 0.9))
def test_wheel_at_rest_bears_the_integral_of_the_pressure(n: float, depth: float) -> None:
    lunar, radius, width = soil(n=n), 0.1, 0.06
    sinkage = depth * radius
    half = math.sqrt(radius**2 - (radius - sinkage) ** 2)

    def pressure(x: float) -> float:  # over the plan, x ahead of the lowest point
        return (1400.0 / width + 820e3) * max(math.sqrt(radius**2 - x * x) - (radius - sinkage), 0.0) ** n

    expected = 2.0 * width * quad(pressure, 0.0, half, epsrel=1e-9)[0]
    load = footing.wheel_load(lunar, radius, width, sinkage)
    assert load == pytest.approx(expected, rel=1e-6)
    assert footing.static_wheel_sinkage(lunar, load, radius, width) == pytest.approx(sinkage, rel=1e-6)


@pytest.mark.published
def test_static_sinkage_of_ishigami() -> None:
    """Published: 11.81 mm under 64.68 N; the static contact of the wheel law, by another quadrature."""
    found = footing.static_wheel_sinkage(load_params("soils", "ishigami_2007", SoilParams), 64.68, 0.09, 0.11)
    assert found == pytest.approx(0.01181, rel=0.01)
    pressure = footing.mean_ground_pressure(64.68, 0.09, 0.11, found)
    assert pressure == pytest.approx(64.68 / (0.11 * 0.09 * math.sin(math.acos(1.0 - found / 0.09))))


@pytest.mark.published("Lunar Sourcebook, table 9.4")
def test_regolith_over_depth() -> None:
    assert regolith.density(0.0) == pytest.approx(1301.3, abs=0.1)
    assert regolith.density(0.30) == pytest.approx(1920.0 * 42.2 / 48.0)
    for depth in (0.05, 0.15, 0.3, 0.6):
        mean = quad(regolith.density, 0.0, depth)[0] / depth
        assert regolith.mean_density(depth) == pytest.approx(mean, rel=1e-9)
    # Lunar Sourcebook, table 9.4: means of 1.50, 1.58 and 1.66 g/cm3 for 0-15, 0-30 and 0-60 cm, +- 0.05
    assert [regolith.mean_density(z) / 1000.0 for z in (0.15, 0.3, 0.6)] == pytest.approx([1.50, 1.58, 1.66], abs=0.05)
    assert (regolith.strength(0.075).cohesion, regolith.strength(0.45).friction_angle_deg) == (520.0, 54.0)
    deep = regolith.soil_at(soil(), 0.15)
    assert (deep.cohesion, deep.friction_angle_deg, deep.k_phi) == (900.0, 46.0, 820e3)
    with pytest.raises(InvalidValueError, match="depth"):
        regolith.density(-0.1)


@given(st.floats(0.0, 1.0))
def test_relative_density_there_and_back(relative: float) -> None:
    density = density_at(relative, 1570.0, 2030.0)
    assert 1570.0 - 1e-9 <= density <= 2030.0 + 1e-9
    assert relative_density_at(min(max(density, 1570.0), 2030.0), 1570.0, 2030.0) == pytest.approx(relative, abs=1e-9)


def test_soil_by_relative_density() -> None:
    given_so = soil("jsc_1a", density_range=(1570.0, 2030.0), relative_density=0.5)
    assert given_so.density == pytest.approx(2.0 / (1.0 / 1570.0 + 1.0 / 2030.0))  # halfway in specific volume
    with pytest.raises(ValueError, match="density_range"):
        soil("lunar_nominal", relative_density=0.5)
    # a contact law that needs a density finds it given, too
    told = load_params("soils", "jsc_1a", SoilParams).model_dump(exclude={"density"}, exclude_unset=True)
    with pytest.raises(ValueError, match="missing: density"):
        SoilParams.model_validate(told)
    halfway = {"density_range": (1570.0, 2030.0), "relative_density": 0.5}
    assert SoilParams.model_validate(told | halfway).missing(("density", "cohesion")) == ()


def test_soils_are_drawn_within_the_spread() -> None:
    uncertain = soil(spread={"cohesion": 40.0, "shear_modulus": (0.01, 0.02)})
    drawn = draw_soils(uncertain, 400, seed=3)
    cohesions = np.array([one.cohesion for one in drawn])
    assert cohesions.mean() == pytest.approx(170.0, abs=8.0) and cohesions.std() == pytest.approx(40.0, rel=0.15)
    assert all(0.01 <= one.shear_modulus <= 0.02 for one in drawn)
    assert drawn == draw_soils(uncertain, 400, seed=3) != draw_soils(uncertain, 400, seed=4)
    for spread in ({"colour": 1.0}, {"kind": 1.0}, {"cohesion": -1.0}, {"cohesion": (2.0, 1.0)}):
        with pytest.raises(ValueError, match="spread"):
            soil(spread=spread)
