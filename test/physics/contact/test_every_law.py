"""What every contact law promises: finite, dissipative, continuous through zero speed, at rest for ever."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_analysis.wheels.examples import LAWS
from sojourn_machine.contact_choice import CONTACT_LAWS, FOOT_LAWS
from sojourn_machine.errors import InvalidValueError
from sojourn_physics.contact.contact_law import STATE_COLUMNS, StateColumn, WheelColumn
from sojourn_physics.contact.law_call import row_entry

Maker = Callable[..., Any]
GROUNDS = ["lunar_nominal", "rigid_rock", "snow", "lean_clay", "ding_2011"]
WITHOUT_RIM = ("foot_pad",)
MOMENT_OF_SOIL_ALONE = ("rigid_wheel_on_soil",)
"""Laws whose moment about the normal knows nothing of a yaw rate."""
every_law = pytest.mark.parametrize("model", LAWS, ids=LAWS)
anything = st.floats(-1e3, 1e3)
FORCES = ("force_x", "force_y", "force_z", "moment_x", "moment_y", "moment_z", "torque")


def soft(ground: str, depth: float) -> float:
    """A penetration that suits the ground: rock is not pressed in by centimetres."""
    return depth * {"rigid_rock": 0.05, "lean_clay": 0.1}.get(ground, 1.0)


@every_law
@settings(max_examples=80, deadline=None)
@given(
    ground=st.sampled_from(GROUNDS),
    penetration=st.floats(1e-12, 5.0),
    along=anything,
    side=anything,
    normal=anything,
    rim=anything,
    yaw=anything,
    roll=anything,
    camber=st.floats(-0.999, 0.999),
    step=st.floats(1e-5, 5e-3),
    remembered=st.lists(st.floats(-1.0, 1.0), min_size=STATE_COLUMNS, max_size=STATE_COLUMNS),
)
def test_finite_for_every_finite_input(
    law: Maker, model: str, ground: str, penetration: float, along: float, side: float, normal: float,
    rim: float, yaw: float, roll: float, camber: float, step: float, remembered: list[float],
) -> None:  # fmt: skip
    one = law(model, ground, dt=step)
    one.state[:] = remembered
    for _ in range(3):
        found = one.step(
            penetration=penetration, v_along=along, v_side=side, v_normal=normal, rim_speed=rim, yaw_rate=yaw,
            roll_rate=roll, camber=camber,
        )  # fmt: skip
        assert all(math.isfinite(value) for value in found.values()), found
        assert np.isfinite(one.state).all()
        assert found["force_z"] >= 0.0
        assert abs(found["slip_ratio"]) <= 1.0 and abs(found["slip_angle"]) <= math.pi
        assert min(found[f"{kind}_resistance"] for kind in ("rolling", "compaction", "bulldozing")) >= 0.0


@every_law
@settings(max_examples=25, deadline=None)
@given(
    ground=st.sampled_from(GROUNDS),
    along=st.floats(-2.0, 2.0),
    side=st.floats(-1.0, 1.0),
    rim=st.floats(-2.0, 2.0),
    yaw=st.floats(-1.0, 1.0),
    camber=st.floats(-0.4, 0.4),
    depth=st.floats(0.001, 0.03),
)
def test_steady_motion_never_takes_energy_from_the_ground(
    law: Maker, model: str, ground: str, along: float, side: float, rim: float, yaw: float, camber: float,
    depth: float,
) -> None:  # fmt: skip
    if max(abs(along), abs(side), abs(rim)) < 0.05:
        return  # steady only after many seconds
    one = law(model, ground, dt=0.004)
    if model in WITHOUT_RIM:
        rim = 0.0
    if model in MOMENT_OF_SOIL_ALONE:
        yaw = 0.0
    motion = {"penetration": soft(ground, depth), "v_along": along, "v_side": side, "rim_speed": rim}
    found = one.step(2500, **motion, yaw_rate=yaw, camber=camber)
    flow = found["force_z"] * max(abs(along), abs(side), abs(rim))
    assert found["power"] >= -1e-6 * flow, (found, one.state)


@every_law
@pytest.mark.parametrize("ground", GROUNDS)
def test_continuous_through_zero_speed(law: Maker, model: str, ground: str) -> None:
    """A contact with a past, at a speed of a nanometre a second this way or that, and at rest."""
    results = []
    for speed in (-1e-9, 0.0, 1e-9):
        one = law(model, ground)
        one.state[: StateColumn.TRAVEL + 1] = [2e-4, 1e-4, 0.0]
        found = one.step(
            penetration=soft(ground, 0.01), v_along=speed, v_side=-speed, v_normal=speed, rim_speed=2.0 * speed,
            yaw_rate=speed,
        )  # fmt: skip
        results.append(np.array([found[name] for name in FORCES]))
    scale = np.abs(results[1]).max()
    assert scale > 1.0
    assert np.abs(results[0] - results[1]).max() < 1e-5 * scale
    assert np.abs(results[2] - results[1]).max() < 1e-5 * scale


@every_law
@pytest.mark.parametrize("ground", ["lunar_nominal", "rigid_rock"])
def test_rest_is_a_fixed_point(law: Maker, model: str, ground: str) -> None:
    one = law(model, ground)
    depth = soft(ground, 0.01)
    one.step(40, penetration=depth, v_along=0.003, v_side=0.002, yaw_rate=0.01)
    first = one.step(penetration=depth)
    state = one.state.copy()
    later = one.step(5000, penetration=depth)
    # against the push
    assert first["force_y"] < -1e-3 * first["force_z"] or model == "roller_wheel"
    assert first["force_x"] < -1e-4 * first["force_z"]
    assert np.array_equal(one.state, state)
    assert first == later


@every_law
@settings(max_examples=30, deadline=None)
@given(
    ground=st.sampled_from(["lunar_nominal", "rigid_rock"]),
    depth=st.floats(1e-4, 0.05),
    along=st.floats(-1.0, 1.0),
    side=st.floats(-1.0, 1.0),
    rim=st.floats(-1.0, 1.0),
    factor=st.floats(1.001, 1.5),
)
def test_load_grows_with_the_penetration(
    law: Maker, model: str, ground: str, depth: float, along: float, side: float, rim: float, factor: float
) -> None:
    """In a contact that is pressed straight down; a driven wheel's stresses turn with its slip."""
    one = law(model, ground)
    shallow = one.step(penetration=depth)
    one.state[:] = 0.0
    deep = one.step(penetration=depth * factor)
    assert deep["force_z"] > shallow["force_z"] > 0.0


@every_law
@pytest.mark.parametrize("ground", ["lunar_nominal", "rigid_rock"])
@pytest.mark.parametrize("turning", [0.0, 0.9, 1.1])
@pytest.mark.parametrize("phase", [0.0, 1.5])
@pytest.mark.parametrize("amplitude", [2e-4, 0.02])
def test_rocking_to_and_fro_costs_work(
    law: Maker, model: str, ground: str, turning: float, phase: float, amplitude: float
) -> None:
    """Turning to and fro `turning` times as far as it travels, `phase` apart, and a little aside: in a whole
    swing no energy comes out, beyond what lies within the memory of the direction of travel."""
    one = law(model, ground, dt=0.004)
    rate, depth = 1.5, soft(ground, 0.01)
    period = round(2.0 * math.pi / rate / one.dt)
    turning = 0.0 if model in WITHOUT_RIM else turning
    for _ in range(2):
        work = moved = 0.0
        for k in range(period):
            angle = 2.0 * math.pi * (k + 0.5) / period
            speed = amplitude * rate * math.cos(angle)
            found = one.step(
                penetration=depth, v_along=speed, v_side=0.3 * speed,
                rim_speed=turning * amplitude * rate * math.cos(angle + phase),
            )  # fmt: skip
            work += found["power"] * one.dt
            moved += abs(found["power"]) * one.dt
    assert work >= -0.02 * moved


@every_law
def test_travel_reversed_is_mirrored(law: Maker, model: str) -> None:
    ahead, back = law(model, "lunar_nominal"), law(model, "lunar_nominal")
    if model == "roller_wheel":
        return  # its rollers have a hand
    rim = 0.0 if model in WITHOUT_RIM else 0.13
    here = ahead.step(800, penetration=0.01, v_along=0.1, v_side=0.02, rim_speed=rim)
    there = back.step(800, penetration=0.01, v_along=-0.1, v_side=0.02, rim_speed=-rim)
    for name in FORCES:
        sign = -1.0 if name in ("force_x", "torque", "moment_y", "moment_z") else 1.0
        assert there[name] == pytest.approx(sign * here[name], abs=1e-9 * here["force_z"]), name


def test_every_law_that_is_registered_has_an_example() -> None:
    assert {*CONTACT_LAWS.names(), *FOOT_LAWS.names()} <= set(LAWS)


def test_a_row_without_a_law_is_refused(law: Maker) -> None:
    one = law("brush", "rigid_rock")
    one.wheel[WheelColumn.LAW] = 0.0
    with pytest.raises(ValueError, match="without a contact law"):
        one.step(penetration=0.01)


def test_what_is_no_kernel_is_no_law() -> None:
    with pytest.raises(InvalidValueError, match="compiled by"):
        row_entry(lambda wheel, soil, motion, dt, state, out: None)
