"""Brush model and Magic Formula against published values: the laws as the plant calls them.

Magic Formula: coefficients of Bakker, Nyborg & Pacejka 1987 (SAE 870421); side force of a load of 4 kN.
Brush: F_y = mu F_z (3x - 3x^2 + x^3), x = C tan(alpha)/(3 mu F_z), C 8000 N/rad, mu 0.8, F_z 1000 N.
"""

import math

import numpy as np
import pytest

from sojourn_analysis.wheels.examples import example_row
from sojourn_machine.params import FloatArray
from sojourn_physics.contact.brush import BrushColumn
from sojourn_physics.contact.contact_law import (
    MOTION_COLUMNS,
    OUT_COLUMNS,
    STATE_COLUMNS,
    MotionColumn,
    OutColumn,
    WheelColumn,
)
from sojourn_physics.contact.firm_wheel import FirmColumn
from sojourn_physics.contact.law_call import apply_law
from sojourn_physics.soil.params import SoilParams, kernel_row

ROCK = kernel_row(
    SoilParams(
        name="rock", citation="stiff ground, for the tests", kind="rigid", n=1.0, k_c=0.0, k_phi=5e8,
        friction_angle_deg=40.0, contact_damping=0.0,
    )
)  # fmt: skip
SPEED = 5.0


def side_force(wheel: FloatArray, load: float, angle_deg: float) -> tuple[float, float]:
    """Load and side force of a wheel that rolls freely at a slip angle, after twenty metres."""

    def roll(penetration: float, side: float, rim: float, steps: int) -> FloatArray:
        motion, out, state = np.zeros(MOTION_COLUMNS), np.zeros(OUT_COLUMNS), np.zeros(STATE_COLUMNS)
        motion[[MotionColumn.PENETRATION, MotionColumn.V_SIDE, MotionColumn.RIM_SPEED]] = penetration, side, rim
        motion[MotionColumn.V_ALONG] = SPEED if steps > 1 else 0.0
        for _ in range(steps):
            out[:] = 0.0
            apply_law(wheel, ROCK, motion, 0.001, state, out)
        return out

    low, high = 0.0, 0.1
    for _ in range(80):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if roll(middle, 0.0, 0.0, 1)[OutColumn.FORCE_Z] < load else (low, middle)
    deflection = roll(low, 0.0, 0.0, 1)[OutColumn.DEFLECTION]
    radius = wheel[WheelColumn.RADIUS]
    rim = SPEED * radius / (radius - deflection / 3.0)
    out = roll(low, -SPEED * math.tan(math.radians(angle_deg)), rim, 4000)
    return float(out[OutColumn.FORCE_Z]), float(out[OutColumn.FORCE_Y])


@pytest.mark.published("Bakker, Nyborg & Pacejka 1987, SAE 870421")
@pytest.mark.parametrize(("angle_deg", "force"), [(2.0, 1911.1), (5.0, 3389.6), (10.0, 3688.4)])
def test_magic_formula(angle_deg: float, force: float) -> None:
    load, found = side_force(example_row("magic_formula"), 4000.0, angle_deg)
    assert load == pytest.approx(4000.0, rel=1e-6)
    assert found == pytest.approx(force, rel=1e-3)


@pytest.mark.published("brush tyre, C 8000 N/rad, mu 0.8, 1000 N")
@pytest.mark.parametrize(("angle_deg", "force"), [(1.0, 131.67), (2.0, 248.11), (10.0, 743.95), (16.71, 800.0)])
def test_brush(angle_deg: float, force: float) -> None:
    wheel = example_row("brush")
    wheel[[BrushColumn.CORNERING_STIFFNESS, BrushColumn.LONGITUDINAL_STIFFNESS]] = 8000.0
    wheel[FirmColumn.FRICTION] = 0.8
    load, found = side_force(wheel, 1000.0, angle_deg)
    assert load == pytest.approx(1000.0, rel=1e-6)
    assert found == pytest.approx(force, rel=1e-4)
