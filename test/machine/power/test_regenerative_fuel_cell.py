"""A store of hydrogen and oxygen: its round trip, its account, a night on it in a network."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError
from test_network import bus, imbalance, load

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.power.network import PowerNetwork
from sojourn_machine.power.polarisation import ElectrolyserCurve, FuelCellCurve
from sojourn_machine.power.power_params import PowerParams
from sojourn_machine.power.regenerative_fuel_cell import RegenerativeFuelCellParams

STORE = RegenerativeFuelCellParams(
    fuel_cell=FuelCellCurve(
        open_voltage=1.031, tafel=0.03, resistance=2.45e-4, transport=2.11e-5, transport_rate=0.008
    ),
    cells=20, area=0.02, largest_current_density=500.0,
    electrolyser=ElectrolyserCurve(activation=0.06, exchange=1.0, resistance=2.5e-4),
    electrolyser_cells=15, electrolyser_area=0.01, largest_electrolysis_density=400.0,
    hydrogen=1.5, voltage_empty=26.0, voltage_full=32.0, resistance=0.1, temperature_surroundings=290.0,
)  # fmt: skip


def test_the_round_trip_is_as_published() -> None:
    """45 to 60 % (Burke 2003), here by hand at half loads too."""
    assert 0.40 < STORE.charging_efficiency < 0.60
    half = 0.5 * STORE.most_discharge
    volts = STORE.passed * half / STORE.passed / STORE.charge_of(half)
    taken = 0.5 * STORE.most_charge
    up = STORE.electrolyser.voltage(STORE.electrolyser.density_at(taken * STORE.passed / (15 * 0.01 * 10.0)))
    assert STORE.charging_efficiency == pytest.approx(volts * STORE.passed / up, rel=1e-6)


@settings(max_examples=100, deadline=None)
@given(
    currents=st.lists(st.floats(-20.0, 40.0), min_size=1, max_size=30),
    dt=st.sampled_from([0.02, 60.0]),
    soc=st.floats(0.2, 0.8),
)
def test_energy_is_kept(currents: list[float], dt: float, soc: float) -> None:
    """Chemical energy out is terminal energy and heat."""
    first = state = STORE.initial_state(soc)
    for current in currents:
        state = STORE.step(state, current, dt)
    out = STORE.chemical_energy(first.soc) - STORE.chemical_energy(state.soc)
    turned = sum(abs(current) for current in currents) * 32.0 * dt
    assert out == pytest.approx(state.energy_terminal + state.energy_heat, rel=1e-6, abs=1e-6 * turned + 1e-6)
    assert STORE.heat_given(first, state) == state.energy_heat


@given(st.floats(0.0, 1.0))
def test_its_voltage_tells_its_charge(soc: float) -> None:
    assert STORE.soc_from_open_circuit_voltage(STORE.open_circuit_voltage(soc)) == pytest.approx(soc, abs=1e-12)


def test_a_full_tank_lasts_as_long_as_its_energy_says() -> None:
    """At half of its power, by way of the terminals."""
    half, state, hours = 0.5 * STORE.most_discharge, STORE.initial_state(1.0), 0.0
    while state.soc > 0.0:
        force = STORE.open_circuit_voltage(state.soc)
        current = (force - math.sqrt(force**2 - 4.0 * STORE.resistance * half)) / (2.0 * STORE.resistance)
        state = STORE.step(state, current, 60.0)
        hours += 1.0 / 60.0
    assert hours == pytest.approx(STORE.stored_energy(1.0) / half / 3600.0, abs=0.05)
    assert state.energy_terminal / 3.6e6 / STORE.hydrogen == pytest.approx(18.0, rel=0.2)  # kWh of a kilogram


def test_it_carries_a_bus_through_a_night() -> None:
    """Alone on its bus: it gives what is asked, and an empty tank is a brownout."""
    params = PowerParams(stores={"cells": STORE}, bus=bus(load("lamp", 300.0, kind="constant_power")))
    network = PowerNetwork(params)
    state = network.initial_state(0.5)
    for _ in range(60):
        state, output = network.step(state, (1.0,), (0.0,), 600.0)
    assert imbalance(state) < 1e-9 and output.load_power[0] == pytest.approx(300.0)
    empty, output = network.step(network.initial_state(0.0), (1.0,), (0.0,), 600.0)
    assert output.load_power[0] == 0.0 and empty.stores[0].soc == 0.0


def test_limits_are_said() -> None:
    assert STORE.limits_exceeded(290.0, 1.0) == ()
    assert STORE.limits_exceeded(290.0, 500.0) == ("discharge current above its limit",)
    assert STORE.limits_exceeded(290.0, -500.0) == ("charge current above its limit",)


@pytest.mark.parametrize(("current", "dt"), [(math.nan, 1.0), (1.0, 0.0)])
def test_no_numbers_are_refused(current: float, dt: float) -> None:
    with pytest.raises(InvalidValueError):
        STORE.step(STORE.initial_state(0.5), current, dt)
    with pytest.raises(InvalidValueError):
        STORE.initial_state(1.5)


def test_voltages_that_do_not_rise_are_refused() -> None:
    with pytest.raises(ValidationError, match="voltage_full"):
        RegenerativeFuelCellParams(**(STORE.model_dump() | {"voltage_full": 20.0}))


EASY = {"activation": 0.0, "exchange": 1.0, "resistance": 0.0}
LOSSLESS = {"auxiliaries": 0.0, "regulator_efficiency": 1.0}


def test_no_round_gives_more_than_it_took() -> None:
    """Of what is allowed the best is 1, at no powers; at half of them it is less."""
    curve = {"open_voltage": 1.031, "tafel": 0.0, "resistance": 0.0, "transport": 0.0, "transport_rate": 0.0}
    of_cells = STORE.model_dump() | LOSSLESS | {"fuel_cell": curve}
    with pytest.raises(ValidationError, match=r"electrolyser.reversible_voltage = 1\.0.*1\.031 V"):
        RegenerativeFuelCellParams(**of_cells | {"electrolyser": EASY | {"reversible_voltage": 1.0}})
    best = RegenerativeFuelCellParams(**of_cells | {"electrolyser": EASY | {"reversible_voltage": 1.031}})
    assert best.best_round_trip == pytest.approx(1.0) and best.charging_efficiency <= 1.0 + 1e-12
    lossy = of_cells | {"auxiliaries": 0.05, "electrolyser": EASY | {"reversible_voltage": 1.0}}
    assert RegenerativeFuelCellParams(**lossy).charging_efficiency < 1.0
    assert STORE.charging_efficiency < STORE.best_round_trip < 1.0


@pytest.mark.parametrize("volts", [0.6, 0.89])
def test_no_electrolyser_splits_water_for_nothing(volts: float) -> None:
    """Steam at 1300 K takes 0.91 V."""
    with pytest.raises(ValidationError, match="reversible_voltage"):
        ElectrolyserCurve.model_validate(EASY | {"reversible_voltage": volts})
    assert ElectrolyserCurve.model_validate(EASY | {"reversible_voltage": 0.95}).voltage(0.0) == 0.95
