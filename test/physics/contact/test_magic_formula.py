"""Magic Formula against published values and the formula written anew, combined slip, camber, relaxation."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_analysis.wheels.examples import example_row
from sojourn_physics.contact.firm_wheel import FirmColumn
from sojourn_physics.contact.magic_formula import magic_forces

Maker = Callable[..., Any]
ROW = example_row("magic_formula")
LATERAL = (1.30, -22.1, 1011, 1078, 1.82, 0.208, 0.0, -0.354, 0.707, 0.028, 0.0, 14.8, 0.022, 0.0)
MOMENT = (2.40, -2.72, -2.28, -1.86, -2.73, 0.110, -0.070, 0.643, -4.04, 0.015, -0.066, 0.945, 0.030, 0.070)
ALONG = (1.65, -21.3, 1144, 49.6, 226, 0.069, -0.006, 0.056, 0.486, 0.0, 0.0, 0.0, 0.0, 0.0)


def written_anew(kind: tuple[float, ...], x: float, fz: float, camber: float = 0.0) -> float:
    """The formula with x in degrees or per cent, Fz in kN, camber in degrees."""
    c, a1, a2, a3, a4, a5, a6, a7, a8, a9, a10, a11, a12, a13 = kind
    d = a1 * fz**2 + a2 * fz
    bcd = a3 * math.sin(a4 * math.atan(a5 * fz)) if kind is LATERAL else (a3 * fz**2 + a4 * fz) / math.exp(a5 * fz)
    b = bcd / (c * d) * (1.0 - a12 * abs(camber))
    e = (a6 * fz**2 + a7 * fz + a8) / (1.0 - a13 * abs(camber))
    x += a9 * camber
    phi = (1.0 - e) * x + (e / b) * math.atan(b * x)
    return d * math.sin(c * math.atan(b * phi)) + (a10 * fz**2 + a11 * fz) * camber


@pytest.mark.published("Bakker, Nyborg & Pacejka 1987, SAE 870421")
@pytest.mark.parametrize(("angle_deg", "force"), [(2.0, 1911.1), (5.0, 3389.6), (10.0, 3688.4)])
def test_published_side_forces(angle_deg: float, force: float) -> None:
    assert magic_forces(ROW, 4000.0, 0.0, math.radians(angle_deg), 0.0)[1] == pytest.approx(force, rel=1e-4)


@settings(max_examples=200, deadline=None)
@given(st.floats(0.5, 8.0), st.floats(-30.0, 30.0), st.floats(-8.0, 8.0))
def test_pure_side_slip_with_camber(fz: float, alpha: float, camber: float) -> None:
    angles = math.radians(alpha), math.radians(camber)
    _, force, moment = magic_forces(ROW, 1e3 * fz, 0.0, *angles)
    assert force == pytest.approx(written_anew(LATERAL, alpha, fz, camber), rel=1e-9, abs=1e-6)
    assert moment == pytest.approx(written_anew(MOMENT, alpha, fz, camber), rel=1e-9, abs=1e-6)


@settings(max_examples=100, deadline=None)
@given(st.floats(0.5, 8.0), st.floats(-1.0, 1.0))
def test_pure_longitudinal_slip(fz: float, slip: float) -> None:
    force = magic_forces(ROW, 1e3 * fz, slip, 0.0, 0.0)[0]
    assert force == pytest.approx(written_anew(ALONG, 100.0 * slip, fz), rel=1e-9, abs=1e-6)


def test_the_other_slip_takes_from_a_force_and_never_adds() -> None:
    pure_x, pure_y = (
        magic_forces(ROW, 4000.0, 0.05, 0.0, 0.0)[0],
        magic_forces(ROW, 4000.0, 0.0, 0.05, 0.0)[1],
    )
    along, across, _ = magic_forces(ROW, 4000.0, 0.05, 0.05, 0.0)
    assert 0.0 < along < pure_x and 0.0 < across < pure_y
    # both stay on an ellipse of the greatest forces
    assert math.hypot(along / 4235.2, across / 3690.4) <= 1.0
    # a large slip along leaves next to nothing across
    assert magic_forces(ROW, 4000.0, 1.0, 0.02, 0.0)[1] < 0.1 * magic_forces(ROW, 4000.0, 0.0, 0.02, 0.0)[1]


@pytest.mark.parametrize("load", [0.0, 1e-6, 50.0, 2e4, 1e6])
def test_loads_far_from_those_measured_stay_sensible(load: float) -> None:
    along, across, moment = magic_forces(ROW, load, 0.1, 0.1, 0.05)
    assert along >= 0.0 and across >= 0.0 and math.isfinite(moment)
    assert math.hypot(along, across) <= 1.5 * load + 1e-9


def steady(law: Maker, load: float, **motion: float) -> dict[str, float]:
    row = ROW.copy()
    row[FirmColumn.ROLLING_RESISTANCE] = 0.0
    one = law(row, "rigid_rock")
    camber = motion.get("camber", 0.0)
    depth = one.penetration_for(load, camber=camber)
    fresh = one.step(penetration=depth, camber=camber)
    one.state[:] = 0.0
    rolling = 0.31 - fresh["deflection"] / 3.0
    motion["rim_speed"] = motion.pop("rolling_speed") * 0.31 / rolling
    found: dict[str, float] = one.step(4000, penetration=depth, **motion)
    return found


@pytest.mark.published("Bakker, Nyborg & Pacejka 1987, SAE 870421")
def test_a_rolling_wheel_has_the_published_forces(law: Maker) -> None:
    found = steady(law, 4000.0, v_along=5.0, v_side=-5.0 * math.tan(math.radians(5.0)), rolling_speed=5.0)
    assert found["force_y"] == pytest.approx(3389.6, rel=1e-3)
    assert found["moment_z"] == pytest.approx(written_anew(MOMENT, 5.0, 4.0), rel=1e-3)
    braked = steady(law, 4000.0, v_along=5.0, rolling_speed=4.5)
    assert braked["force_x"] == pytest.approx(written_anew(ALONG, -10.0, 4.0), rel=1e-3)


def test_a_leaning_wheel_is_thrust_to_where_its_top_leans_and_pays_for_it(law: Maker) -> None:
    """The left end of the axle up: the top leans to the right, and so does the force."""
    found = steady(law, 4000.0, v_along=5.0, rolling_speed=5.0, camber=math.sin(math.radians(5.0)))
    assert found["force_y"] == pytest.approx(written_anew(LATERAL, 0.0, 4.0, -5.0), rel=1e-3)
    against = steady(law, 4000.0, v_along=5.0, v_side=-0.02, rolling_speed=5.0, camber=math.sin(math.radians(5.0)))
    assert against["force_y"] * -0.02 > 0.0  # pushes with its own motion
    assert against["power"] >= -1e-9 * 4000.0
    assert against["torque"] > 0.0


def test_force_lags_by_the_relaxation_length(law: Maker) -> None:
    one = law(ROW, "rigid_rock")
    depth = one.penetration_for(4000.0)
    motion = {"penetration": depth, "v_along": 5.0, "v_side": -0.005, "rim_speed": 5.1}
    forces = [one.step(**motion)["force_y"] for _ in range(300)]
    final = one.step(3000, **motion)["force_y"]
    rolled = 0.005 * (1 + np.arange(300))
    assert np.allclose(forces, final * (1.0 - np.exp(-rolled / 0.3)), atol=0.015 * final)


@pytest.mark.parametrize("yaw", [0.0, 1e-6])
def test_a_leaning_wheel_at_rest_pays_for_nothing(law: Maker, yaw: float) -> None:
    """Bent bristles and a rim that hardly turns: camber once made a torque of this, and a parked rover shook."""
    one = law(ROW, "rigid_rock")
    motion = {"penetration": 0.001, "v_side": -0.002, "camber": 0.1}
    one.step(300, **motion)
    still = one.step(penetration=0.001, camber=0.1)
    crawl = one.step(penetration=0.001, camber=0.1, v_side=1e-6, rim_speed=1e-9, yaw_rate=yaw)
    assert abs(still["force_y"]) > 1.0
    assert crawl["torque"] == pytest.approx(still["torque"], abs=1e-5 * still["force_z"])
