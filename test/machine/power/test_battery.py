"""The battery against closed forms, quadrature of its own voltage, and its energy balance."""

import copy
from dataclasses import replace
from math import exp, inf, nan

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from sojourn_config.scenario import load_scenario
from sojourn_machine.errors import InvalidValueError, MachineError
from sojourn_machine.power import battery
from sojourn_machine.power.battery import BatteryParams
from sojourn_machine.power.network import PowerNetwork
from sojourn_machine.power.pack import PackState
from sojourn_machine.power.stores import StoreParams
from sojourn_machine.power.surroundings import DARK, PowerSurroundings


def make(**changes: object) -> BatteryParams:
    values: dict[str, object] = {
        "name": "pack",
        "cells_series": 8,
        "cells_parallel": 2,
        "capacity_ah": 8.0,
        "soc_points": (0.0, 0.1, 0.5, 1.0),
        "ocv_points": (2.85, 3.33, 3.69, 4.18),
        "resistance_temperatures": (253.15, 298.15),
        "resistance_ohmic": (0.04, 0.0095),
        "resistance_polarisation": (0.021, 0.005),
        "capacitance_polarisation": 6000.0,
        "coulombic_efficiency": 0.99,
        "charge_current_limit": 4.0,
        "discharge_current_limit": 16.0,
        "heat_capacity": 320.0,
        "thermal_conductance": 0.5,
        "temperature_surroundings": 298.15,
        "temperature_discharge_min": 253.15,
        "temperature_charge_min": 273.15,
        "temperature_max": 303.15,
    }
    return BatteryParams(**(values | changes))


PACK = make()


def run(params: BatteryParams, state: PackState, current: float, dt: float, steps: int) -> PackState:
    for _ in range(steps):
        state = battery.step(params, state, current, dt)
    return state


def chemical(params: BatteryParams, before: PackState, after: PackState) -> float:
    return battery.stored_energy(params, before.soc) - battery.stored_energy(params, after.soc)


def capacitor(params: BatteryParams, state: PackState) -> float:
    return 0.5 * params.capacitance * state.polarisation_voltage**2


def test_charge_of_a_full_discharge_is_the_capacity_of_the_pack() -> None:
    state = run(PACK, battery.initial_state(PACK, 1.0), 8.0, 10.0, 720)  # 2 h at C/2
    assert state.soc == pytest.approx(0.0, abs=1e-12)
    assert state.charge_drawn == pytest.approx(16.0 * 3600.0)


def test_charging_stores_the_coulombic_efficiency() -> None:
    state = run(PACK, battery.initial_state(PACK, 0.2), -4.0, 10.0, 360)
    assert state.soc == pytest.approx(0.2 + 0.99 * 4.0 / 16.0)


def test_open_circuit_voltage_at_the_published_points_and_its_inverse() -> None:
    for soc, cell in ((0.0, 2.85), (0.1, 3.33), (0.5, 3.69), (1.0, 4.18)):
        assert battery.open_circuit_voltage(PACK, soc) == pytest.approx(8 * cell)
    for soc in np.linspace(0.0, 1.0, 37):
        voltage = battery.open_circuit_voltage(PACK, float(soc))
        assert battery.soc_from_open_circuit_voltage(PACK, voltage) == pytest.approx(soc, abs=1e-12)


def test_resistance_of_the_pack_follows_the_temperature_table() -> None:
    assert battery.resistances(PACK, 298.15) == pytest.approx((0.038, 0.02))
    assert battery.resistances(PACK, 275.65)[0] == pytest.approx(4 * (0.04 + 0.0095) / 2)
    assert battery.resistances(PACK, 100.0) == battery.resistances(PACK, 253.15)
    assert battery.resistances(PACK, 400.0) == battery.resistances(PACK, 298.15)


def test_polarisation_rises_and_relaxes_exponentially_whatever_the_step() -> None:
    params = make(thermal_conductance=0.0, heat_capacity=1e6)  # holds the resistance still
    tau = 0.02 * params.capacitance
    rise = run(params, battery.initial_state(params, 0.8), 10.0, 0.5, 120)
    assert rise.polarisation_voltage == pytest.approx(0.2 * (1.0 - exp(-60.0 / tau)), rel=1e-4)
    rest = battery.step(params, rise, 0.0, 45.0)
    assert rest.polarisation_voltage == pytest.approx(rise.polarisation_voltage * exp(-45.0 / tau), rel=1e-4)


@settings(max_examples=60, deadline=None)
@given(
    soc=st.floats(0.02, 1.0),
    temperature=st.floats(240.0, 310.0),
    currents=st.lists(st.floats(-12.0, 30.0), min_size=1, max_size=8),
    dt=st.floats(0.001, 30.0),
)
def test_chemical_energy_out_is_terminal_energy_and_heat_and_what_is_stored(
    soc: float, temperature: float, currents: list[float], dt: float
) -> None:
    start = state = battery.initial_state(PACK, soc, temperature)
    throughput = 1.0
    for current in currents:
        after = battery.step(PACK, state, current, dt)
        assert after.energy_heat >= state.energy_heat - 1e-9  # J, the rounding of 1.7 MJ
        throughput += abs(after.energy_terminal - state.energy_terminal)
        state = after
    balance = chemical(PACK, start, state) - state.energy_terminal - state.energy_heat - capacitor(PACK, state)
    assert abs(balance) < 1e-9 * (throughput + battery.stored_energy(PACK, 1.0))
    assert state.soc <= 1.0


@pytest.mark.parametrize("current", [9.0, -6.0])
def test_terminal_energy_is_the_integral_of_the_terminal_voltage(current: float) -> None:
    start = state = battery.initial_state(PACK, 0.6)
    voltages, dt = [battery.terminal_voltage(PACK, state, current)], 0.25
    for _ in range(400):
        state = battery.step(PACK, state, current, dt)
        voltages.append(battery.terminal_voltage(PACK, state, current))
    integral = current * dt * (sum(voltages) - 0.5 * (voltages[0] + voltages[-1]))
    assert state.energy_terminal - start.energy_terminal == pytest.approx(integral, rel=2e-6)


def test_one_long_step_is_many_short_ones() -> None:
    params = make(thermal_conductance=0.0, heat_capacity=1e6)
    start = battery.initial_state(params, 0.9)
    long, short = battery.step(params, start, 12.0, 100.0), run(params, start, 12.0, 0.1, 1000)
    for name in ("soc", "polarisation_voltage", "energy_terminal", "energy_heat", "charge_drawn"):
        assert getattr(long, name) == pytest.approx(getattr(short, name), rel=1e-3)


def test_temperature_settles_where_conduction_carries_the_heat_away() -> None:
    params = make(
        resistance_temperatures=(298.15,),
        resistance_ohmic=(0.0095,),
        resistance_polarisation=(0.005,),
        capacity_ah=1000.0,
    )
    state = run(params, battery.initial_state(params, 1.0), 5.0, 60.0, 2000)
    expected = 298.15 + 25.0 * (0.038 + 0.02) / 0.5
    assert state.temperature == pytest.approx(expected, abs=1e-3)


def test_temperature_without_conduction_keeps_the_heat() -> None:
    params = make(thermal_conductance=0.0)
    state = run(params, battery.initial_state(params, 0.9), 20.0, 1.0, 600)
    assert (state.temperature - 298.15) * 320.0 * 16 == pytest.approx(state.energy_heat)


def test_surroundings_of_the_caller_are_used() -> None:
    state = battery.initial_state(PACK, 0.5, 290.0)
    rate = 0.5 / (320.0 * 16)
    cooled = battery.step(PACK, state, 0.0, 1000.0, temperature_surroundings=250.0)
    assert cooled.temperature == pytest.approx(250.0 + 40.0 * exp(-rate * 1000.0))


def test_a_full_pack_turns_charge_into_heat() -> None:
    start = battery.initial_state(PACK, 1.0)
    state = battery.step(PACK, start, -2.0, 100.0)
    assert state.soc == 1.0
    assert state.energy_heat == pytest.approx(-state.energy_terminal - capacitor(PACK, state), rel=1e-9)
    assert state.energy_heat > 2.0 * 100.0 * 8 * 4.18


def test_an_empty_pack_is_a_dead_source() -> None:
    state = battery.step(PACK, battery.initial_state(PACK, 1e-5), 20.0, 1.0)
    assert -1e-3 < state.soc < 0.0
    assert battery.thevenin(PACK, state)[0] == 0.0
    assert battery.terminal_voltage(PACK, state, 0.0) == 0.0
    assert "empty" in battery.limits_exceeded(PACK, state, 0.0)


def test_thevenin_is_the_terminal_voltage_at_every_current() -> None:
    state = run(PACK, battery.initial_state(PACK, 0.7, 270.0), 6.0, 1.0, 50)
    source, resistance = battery.thevenin(PACK, state)
    assert source == pytest.approx(battery.open_circuit_voltage(PACK, state.soc) - state.polarisation_voltage)
    for current in (-5.0, 0.0, 13.0):
        assert battery.terminal_voltage(PACK, state, current) == pytest.approx(source - resistance * current)


def test_limits_are_told_in_words() -> None:
    state = battery.initial_state(PACK, 0.5)
    assert battery.limits_exceeded(PACK, state, 10.0) == ()
    assert battery.limits_exceeded(PACK, state, 33.0) == ("discharge current above its limit",)
    assert battery.limits_exceeded(PACK, state, -9.0) == ("charge current above its limit",)
    assert battery.limits_exceeded(PACK, replace(state, temperature=260.0), -1.0) == ("too cold to charge",)
    assert battery.limits_exceeded(PACK, replace(state, temperature=240.0), 1.0) == ("too cold to discharge",)
    assert battery.limits_exceeded(PACK, replace(state, temperature=310.0), 1.0) == ("too hot",)


@pytest.mark.parametrize("current", [nan, inf, -inf])
def test_a_current_that_is_no_number_is_refused_by_name(current: float) -> None:
    with pytest.raises(InvalidValueError, match=r"pack current \[A\].*finite"):
        battery.step(PACK, battery.initial_state(PACK, 0.5), current, 0.02)


@pytest.mark.parametrize("dt", [0.0, -0.1, nan, inf])
def test_a_step_without_length_is_refused(dt: float) -> None:
    with pytest.raises(MachineError, match="dt"):
        battery.step(PACK, battery.initial_state(PACK, 0.5), 1.0, dt)


def test_bad_starts_are_refused() -> None:
    for soc in (-0.01, 1.01, nan):
        with pytest.raises(InvalidValueError, match="state of charge"):
            battery.initial_state(PACK, soc)
    for temperature in (0.0, -3.0, nan, inf):
        with pytest.raises(InvalidValueError, match="temperature"):
            battery.initial_state(PACK, 0.5, temperature)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"ocv_points": (2.85, 3.33, 3.30, 4.18)}, "ocv_points"),
        ({"ocv_points": (2.85, 3.33, 4.18)}, "as many as soc_points"),
        ({"ocv_points": (0.0, 3.33, 3.69, 4.18)}, "above 0 V"),
        ({"soc_points": (0.0, 0.5, 0.1, 1.0)}, "soc_points"),
        ({"soc_points": (0.0, 0.1, 0.5, 0.9)}, "ends at 1"),
        ({"resistance_ohmic": (0.04,)}, "resistance_ohmic"),
        ({"resistance_polarisation": (0.04, 0.0)}, "resistance_polarisation"),
        ({"temperature_charge_min": 200.0}, "temperature limits"),
        ({"capacity_ah": 0.0}, "capacity_ah"),
        ({"cells_series": 0}, "cells_series"),
        ({"coulombic_efficiency": 1.2}, "coulombic_efficiency"),
        ({"heat_capacity": nan}, "heat_capacity"),
        ({"capacity": 8.0}, "capacity"),
    ],
)
def test_bad_parameters_are_refused_by_name(changes: dict[str, object], words: str) -> None:
    with pytest.raises(ValidationError, match=words):
        make(**changes)


def test_a_changed_copy_of_the_parameters_has_its_own_tables() -> None:
    assert battery.open_circuit_voltage(PACK, 1.0) == pytest.approx(8 * 4.18)
    changed = PACK.model_copy(update={"cells_series": 4})
    assert battery.open_circuit_voltage(changed, 1.0) == pytest.approx(4 * 4.18)


def test_parameters_and_state_are_values() -> None:
    assert copy.deepcopy(PACK) == PACK
    assert battery.step(PACK, battery.initial_state(PACK, 0.5), 3.0, 0.02) == battery.step(
        copy.deepcopy(PACK), battery.initial_state(PACK, 0.5), 3.0, 0.02
    )


def test_a_frozen_pack_gives_and_takes_nothing_and_lives_again_after_the_thaw() -> None:
    power = load_scenario("mars_sol").power
    network, light = PowerNetwork(power), PowerSurroundings(np.array([0.0, 0.0, 1.0]), 500.0, 50.0)
    state, on = network.initial_state(0.6), np.ones(len(power.loads))
    (pack,) = state.stores
    frozen = replace(pack, temperature=150.0)
    demand = np.zeros(len(power.loads))
    for surroundings in (DARK, light):
        after, seen = network.step(replace(state, stores=(frozen,)), on, demand, 1.0, surroundings)
        assert seen.store_currents == (0.0,)
        assert after.stores[0].soc == frozen.soc and after.stores[0].energy_terminal == 0.0
        assert (seen.load_power.sum() > 0.0) == (surroundings is light)
    thawed = replace(frozen, temperature=293.0)
    _, seen = network.step(replace(state, stores=(thawed,)), on, demand, 1.0, DARK)
    assert seen.store_currents[0] > 1.0 and seen.load_power.sum() > 50.0
    assert next(iter(power.all_stores.values())).limits_exceeded(150.0, 0.0) == ("frozen",)


def at(soc: float) -> PackState:
    return PackState(soc=soc, polarisation_voltage=0.0, temperature=290.0)


@pytest.mark.parametrize("soc", [-0.01, 0.0, 0.05, 0.3, 0.8, 1.0])
def test_elastance_is_the_slope_of_the_force(soc: float) -> None:
    assert make().elastance(at(soc)) == pytest.approx(StoreParams.elastance(make(), at(soc)), rel=1e-9)


def test_elastance_at_a_point_of_the_table_is_that_of_one_side() -> None:
    assert make().elastance(at(0.5)) in [make().elastance(at(soc)) for soc in (0.4, 0.6)]
