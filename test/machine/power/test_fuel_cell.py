"""A fuel cell with its tanks against the published curve, Faraday's law by another route, and its own account."""

import math
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_config.load import load_params
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.power.fuel_cell import FuelCellParams, FuelCellState
from sojourn_machine.power.polarisation import (
    HYDROGEN_PER_CHARGE,
    THERMONEUTRAL,
    ElectrolyserCurve,
    specific_consumption,
    water_of,
)

STACK = load_params("parts", "ballard_mark_v", FuelCellParams)
JOULES_PER_KWH = 3.6e6


@pytest.mark.published
def test_the_published_curve() -> None:
    """Ballard Mark V at 70 C: 0.868 V at 100, 0.690 V at 600 mA/cm2."""
    assert STACK.curve.voltage(100.0) == pytest.approx(0.868, abs=5e-4)
    assert STACK.curve.voltage(600.0) == pytest.approx(0.690, abs=1e-3)


def test_reactants_of_a_kilowatt_hour() -> None:
    """0.373 kg/kWh at 0.9 V: 18.015 g of water for two faradays, the charge of a kilowatt hour at 0.9 V."""
    assert specific_consumption(0.9) * JOULES_PER_KWH == pytest.approx(0.373, abs=1e-3)
    moles = JOULES_PER_KWH / 0.9 / (2.0 * 96485.0)
    assert specific_consumption(0.9) * JOULES_PER_KWH == pytest.approx(moles * 18.015e-3, rel=1e-4)
    assert specific_consumption(0.0) == math.inf


@settings(max_examples=100, deadline=None)
@given(
    powers=st.lists(st.one_of(st.just(0.0), st.floats(1.0, STACK.most_power)), min_size=1, max_size=20),
    dt=st.sampled_from([0.02, 60.0]),
)
def test_mass_and_energy_are_kept(powers: list[float], dt: float) -> None:
    """Water is what both tanks lost; the reaction's heat of 286 kJ/mol is power and heat."""
    first = state = STACK.initial_state()
    for power in powers:
        state = STACK.step(state, power, dt)
    used = first.hydrogen - state.hydrogen
    assert state.water == pytest.approx(used + first.oxygen - state.oxygen, rel=1e-9, abs=1e-14)
    assert state.water == pytest.approx(water_of(used), rel=1e-9, abs=1e-14)
    assert state.energy + state.energy_heat == pytest.approx(used / 2.01588e-3 * 285.8e3, rel=1e-3, abs=1e-9)
    assert STACK.heat_given(first, state) == state.energy_heat >= 0.0


@given(st.floats(0.001, 1.0), st.floats(0.001, 1.0))
def test_more_power_costs_more_than_its_share(a: float, b: float) -> None:
    """The voltage falls with the current, so hydrogen for a watt grows with the watts."""
    low, high = sorted((a, b))
    assert STACK.voltage_at(low * STACK.most_power) >= STACK.voltage_at(high * STACK.most_power) - 1e-12


@given(st.floats(1.0, 700.0))
def test_the_current_of_a_power_is_found_again(density: float) -> None:
    power = STACK.passed * STACK.stack_power(density)
    assert STACK.voltage_at(power) == pytest.approx(STACK.curve.voltage(density), abs=1e-9)


def test_the_most_power_is_where_no_other_current_gives_more() -> None:
    weak = STACK.model_copy(update={"largest_current_density": 5000.0})
    peak = weak.curve.most_power_density(5000.0)
    assert max(weak.stack_power(i) for i in range(1, 1500)) <= weak.stack_power(peak) * (1.0 + 1e-9)
    assert STACK.best_density == 700.0


def test_an_empty_tank_gives_nothing_and_its_end_is_foreseen() -> None:
    state, hours = STACK.initial_state(), 0.0
    while STACK.point(state).power > 0.0:
        state = STACK.step(state, 500.0, 60.0)
        hours += 1.0 / 60.0
    charge = 500.0 / STACK.passed / STACK.voltage_at(500.0)
    assert hours == pytest.approx(1.0 / (HYDROGEN_PER_CHARGE * charge) / 3600.0, abs=0.02)
    assert STACK.point(FuelCellState(1.0, 0.0)).power == 0.0


def test_an_electrolyser_takes_more_than_the_reaction_needs() -> None:
    curve = ElectrolyserCurve(activation=0.05, exchange=1.0, resistance=2e-4)
    for density in (1.0, 100.0, 1000.0):
        power = density * curve.voltage(density)
        assert curve.density_at(power) == pytest.approx(density, rel=1e-9)
    assert curve.voltage(0.0) == 1.229 and curve.voltage(400.0) > THERMONEUTRAL > curve.voltage(1.0)


@pytest.mark.parametrize(("power", "dt"), [(math.nan, 1.0), (1.0, 0.0), (1.0, math.inf), (math.inf, 1.0)])
def test_what_cannot_be_stepped_is_refused(power: float, dt: float) -> None:
    with pytest.raises(InvalidValueError):
        STACK.step(STACK.initial_state(), power, dt)


def run(stack: FuelCellParams, state: FuelCellState, power: float, seconds: float) -> FuelCellState:
    for _ in range(round(seconds / 10.0)):
        state = stack.step(state, power, 10.0)
    return state


def test_a_cold_stack_allows_a_part_of_its_power_and_all_when_warm() -> None:
    cold = STACK.initial_state()
    assert STACK.point(cold).power == pytest.approx(0.3 * STACK.most_power)
    half = run(STACK, cold, 200.0, 60.0)
    assert STACK.point(half).power == pytest.approx(0.65 * STACK.most_power, rel=1e-3)
    warm = run(STACK, half, 200.0, 60.0)
    assert warm.warmth == 1.0 and STACK.point(warm).power == pytest.approx(STACK.most_power, rel=1e-3)
    resting = run(STACK, warm, 0.0, 1800.0)
    assert resting.warmth == pytest.approx(0.5) and resting.hydrogen == warm.hydrogen
    assert run(STACK, resting, 0.0, 1900.0).warmth == 0.0
    always = STACK.model_copy(update={"warm_up_s": 0.0})
    assert always.point(always.initial_state()).power == pytest.approx(always.most_power)


def test_cells_lose_voltage_by_the_hours_and_starts() -> None:
    """5000 h at 5 uV/h are 25 mV, and ten starts 0.2 mV; by as much does the voltage at a current sink."""
    state = STACK.initial_state()
    for _ in range(10):
        state = run(STACK, run(STACK, state, 200.0, 120.0), 0.0, 3610.0)
    assert state.worn == pytest.approx(10 * (2e-5 + 5e-6 * 120.0 / 3600.0), rel=1e-9)
    old = FuelCellState(1.0, 8.0, warmth=1.0, worn=0.025)
    curve, best = STACK.worn_curve(0.025)
    assert curve.voltage(300.0) == pytest.approx(STACK.curve.voltage(300.0) - 0.025, abs=1e-9)
    assert STACK.point(old).power == pytest.approx(STACK.most_power - STACK.passed * STACK.milliwatts * best * 0.025)
    used = [before.hydrogen - STACK.step(before, 500.0, 60.0).hydrogen for before in (replace(old, worn=0.0), old)]
    assert 1.02 < used[1] / used[0] < 1.06  # of 0.8 V at 500 W, and more current for it


def test_the_account_of_worn_cells_is_exact() -> None:
    first = FuelCellState(1.0, 8.0, warmth=0.4, worn=0.05)
    state = run(STACK, first, 400.0, 600.0)
    used = first.hydrogen - state.hydrogen
    assert state.energy + state.energy_heat == pytest.approx(used / 2.01588e-3 * 285.8e3, rel=1e-3)
