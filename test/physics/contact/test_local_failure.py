"""Loose soil, whose file says that it fails locally, is pushed with two thirds of its strength under every law."""

import math
from collections.abc import Callable
from typing import Any

import pytest

from sojourn_analysis.vehicle.wheel_traction import ClosedFormWheel
from sojourn_analysis.wheels.examples import FOOT_RADIUS, TRACK_SIZE, example_row
from sojourn_config.load import load_params
from sojourn_machine.params import FloatArray
from sojourn_physics.contact.contact_law import WheelColumn
from sojourn_physics.contact.passive_pressure import round_bearing_capacity, wall_resistance
from sojourn_physics.soil.bearing import bearing_factors, bulldozing_resistance
from sojourn_physics.soil.params import SoilParams, kernel_row

Maker = Callable[..., Any]
LOOSE = load_params("soils", "lunar_nominal", SoilParams, ["bulldozing_failure=local"])
COHESION = 2.0 / 3.0 * LOOSE.cohesion
TANGENT = 2.0 / 3.0 * math.tan(LOOSE.friction_angle)
ANGLE = math.atan(TANGENT)


def pushed(row: FloatArray, sinkage: float) -> float:
    weight = LOOSE.unit_weight(row[WheelColumn.GRAVITY])
    width, diameter = row[WheelColumn.WIDTH], 2.0 * row[WheelColumn.RADIUS]
    return bulldozing_resistance(ANGLE, COHESION, weight, width, diameter, sinkage)


@pytest.mark.parametrize("model", ["bekker_wheel_on_soil", "compliant_wheel_on_soil"])
def test_a_wheel_pushes_loose_soil(law: Maker, model: str) -> None:
    row = example_row(model)
    found = law(row, kernel_row(LOOSE)).step(20000, penetration=0.04, v_along=0.5, rim_speed=0.5)
    assert found["sinkage"] > 0.0
    assert found["bulldozing_resistance"] == pytest.approx(pushed(row, found["sinkage"]), rel=1e-3)


def test_a_track_pushes_loose_soil(law: Maker) -> None:
    row = example_row("track")
    found = law(row, kernel_row(LOOSE)).step(30000, penetration=0.02, v_along=0.5, rim_speed=0.5)
    wall = TRACK_SIZE["width"] * wall_resistance(0.02, COHESION, TANGENT, LOOSE.unit_weight(row[WheelColumn.GRAVITY]))
    assert found["bulldozing_resistance"] == pytest.approx(wall, rel=1e-6)


def test_a_foot_pushes_loose_soil_and_breaks_through_it(law: Maker) -> None:
    row = example_row("foot_pad")
    foot = law(row, kernel_row(LOOSE))
    weight = LOOSE.unit_weight(row[WheelColumn.GRAVITY])
    capacity = math.pi * FOOT_RADIUS**2 * round_bearing_capacity(0.1, FOOT_RADIUS, COHESION, TANGENT, weight)
    assert 0.8 * capacity < foot.step(penetration=0.1)["force_z"] <= capacity
    found = foot.step(8000, penetration=0.02, v_along=0.05)
    wall = 2.0 * FOOT_RADIUS * wall_resistance(0.02, COHESION, TANGENT, weight)
    assert found["bulldozing_resistance"] == pytest.approx(wall * (1.0 - math.exp(-4.0)), rel=0.01)


def test_the_closed_forms_of_a_design_push_loose_soil() -> None:
    wheel = ClosedFormWheel(LOOSE, 0.4065, 0.229, 1.624)
    found = wheel.forces(2000.0, 0.1)
    expected = bulldozing_resistance(ANGLE, COHESION, LOOSE.unit_weight(1.624), 0.229, 0.813, found.sinkage)
    assert found.bulldozing == pytest.approx(expected) and expected > 0.0


@pytest.mark.published
@pytest.mark.parametrize(("degrees", "n_gamma"), [(20.0, 5.0), (30.0, 19.7), (35.0, 42.4)])
def test_the_weight_factor_is_near_terzaghis_own(degrees: float, n_gamma: float) -> None:
    """Terzaghi's graph as tabulated by Bowles, Foundation Analysis and Design, table 4-2: the fit is 12 % off."""
    assert bearing_factors(math.radians(degrees)).n_gamma == pytest.approx(n_gamma, rel=0.13)
