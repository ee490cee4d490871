"""Bekker's closed forms against the published figures of the lunar rover's wheel."""

import math
from collections.abc import Callable
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_analysis.wheels.examples import example_row
from sojourn_machine.params import FloatArray
from sojourn_physics.contact.bekker_wheel import mean_shear, wheel_load
from sojourn_physics.contact.contact_law import WheelColumn
from sojourn_physics.contact.passive_pressure import terzaghi_factors, wall_resistance, wheel_bulldozing
from sojourn_physics.soil.bearing import bearing_factors, bulldozing_resistance
from sojourn_physics.soil.params import SoilColumn, SoilParams, kernel_row

Maker = Callable[..., Any]
LOAD, RADIUS, WIDTH = 253.0, 0.4065, 0.229
GRAVITY = 1.62


def published_soil() -> FloatArray:
    """Nominal lunar soil with the friction angle and the weight of the published figures."""
    return kernel_row(
        SoilParams(
            name="lunar", citation="validation figures", n=1.0, k_c=1400.0, k_phi=820e3, cohesion=170.0,
            friction_angle_deg=33.0, shear_modulus=0.0178, shear_modulus_lateral=0.0178, density=2470.0 / GRAVITY,
            theta_m_c1=0.4, theta_m_c2=0.2, contact_damping=0.0,
        )
    )  # fmt: skip


def published(law: Maker) -> tuple[Any, float]:
    row = example_row("bekker_wheel_on_soil")
    row[WheelColumn.GRAVITY] = GRAVITY
    one = law(row, published_soil())
    return one, one.penetration_for(LOAD)


def rolled(one: Any, depth: float, slip: float) -> dict[str, float]:
    rim = 0.5
    result: dict[str, float] = one.step(20000, penetration=depth, v_along=rim * (1.0 - slip), rim_speed=rim)
    return result


@pytest.mark.published("Bekker's wheel of the lunar roving vehicle, 253 N")
def test_sinkage_and_resistances_of_the_lunar_rover(law: Maker) -> None:
    one, depth = published(law)
    assert depth == pytest.approx(17.04e-3, rel=1e-3)
    found = rolled(one, depth, 0.05)
    assert found["compaction_resistance"] == pytest.approx(27.47, rel=1e-3)
    assert found["bulldozing_resistance"] == pytest.approx(89.19, rel=2e-3)
    assert found["sinkage"] == depth


@pytest.mark.published("Bekker's wheel of the lunar roving vehicle, 253 N")
@pytest.mark.parametrize(("slip", "thrust"), [(0.05, 25.16), (0.2, 75.39), (0.5, 119.8)])
def test_thrust_of_the_lunar_rover(law: Maker, slip: float, thrust: float) -> None:
    one, depth = published(law)
    found = rolled(one, depth, slip)
    assert found["torque"] / RADIUS == pytest.approx(thrust, rel=1e-3)
    resistance = found["compaction_resistance"] + found["bulldozing_resistance"]
    assert found["force_x"] == pytest.approx(thrust - resistance, abs=1e-3 * thrust)


@pytest.mark.published("Bekker's wheel of the lunar roving vehicle, 253 N")
def test_greatest_thrust_of_the_lunar_rover(law: Maker) -> None:
    one, depth = published(law)
    area = WIDTH * RADIUS * math.acos(1.0 - depth / RADIUS)
    assert area == pytest.approx(0.02705, rel=1e-3)
    assert area * 170.0 + LOAD * math.tan(math.radians(33.0)) == pytest.approx(168.9, rel=1e-3)
    soft = published_soil()
    soft[SoilColumn.SHEAR_MODULUS] = 1e-5  # sheared to its strength at once
    found = rolled(law(one.wheel, soft), depth, 0.9)
    assert found["torque"] / RADIUS == pytest.approx(168.9, rel=1e-3)


def test_thrust_turns_with_the_slip(law: Maker) -> None:
    """With one shear modulus the shear lies along the slip velocity."""
    one, depth = published(law)
    found = one.step(20000, penetration=depth, v_along=0.3, v_side=-0.2, rim_speed=0.4)
    assert found["force_y"] / (found["torque"] / RADIUS) == pytest.approx(0.2 / 0.1, rel=1e-6)


@settings(max_examples=100, deadline=None)
@given(st.floats(0.0, 50.0), st.floats(1e-4, 0.3), st.floats(0.0, 5e3), st.floats(0.0, 2e4))
def test_passive_pressure_is_that_of_the_formulas_of_soil(
    angle_deg: float, sinkage: float, cohesion: float, weight: float
) -> None:
    phi = math.radians(angle_deg)
    tangent = math.tan(phi)
    factors = bearing_factors(phi)
    expected = (factors.n_q, factors.n_c, factors.n_gamma, factors.k_c, factors.k_gamma)
    assert terzaghi_factors(tangent) == pytest.approx(expected, rel=1e-6, abs=1e-6)
    pushed = bulldozing_resistance(phi, cohesion, weight, WIDTH, 2.0 * RADIUS, sinkage)
    assert wheel_bulldozing(sinkage, RADIUS, WIDTH, cohesion, tangent, weight) == pytest.approx(pushed, rel=1e-6)
    wall = cohesion * sinkage * factors.k_c + 0.5 * weight * sinkage**2 * factors.k_gamma
    assert wall_resistance(sinkage, cohesion, tangent, weight) == pytest.approx(wall, rel=1e-6, abs=1e-9)


@pytest.mark.parametrize("rolling", [0.0, 0.4, 1.0])
def test_mean_shear_goes_over_into_its_series(rolling: float) -> None:
    assert mean_shear(0.99999e-4, rolling) == pytest.approx(mean_shear(1.00001e-4, rolling), rel=1e-6)
    assert mean_shear(2.0, 1.0) == pytest.approx((1.0 - (1.0 - math.exp(-2.0)) / 2.0) / 2.0)


def test_load_grows_with_the_exponent_of_the_sinkage() -> None:
    soil = published_soil()
    ratio = wheel_load(RADIUS, WIDTH, 0.02, soil) / wheel_load(RADIUS, WIDTH, 0.01, soil)
    assert ratio == pytest.approx(2.0**1.5)
