"""Soil that is sheared to and fro: Masing's branches, the energy that a loop takes, and what must not change."""

import math
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_machine.params import FloatArray
from sojourn_physics.contact.contact_law import STATE_COLUMNS, StateColumn
from sojourn_physics.contact.hysteresis import EXPONENT, ON_BACKBONE, STIFFNESS, YIELD, effective_shear
from sojourn_physics.contact.rigid_rim import RigidRim, RimContact
from sojourn_physics.contact.rigid_wheel_on_soil import contact_length
from sojourn_physics.contact.wheel_on_soil import QUADRATURE, wheel_forces

Maker = Callable[..., Any]
SOIL_LAWS = [
    "rigid_wheel_on_soil",
    "compliant_wheel_on_soil",
    "track",
    "foot_pad",
]


def backbone(x: float) -> float:
    return float(np.sum(STIFFNESS * np.minimum(x, YIELD)))


def follow(path: FloatArray) -> FloatArray:
    """Effective shear along a path of displacements, (n, 3) -> (n, 3), from untouched soil."""
    state = np.zeros(STATE_COLUMNS)
    before, found = np.zeros(3), []
    for place in path:
        found.append(effective_shear(*(place - before), 1.0, float(np.linalg.norm(place)), state))
        before = place
    return np.array(found)


def line(*corners: float, step: float = 1e-5) -> FloatArray:
    """Displacements along x through these corners."""
    pieces = [
        np.linspace(a, b, round(abs(b - a) / step) + 1)[1:] for a, b in zip((0.0, *corners), corners, strict=False)
    ]
    x = np.concatenate(pieces)
    return np.stack([x, np.zeros_like(x), np.zeros_like(x)], axis=1)


def damping_ratio(one: Any, amplitude: float, frequency: float, axis: str = "v_along") -> float:
    """Energy lost in the third loop over 4 π that at its end, of a contact that is not turning."""
    count = round(1.0 / frequency / one.dt)
    name = "force_x" if axis == "v_along" else "force_y"
    for _ in range(3):
        work, forces = 0.0, []
        for k in range(count):
            speed = amplitude * 2.0 * math.pi * frequency * math.cos(2.0 * math.pi * (k + 0.5) / count)
            force = one.step(penetration=0.01, **{axis: speed})[name]
            work -= force * speed * one.dt
            forces.append(force)
    return float(work / (math.pi * (max(forces) - min(forces)) * amplitude))


def test_soil_sheared_one_way_follows_the_displacement() -> None:
    path = np.cumsum(np.full((200, 3), [1e-4, -2e-4, 5e-5]), axis=0)
    assert np.allclose(follow(path), path, rtol=1e-9)


def test_a_branch_is_twice_the_backbone() -> None:
    """Masing 1926, from the first turn and from a turn inside that loop; the outer one is found again."""
    largest, inner = 0.01, 0.002
    path = line(largest, -inner, 0.0, -inner, -largest)
    x, e = path[:, 0], follow(path)[:, 0]
    turns = [int(np.flatnonzero(np.isclose(x, largest))[0])]
    for k in range(turns[0], len(x) - 1):
        moved = (largest - x[k]) / (2.0 * largest)
        if k < turns[0] + 1200 or x[k] < -inner - 1e-9:  # before the inner loop, and after it
            assert e[k] == pytest.approx(largest - 2.0 * largest * backbone(moved), abs=1e-9)
    back = turns[0] + 1200
    for k in range(back, back + 200):
        moved = (x[k] + inner) / (2.0 * largest)
        assert e[k] == pytest.approx(e[back] + 2.0 * largest * backbone(moved), abs=1e-9)


def test_damping_ratio_of_the_sliders_in_closed_form() -> None:
    """(2/π)(2 ∫ B/(x B) - 1) of Masing's loops, and the power law's (2/π)(1 - β)/(1 + β) between the sliders."""
    amplitude = 0.008
    path = line(amplitude, -amplitude, amplitude, step=5e-6)
    e, x = follow(path)[:, 0], path[:, 0]
    first = int(np.argmax(x))
    area = np.trapezoid(e[first:], x[first:])
    steps = np.linspace(0.0, 1.0, 20001)
    wanted = 2.0 / math.pi * (2.0 * np.trapezoid([backbone(s) for s in steps], steps) - 1.0)
    assert area / (2.0 * math.pi * amplitude**2) == pytest.approx(wanted, rel=1e-3)
    assert wanted == pytest.approx(2.0 / math.pi * (1.0 - EXPONENT) / (1.0 + EXPONENT), abs=0.03)


@settings(max_examples=60, deadline=None)
@given(
    corners=st.lists(st.tuples(st.floats(-0.01, 0.01), st.floats(-0.01, 0.01), st.floats(-0.01, 0.01)), max_size=8),
    start=st.tuples(st.floats(-0.01, 0.01), st.floats(-0.01, 0.01), st.floats(-0.01, 0.01)),
)
def test_sliders_never_give_energy(corners: list[tuple[float, ...]], start: tuple[float, ...]) -> None:
    """From untouched soil the work is never negative, nor is that of a closed loop less than what was stored."""
    places = [np.zeros(3), *(np.array(corner) for corner in (start, *corners, start))]
    path = np.concatenate([np.linspace(a, b, 60)[1:] for a, b in pairwise(places)])
    e = follow(path)
    steps = np.diff(path, axis=0, prepend=0.0)
    work = np.cumsum(np.sum(e * steps, axis=1))
    assert work.min() >= -1e-15
    assert np.all(np.linalg.norm(e, axis=1) <= np.maximum.accumulate(np.linalg.norm(path, axis=1)) * (1.0 + 1e-9))


@pytest.mark.parametrize("model", SOIL_LAWS, ids=SOIL_LAWS)
@pytest.mark.parametrize("axis", ["v_along", "v_side"])
@pytest.mark.parametrize("amplitude", [2e-4, 1e-3, 3e-3, 1e-2])
def test_damping_ratio_of_soil(law: Maker, model: str, axis: str, amplitude: float) -> None:
    """0.15 to 0.30 (Seed & Idriss 1970: sand, 0.2 to 0.25), slowly, so that it is the soil's and not a damper's."""
    assert 0.15 <= damping_ratio(law(model, "lunar_nominal", dt=0.004), amplitude, 0.2, axis) <= 0.30


@pytest.mark.parametrize("amplitude", [2e-4, 1e-3, 3e-3, 1e-2])
def test_damping_ratio_at_the_swing_of_a_rover(law: Maker, amplitude: float) -> None:
    """A wheel that has rolled and stands, at 1.15 Hz."""
    one = law("rigid_wheel_on_soil", "lunar_nominal")
    one.step(4000, penetration=0.01, v_along=0.1, rim_speed=0.102)
    assert 0.15 <= damping_ratio(one, amplitude, 1.15) <= 0.31


@pytest.mark.parametrize("model", SOIL_LAWS, ids=SOIL_LAWS)
@settings(max_examples=25, deadline=None)
@given(
    corners=st.lists(st.tuples(st.floats(-0.01, 0.01), st.floats(-0.01, 0.01)), min_size=1, max_size=5),
    speed=st.floats(0.002, 0.1),
)
def test_no_closed_path_takes_energy_from_soil(
    law: Maker, model: str, corners: list[tuple[float, float]], speed: float
) -> None:
    """A contact that is dragged over the ground from place to place and home again."""
    one = law(model, "lunar_nominal", dt=0.002)
    places = [np.zeros(2), *(np.array(corner) for corner in corners), np.zeros(2)]
    work = moved = 0.0
    for a, b in pairwise(places):
        count = max(round(float(np.linalg.norm(b - a)) / speed / one.dt), 1)
        velocity = (b - a) / (count * one.dt)
        for _ in range(count):
            power = one.step(penetration=0.01, v_along=velocity[0], v_side=velocity[1])["power"]
            work += power * one.dt
            moved += abs(power) * one.dt
    assert work >= -1e-6 * moved - 1e-12


@pytest.mark.parametrize(("slip", "side"), [(0.05, 0.0), (0.3, 0.05), (-0.2, 0.0), (0.8, -0.1)])
def test_steady_rolling_is_that_of_wong_and_reece(law: Maker, slip: float, side: float) -> None:
    one = law("rigid_wheel_on_soil", "lunar_nominal")
    v = 0.1
    rim = v / (1.0 - slip) if slip > 0.0 else v * (1.0 + slip)
    found = one.step(20000, penetration=0.01, v_along=v, v_side=-side * max(v, rim), rim_speed=rim)
    wheel = one.wheel
    length = contact_length(wheel[0], 0.01, one.soil, 1.0)
    transport = max(rim, math.hypot(v, side * max(v, rim)))
    assert one.state[StateColumn.SHEAR_ALONG] == pytest.approx(length * (rim - v) / transport, rel=1e-6)
    shape = RigidRim(wheel[0], wheel[1], wheel[2], wheel[4], 0.0)
    contact = RimContact(0.01, (rim - v) / transport, side * max(v, rim) / transport, 1.0)
    wanted = wheel_forces(shape, wheel[5], contact, one.soil, QUADRATURE)
    lead = 1e-3 * abs(wanted[0]) + 1e-3 * wanted[2]  # what is left of it at this speed
    assert found["force_x"] == pytest.approx(wanted[0], abs=lead)
    assert found["torque"] == pytest.approx(wanted[3], abs=lead)


def test_on_the_backbone_every_small_change_is_a_first_loading() -> None:
    """As a tangent needs it: de = du in any direction, about any e, and nothing slips."""
    state = np.zeros(STATE_COLUMNS)
    effective_shear(2e-3, -1e-3, 0.0, 1.0, math.hypot(2e-3, 1e-3), state)
    effective_shear(-1.5e-3, 0.0, 0.0, 1.0, math.hypot(0.5e-3, 1e-3), state)
    held = np.array(effective_shear(0.0, 0.0, 0.0, 1.0, math.hypot(0.5e-3, 1e-3), state))
    state[StateColumn.LARGEST_SHEAR] = ON_BACKBONE
    for moved in ((1e-6, 0.0), (-1e-6, 0.0), (0.0, 2e-6), (-3e-4, 5e-4)):
        branch = state.copy()
        now = np.array(effective_shear(*moved, 0.0, 1.0, 1e-3, branch))
        assert now - held == pytest.approx(np.array([*moved, 0.0]), rel=1e-9, abs=1e-15)
        assert branch[StateColumn.LARGEST_SHEAR] == ON_BACKBONE
