"""Wheels on firm ground: springs in series, Coulomb friction, rolling resistance, the wire-mesh wheel."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.optimize import brentq

from sojourn_analysis.wheels.examples import LRV_MESH, ROVER_SIZE, example_row
from sojourn_machine.supports import WheelParams
from sojourn_physics.contact.firm_wheel import FirmColumn
from sojourn_physics.contact.resistance_memory import advance_headway
from sojourn_physics.contact.rows import wheel_rows
from sojourn_physics.contact.series_compliance import Carcass, sinkage_in_series
from sojourn_physics.soil.params import SoilColumn

Maker = Callable[..., Any]
RADIUS, WIDTH = 0.125, 0.16
RIGID = "rigid_wheel_on_rigid_ground"
MESH = "compliant_wheel_on_rigid_ground"


@settings(max_examples=200, deadline=None)
@given(
    amount=st.floats(1.0, 1e9),
    exponent=st.floats(0.3, 3.5),
    penetration=st.floats(1e-9, 3.0),
    offset=st.floats(0.0, 1e4),
    linear=st.floats(1.0, 1e6),
    square=st.floats(0.0, 1e7),
    stop=st.floats(0.001, 0.2),
    stop_stiffness=st.sampled_from([0.0, 1e5]),
)
def test_two_springs_carry_the_same_load(
    amount: float, exponent: float, penetration: float, offset: float, linear: float, square: float, stop: float,
    stop_stiffness: float,
) -> None:  # fmt: skip
    """Against a bracketing solver of another kind."""

    def excess(z: float) -> float:
        d = penetration - z
        return amount * z**exponent - offset - linear * d - square * d * d - stop_stiffness * max(d - stop, 0.0)

    found = sinkage_in_series(amount, exponent, penetration, Carcass(offset, linear, square, stop, stop_stiffness))
    if excess(penetration) <= 0.0:
        assert found == penetration
        return
    expected = brentq(excess, 0.0, penetration, xtol=1e-15 * penetration, rtol=1e-14)
    assert found == pytest.approx(expected, rel=1e-6, abs=1e-11 * penetration)


@pytest.mark.parametrize("n", [0.5, 1.0, 1.3])
def test_load_of_a_rigid_rim_is_that_of_the_strips_under_it(law: Maker, n: float) -> None:
    one = law(RIGID, "rigid_rock")
    soil = one.soil.copy()
    soil[SoilColumn.N] = n
    one = law(example_row(RIGID), soil)
    depth = 0.002
    chord = math.sqrt(2.0 * RADIUS * depth)
    modulus = soil[SoilColumn.K_PHI]
    load = 2.0 * WIDTH * modulus * quad(lambda x: (depth - x * x / (2.0 * RADIUS)) ** n, 0.0, chord, epsabs=1e-13)[0]
    found = one.step(penetration=depth)
    assert found["force_z"] == pytest.approx(load, rel=1e-9)
    assert found["sinkage"] == pytest.approx(depth) and found["deflection"] == pytest.approx(0.0, abs=1e-15)


def test_wheel_and_ground_share_the_penetration(law: Maker) -> None:
    one = law("wheel_and_ground_in_series", "rigid_rock")
    found = one.step(penetration=0.004)
    assert found["sinkage"] + found["deflection"] == pytest.approx(0.004)
    assert found["force_z"] == pytest.approx(40e3 * found["deflection"])
    alone = law(RIGID, "rigid_rock").step(penetration=found["sinkage"])
    assert found["force_z"] == pytest.approx(alone["force_z"])


def test_the_wire_mesh_wheel_of_the_lunar_rover(law: Maker) -> None:
    """253 N bend it by 40 mm (the curve is an estimate, see `examples`); it rolls on a smaller radius, and its bump
    stop carries what the mesh does not."""
    one = law(MESH, "rigid_rock")
    depth = one.penetration_for(253.0)
    found = one.step(penetration=depth)
    assert found["deflection"] == pytest.approx(0.040, abs=0.002)
    assert found["sinkage"] < 1e-3
    assert found["force_z"] == pytest.approx(
        LRV_MESH["stiffness"] * found["deflection"] + LRV_MESH["progressive_stiffness"] * found["deflection"] ** 2
    )
    beyond = law(MESH, "rigid_rock").step(penetration=0.09)
    d = beyond["deflection"]
    mesh = LRV_MESH["stiffness"] * d + LRV_MESH["progressive_stiffness"] * d * d
    assert beyond["force_z"] - mesh == pytest.approx(LRV_MESH["stop_stiffness"] * (d - 0.07), rel=1e-6)
    # it rolls freely where r_e omega = v
    rolling = 0.4065 - found["deflection"] / 3.0
    free = law(MESH, "rigid_rock")
    for _ in range(3000):
        result = free.step(penetration=depth, v_along=1.0, rim_speed=0.4065 / rolling)
    assert result["slip_ratio"] == pytest.approx(0.0, abs=1e-9)
    assert abs(result["force_x"]) < 1e-6 * result["force_z"]


@pytest.mark.parametrize("speed", [0.05, -0.05, 2.0])
def test_rolling_resistance_grows_with_the_square_of_the_speed(law: Maker, speed: float) -> None:
    row = example_row(RIGID)
    row[FirmColumn.ROLLING_RESISTANCE] = 0.02
    row[FirmColumn.ROLLING_RESISTANCE_PER_SPEED_SQUARED] = 0.003
    found = law(row, "rigid_rock").step(4000, penetration=3e-4, v_along=speed, rim_speed=speed)
    part = 0.02 + 0.003 * speed**2
    assert found["torque"] == pytest.approx(math.copysign(part * found["force_z"] * RADIUS, speed), rel=1e-4)
    assert found["rolling_resistance"] == pytest.approx(part * found["force_z"], rel=1e-4)
    assert found["power"] == pytest.approx(part * found["force_z"] * abs(speed), rel=1e-4)


@settings(max_examples=40, deadline=None)
@given(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0))
def test_a_locked_wheel_slides_against_its_motion_with_coulomb_friction(law: Maker, along: float, side: float) -> None:
    speed = math.hypot(along, side)
    if speed < 0.02:
        return
    one = law(RIGID, "rigid_rock")
    found = one.step(1500, penetration=3e-4, v_along=along, v_side=side)
    friction = one.soil[SoilColumn.TAN_PHI] * found["force_z"]
    assert found["force_x"] == pytest.approx(-friction * along / speed, rel=1e-3, abs=1e-3 * friction)
    assert found["force_y"] == pytest.approx(-friction * side / speed, rel=1e-3, abs=1e-3 * friction)


def test_a_wheel_that_stops_sliding_gives_back_no_more_than_its_bristles_hold(law: Maker) -> None:
    """Slid, then pulled back: the work that comes out is that of a displacement `break_away`."""
    one = law(RIGID, "rigid_rock")
    one.step(500, penetration=3e-4, v_side=0.1)
    returned = 0.0
    for _ in range(2000):
        found = one.step(penetration=3e-4, v_side=-1e-3)
        returned -= min(found["power"], 0.0) * one.dt
    limit = one.soil[SoilColumn.TAN_PHI] * found["force_z"]
    assert found["force_y"] == pytest.approx(limit, rel=1e-3)
    # of 3x - 3x² + x³ from 0 to 1: three quarters
    assert returned <= 0.76 * limit * 1e-3


def test_a_wheel_turned_on_the_spot_meets_the_friction_of_a_line(law: Maker) -> None:
    one = law(RIGID, "rigid_rock")
    found = one.step(4000, penetration=3e-4, yaw_rate=0.5)
    friction = one.soil[SoilColumn.TAN_PHI] * found["force_z"]
    line = quad(lambda y: abs(y) * friction / WIDTH, -WIDTH / 2.0, WIDTH / 2.0)[0]
    assert found["moment_z"] == pytest.approx(-line, rel=1e-6)


def test_own_friction_goes_before_that_of_the_ground(law: Maker) -> None:
    row = example_row(RIGID)
    row[FirmColumn.FRICTION] = 0.3
    found = law(row, "rigid_rock").step(1500, penetration=3e-4, v_side=0.1)
    assert found["force_y"] == pytest.approx(-0.3 * found["force_z"], rel=1e-3)


def test_a_tilted_wheel_is_turned_by_its_load_as_its_height_says(law: Maker) -> None:
    """Moment about x is the derivative of the potential: penetration = r cos(camber) - height."""
    one = law(MESH, "rigid_rock")
    camber, height = 0.2, 0.37
    found = one.step(penetration=0.4065 * math.cos(camber) - height, camber=math.sin(camber))
    assert found["moment_x"] == pytest.approx(0.4065 * math.sin(camber) * found["force_z"], rel=1e-9)


def test_dahl_resistance_reverses_within_its_length() -> None:
    state = np.zeros(5)
    for _ in range(1000):
        ahead = advance_headway(0.1, 0.05, 0.01, state)
    assert ahead == pytest.approx(1.0, abs=1e-6)
    for _ in range(50):  # back by 50 mm, one length: H goes as 2 e^-1 - 1
        back = advance_headway(-0.1, 0.05, 0.01, state)
    assert back == pytest.approx(2.0 * math.exp(-1.0) - 1.0, abs=0.02)


def test_rows_hold_what_the_parameters_say() -> None:
    wheel = WheelParams.model_validate({
        "name": "a", "joint": "b", **ROVER_SIZE,
        "contact": {"model": "wheel_and_ground_in_series", "stiffness": 5e4, "break_away": 2e-3, "friction": 0.4},
    })  # fmt: skip
    row = wheel_rows([wheel], 3.7)[0]
    assert row[FirmColumn.STIFFNESS] == 5e4
    assert row[FirmColumn.BREAK_AWAY] == 2e-3
    assert row[FirmColumn.FRICTION] == 0.4
    assert row[FirmColumn.DAMPING] == 1.0
    assert row[FirmColumn.STOP_STIFFNESS] == 0.0
