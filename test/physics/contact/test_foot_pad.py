"""Foot pad: bearing, failure of the soil under it, shear and wall."""

import math
from collections.abc import Callable
from typing import Any

import pytest
from scipy.integrate import dblquad

from sojourn_analysis.wheels.examples import FOOT_RADIUS, example_row
from sojourn_physics.contact.contact_law import WheelColumn
from sojourn_physics.contact.foot_pad import FRICTION_ARM, pad_pressure
from sojourn_physics.contact.passive_pressure import round_bearing_capacity, wall_resistance
from sojourn_physics.contact.wheel_on_soil import pressure_modulus
from sojourn_physics.soil.bearing import bearing_factors
from sojourn_physics.soil.params import SoilColumn

Maker = Callable[..., Any]
FOOT = "foot_pad"
AREA = math.pi * FOOT_RADIUS**2


def test_light_load_sinks_as_a_plate(law: Maker) -> None:
    one = law(FOOT, "lunar_nominal")
    depth = 1e-3
    found = one.step(penetration=depth)
    plate = AREA * pressure_modulus(one.soil, FOOT_RADIUS) * depth ** one.soil[SoilColumn.N]
    assert found["force_z"] == pytest.approx(plate, rel=0.01)
    assert found["sinkage"] == depth


def test_heavy_load_is_limited_by_what_the_soil_bears(law: Maker) -> None:
    one = law(FOOT, "lunar_nominal")
    phi = math.atan(one.soil[SoilColumn.TAN_PHI])
    factors = bearing_factors(phi)
    weight = one.soil[SoilColumn.DENSITY] * 1.62
    depth = 0.1
    capacity = (
        1.3 * one.soil[SoilColumn.COHESION] * factors.n_c
        + weight * (depth * factors.n_q + 0.3 * 2.0 * FOOT_RADIUS * factors.n_gamma)
    )  # fmt: skip
    tangent = one.soil[SoilColumn.TAN_PHI]
    cohesion = one.soil[SoilColumn.COHESION]
    assert round_bearing_capacity(depth, FOOT_RADIUS, cohesion, tangent, weight) == pytest.approx(capacity)
    bekker = pressure_modulus(one.soil, FOOT_RADIUS) * depth
    found = one.step(penetration=depth)["force_z"] / AREA
    assert capacity < bekker
    assert found <= capacity
    assert found == pytest.approx((bekker**-4.0 + capacity**-4.0) ** -0.25)


def test_pressure_rises_with_the_depth_all_the_way(law: Maker) -> None:
    for soil in ("lunar_nominal", "clayey_soil", "snow", "rigid_rock"):
        row = law(FOOT, soil).soil
        pressures = [pad_pressure(FOOT_RADIUS, 1e-4 * 1.3**i, row, 3000.0) for i in range(30)]
        assert pressures == sorted(pressures) and pressures[0] > 0.0


def test_a_sliding_foot_meets_friction_and_the_wall_it_pushes(law: Maker) -> None:
    one = law(FOOT, "lunar_nominal")
    found = one.step(8000, penetration=0.02, v_along=0.03, v_side=0.04)
    cohesion, tangent = one.soil[SoilColumn.COHESION], one.soil[SoilColumn.TAN_PHI]
    weight = one.soil[SoilColumn.DENSITY] * one.wheel[WheelColumn.GRAVITY]
    wall = 2.0 * FOOT_RADIUS * wall_resistance(0.02, cohesion, tangent, weight)
    limit = AREA * cohesion + found["force_z"] * tangent + wall
    # it remembers four shear moduli of its way
    assert math.hypot(found["force_x"], found["force_y"]) == pytest.approx(limit * (1.0 - math.exp(-4.0)), rel=0.01)
    assert found["force_y"] / found["force_x"] == pytest.approx(4.0 / 3.0, rel=1e-6)
    assert found["bulldozing_resistance"] == pytest.approx(wall * (1.0 - math.exp(-4.0)), rel=0.01)


def test_a_turning_foot_meets_the_friction_of_its_disk(law: Maker) -> None:
    one = law(FOOT, "lunar_nominal")
    found = one.step(20000, penetration=0.005, yaw_rate=1.0)
    disk = dblquad(lambda r, _: r * r, 0.0, 2.0 * math.pi, 0.0, FOOT_RADIUS)[0] / AREA
    assert disk == pytest.approx(FRICTION_ARM * FOOT_RADIUS)
    limit = AREA * one.soil[SoilColumn.COHESION] + found["force_z"] * one.soil[SoilColumn.TAN_PHI]
    assert found["moment_z"] == pytest.approx(-limit * disk * (1.0 - math.exp(-4.0)), rel=0.01)
    assert abs(found["force_x"]) < 1e-12


def test_the_row_of_a_foot_has_its_radius() -> None:
    assert example_row(FOOT)[WheelColumn.RADIUS] == FOOT_RADIUS
