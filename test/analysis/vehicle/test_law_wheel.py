"""Wheels of the plant in steady rolling, on virgin soil and in ruts: against the test bed and closed forms."""

import math
from typing import Any

import numpy as np
import pytest

from sojourn_analysis.vehicle.law_wheel import LawWheel
from sojourn_analysis.vehicle.multi_pass import FollowingWheel, following_wheels, passes
from sojourn_analysis.vehicle.side_force import SoilSideForce, cornering_stiffness
from sojourn_analysis.vehicle.wheel_traction import RimStressWheel
from sojourn_analysis.wheels.examples import LRV_CARCASS, LRV_SIZE
from sojourn_config.load import load_params
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.supports import WheelParams
from sojourn_physics.contact.wheel_shape import WheelShape
from sojourn_physics.soil.params import SoilParams

MOON = 1.624
SIZE = {"radius": 0.125, "width": 0.16}
LOAD = 49.0


@pytest.fixture(scope="module")
def soil() -> SoilParams:
    return load_params("soils", "lunar_nominal", SoilParams)


def wheel(soil: SoilParams, size: dict[str, float] | None = None, **contact: Any) -> LawWheel:
    law = contact or {"model": "rigid_wheel_on_soil"}
    params = WheelParams.model_validate({"name": "w", "joint": "w", **(size or SIZE), "contact": law})
    return LawWheel(params, soil, MOON)


@pytest.mark.parametrize("slip", [-0.3, 0.0, 0.1, 0.6])
def test_rigid_wheel_is_that_of_the_test_bed(soil: SoilParams, slip: float) -> None:
    """Two ways to the same equations: the steady kernel of the bed, and the plant's law with its memory settled.

    At 1 m/s a ten-thousandth is left of the damping that the plant's law has near rest.
    """
    bed = RimStressWheel(soil, WheelShape(name="w", citation="test", **SIZE), MOON)
    assert wheel(soil).forces(LOAD, slip)[:3] == pytest.approx(bed.forces(LOAD, slip)[:3], rel=2e-4, abs=1e-3)


def test_side_force_is_that_of_the_test_bed(soil: SoilParams) -> None:
    bed = SoilSideForce(soil, WheelShape(name="w", citation="test", **SIZE), MOON)
    for angle in (-0.2, 0.05, 0.4):
        assert wheel(soil).force(LOAD, angle) == pytest.approx(bed.force(LOAD, angle), rel=1e-4)


def test_brush_has_the_stiffness_it_is_given() -> None:
    rock = load_params("soils", "rigid_rock", SoilParams)
    brush = wheel(rock, model="brush", stiffness=3e4, longitudinal_stiffness=800.0, cornering_stiffness=600.0)
    # pressed flat it rolls on a smaller radius, and so slips a little where the rim does not: 3 % of the grip are taken
    assert cornering_stiffness(brush, LOAD) == pytest.approx(600.0, rel=0.04)
    steep = (brush.forces(LOAD, 2e-3).pull - brush.forces(LOAD, 1e-3).pull) / 1e-3
    assert steep == pytest.approx(800.0, rel=0.12)


def test_mesh_of_the_lunar_rover_is_pressed_flat(soil: SoilParams) -> None:
    """Where the soil carries as much as the carcass presses: k z = p_c, the rest is deflection (Bekker 1960)."""
    mesh = wheel(soil, LRV_SIZE, model="compliant_wheel_on_soil", **LRV_CARCASS)
    load = 700.0 * MOON / 4.0
    found = mesh.forces(load, 0.0)
    modulus = 1400.0 / 0.229 + 820e3
    pressure = modulus * found.sinkage
    deflection = (pressure - LRV_CARCASS["carcass_pressure"]) / LRV_CARCASS["carcass_pressure_slope"]
    flat = 2.0 * math.sqrt(2.0 * 0.4065 * deflection - deflection**2) * 0.229 * pressure
    assert 0.8 * load < flat < load  # the arc ahead carries the rest
    assert found.compaction == pytest.approx(0.229 * modulus * found.sinkage**2 / 2.0, rel=1e-6)
    rigid = wheel(soil, LRV_SIZE).forces(load, 0.0)
    assert found.compaction < 0.1 * rigid.compaction


def test_later_passes_cost_less_and_come_to_rest(soil: SoilParams) -> None:
    """Every pass deepens the rut a little less; the pull at one slip grows; elastic soil is left in the end."""
    forces, ruts = passes(wheel(soil), LOAD, 0.1, 6)
    pulls = np.array([force.pull for force in forces])
    assert ruts[0] == 0.0 and np.all(np.diff(ruts) > 0.0) and np.all(np.diff(np.diff(ruts)) < 0.0)
    assert np.all(np.diff(pulls) > 0.0)
    assert forces[1].compaction < 0.5 * forces[0].compaction
    assert ruts[1] < forces[0].sinkage


def test_a_light_wheel_after_a_heavy_one_leaves_the_rut_alone(soil: SoilParams) -> None:
    heavy = wheel(soil)
    depth = heavy.forces(3.0 * LOAD, 0.1).sinkage
    light = LawWheel(heavy.wheel, soil, MOON, depth)
    assert light.rut + light.forces(LOAD, 0.1).sinkage < depth


def test_only_wheels_of_one_track_follow_one_another(soil: SoilParams) -> None:
    three = [wheel(soil)] * 3
    loads = np.array([LOAD, LOAD, LOAD])
    found = following_wheels(three, loads, np.array([1.0, 1.5, 1.02]))
    assert found[0] is three[0] and found[1] is three[1]
    assert isinstance(found[2], FollowingWheel) and len(found[2].before) == 1
    assert found[2].forces(LOAD, 0.1) == passes(three[0], LOAD, 0.1, 2)[0][1]


@pytest.mark.parametrize(("load", "slip"), [(0.0, 0.1), (math.nan, 0.1), (LOAD, 1.2), (1e7, 0.1)])
def test_what_no_wheel_bears_is_refused(soil: SoilParams, load: float, slip: float) -> None:
    with pytest.raises(InvalidValueError):
        wheel(soil).forces(load, slip)
