"""One wheel and its ruts: what it leaves, what it meets on the way back, and what that costs."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from sojourn_physics.contact.ground_memory import GREATEST, PAST_COLUMNS, settle_soil
from sojourn_physics.contact.ground_memory import RUT as PAST_RUT
from sojourn_physics.soil.params import SoilColumn
from sojourn_physics.terrain.memory import GroundMemory, MemoryBoard
from sojourn_physics.terrain.memory_tiles import CHANNELS, DUG, RUT, SINKAGE, TILE

Maker = Callable[..., Any]
RADIUS = 0.125
LEVEL = np.eye(3)


def roll(rig: Any, start: float, end: float, depth: float, speed: float = 0.5, slip: float = 0.1) -> np.ndarray:
    """Drive the wheel along x with its lowest point `depth` below the old ground; gives x, F_x, F_z, power, step by
    step."""
    sense = math.copysign(1.0, end - start)
    spin = sense * speed / (1.0 - slip) / RADIUS
    rows = []
    for x in np.arange(start, end, sense * speed * rig.dt):
        centre = np.array([x, 0.0, RADIUS - depth])
        velocity, angular = np.array([sense * speed, 0.0, 0.0]), np.array([0.0, spin, 0.0])
        force, moment = rig.push(centre, LEVEL, velocity, angular)
        rows.append((x, force[0], force[2], -force @ velocity - moment @ angular))
    return np.array(rows)


def with_rut(rig: Any, depth: float, begin: float, end: float) -> None:
    """Press a rut into the ground across the whole width, from x = begin to end."""
    cell = rig.cell
    values = {}
    for column in range(int((begin + 10.0) / cell / TILE), int((end + 10.0) / cell / TILE) + 1):
        tile = np.zeros((TILE, TILE, CHANNELS), dtype=np.float32)
        x = -10.0 + cell * (column * TILE + np.arange(TILE))
        there = (x >= begin) & (x <= end)
        tile[:, there, SINKAGE], tile[:, there, RUT] = 1.2 * depth, depth
        for row in range(int(9.0 / cell / TILE), int(11.0 / cell / TILE) + 1):
            values[column, row] = tile
    rig.memory = MemoryBoard(GroundMemory(cell, -10.0, -10.0, values))


def test_a_rolling_wheel_leaves_a_rut_of_its_sinkage_and_width(rig: Maker) -> None:
    wheel = rig("lunar_nominal", cell=0.025)
    roll(wheel, 0.0, 1.0, 0.015)
    memory = wheel.memory.store()
    modulus = 1400.0 / wheel.width + 820.0e3
    rebound = modulus * 0.015 / (503.0e6 * 0.015)
    sinkage, rut, shear = memory.sample(0.5, 0.0)
    assert sinkage == pytest.approx(0.015, rel=1e-6)
    assert rut == pytest.approx(0.015 - rebound, rel=1e-6)
    assert 0.0 < shear < 0.1 * 4.0 * math.sqrt(2.0 * RADIUS * 0.015)
    across = memory.grid(np.array([0.5]), np.linspace(-0.2, 0.2, 801))[:, 0, RUT]
    assert np.ptp(np.linspace(-0.2, 0.2, 801)[across > 0.5 * rut]) == pytest.approx(wheel.width, abs=0.026)
    assert memory.sample(1.1, 0.0) == (0.0, 0.0, 0.0)  # nothing ahead of it


def test_a_wheel_does_not_feel_the_rut_that_it_is_making(rig: Maker) -> None:
    fresh, remembers = rig("lunar_nominal"), rig("lunar_nominal", cell=0.025)
    without, with_memory = roll(fresh, 0.0, 1.5, 0.012), roll(remembers, 0.0, 1.5, 0.012)
    assert np.array_equal(without, with_memory)
    assert remembers.memory.store().tiles


def test_the_second_wheel_meets_compacted_soil(rig: Maker) -> None:
    """At the load of the first it sinks in by a third as much, and takes less power at the same speed and slip."""
    wheel = rig("lunar_nominal", cell=0.025)
    first = roll(wheel, 0.0, 1.5, 0.013)
    load = first[1000:, 2].mean()
    wheel.state[:] = 0.0
    low, high = 0.012, 0.030
    for _ in range(14):  # the depth at which the second pass carries the same load
        depth = 0.5 * (low + high)
        trial = rig("lunar_nominal", cell=0.025)
        trial.memory.load(wheel.memory.store())
        second = roll(trial, 0.5, 1.0, depth)[600:]
        low, high = (low, depth) if second[:, 2].mean() > load else (depth, high)
    assert second[:, 2].mean() == pytest.approx(load, rel=1e-3)
    rut = wheel.memory.store().sample(0.7, 0.0)[1]
    assert 0.013 < depth < 0.017  # a little deeper than the first, not twice as deep
    assert depth - rut < 0.45 * 0.013
    assert trial.report[0, 3] == pytest.approx(depth - rut, rel=0.02)
    assert second[:, 3].mean() < 0.8 * first[1000:, 3].mean()


def test_a_wheel_that_turns_back_meets_its_own_rut_within_a_contact_length(rig: Maker) -> None:
    wheel = rig("lunar_nominal", cell=0.025)
    ahead = roll(wheel, 0.0, 1.0, 0.013)
    back = roll(wheel, 1.0, 0.0, 0.013)
    begin = ahead[500:1500, 2].mean()
    assert back[5, 2] == pytest.approx(begin, rel=0.3)
    assert back[600:1200, 2].mean() < 0.75 * begin  # held at the same depth, it bears less: most of it is a rut
    assert abs(np.diff(back[:, 2])).max() < 0.1 * begin  # and it comes to that evenly, 0.5 mm a step


def test_a_parked_wheel_changes_nothing(rig: Maker) -> None:
    wheel = rig("lunar_nominal", cell=0.025)
    centre = np.array([0.0, 0.0, RADIUS - 0.01])
    for _ in range(200):
        wheel.push(centre, LEVEL, np.zeros(3), np.zeros(3))
    assert not wheel.memory.store().tiles
    end = roll(wheel, 0.0, 0.5, 0.01)[-1, 0]
    memory = wheel.memory.store()
    for _ in range(200):
        wheel.push(np.array([end, 0.0, RADIUS - 0.01]), LEVEL, np.zeros(3), np.zeros(3))
    assert wheel.memory.store() is memory


@pytest.mark.parametrize("length", [0.05, 0.2, 0.6])
@pytest.mark.parametrize("depth", [0.003, 0.012])
def test_crossing_a_rut_gives_no_energy(rig: Maker, depth: float, length: float) -> None:
    """Rolled over at constant height without friction, the ground takes back on one side what it gives on the other:
    what is left is never a gain."""
    wheel = rig("lunar_nominal", cell=0.025)
    wheel.soils[:, SoilColumn.COHESION] = wheel.soils[:, SoilColumn.TAN_PHI] = 0.0
    wheel.soils[:, SoilColumn.CONTACT_DAMPING] = 0.0
    with_rut(wheel, depth, 0.5, 0.5 + length)
    path = roll(wheel, 0.0, 1.5, 0.015, speed=0.25, slip=0.0)
    power, x = path[:, 3], path[:, 0]
    work = float(power.sum() * wheel.dt)
    undisturbed = power[(x > 0.2) & (x < 0.35)].mean() * 1.5 / 0.25
    assert 0.0 < work < undisturbed
    # the edges alone, over the level parts' own resistance, are nearly in balance
    given = float(np.minimum(power, 0.0).sum() * wheel.dt)
    assert -given < float(np.maximum(power, 0.0).sum() * wheel.dt)


@pytest.mark.parametrize("depth", [0.0005, 0.002, 0.006])
@pytest.mark.parametrize("slip", [-0.9, -0.3, 0.0, 0.3, 0.9])
def test_steady_rolling_in_a_rut_never_takes_energy_from_the_ground(rig: Maker, slip: float, depth: float) -> None:
    wheel = rig("lunar_nominal", cell=0.025)
    with_rut(wheel, 0.012, -1.0, 2.0)
    centre_depth = 0.012 + depth
    forward = 0.3
    spin = forward / RADIUS * (1.0 + slip if slip < 0.0 else 1.0 / (1.0 - slip))
    for x in np.arange(0.0, 0.6, forward * wheel.dt):
        velocity, angular = np.array([forward, 0.0, 0.0]), np.array([0.0, spin, 0.0])
        force, moment = wheel.push(np.array([x, 0.0, RADIUS - centre_depth]), LEVEL, velocity, angular)
    assert wheel.report[0, 3] == pytest.approx(depth, rel=1e-6)
    assert -force @ velocity - moment @ angular > 0.0


def test_soil_in_a_rut_springs_back_behind_the_wheel(rig: Maker) -> None:
    virgin = rig("lunar_nominal").soils[0]
    row = rig("lunar_nominal").row
    exits = []
    for rut in (1e-9, 0.003, 0.012):
        soil, past = virgin.copy(), np.zeros(PAST_COLUMNS)
        past[PAST_RUT], past[GREATEST] = rut, rut + 0.0016
        settle_soil(row, 0.0016, soil, past)
        exits.append(soil[SoilColumn.EXIT_LAMBDA])
    assert exits[0] == pytest.approx(0.0, abs=1e-5)  # as on virgin soil, whose contact ends under the axle
    assert exits[0] < exits[1] < exits[2] <= 1.0
    stiffness = virgin[SoilColumn.UNLOADING_STIFFNESS_PER_SINKAGE] * 0.0136
    rebound = (1400.0 / 0.16 + 820.0e3) * 0.0136 / stiffness
    assert exits[2] == pytest.approx(min(rebound / 0.0016, 1.0) * 0.012 / 0.0136, rel=1e-9)


motions = st.tuples(
    st.floats(-0.3, 0.3), st.floats(-0.3, 0.3), st.floats(-0.05, 0.1), st.floats(-3.0, 3.0), st.floats(-3.0, 3.0),
    st.floats(-30.0, 30.0), st.floats(-0.6, 0.6),
)  # fmt: skip


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.lists(motions, min_size=2, max_size=12))
def test_finite_on_any_ground_that_wheels_have_torn_up(rig: Maker, path: list[tuple[float, ...]]) -> None:
    wheel = rig("lunar_nominal", cell=0.025)
    for x, y, depth, along, aside, spin, yaw in path:
        c, s = math.cos(yaw), math.sin(yaw)
        rotation = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        for step in range(40):
            centre = np.array([x + 0.002 * step * along, y + 0.002 * step * aside, RADIUS - depth])
            force, moment = wheel.push(centre, rotation, np.array([along, aside, 0.0]), rotation @ [0.0, spin, 0.0])
            assert np.isfinite(force).all() and np.isfinite(moment).all() and np.isfinite(wheel.state).all()
    for tile in wheel.memory.store().tiles.values():
        assert np.isfinite(tile).all() and (tile[..., RUT] <= tile[..., SINKAGE]).all()
        assert (tile[..., :DUG] >= 0.0).all() and (tile[..., DUG] <= 0.0).all()  # banks beside, nothing dug


def test_a_wheel_that_comes_down_on_the_edge_of_a_rut_is_pressed_up_gently(rig: Maker) -> None:
    """The tilted plane through a steep edge reaches above the ground as it was: a wheel that bounced there met more
    than a centimetre of soil at once, four times its load, and the chassis chattered within the control period."""
    wheel = rig("lunar_nominal", cell=0.025)
    with_rut(wheel, 0.012, -1.0, 0.5)
    pressed = []
    for depth in np.arange(-0.001, 0.002, 2e-5):
        wheel.state[:] = 0.0
        force, _ = wheel.push(np.array([0.51, 0.0, RADIUS - depth]), LEVEL, np.zeros(3), np.zeros(3))
        assert wheel.report[0, 3] <= max(depth, 0.0) + 1e-12
        pressed.append(force[2])
    assert pressed[0] == 0.0 and pressed[-1] > 1.0
    assert np.abs(np.diff(pressed)).max() < 2.0, "newton in a fiftieth of a millimetre"


def test_rock_keeps_no_rut(rig: Maker) -> None:
    wheel = rig("rigid_rock", cell=0.025)
    roll(wheel, 0.0, 0.5, 0.0005)
    assert not wheel.memory.store().tiles
