"""Start-up and ageing of a store of hydrogen and oxygen: how long a start takes, what the wear of its cells costs."""

from math import ceil, log, sqrt

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError
from test_network import IdealSource, bus, imbalance, load
from test_regenerative_fuel_cell import STORE

from sojourn_machine.power.cell_condition import CellCondition, CellConditionParams
from sojourn_machine.power.network import PowerNetwork
from sojourn_machine.power.power_params import PowerParams
from sojourn_machine.power.regenerative_fuel_cell import RegenerativeFuelCellParams, RegenerativeState

STACK = {"warm_up_s": 120.0, "cool_down_s": 3600.0, "cold_part": 0.3, "wear_per_hour": 5e-6, "wear_per_start": 2e-5}
ELECTROLYSER = {"warm_up_s": 600.0, "cool_down_s": 7200.0, "cold_part": 0.1, "wear_per_hour": 1e-5}
HYDROGEN_HEAT = 285.8e3 / 2.01588e-3
"""Of its burning to liquid water, by the tables [J/kg]."""


def store(**changes: object) -> RegenerativeFuelCellParams:
    both = {"condition": STACK, "electrolyser_condition": ELECTROLYSER}
    return RegenerativeFuelCellParams.model_validate(STORE.model_dump() | both | changes)


def most_out(params: RegenerativeFuelCellParams, state: RegenerativeState) -> float:
    """Power at the terminals with all the current that it gives [W]."""
    point = params.point(state)
    return (point.source - point.resistance * point.most) * point.most


def most_in(params: RegenerativeFuelCellParams, state: RegenerativeState) -> float:
    """Power at the terminals at its ceiling [W]."""
    point = params.point(state)
    return point.ceiling * (point.ceiling - point.source) / point.resistance


def run(
    params: RegenerativeFuelCellParams, state: RegenerativeState, current: float, seconds: float
) -> RegenerativeState:
    for _ in range(round(seconds / 10.0)):
        state = params.step(state, current, 10.0)
    return state


def test_no_more_is_given_or_taken_than_cells_can() -> None:
    """A bus that asks for twice the power of the stack gets that, and a sun of twice the electrolyser's charges so."""
    params = PowerParams(stores={"cells": STORE}, bus=bus(load("motor", 3000.0)))
    network = PowerNetwork(params)
    state, output = network.step(network.initial_state(0.5), (1.0,), (2.0 * STORE.most_discharge,), 1.0)
    assert output.load_power[0] == pytest.approx(STORE.most_discharge, rel=1e-9)
    assert imbalance(state) < 1e-9
    sun = IdealSource(power=2.0 * STORE.most_charge)
    network = PowerNetwork(PowerParams(stores={"cells": STORE}, sources={"sun": sun}, bus=bus(load("motor", 1.0))))
    state, output = network.step(network.initial_state(0.1), (1.0,), (0.0,), 1.0)
    assert output.source_powers[0] == pytest.approx(STORE.most_charge, rel=1e-9)
    assert STORE.open_circuit_voltage(0.1) < output.voltage < STORE.voltage_full


def test_without_a_table_nothing_warms_and_nothing_wears() -> None:
    state = run(STORE, STORE.initial_state(0.5), 5.0, 36000.0)
    assert state.cells.worn == 0.0 and most_out(STORE, state) == pytest.approx(STORE.most_discharge, rel=1e-9)


def test_a_start_of_the_stack_takes_as_long_as_it_says() -> None:
    params = store()
    cold = params.initial_state(0.5)
    assert most_out(params, cold) == pytest.approx(0.3 * params.most_discharge, rel=1e-9)
    half = run(params, cold, 2.0, 60.0)
    assert most_out(params, half) == pytest.approx(0.65 * params.most_discharge, rel=1e-3)
    almost = run(params, half, 2.0, 50.0)
    warm = run(params, almost, 2.0, 10.0)
    assert most_out(params, almost) < 0.95 * params.most_discharge
    assert most_out(params, warm) == pytest.approx(params.most_discharge, rel=1e-3) and warm.electrolyser.warmth == 0.0
    assert run(params, warm, 0.0, 1800.0).cells.warmth == pytest.approx(0.5)
    assert run(params, warm, -1.0, 3610.0).cells.warmth == 0.0


def test_a_start_of_the_electrolyser_takes_as_long_as_it_says() -> None:
    params = store(voltage_full=60.0)
    cold = params.initial_state(0.1)
    assert most_in(params, cold) == pytest.approx(0.1 * params.most_charge, rel=1e-9)
    half = run(params, cold, -1.0, 300.0)
    assert most_in(params, half) == pytest.approx(0.55 * params.most_charge, rel=1e-3)
    warm = run(params, half, -1.0, 300.0)
    assert most_in(params, warm) == pytest.approx(params.most_charge, rel=1e-3) and warm.cells.warmth == 0.0


def test_a_cold_stack_holds_a_bus_with_a_part_of_its_power_until_it_is_warm() -> None:
    """In a network, which asks for all from the first second: served once the cells allow as much, and not before."""
    params = store()
    asked = 0.8 * params.most_discharge
    network = PowerNetwork(PowerParams(stores={"cells": params}, bus=bus(load("motor", 3000.0))))
    state, served = network.initial_state(0.9), []
    for _ in range(120):
        state, output = network.step(state, (1.0,), (asked,), 1.0)
        served.append(output.load_power[0])
    assert served[0] == pytest.approx(0.3 * params.most_discharge, rel=1e-3)
    first = next(second for second, power in enumerate(served) if power > asked * (1.0 - 1e-9))
    assert first == ceil((0.8 - 0.3) / 0.7 * 120.0) and imbalance(state) < 1e-9


CURRENTS = st.lists(st.one_of(st.just(0.0), st.floats(0.1, 15.0), st.floats(-15.0, -0.1)), min_size=1, max_size=30)


@settings(max_examples=60, deadline=None)
@given(
    currents=CURRENTS, dt=st.sampled_from([0.02, 60.0]), soc=st.floats(0.2, 0.8), worn=st.floats(0.0, 0.05),
    warmth=st.floats(0.0, 1.0),
)  # fmt: skip
def test_mass_charge_and_heat_of_worn_cells_are_kept(
    currents: list[float], dt: float, soc: float, worn: float, warmth: float
) -> None:
    """Charge of each step by the balance of powers in a cell, not by the store's own law; the heat of the reaction."""
    params, lost = store(), CellCondition(warmth, worn)
    first = state = RegenerativeState(soc, 290.0, cells=lost, electrolyser=lost)
    turned = 0.0
    for current in currents:
        before, state = state, params.step(state, current, dt)
        power = (state.energy_terminal - before.energy_terminal) / dt
        charge = (before.soc - state.soc) * params.hydrogen / 2.01588e-3 * 2.0 * 96485.332 / dt
        if power > 0.0:
            density = charge / (params.cells * params.area * 10.0)
            volts = params.fuel_cell.voltage(density) - before.cells.worn
            assert charge * volts == pytest.approx(power / params.passed, rel=1e-4)
        elif power < 0.0:
            density = -charge / (params.electrolyser_cells * params.electrolyser_area * 10.0)
            volts = params.electrolyser.voltage(density) + before.electrolyser.worn
            assert charge * volts == pytest.approx(power * params.passed, rel=1e-4)
        turned += abs(power) * dt
    burnt = (first.soc - state.soc) * params.hydrogen * HYDROGEN_HEAT
    assert burnt == pytest.approx(state.energy_terminal + state.energy_heat, rel=1e-3, abs=2e-3 * turned + 1e-6)
    out = params.chemical_energy(first.soc) - params.chemical_energy(state.soc)
    assert out == pytest.approx(state.energy_terminal + state.energy_heat, rel=1e-9, abs=1e-9 * turned + 1e-6)


@settings(max_examples=60, deadline=None)
@given(currents=CURRENTS, dt=st.sampled_from([1.0, 60.0, 900.0]))
def test_wear_is_that_of_the_hours_and_starts_and_warmth_stays_in_its_bounds(currents: list[float], dt: float) -> None:
    params = store()
    state, warm, hours, starts, split = params.initial_state(0.5), 0.0, 0.0, 0, 0.0
    for current in currents:
        starts += current > 0.0 and warm == 0.0
        hours += dt / 3600.0 if current > 0.0 else 0.0
        split += dt / 3600.0 if current < 0.0 else 0.0
        warm = min(1.0, warm + dt / 120.0) if current > 0.0 else max(0.0, warm - dt / 3600.0)
        state = params.step(state, current, dt)
        assert 0.0 <= state.cells.warmth <= 1.0 and 0.0 <= state.electrolyser.warmth <= 1.0
    assert state.cells.warmth == pytest.approx(warm, abs=1e-12)
    assert state.cells.worn == pytest.approx(5e-6 * hours + 2e-5 * starts, rel=1e-9)
    assert state.electrolyser.worn == pytest.approx(1e-5 * split, rel=1e-9)


def aged(hours: float) -> RegenerativeFuelCellParams:
    return store(
        condition=STACK | {"hours_before": hours}, electrolyser_condition=ELECTROLYSER | {"hours_before": hours}
    )


def test_a_round_trip_falls_by_the_voltages_that_are_lost() -> None:
    """5000 h: 25 mV less of the stack, 50 mV more of the electrolyser; by hand from the new curves."""
    new, old = aged(0.0), aged(5000.0)
    assert old.initial_state(0.5).cells.worn == pytest.approx(0.025)
    assert old.initial_state(0.5).electrolyser.worn == pytest.approx(0.05)
    half, fed = 0.5 * old.most_discharge, 0.5 * old.most_charge
    density = old.charge_of(half) / (20 * 0.02 * 10.0)
    i = -old.charge_of(-fed) / (15 * 0.01 * 10.0)
    out = old.fuel_cell.voltage(density) - 0.025
    into = 1.229 + 0.06 * log(1.0 + i) + 2.5e-4 * i + 0.05
    assert old.charge_of(half) * out == pytest.approx(half / old.passed, rel=1e-6)
    assert -old.charge_of(-fed) * into == pytest.approx(fed * old.passed, rel=1e-6)
    assert old.charging_efficiency == pytest.approx(out / into * old.passed**2, rel=1e-6)
    assert new.charging_efficiency == pytest.approx(STORE.charging_efficiency, rel=1e-12)
    assert 0.92 < old.charging_efficiency / new.charging_efficiency < 0.96  # (1 - 0.025/0.8) / (1 + 0.05/1.7) = 0.941
    assert old.most_discharge < new.most_discharge and old.most_charge > new.most_charge


def test_an_aged_store_carries_a_night_as_much_shorter() -> None:
    """Through the terminals, from full to empty at the same power: hours as the voltage of the cells."""
    lasted = []
    for params in (aged(0.0), aged(5000.0)):
        state, hours = params.initial_state(1.0), 0.0
        while state.soc > 0.0:
            force = params.open_circuit_voltage(state.soc)
            state = params.step(state, (force - sqrt(force**2 - 0.4 * 500.0)) / 0.2, 60.0)
            hours += 1.0 / 60.0
        lasted.append(hours)
    volts = [params.fuel_cell.voltage(params.charge_of(500.0) / 4.0) for params in (aged(0.0), aged(5000.0))]
    assert lasted[1] / lasted[0] == pytest.approx((volts[1] - 0.025) / volts[0], rel=3e-3)


def test_cells_that_are_worn_out_give_nothing() -> None:
    params = store()
    dead = RegenerativeState(0.5, 290.0, cells=CellCondition(1.0, 2.0))
    assert not params.point(dead).discharges and params.point(dead).charges
    with pytest.raises(ValueError, match="worn out"):
        params.step(dead, 1.0, 1.0)
    with pytest.raises(ValidationError, match="leaves the cells a voltage"):
        store(condition={"wear_per_hour": 1e-3, "hours_before": 5000.0})


@pytest.mark.parametrize("wrong", [{"warm_up_s": -1.0}, {"cold_part": 0.0}, {"hours_before": -1.0}, {"wear": 1.0}])
def test_what_no_cell_does_is_refused(wrong: dict[str, float]) -> None:
    with pytest.raises(ValidationError):
        CellConditionParams.model_validate(wrong)
