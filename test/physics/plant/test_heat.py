"""The heat of a machine in its plant: its account, its thermostats, and the same as in a plan of its days."""

from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

from sojourn_config.expected_heat import site_heat
from sojourn_config.scenario import LoadedScenario, load_scenario
from sojourn_machine.evolution import replace
from sojourn_machine.params import FloatArray
from sojourn_physics.plant.light import light_for_power
from sojourn_physics.plant.state import PlantState, zeros_command
from sojourn_physics.plant.step import step
from sojourn_physics.plant.supply_kernels import HEAT, SWITCHED, in_base, with_period
from sojourn_plant.start import build_plant
from sojourn_studies.power_days import power_days

COLD_START = "thermal.nodes.box.temperature=262.0"
BRIEF = {"thermal.heaters.survival_heater.on_below": 262.05, "thermal.heaters.survival_heater.off_above": 262.16}


def night(*more: str) -> LoadedScenario:
    return load_scenario("lunar_night", [COLD_START, *(f"{key}={value}" for key, value in BRIEF.items()), *more])


SCENARIO = night()


@pytest.fixture(scope="module")
def stood() -> tuple[LoadedScenario, Any, list[PlantState]]:
    """Two minutes on the spot, all loads on."""
    scenario = night()
    model, state = build_plant(scenario)
    command = zeros_command(len(model.joints.names), len(model.loads))
    states = [state]
    for _ in range(6000):
        state, _ = step(model, state, command)
        states.append(state)
    return scenario, model, states


def temperatures(state: PlantState) -> FloatArray:
    assert state.heat is not None
    return state.heat.nodes.thermal.temperatures


def test_nodes_go_on_once_a_second(stood: tuple[LoadedScenario, Any, list[PlantState]]) -> None:
    _, _, states = stood
    changed = [k for k in range(1, 301) if (temperatures(states[k]) != temperatures(states[k - 1])).any()]
    assert changed == [50, 100, 150, 200, 250, 300]


def test_heat_is_what_the_loads_drew(stood: tuple[LoadedScenario, Any, list[PlantState]]) -> None:
    """The thermal account at the end: heaters by their thermostat, everything else by what it drew."""
    scenario, model, states = stood
    first, last = states[0].heat, states[-1].heat
    assert first is not None and last is not None and scenario.thermal is not None
    network = model.heat.machine.network
    gained = network.stored(last.nodes.thermal) - network.stored(first.nodes.thermal)
    account = last.nodes.thermal.account
    assert gained == pytest.approx(account.taken_in, rel=1e-6)
    assert account.radioisotope == pytest.approx(20.0 * 120.0, rel=1e-6)
    cells: Any = [states[0].power.stores[0], last.power.stores[0]]
    drawn = states[-1].power.energy.loads - states[0].power.energy.loads
    released = scenario.power.battery.heat_given(*cells)
    moved = sum(thermal_load(scenario, name) for name in ("computer", "receiver", "imu", "cameras")) * 120.0
    assert account.given >= 0.99 * moved + released and account.given + account.heaters <= drawn + released + 1.0


def thermal_load(scenario: LoadedScenario, name: str) -> float:
    return next((load.power_w for load in scenario.power.loads if load.name == name), 0.0)


def test_the_thermostat_switches_its_load(stood: tuple[LoadedScenario, Any, list[PlantState]]) -> None:
    """It calls at the start, and what the heater draws stops once its node is warm enough."""
    _, _, states = stood
    box = np.array([temperatures(state)[0] for state in states])
    duty = np.array([state.heat.nodes.duty[0] for state in states if state.heat is not None])
    assert duty[0] == 1.0 and 0.0 in duty
    off = int(np.flatnonzero(duty == 0.0)[0])
    assert box[off] == pytest.approx(262.16, abs=0.005)


def test_a_plan_of_its_days_says_the_same(stood: tuple[LoadedScenario, Any, list[PlantState]]) -> None:
    """Another way through the same equations, in steps of 5 s, under the law of the power manager."""
    scenario, _, states = stood
    planned = power_days(scenario, 120.0 / scenario.body.solar_day, 5.0)
    for place, name in enumerate(scenario.thermal.nodes if scenario.thermal else ()):
        assert planned.nodes[name][-1] == pytest.approx(temperatures(states[-1])[place], abs=0.05), name


@settings(max_examples=50, deadline=None)
@example([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.2e-313, 0.0, 0.0], 1.0)
@given(st.lists(st.floats(-5.0, 50.0), min_size=9, max_size=9), st.floats(0.0, 3.0))
def test_of_what_moves_the_machine_only_the_heat_of_its_motors_stays(energy: list[float], heat: float) -> None:
    """Shared among the loads of motors by what they turned over; the others' power is heat as it is."""
    moves = np.array([load.kind == "commanded" for load in SCENARIO.power.loads])
    moved, power = np.where(moves, np.array(energy), 0.0), np.arange(9.0)
    before, switches = np.ones((2, 9)), np.linspace(0.0, 1.0, 9)
    sums = with_period(before, power, switches, moves, moved, heat, 3, 0.02) - before
    assert sums[SWITCHED] == pytest.approx(3.0 * switches)
    warming = sums[HEAT]
    assert warming[~moves] == pytest.approx(0.06 * power[~moves]) and (warming >= 0.0).all()
    assert warming[moves].sum() == pytest.approx(heat if np.abs(moved).sum() > 0.0 else 0.0)


@settings(max_examples=50, deadline=None)
@given(st.lists(st.floats(-1.0, 1.0), min_size=7, max_size=7))
def test_the_machine_sees_the_sun_as_its_base_is_turned(numbers: list[float]) -> None:
    """By Pinocchio's rotation matrix."""
    turn, direction = np.array(numbers[:4]), np.array(numbers[4:])
    assume(np.linalg.norm(turn) > 0.1)
    turn /= np.linalg.norm(turn)
    base_in_map = pin.Quaternion(turn).toRotationMatrix()
    to_sun, up = in_base(np.array([3.0, -2.0, 0.5, *turn, 0.7]), direction)
    assert to_sun == pytest.approx(base_in_map.T @ direction, abs=1e-12)
    assert up == pytest.approx(base_in_map.T @ [0.0, 0.0, 1.0], abs=1e-12)


def test_the_light_on_the_machine_is_looked_for_ten_times_a_second() -> None:
    """It turns with the machine: what an array sees is at most 0.1 s old, and no array is lit by what never was."""
    scenario = load_scenario("mars_sol", ["machine=explorer_solar"])
    model, state = build_plant(scenario)
    command, seen = zeros_command(len(model.joints.names), len(model.loads)), [state]
    for number in range(12):
        tilted = state.configuration.copy()
        tilted[3:7] = pin.Quaternion(pin.rpy.rpyToMatrix(0.0, 0.001 * number, 0.0)).coeffs()
        before = replace(state, configuration=tilted)
        state, _ = step(model, before, command)
        seen.append(state)
        if before.tick % 5 == 0:
            light = light_for_power(model, state)
            to_sun, _ = in_base(state.configuration, light.direction)
            assert state.power.surroundings.to_sun == pytest.approx(to_sun, abs=1e-4)
    news = [k for k in range(1, 13) if seen[k].power.surroundings is not seen[k - 1].power.surroundings]
    assert news == [1, 6, 11]


def test_a_driving_machine_is_warmed_by_less_than_it_draws() -> None:
    """Five seconds: some of it is work on the ground."""
    scenario = night()
    model, start = build_plant(scenario)
    command = zeros_command(len(model.joints.names), len(model.loads))
    wheels = model.reference_rows([wheel.joint for wheel in scenario.machine.wheels])
    command.reference[1, wheels] = 0.5
    state = start
    for _ in range(250):
        command.reference[0, wheels] += 0.5 * 0.02
        state, _ = step(model, state, command)
    assert state.heat is not None and scenario.power.battery is not None
    account, energy = state.heat.nodes.thermal.account, state.energy
    released = energy.winding_heat + energy.friction_heat + energy.stop_heat
    assert energy.electrical > released + 1.0 > 2.0
    cells = scenario.power.battery.heat_given(start.power.stores[0], state.power.stores[0])
    drawn = state.power.energy.loads - account.heaters
    most = drawn - (energy.electrical - released) + cells
    # the motors that hold the arm warm nothing that thermal.yaml names
    assert 0.93 * most < account.given < most + 1.0 < drawn + cells


def test_a_machine_whose_heat_is_not_said_has_none() -> None:
    scenario = load_scenario("flat_drive")
    assert site_heat(scenario) is None
    model, state = build_plant(scenario)
    assert model.heat is None and state.heat is None
