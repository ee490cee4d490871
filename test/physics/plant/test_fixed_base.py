"""A machine whose base stands fast: the foundation takes any load, and the arm moves as on a base without freedom."""

import math
from dataclasses import replace
from functools import lru_cache

import numpy as np
import pinocchio as pin
import pytest
from scipy.integrate import solve_ivp

from sojourn_config.scenario import LoadedScenario, load_scenario
from sojourn_machine.params import FloatArray
from sojourn_physics.plant.model import PlantModel, Site
from sojourn_physics.plant.params import SimulationParams
from sojourn_physics.plant.state import PlantState, zeros_command
from sojourn_physics.plant.step import initial_state, step
from sojourn_plant.start import build_plant


@lru_cache
def puma(slope_deg: float = 0.0) -> LoadedScenario:
    ground = ["terrain.kind=slope", f"terrain.slope_deg={slope_deg}"] if slope_deg else []
    return load_scenario("puma560_course", ground)


def run(model: PlantModel, state: PlantState, seconds: float) -> PlantState:
    command = zeros_command(len(model.joints.names), len(model.loads))
    command.reference[0] = state.motor_angles
    for _ in range(round(seconds / model.simulation.control_period)):
        state, _ = step(model, state, command)
    return state


def falling_arm(physics_step: float) -> tuple[PlantModel, PlantState]:
    """The arm without motors and friction, let go from its pose."""
    scenario = puma()
    free = {"drives": (), "passive_joint": scenario.machine.passive_joint}
    site = Site(scenario.height_field(), list(scenario.soils.values()), scenario.gravity_field)
    model = PlantModel(
        scenario.urdf_xml, scenario.machine.model_copy(update=free), site, scenario.power,
        SimulationParams(physics_step=physics_step, settle_time=0.0),
    )  # fmt: skip
    return model, initial_state(model, 0.0, 0.0, 0.3, 0.8, scenario.arm_pose("unfold"))


def test_a_falling_arm_moves_as_one_whose_base_has_no_freedom() -> None:
    # Pinocchio's articulated-body algorithm on the fixed model, by an adaptive Runge-Kutta method
    fixed = pin.buildModelFromXML(puma().urdf_xml)
    fixed.gravity.linear = np.array([0.0, 0.0, -puma().gravity])
    data, count = fixed.createData(), fixed.nv
    start = np.array(list(puma().arm_pose("unfold").values()))

    def rates(_time: float, both: FloatArray) -> FloatArray:
        return np.concatenate([both[count:], pin.aba(fixed, data, both[:count], both[count:], np.zeros(count))])

    end = solve_ivp(rates, (0.0, 0.2), np.concatenate([start, np.zeros(count)]), rtol=1e-9, atol=1e-10).y[:count, -1]
    assert np.abs(end - start).max() > 0.25
    errors = []
    for physics_step in (2e-4, 1e-4):
        model, state = falling_arm(physics_step)
        errors.append(np.abs(run(model, state, 0.2).joints[0] - end).max())
    assert errors[1] < 2e-3
    assert errors[1] == pytest.approx(0.5 * errors[0], rel=0.1)  # the plant's method is of first order


def test_the_base_stays_where_it_stands_whatever_the_arm_does() -> None:
    model, state = falling_arm(1e-3)
    after = run(model, state, 1.0)
    assert np.abs(after.velocity[6:]).max() > 0.5
    np.testing.assert_allclose(after.configuration[:7], state.configuration[:7], atol=1e-12)
    assert np.abs(after.velocity[:6]).max() < 1e-12


def test_it_stands_square_on_a_slope_and_where_it_was_asked_for() -> None:
    model, state = build_plant(puma(10.0))
    up = pin.Quaternion(state.configuration[3:7]).toRotationMatrix()[:, 2]
    assert math.degrees(math.acos(up[2])) == pytest.approx(10.0, abs=1e-6)
    np.testing.assert_allclose(state.configuration[:2], 0.0, atol=1e-9)
    assert state.configuration[2] == pytest.approx(model.terrain.height(0.0, 0.0), abs=1e-12)
    assert not model.supports.names and model.wheel_names == ()


def test_its_energy_account_is_balanced_while_motors_move_it() -> None:
    model, state = build_plant(puma())
    command = zeros_command(len(model.joints.names), len(model.loads))
    command.reference[0] = state.motor_angles
    rates = np.array([0.3, -0.2, 0.3, 0.5, -0.5, 0.5])
    first, now = state, state
    for period in range(100):
        told = replace(command, reference=command.reference.copy())
        told.reference[0] += rates * min(period, 60) * model.simulation.control_period
        told.reference[1] = rates * (period < 60)
        now, _ = step(model, now, told)
    assert np.abs(now.joints[0] - first.joints[0]).min() > 0.15
    assert now.energy.balance_error(first.energy) < 2e-3


def test_without_weight_a_resting_arm_costs_no_torque() -> None:
    model, state = build_plant(load_scenario("puma560_course", ["body=low_earth_orbit"]))
    _, output = step(model, state, replace(zeros_command(6, len(model.loads)), reference=np.vstack(
        [state.motor_angles, np.zeros((2, 6))]
    )))  # fmt: skip
    assert model.gravity == 0.0
    assert np.abs(output.efforts).max() < 1e-9
