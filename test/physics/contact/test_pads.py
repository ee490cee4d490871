"""Pads: bearing, friction, memory, edges."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_machine.supports import PadParams, ScoopParams
from sojourn_physics.contact.rows import pad_cuts
from sojourn_physics.soil.digging import DiggingSoil, mckyes
from sojourn_physics.soil.params import SoilColumn, SoilParams
from sojourn_physics.terrain.memory_tiles import DUG, RUT, TILE, new_page

Maker = Callable[..., Any]
ZERO = np.zeros(3)
RADIUS = 0.05


def soil_of(name: str) -> SoilParams:
    text = (Path(__file__).resolve().parents[3] / "config" / "soils" / f"{name}.yaml").read_text(encoding="utf-8")
    return SoilParams.model_validate(yaml.safe_load(text))


@pytest.mark.parametrize("soil", ["lunar_nominal", "clayey_soil", "rigid_rock"])
@pytest.mark.parametrize("slope", [0.0, 0.3])
def test_bearing_of_a_plate(rig: Maker, soil: str, slope: float) -> None:
    pad = rig(soil, wheel=False, radius=RADIUS, slope_x=slope)
    row = pad.soils[0]
    force, moment = pad.push(-0.004 * pad.normal, np.eye(3), ZERO, ZERO)
    modulus = row[SoilColumn.K_C] / RADIUS + row[SoilColumn.K_PHI]
    expected = math.pi * RADIUS**2 * modulus * 0.004 ** row[SoilColumn.N]
    assert np.allclose(force, expected * pad.normal, rtol=1e-9)
    assert np.allclose(moment, 0.0, atol=1e-9 * expected)
    assert pad.report[0, 3] == pytest.approx(0.004)


@pytest.mark.parametrize(("lowered", "height"), [(0.02, -0.024), (-0.03, 0.026), (0.0, -0.004)])
def test_a_pad_meets_the_ground_as_it_is_now(rig: Maker, lowered: float, height: float) -> None:
    """In a rut or a hole, on a heap, and on ground that nobody has touched: sunk by 4 mm each time."""
    pad = rig("lunar_nominal", wheel=False, radius=RADIUS, cell=0.02)
    untouched = rig("lunar_nominal", wheel=False, radius=RADIUS)
    if lowered:
        column, row = (round((0.0 - origin) / 0.02) for origin in pad.memory.place[:2])
        pool, slots, pages, _ = pad.memory.tables
        for i in range(-3, 4):
            for j in range(-3, 4):
                page = new_page(slots, pages, (column + j) // TILE, (row + i) // TILE)
                pool[page, (row + i) % TILE, (column + j) % TILE, RUT if lowered > 0.0 else DUG] = lowered
    found, _ = pad.push(np.array([0.0, 0.0, height]), np.eye(3), ZERO, ZERO)
    wanted, _ = untouched.push(np.array([0.0, 0.0, -0.004]), np.eye(3), ZERO, ZERO)
    assert np.allclose(found, wanted, rtol=1e-5)
    clear, _ = pad.push(np.array([0.0, 0.0, height + 0.005]), np.eye(3), ZERO, ZERO)
    assert not clear.any()


def test_friction_of_a_sliding_pad(rig: Maker) -> None:
    pad = rig("lunar_nominal", wheel=False, radius=RADIUS)
    row = pad.soils[0]
    velocity = np.array([0.03, -0.04, 0.0])
    force, _ = pad.hold(np.array([0.0, 0.0, -0.01]), np.eye(3), velocity, ZERO, 8000)
    limit = row[SoilColumn.COHESION] * math.pi * RADIUS**2 + force[2] * row[SoilColumn.TAN_PHI]
    # against the motion; it remembers four shear moduli of its way, so 1 - e^-4 of the limit
    assert np.allclose(force[:2], -velocity[:2] / 0.05 * limit * (1.0 - math.exp(-4.0)), rtol=0.01)


def test_a_pad_at_rest_keeps_its_friction(rig: Maker) -> None:
    pad = rig("lunar_nominal", wheel=False, radius=RADIUS)
    centre = np.array([0.0, 0.0, -0.01])
    pad.hold(centre, np.eye(3), np.array([0.01, 0.0, 0.0]), ZERO, 500)
    force, _ = pad.push(centre, np.eye(3), ZERO, ZERO)
    later, _ = pad.hold(centre, np.eye(3), ZERO, ZERO, 2000)
    assert force[0] < -1.0
    assert np.array_equal(force, later)
    lifted, _ = pad.push(np.array([0.0, 0.0, 0.01]), np.eye(3), ZERO, ZERO)
    assert not lifted.any() and not pad.state.any()


@settings(max_examples=60, deadline=None)
@given(
    st.sampled_from(["lunar_nominal", "rigid_rock", "snow"]),
    st.lists(st.floats(-1e3, 1e3), min_size=3, max_size=3),
    st.floats(-3.0, 1.0),
)
def test_finite_and_within_the_friction_cone(rig: Maker, soil: str, velocity: list[float], height: float) -> None:
    pad = rig(soil, wheel=False, radius=RADIUS, slope_x=0.2)
    row = pad.soils[0]
    for _ in range(5):
        force, _ = pad.push(np.array([0.0, 0.0, height]), np.eye(3), np.array(velocity), ZERO)
        normal = float(force @ pad.normal)
        along = float(np.linalg.norm(force - normal * pad.normal))
        limit = row[SoilColumn.COHESION] * math.pi * RADIUS**2 + normal * row[SoilColumn.TAN_PHI]
        assert math.isfinite(along) and normal >= -1e-9
        assert along <= limit * (1.0 + 1e-9) + 1e-9
    assert np.isfinite(pad.state).all()


def test_a_pad_off_the_map_is_told(rig: Maker) -> None:
    pad = rig("lunar_nominal", wheel=False, radius=RADIUS)
    pad.push(np.array([0.0, 11.0, -0.01]), np.eye(3), ZERO, ZERO)
    assert not pad.on_map
    pad.push(np.array([0.0, 11.0, 0.5]), np.eye(3), ZERO, ZERO)
    assert pad.on_map  # in the air there is nothing to miss


@pytest.mark.parametrize(("name", "depth"), [("lunar_nominal", 0.03), ("dry_sand", 0.05), ("rigid_rock", 1e-5)])
def test_a_scoop_that_is_dragged_meets_mckyes_cut(rig: Maker, name: str, depth: float) -> None:
    """In steady dragging: friction of its end and the force on its flank, as the law of digging gives it."""
    plain, scoop = rig(name, wheel=False, radius=0.02), rig(name, wheel=False, radius=0.02)
    tool, soil = ScoopParams(width=0.04), soil_of(name)
    pads = (PadParams(name="tip", link="tip", position=(0.0, 0.0, 0.0), radius=0.02, scoop=tool),)
    scoop.cuts = pad_cuts(pads, (soil,), 1.62)
    centre, velocity = np.array([0.0, 0.0, -depth]), np.array([0.02, 0.0, 0.0])
    without, _ = plain.hold(centre, np.eye(3), velocity, ZERO, 20000)
    force, _ = scoop.hold(centre, np.eye(3), velocity, ZERO, 20000)
    gain = 1.0 - math.exp(-4.0)
    cut = 0.0
    if soil.kind == "soil":
        friction = math.radians(soil.friction_angle_deg)
        seen = DiggingSoil(soil.density * 1.62, soil.cohesion, friction, math.radians(15.0))
        cut = mckyes(seen, 0.04, depth, 0.5 * math.pi, sides=True).forward
    assert without[0] - force[0] == pytest.approx(gain * cut, rel=0.02, abs=1e-9)
    assert scoop.report[0, 14] == pytest.approx(gain * cut, rel=0.02, abs=1e-9)
    assert force[2] == pytest.approx(without[2])


@settings(max_examples=40, deadline=None)
@given(st.floats(0.001, 0.1), st.floats(0.0, 2.0 * math.pi), st.floats(1e-3, 0.5))
def test_a_scoop_takes_energy_on_any_closed_way(rig: Maker, depth: float, heading: float, speed: float) -> None:
    """There and back at one depth: it never gives more than it took."""
    scoop = rig("lunar_nominal", wheel=False, radius=0.02)
    pads = (PadParams(name="tip", link="tip", position=(0.0, 0.0, 0.0), radius=0.02, scoop=ScoopParams(width=0.04)),)
    scoop.cuts = pad_cuts(pads, (soil_of("lunar_nominal"),), 1.62)
    centre = np.array([0.0, 0.0, -depth])
    way = speed * np.array([math.cos(heading), math.sin(heading), 0.0])
    work = 0.0
    for sense in (1.0, -1.0, 1.0, -1.0):
        for _ in range(100):
            force, _ = scoop.push(centre, np.eye(3), sense * way, ZERO)
            work -= float(force @ (sense * way)) * scoop.dt
    assert work > 0.0
