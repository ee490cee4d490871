"""Compliant wheel on soil: where it flattens, and its integrals against quadrature written anew."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

from sojourn_analysis.wheels.examples import example_row
from sojourn_machine.params import FloatArray
from sojourn_physics.contact.compliant_wheel_on_soil import CompliantOnSoilColumn, flattening, soft_rim_forces
from sojourn_physics.contact.contact_law import WheelColumn
from sojourn_physics.contact.passive_pressure import wheel_bulldozing
from sojourn_physics.contact.rigid_rim import RimContact
from sojourn_physics.contact.wheel_on_soil import QUADRATURE, pressure_modulus, rim_forces
from sojourn_physics.soil.params import SoilColumn

Maker = Callable[..., Any]
R, B = 0.4065, 0.229


def wheel(pressure: float, slope: float = 0.0, tread: float = 1.0) -> FloatArray:
    row = example_row("compliant_wheel_on_soil")
    row[CompliantOnSoilColumn.CARCASS_PRESSURE] = pressure
    row[CompliantOnSoilColumn.CARCASS_PRESSURE_SLOPE] = slope
    row[CompliantOnSoilColumn.TREAD_STRENGTH] = tread
    return row


def integrated(
    row: FloatArray, soil: FloatArray, h: float, slip: float, side: float, rolling: float
) -> tuple[float, ...]:
    """F_x, F_y, F_z and the shear along the rim, by adaptive quadrature of the module's equations."""
    k, n = pressure_modulus(soil, B), soil[SoilColumn.N]
    c, mu = row[CompliantOnSoilColumn.TREAD_STRENGTH] * soil[[SoilColumn.COHESION, SoilColumn.TAN_PHI]]
    _, d, greatest = flattening(row, soil, h)
    t1, tc = math.acos(1.0 - h / R), math.acos(1.0 - d / R)
    pressed = 2.0 * R * math.sin(t1)

    def traction(sigma: float, rolled: float, across: float) -> tuple[float, float]:
        x = (rolling * rolled + (1.0 - rolling) * slip * pressed) / soil[SoilColumn.SHEAR_MODULUS]
        y = side * (rolling * across + (1.0 - rolling) * pressed) / soil[SoilColumn.SHEAR_MODULUS_LATERAL]
        j = math.hypot(x, y)
        tau = (c + sigma * mu) * (1.0 - math.exp(-j))
        return (tau * x / j, tau * y / j) if j > 0.0 else (0.0, 0.0)

    def rolled_at(theta: float) -> float:
        if slip >= 0.0:
            return R * (t1 - theta - (1.0 - slip) * (math.sin(t1) - math.sin(theta)))
        return R * ((1.0 + slip) * (t1 - theta) - (math.sin(t1) - math.sin(theta)))

    def arc(theta: float) -> tuple[float, ...]:
        sigma = k * max(R * (math.cos(theta) - math.cos(t1)), 0.0) ** n
        x, y = traction(sigma, rolled_at(theta), R * (t1 - theta))
        cosine, sine = math.cos(theta), math.sin(theta)
        both = 2.0 - rolling
        return (
            R * B * (both * x * cosine - rolling * sigma * sine),
            R * B * both * y,
            R * B * (both * sigma * cosine + rolling * x * sine),
            R * B * both * x,
        )

    def flat(passed: float) -> tuple[float, ...]:
        x, y = traction(greatest, rolled_at(tc) + slip * passed, R * (t1 - tc) + passed)
        return B * x, B * y, B * greatest, B * x

    options = {"epsabs": 1e-9, "epsrel": 1e-10, "limit": 200}
    length = 2.0 * R * math.sin(tc)
    total = [
        quad(lambda t, i=i: arc(t)[i], tc, t1, **options)[0]
        + quad(lambda p, i=i: flat(p)[i], 0.0, length, **options)[0]
        for i in range(4)
    ]
    total[2] = max(total[2], 0.0)
    return tuple(total)


@settings(max_examples=40, deadline=None)
@given(
    soil_name=st.sampled_from(["lunar_nominal", "dry_sand", "sandy_loam", "ding_2011"]),
    pressure=st.floats(1e3, 3e4),
    slope=st.floats(0.0, 2e5),
    h=st.floats(0.003, 0.1),
    slip=st.floats(-1.0, 1.0),
    side=st.floats(-0.6, 0.6),
    rolling=st.sampled_from([0.0, 0.3, 1.0]),
    tread=st.sampled_from([1.0, 0.6]),
)
@example(soil_name="lunar_nominal", pressure=1000.0, slope=0.0, h=0.0625, slip=1.0, side=0.5, rolling=1.0, tread=1.0)
def test_forces_are_the_integrals_of_the_stresses(
    law: Maker,
    soil_name: str,
    pressure: float,
    slope: float,
    h: float,
    slip: float,
    side: float,
    rolling: float,
    tread: float,
) -> None:
    row, soil = wheel(pressure, slope, tread), law("compliant_wheel_on_soil", soil_name).soil
    expected = integrated(row, soil, h, slip, side, rolling)
    found = soft_rim_forces(row, soil, RimContact(h, slip, side, rolling), QUADRATURE)
    scale = math.hypot(*expected[:3])
    assert np.allclose(found[:4], expected, rtol=0.0, atol=5e-4 * scale)  # of the few points; 3e-4 is the most seen


def test_a_hard_carcass_rolls_as_a_rigid_wheel_without_soil_behind_it(law: Maker) -> None:
    soil = law("compliant_wheel_on_soil", "lunar_nominal").soil.copy()
    soil[[SoilColumn.THETA_M_C1, SoilColumn.THETA_M_C2]] = 0.0
    soil[SoilColumn.EXIT_LAMBDA] = 0.0
    for slip in (-0.5, 0.0, 0.3):
        soft = soft_rim_forces(wheel(1e6), soil, RimContact(0.02, slip, 0.1, 1.0), QUADRATURE)
        rigid = rim_forces(R, R, B, RimContact(0.02, slip, 0.1, 1.0), soil, QUADRATURE)
        assert soft[:3] == pytest.approx(rigid[:3], rel=1e-6)
        assert soft[3] * R == pytest.approx(rigid[3], rel=1e-6)
        assert soft[5] == 0.0


def test_it_flattens_from_where_the_ground_pressure_reaches_the_carcass_pressure(law: Maker) -> None:
    soil = law("compliant_wheel_on_soil", "lunar_nominal").soil
    row = wheel(8e3)
    critical = 8e3 / pressure_modulus(soil, B)  # n = 1
    below, above = flattening(row, soil, 0.999 * critical), flattening(row, soil, 1.5 * critical)
    assert below == pytest.approx((0.999 * critical, 0.0, 0.999 * 8e3))
    assert above == pytest.approx((critical, 0.5 * critical, 8e3))
    # and the load is continuous there
    here = [
        soft_rim_forces(row, soil, RimContact(factor * critical, 0.1, 0.0, 1.0), QUADRATURE)
        for factor in (1 - 1e-9, 1 + 1e-9)
    ]
    assert here[0][2] == pytest.approx(here[1][2], rel=1e-3)


def test_a_soft_wheel_sinks_less_and_pulls_more(law: Maker) -> None:
    """The reason to build one: same load, same slip."""
    found = {}
    for name, pressure in (("soft", 4e3), ("hard", 1e6)):
        one = law(wheel(pressure), "lunar_nominal")
        depth = one.penetration_for(253.0)
        for _ in range(12):  # the load of a rolling wheel
            one.state[:] = 0.0
            rolled = one.step(4000, penetration=depth, v_along=0.4, rim_speed=0.5)
            depth *= (253.0 / rolled["force_z"]) ** 0.7
        found[name] = rolled
    assert found["soft"]["force_z"] == pytest.approx(found["hard"]["force_z"], rel=0.01)
    assert found["soft"]["sinkage"] < 0.7 * found["hard"]["sinkage"]
    assert found["soft"]["compaction_resistance"] < 0.7 * found["hard"]["compaction_resistance"]
    assert found["soft"]["force_x"] > found["hard"]["force_x"]


def test_on_rock_it_carries_its_carcass_pressure_over_its_footprint(law: Maker) -> None:
    one = law("compliant_wheel_on_soil", "rigid_rock")
    found = one.step(penetration=0.04)
    d = found["deflection"]
    assert d == pytest.approx(0.04, rel=2e-3)
    pressure = (
        one.wheel[CompliantOnSoilColumn.CARCASS_PRESSURE] + d * one.wheel[CompliantOnSoilColumn.CARCASS_PRESSURE_SLOPE]
    )
    footprint = 2.0 * B * math.sqrt(2.0 * R * d - d * d)
    assert found["force_z"] == pytest.approx(pressure * footprint, rel=0.01)
    assert found["force_z"] == pytest.approx(253.0, rel=0.06)  # the lunar rover's wheel at its nominal load


def test_compaction_is_the_work_of_the_rut(law: Maker) -> None:
    one = law("compliant_wheel_on_soil", "dry_sand")
    found = one.step(8000, penetration=0.03, v_along=0.5, rim_speed=0.5)
    k, n = pressure_modulus(one.soil, B), one.soil[SoilColumn.N]
    work = B * quad(lambda z: k * z**n, 0.0, found["sinkage"])[0]
    assert found["compaction_resistance"] == pytest.approx(work, rel=1e-4)
    assert one.wheel[WheelColumn.RADIUS] == R


@given(depth=st.floats(0.085, 0.2), stiffness=st.floats(1e4, 1e7))
def test_a_bump_stop_bears_from_its_deflection_on(law: Maker, depth: float, stiffness: float) -> None:
    row, soil = wheel(2700.0), law("compliant_wheel_on_soil", "lunar_nominal").soil
    row[CompliantOnSoilColumn.BUMP_STOP] = 0.08
    before = flattening(row, soil, depth)
    row[CompliantOnSoilColumn.BUMP_STOP_SLOPE] = stiffness
    sinkage, deflection, pressure = flattening(row, soil, depth)
    assert pressure == pytest.approx(2700.0 + stiffness * max(deflection - 0.08, 0.0), rel=1e-6)
    assert deflection <= before[1] and sinkage + deflection == pytest.approx(depth)
    assert flattening(row, soil, 0.08) == pytest.approx(flattening(wheel(2700.0), soil, 0.08)), "not touched yet"


@pytest.mark.parametrize(("soil", "crust"), [("lunar_nominal", False), ("viking_blocky", True)])
def test_a_wheel_rides_up_on_a_crust_that_it_cannot_push_away(law: Maker, soil: str, crust: bool) -> None:
    """Hegedus' wedge of a crust of 5.5 kPa would hold a wheel sunk by 3 mm with twice its load."""
    one = law(wheel(2700.0), soil)
    found = one.step(2000, penetration=0.055, v_along=0.5, rim_speed=0.5)
    z = found["sinkage"]
    angle = math.acos(1.0 - z / R)
    climb = found["force_z"] * math.tan(angle)
    tangent, density = one.soil[SoilColumn.TAN_PHI], one.soil[SoilColumn.DENSITY]
    gravity = one.wheel[WheelColumn.GRAVITY]
    pushed = wheel_bulldozing(z, R, B, one.soil[SoilColumn.COHESION], tangent, density * gravity)
    assert pushed > 10.0 * climb if crust else pushed < 1.2 * climb
    assert 0.9 * min(pushed, climb) < found["bulldozing_resistance"] <= 1.001 * min(pushed, climb)
