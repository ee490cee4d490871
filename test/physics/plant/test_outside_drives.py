"""Drives whose law is their own, beside motors, gears and servos: their torque, their power, their energy."""

from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sprung_drive import SprungDrive, SprungDriveParams

from sojourn_config.scenario import load_scenario
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.machine import MachineParams
from sojourn_physics.actuators.actuator import JointMotion, JointOrder, Push
from sojourn_physics.actuators.joint_drive import ANGLE
from sojourn_physics.faults.acting import ActingFault, FaultyPlant
from sojourn_physics.faults.joint_seized import JointSeized
from sojourn_physics.plant.model import PlantModel, Site
from sojourn_physics.plant.state import PlantCommand, PlantState, zeros_command
from sojourn_physics.plant.step import initial_state, step

FRONT = ("wheel_front_left_joint", "wheel_front_right_joint")
SPRUNG = SprungDriveParams(
    kind="sprung_drive", joints=FRONT, load="drive", stiffness=200.0, damping=8.0, max_torque=18.0
)


@lru_cache
def plant(params: type[SprungDriveParams] = SprungDriveParams) -> tuple[PlantModel, PlantState]:
    """The skid rover on flat ground with drives of another kind on its front wheels, at rest."""
    scenario = load_scenario("flat_drive", ("machine=skid",))
    geared = scenario.machine.drives[0]
    rear = geared.model_copy(update={"joints": tuple(joint for joint in geared.joints if joint not in FRONT)})
    machine: MachineParams = scenario.machine.model_copy(
        update={"drives": (params.model_validate(SPRUNG.model_dump()), rear)}
    )
    site = Site(scenario.height_field(), list(scenario.soils.values()), scenario.gravity_field)
    model = PlantModel(scenario.urdf_xml, machine, site, scenario.power, scenario.simulation)
    return model, initial_state(model, 0.0, 0.0, 0.0, 0.8)


def driven(model: PlantModel, rate: float, front: float = 1.0) -> PlantCommand:
    """All wheels at a rate [rad/s], the front ones with a part of their current."""
    command, rows = zeros_command(len(model.joints.names), len(model.loads)), model.reference_rows(FRONT)
    command.reference[1, model.reference_rows([wheel.joint for wheel in model.machine.wheels])] = rate
    health = np.ones(len(model.joints.names))
    health[rows] = front
    return replace(command, motor_health=health)


def test_a_joint_of_theirs_that_seizes_is_held_by_more_than_its_largest_effort() -> None:
    """It was held by nothing: only what our own drives are limited to was looked at."""
    model, state = plant()
    seized = JointSeized(kind="joint_seized", joint=FRONT[0])
    with_fault = FaultyPlant(model).model((ActingFault(seized, "seized"),))
    stuck, free = (model.joint_index[joint] for joint in FRONT)
    for _ in range(50):
        state, _ = step(with_fault, state, driven(model, 1.0))
    assert abs(state.joints[ANGLE, stuck]) < 2e-3 < 0.1 < abs(state.joints[ANGLE, free])


@settings(max_examples=15)
@given(first=st.floats(0.5, 3.0), then=st.lists(st.floats(-3.0, 3.0), max_size=2), off=st.booleans())
def test_what_they_take_is_work_heat_and_what_they_store(first: float, then: list[float], off: bool) -> None:
    model, state = plant()
    start = state.energy
    for rate in (first, *then):
        for _ in range(15):
            state, _ = step(model, state, driven(model, rate, 0.0 if off else 1.0))
    assert state.energy.balance_error(start) < 2e-3


def test_they_turn_their_wheels_as_told_and_draw_from_their_load() -> None:
    model, state = plant()
    rows, load = model.reference_rows(FRONT), [one.name for one in model.loads].index("drive")
    for _ in range(150):
        state, output = step(model, state, driven(model, 1.0))
    columns = model.joints.columns[rows]
    assert state.velocity[columns] == pytest.approx(1.0, abs=0.05)
    twists = np.array([twist for twist, _ in state.outside])
    assert output.efforts[rows] == pytest.approx(200.0 * twists, abs=0.5)
    assert output.currents[rows] == pytest.approx(output.efforts[rows] / 10.0, abs=0.05)
    geared, _ = step(model, state, driven(model, 1.0))
    hung_up, idle = step(model, state, driven(model, 1.0, 0.0))
    assert output.power.load_power[load] > idle.power.load_power[load] > 0.0
    assert geared.energy.electrical > hung_up.energy.electrical


def test_without_current_they_hold_their_wheels() -> None:
    model, state = plant()
    for _ in range(50):
        state, _ = step(model, state, driven(model, 0.0, 0.0))
    assert np.abs(state.velocity[model.joints.columns[model.reference_rows(FRONT)]]).max() < 1e-4


def test_a_branch_of_their_state_goes_its_own_way_and_back() -> None:
    model, start = plant()
    kept = start.outside
    ahead, _ = step(model, start, driven(model, 2.0))
    astern, _ = step(model, start, driven(model, -2.0))
    assert start.outside == kept and ahead.outside != astern.outside
    again, _ = step(model, start, driven(model, 2.0))
    assert again.outside == ahead.outside
    assert np.array_equal(again.velocity, ahead.velocity)


class Broken(SprungDrive):
    """Says a torque that is no number once it is told to move."""

    def push(self, state: tuple[float, float], told: JointOrder, joint: JointMotion, dt: float) -> Push:
        return Push(float("nan")) if told.rate else super().push(state, told, joint, dt)


class BrokenParams(SprungDriveParams):
    def actuator(self, joint: str) -> Any:
        return Broken(self)


def test_a_torque_that_is_no_number_is_refused_with_the_name_of_the_joint() -> None:
    model, state = plant(BrokenParams)
    with pytest.raises(InvalidValueError, match="wheel_front_left_joint"):
        step(model, state, driven(model, 1.0))
