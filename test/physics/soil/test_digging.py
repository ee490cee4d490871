"""Digging force against Rankine, Coulomb's table and geometry; limits and monotonicity."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_machine.errors import InvalidValueError
from sojourn_physics.soil.digging import (
    Bucket,
    DiggingSoil,
    balovnev,
    mckyes,
    pressure_factor,
    wedge_angle,
    weight_factor,
)

LUNAR = DiggingSoil(1680.0 * 1.62, 170.0, math.radians(37.0), math.radians(10.0))
SOILS = st.builds(
    DiggingSoil,
    st.floats(500.0, 3e4),
    st.floats(0.0, 5e3),
    st.floats(0.2, 0.8),
    st.floats(0.0, 0.19),
    st.floats(0.0, 500.0),
)


def rankine(friction: float) -> float:
    return math.tan(0.25 * math.pi + 0.5 * friction) ** 2


@pytest.mark.parametrize("degrees", [15.0, 30.0, 38.0, 45.0])
def test_a_smooth_upright_blade_is_rankines_wall(degrees: float) -> None:
    phi = math.radians(degrees)
    depth, width, cohesion, surcharge, weight = 0.1, 0.5, 300.0, 50.0, 2600.0
    soil = DiggingSoil(weight, cohesion, phi, 0.0)
    found = mckyes(soil, width, depth, 0.5 * math.pi, surcharge)
    k = rankine(phi)
    by_hand = width * (0.5 * k * weight * depth**2 + 2.0 * math.sqrt(k) * cohesion * depth + k * surcharge * depth)
    assert found.forward == pytest.approx(by_hand, rel=1e-9)
    assert found.lift == pytest.approx(0.0, abs=1e-9 * by_hand)
    assert found.wedge == pytest.approx(0.25 * math.pi - 0.5 * phi, abs=1e-6)


@pytest.mark.parametrize(
    ("friction", "wall", "expected"),
    [
        (30, 0, 3.000),
        (30, 5, 3.506),
        (30, 10, 4.143),
        (30, 15, 4.977),
        (30, 20, 6.105),
        (20, 10, 2.635),
        (25, 15, 3.855),
    ],
)
def test_a_rough_upright_blade_is_coulombs_wall(friction: float, wall: float, expected: float) -> None:
    """Coefficients of passive pressure as foundation engineering tabulates them (Das, Coulomb's K_p)."""
    phi, delta = math.radians(friction), math.radians(wall)
    beta = wedge_angle(0.5 * math.pi, phi, delta)
    assert 2.0 * weight_factor(0.5 * math.pi, beta, phi, delta) == pytest.approx(expected, rel=1e-3)


@settings(max_examples=60, deadline=None)
@given(st.floats(0.8, 1.57), st.floats(0.2, 0.75), st.floats(0.0, 0.19))
def test_the_wedge_is_coulombs_in_closed_form(rake: float, phi: float, delta: float) -> None:
    """Coulomb's minimum has a closed form for a wall of any slope."""
    root = math.sqrt(math.sin(phi + delta) * math.sin(phi) / (math.sin(rake + delta) * math.sin(rake)))
    k = math.sin(rake - phi) ** 2 / (math.sin(rake) ** 2 * math.sin(rake + delta) * (1.0 - root) ** 2)
    beta = wedge_angle(rake, phi, delta)
    assert weight_factor(rake, beta, phi, delta) == pytest.approx(0.5 * k, rel=1e-6)


def test_balovnev_of_a_smooth_plate_is_rankines_wall_with_cohesion_as_a_pressure() -> None:
    plate = Bucket(0.5, 0.0, 0.0, 0.0, 0.5 * math.pi)
    phi, cohesion, weight, depth = math.radians(37.0), 170.0, 2720.0, 0.08
    force = balovnev(DiggingSoil(weight, cohesion, phi, 0.0), plate, depth, 0.5 * math.pi)
    buried = weight * depth * (1.0 - math.sin(phi)) / (1.0 + math.sin(phi))
    by_hand = 0.5 * depth * rankine(phi) * (0.5 * weight * depth + cohesion / math.tan(phi) + buried)
    assert force == pytest.approx(by_hand, rel=1e-12)
    # its cohesion term less the pressure that stands for it is Rankine's 2 c √K_p
    rest = rankine(phi) * cohesion / math.tan(phi) - cohesion / math.tan(phi)
    assert rest == pytest.approx(2.0 * cohesion * math.sqrt(rankine(phi)), rel=1e-12)


@pytest.mark.parametrize("degrees", [20.0, 37.0, 45.0])
def test_pressure_factor_is_continuous_and_prandtls(degrees: float) -> None:
    """Flat on the ground and smooth it is 1; upright K_p; both branches meet for a smooth face at 90 degrees."""
    phi = math.radians(degrees)
    assert pressure_factor(0.5 * math.pi, phi, 0.0) == pytest.approx(rankine(phi))
    assert pressure_factor(-1e-9, phi, 0.0) == pytest.approx(1.0, abs=1e-6)


@settings(max_examples=80, deadline=None)
@given(SOILS, st.floats(0.35, 1.57), st.floats(0.01, 0.3), st.floats(0.02, 0.5))
def test_force_grows_with_all_that_resists(soil: DiggingSoil, rake: float, depth: float, width: float) -> None:
    base = mckyes(soil, width, depth, rake)
    assert math.isfinite(base.forward) and base.forward > 0.0
    for more in (
        mckyes(soil, width, 1.2 * depth, rake),
        mckyes(soil, 1.2 * width, depth, rake),
        mckyes(soil._replace(unit_weight=1.2 * soil.unit_weight), width, depth, rake),
        mckyes(soil, width, depth, rake, surcharge=100.0),
        mckyes(soil, width, depth, rake, speed=0.5, density=1500.0),
        mckyes(soil, width, depth, rake, sides=True),
    ):
        assert more.forward > base.forward
    bucket = Bucket(width, 0.1, 0.002, 0.003, 1.0)
    force = balovnev(soil, bucket, depth, rake)
    assert balovnev(soil, bucket, 1.2 * depth, rake) > force > 0.0


@settings(max_examples=40, deadline=None)
@given(st.floats(0.3, 1.5), st.floats(0.01, 0.2))
def test_weight_and_cohesion_scale_apart(rake: float, depth: float) -> None:
    """In a cohesionless soil the force goes with gravity; in a weightless one it does not know it."""
    loose = LUNAR._replace(cohesion=0.0)
    heavy = loose._replace(unit_weight=6.0 * loose.unit_weight)
    ratio = mckyes(heavy, 0.1, depth, rake).forward / mckyes(loose, 0.1, depth, rake).forward
    assert ratio == pytest.approx(6.0, rel=1e-9)
    bound = LUNAR._replace(unit_weight=0.0)
    assert mckyes(bound, 0.1, 2.0 * depth, rake).forward == pytest.approx(2.0 * mckyes(bound, 0.1, depth, rake).forward)
    assert mckyes(LUNAR, 0.1, 0.0, rake).forward == 0.0


def test_what_these_laws_do_not_hold_for_is_refused() -> None:
    for soil in (LUNAR._replace(friction=0.0), LUNAR._replace(tool_friction=1.0), LUNAR._replace(cohesion=-1.0)):
        with pytest.raises(InvalidValueError):
            mckyes(soil, 0.1, 0.05, 1.0)
    with pytest.raises(InvalidValueError, match="rake"):
        mckyes(LUNAR, 0.1, 0.05, 0.1)
    with pytest.raises(InvalidValueError, match="depth"):
        balovnev(LUNAR, Bucket(0.1, 0.1, 0.0, 0.0, 1.0), -0.1, 1.0)
