"""Brush model against published values, its closed form, and the bristles one by one."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad

from sojourn_analysis.wheels.examples import example_row
from sojourn_machine.params import FloatArray
from sojourn_physics.contact.brush import BrushColumn, pneumatic_trail
from sojourn_physics.contact.firm_wheel import FirmColumn

Maker = Callable[..., Any]
LOAD, FRICTION, STIFFNESS = 1000.0, 0.8, 8000.0
SPEED = 1.0


def published(law: Maker, relaxation: float = 0.05, **changes: float) -> tuple[Any, float]:
    """The wheel of the published values at its load: the rig and the penetration."""
    row = example_row("brush")
    row[BrushColumn.CORNERING_STIFFNESS] = row[BrushColumn.LONGITUDINAL_STIFFNESS] = STIFFNESS
    row[BrushColumn.RELAXATION_LENGTH] = relaxation
    row[FirmColumn.FRICTION] = FRICTION
    row[FirmColumn.ROLLING_RESISTANCE] = 0.0
    for name, value in changes.items():
        row[BrushColumn[name.upper()]] = value
    one = law(row, "rigid_rock")
    return one, one.penetration_for(LOAD)


def steady(one: Any, depth: float, angle: float = 0.0, slip: float = 0.0) -> dict[str, float]:
    """Forces at a slip angle and a practical slip r_e ω = (1 + slip) v."""
    fresh = one.step(penetration=depth)
    one.state[:] = 0.0
    rolling = 0.125 - fresh["deflection"] / 3.0
    rim = SPEED * (1.0 + slip) * 0.125 / rolling
    result: dict[str, float] = one.step(
        3000, penetration=depth, v_along=SPEED, v_side=-SPEED * math.tan(angle), rim_speed=rim
    )
    return result


@pytest.mark.published("brush tyre, C 8000 N/rad, mu 0.8, 1000 N")
@pytest.mark.parametrize(("angle_deg", "force"), [(1.0, 131.67), (2.0, 248.11), (10.0, 743.95)])
def test_published_side_forces(law: Maker, angle_deg: float, force: float) -> None:
    one, depth = published(law)
    found = steady(one, depth, math.radians(angle_deg))
    assert found["force_z"] == pytest.approx(LOAD, rel=1e-9)
    assert found["force_y"] == pytest.approx(force, rel=1e-4)
    assert found["slip_angle"] == pytest.approx(-math.radians(angle_deg), rel=1e-9)


@pytest.mark.published("brush tyre, C 8000 N/rad, mu 0.8, 1000 N")
def test_full_sliding_begins_at_the_published_angle(law: Maker) -> None:
    one, depth = published(law)
    limit = FRICTION * LOAD
    assert steady(one, depth, math.radians(16.60))["force_y"] < limit * (1.0 - 1e-8)
    assert steady(one, depth, math.radians(16.71))["force_y"] == pytest.approx(limit, rel=1e-9)
    assert math.degrees(math.atan(3.0 * limit / STIFFNESS)) == pytest.approx(16.70, abs=0.005)


def bristles_one_by_one(angle: float, half: float) -> tuple[float, float]:
    """Force and moment of a row of bristles under a parabolic pressure, each bent until it slides."""
    stiffness = STIFFNESS / (2.0 * half * half)  # of a length of tread
    peak = 0.75 * LOAD / half

    def shear(x: float) -> float:
        return min(stiffness * (half - x) * math.tan(angle), FRICTION * peak * (1.0 - (x / half) ** 2))

    options = {"epsabs": 1e-8, "limit": 400}
    return quad(shear, -half, half, **options)[0], quad(lambda x: x * shear(x), -half, half, **options)[0]


@pytest.mark.parametrize("angle_deg", [0.5, 2.0, 6.0, 12.0, 20.0])
def test_force_and_aligning_moment_are_those_of_the_bristles(law: Maker, angle_deg: float) -> None:
    one, depth = published(law)
    angle = math.radians(angle_deg)
    found = steady(one, depth, angle)
    half = math.sqrt(2.0 * 0.125 * depth - depth * depth)
    force, moment = bristles_one_by_one(angle, half)
    assert found["force_y"] == pytest.approx(force, rel=1e-5)
    assert found["moment_z"] == pytest.approx(moment, rel=1e-3, abs=1e-4 * half * LOAD)


def test_combined_slip_shares_one_friction(law: Maker) -> None:
    """Both slips equal: each force is that of their resultant, over the square root of two."""
    one, depth = published(law)
    slip = 0.04
    sigma = slip / (1.0 + slip)
    angle = math.atan(sigma * (1.0 + slip))
    both = steady(one, depth, angle, slip)
    x = STIFFNESS * math.sqrt(2.0) * sigma / (3.0 * FRICTION * LOAD)
    force = FRICTION * LOAD * (3.0 * x - 3.0 * x * x + x**3) / math.sqrt(2.0)
    assert both["force_x"] == pytest.approx(force, rel=1e-4)
    assert both["force_y"] == pytest.approx(force, rel=1e-4)
    sliding = steady(one, depth, math.radians(30.0), 0.8)
    assert math.hypot(sliding["force_x"], sliding["force_y"]) == pytest.approx(FRICTION * LOAD, rel=1e-9)


def test_initial_slopes_are_the_stiffnesses(law: Maker) -> None:
    one, depth = published(law, longitudinal_stiffness=5000.0)
    assert steady(one, depth, 1e-4)["force_y"] == pytest.approx(STIFFNESS * 1e-4, rel=2e-3)
    assert steady(one, depth, 0.0, 1e-4)["force_x"] == pytest.approx(5000.0 * 1e-4, rel=2e-3)


def test_side_force_lags_by_the_relaxation_length(law: Maker) -> None:
    """After a step of the slip angle the force has come to 1 - 1/e when one relaxation length is rolled."""
    length = 0.4
    one, depth = published(law, relaxation=length)
    angle = 1e-3
    final = steady(one, depth, angle)["force_y"]
    one.state[:] = 0.0
    fresh = one.step(penetration=depth)
    rim = SPEED * 0.125 / (0.125 - fresh["deflection"] / 3.0)
    forces: list[float] = []
    for _ in range(round(2.0 * length / SPEED / one.dt)):
        found = one.step(penetration=depth, v_along=SPEED, v_side=-SPEED * math.tan(angle), rim_speed=rim)
        forces.append(found["force_y"])
    rolled = SPEED * one.dt * (1 + np.arange(len(forces)))
    expected: FloatArray = final * (1.0 - np.exp(-rolled / length))
    assert np.allclose(forces, expected, atol=0.01 * final)


def test_trail_of_little_and_of_full_sliding() -> None:
    assert pneumatic_trail(0.0, 0.06) == pytest.approx(0.02)
    assert pneumatic_trail(1.0, 0.06) == 0.0
