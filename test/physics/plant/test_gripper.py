"""A gripper alone: the force that it needs by two routes, what it takes, and what slips from it."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_flight.arm.grasp import Finger, needed_force
from sojourn_machine.errors import MachineError
from sojourn_machine.params import FloatArray
from sojourn_machine.tools import GripperToolParams, ObjectParams
from sojourn_physics.plant.tools.gripper import Gripper, needed_grasp
from sojourn_physics.plant.tools.tool_state import ToolState, ToolSurroundings
from sojourn_physics.terrain.height_field import HeightField
from sojourn_physics.terrain.memory import GroundMemory, MemoryBoard

GROUND = HeightField(np.zeros((21, 21)), np.zeros((21, 21), np.uint8), 0.5, -5.0, -5.0, ("soil",))
PARAMS = GripperToolParams(
    kind="gripper", pad="tip", load="arm", radius=0.015, stroke=0.08, speed=0.03, force=60.0, stiffness=2e4,
    finger_length=0.04, power=4.0, load_distance=0.015,
)  # fmt: skip
TUBE = ObjectParams(name="tube", x=1.0, y=0.5, mass=0.5, width=0.03, height=0.03, friction=0.4)
MARS = 3.71
DT = 0.02


def around(tip: FloatArray, opening: float, force: float, supply: float = 1.0) -> ToolSurroundings:
    report = np.zeros(16)
    report[:3] = tip
    return ToolSurroundings(
        board=MemoryBoard(GroundMemory(0.02, -5.0, -5.0)), terrain=GROUND, grid=GROUND.grid, soils=np.zeros((1, 40)),
        gravity=MARS, falling=np.array([0.0, 0.0, -MARS]), dt=DT,
        reference=np.array([opening, 0.0, force]), supply=supply, report=report, drag=np.zeros(2),
        axis=np.array([0.0, 0.0, -1.0]), across=np.array([0.0, 1.0, 0.0]), voltage=28.0,
    )  # fmt: skip


def go(law: Gripper, state: ToolState, tip: FloatArray, opening: float, force: float, seconds: float) -> ToolState:
    for _ in range(round(seconds / DT)):
        state, _ = law.advance(state, around(tip, opening, force))
    return state


def raised(law: Gripper, state: ToolState, tip: FloatArray, height: float, force: float) -> ToolState:
    """Lifted gently, 1 mm a period."""
    for k in range(1, round(height / 0.001) + 1):
        state, _ = law.advance(state, around(tip + np.array([0.0, 0.0, 0.001 * k]), 0.0, force))
    return state


def grasped(force: float, tip: FloatArray | None = None) -> tuple[Gripper, ToolState, FloatArray]:
    law = Gripper(PARAMS, [TUBE], GROUND)
    at = np.array([1.0, 0.5, 0.0]) if tip is None else tip
    state = go(law, law.first(), at, PARAMS.stroke, 0.0, 4.0)
    return law, go(law, state, at, 0.0, force, 4.0), at


@settings(max_examples=60, deadline=None)
@given(st.lists(st.floats(-20.0, 20.0), min_size=3, max_size=3), st.floats(0.1, 1.5))
def test_force_that_a_load_needs_is_that_of_the_grasp(load: list[float], friction: float) -> None:
    """Against the linear programme of `arm.grasp`, whose pyramid lies inside the round cone."""
    force = np.array(load)
    found = needed_grasp(force, np.array([0.0, 1.0, 0.0]), friction)
    fingers = [
        Finger(np.array([0.0, side * 0.02, 0.0]), np.array([0.0, -side, 0.0]), friction, torsion=0.002)
        for side in (1.0, -1.0)
    ]
    by_cone = needed_force(fingers, np.zeros(3), np.concatenate([force, np.zeros(3)]))
    assert found <= by_cone * (1.0 + 1e-6) + 1e-9
    assert by_cone <= found / math.cos(math.pi / 32) + 1e-6


def test_it_takes_what_is_between_its_fingers() -> None:
    law, state, tip = grasped(20.0)
    own = state.own
    assert own.held == 0 and own.grasp == pytest.approx(20.0) and state.effort == own.grasp
    assert state.position == TUBE.width and state.payload == TUBE.mass
    lifted = raised(law, state, tip, 0.2, 20.0)
    assert lifted.own.held == 0 and lifted.own.needed == pytest.approx(0.5 * 0.5 * MARS / 0.4)
    opened = go(law, lifted, tip + np.array([0.1, 0.0, 0.2]), PARAMS.stroke, 0.0, 3.0)
    assert opened.own.held is None and opened.payload == 0.0 and opened.own.slips == 0
    assert opened.own.places[0] == pytest.approx((1.1, 0.5, 0.015))


@pytest.mark.parametrize("tip", [(1.0, 0.53, 0.0), (1.0, 0.5, 0.05), (1.0, 0.5, -0.04)])
def test_what_is_not_there_it_does_not_take(tip: tuple[float, float, float]) -> None:
    _, state, _ = grasped(20.0, np.array(tip))
    assert state.own.held is None and state.position == 0.0 and state.payload == 0.0


@settings(max_examples=12, deadline=None)
@given(st.floats(0.5, 10.0))
def test_it_slips_exactly_where_friction_does_not_carry_it(force: float) -> None:
    law, state, tip = grasped(force)
    assert state.own.held == 0, "on the ground it is held with any force"
    needed = 0.5 * TUBE.mass * MARS / TUBE.friction
    start = 1.0 + 0.001 / DT**2 / MARS  # the first step of the lift is an acceleration
    state = raised(law, state, tip, 0.1, force)
    assert state.own.held == (0 if force >= start * needed else None) or needed < force < start * needed


def test_it_slips_when_it_is_jerked() -> None:
    law, state, tip = grasped(4.0)
    state = raised(law, state, tip, 0.059, 4.0)
    assert state.own.held == 0
    most = 4.0 / 0.5 * 0.4 / TUBE.mass - MARS  # upward acceleration that it holds
    for factor, stays in ((0.9, True), (1.1, False)):
        after, place = state, tip + np.array([0.0, 0.0, 0.059])
        for k in (1, 2, 3):
            rise = 0.001 * k + 0.5 * factor * most * (k - 1) * k * DT**2
            after, _ = law.advance(after, around(place + np.array([0.0, 0.0, rise]), 0.0, 4.0))
        assert (after.own.held == 0) == stays


def test_without_power_nothing_moves_and_an_object_beside_the_ground_is_refused() -> None:
    law = Gripper(PARAMS, [TUBE], GROUND)
    state, energy = law.advance(law.first(), around(np.zeros(3), 0.08, 0.0, supply=0.0))
    assert state.position == 0.0 and energy.electrical == 0.0
    with pytest.raises(MachineError, match="50"):
        Gripper(PARAMS, [TUBE.model_copy(update={"x": 50.0})], GROUND)
