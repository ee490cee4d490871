"""Pads: bearing, friction, memory, edges."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_mechanics.soil.params import SoilColumn

Maker = Callable[..., Any]
ZERO = np.zeros(3)
RADIUS = 0.05


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
