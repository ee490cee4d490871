"""Primary and nickel batteries: Peukert's law, acceptance of charge, self-discharge, their account."""

from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError
from test_network import BATTERY, IdealSource, bus, imbalance, load

from sojourn_config.load import load_params
from sojourn_machine.power.battery import BatteryParams
from sojourn_machine.power.cell_losses import SelfDischarge
from sojourn_machine.power.network import PowerNetwork
from sojourn_machine.power.nickel_battery import NickelCadmiumParams, NickelHydrogenParams
from sojourn_machine.power.pack import PackState
from sojourn_machine.power.power_params import PowerParams
from sojourn_machine.power.primary_battery import PrimaryBatteryParams
from sojourn_machine.power.stores import STORES

UNUSED = ("coulombic_efficiency", "charge_current_limit", "temperature_charge_min")
CELLS = {key: value for key, value in BATTERY.items() if key not in UNUSED}


def primary(peukert: float = 1.2, **more: Any) -> PrimaryBatteryParams:
    """100 Ah at 20 h."""
    return PrimaryBatteryParams(**CELLS | {"capacity_ah": 100.0, "rated_hours": 20.0, "peukert": peukert} | more)


def nickel(**more: Any) -> NickelHydrogenParams:
    return NickelHydrogenParams(
        **BATTERY | {"capacity_ah": 50.0, "acceptance_knee": 0.8, "self_discharge_per_day": 0.1} | more
    )


def hours_to_empty(pack: BatteryParams, current: float, dt: float = 10.0) -> float:
    state, hours = pack.initial_state(1.0, 293.15), 0.0
    while state.soc > 0.0:
        state = pack.step(state, current, dt, 293.15)
        hours += dt / 3600.0
    return hours


@pytest.mark.published("Peukert's law, by hand")
@pytest.mark.parametrize(("k", "hours"), [(1.05, 3.691), (1.2, 2.899)])
def test_peukerts_law_of_the_book(k: float, hours: float) -> None:
    """100 Ah at 20 h, drawn at 25 A."""
    assert hours_to_empty(primary(k), 25.0) == pytest.approx(hours, abs=0.004)
    assert hours_to_empty(primary(k), 5.0) == pytest.approx(20.0, abs=0.01)
    assert hours_to_empty(primary(k), 2.0) == pytest.approx(50.0, abs=0.02)


def test_a_cold_cell_gives_less() -> None:
    cold = primary(1.0, part_temperatures=(233.15, 293.15), part_points=(0.5, 1.0))
    assert cold.peukert_current(3.0, 233.15) == pytest.approx(6.0)
    assert cold.peukert_current(3.0, 263.15) == pytest.approx(4.0)
    assert cold.peukert_current(3.0, 320.0) == pytest.approx(3.0)


def test_what_stands_on_a_shelf_loses_what_its_sheet_says() -> None:
    shelf = primary(self_discharge_per_year=0.03)
    state = shelf.initial_state(1.0, 293.15)
    for _ in range(365):
        state = shelf.step(state, 0.0, 86400.0 * 365.25 / 365.0, 293.15)
    assert state.soc == pytest.approx(0.97, abs=2e-3)
    leak = SelfDischarge(0.03, 1e6)
    assert leak.lost(303.15, 1.0) == pytest.approx(2.0 * leak.lost(293.15, 1.0), rel=1e-6)
    assert leak.lost(293.15, 1e6) == pytest.approx(0.03) and leak.lost(293.15, 1e12) == pytest.approx(1.0)


def test_the_thionyl_chloride_cell_is_of_its_class() -> None:
    """400 to 500 Wh/kg, of a cell of 0.1 kg."""
    cell = load_params("parts", "saft_lsh20", PrimaryBatteryParams)
    assert 400.0 < cell.energy_capacity_wh / 0.1 < 500.0


def test_a_primary_battery_is_never_charged() -> None:
    """A source with nothing to do beside it, and a network that adds up."""
    params = PowerParams(battery=primary(), sources={"sun": IdealSource(power=200.0)}, bus=bus(load("motor", 500.0)))
    network = PowerNetwork(params)
    state, output = network.step(network.initial_state(0.5), (1.0,), (50.0,), 60.0)
    assert output.store_currents[0] == pytest.approx(0.0, abs=1e-9) and output.load_power[0] == pytest.approx(50.0)
    for _ in range(100):
        state, output = network.step(state, (1.0,), (350.0,), 600.0)
    assert imbalance(state) < 1e-9 and state.stores[0].soc < 0.5


@given(st.floats(0.0, 1.0))
def test_a_fuller_cell_of_nickel_takes_less(soc: float) -> None:
    pack = nickel(coulombic_efficiency=0.95)
    assert pack.acceptance(soc) == pytest.approx(0.95 * min((1.0 - soc) / 0.2, 1.0), abs=2e-3)
    assert pack.acceptance(min(soc + 0.1, 1.0)) <= pack.acceptance(soc)


def test_overcharge_becomes_heat() -> None:
    """A cell charged on at 5 A comes near full and no further, and all power becomes heat then."""
    pack, dt = nickel(self_discharge_per_day=0.0), 60.0
    state = pack.initial_state(0.9, 280.0)
    for _ in range(2000):
        before = state
        state = pack.step(state, -5.0, dt, 280.0)
    assert 0.98 < state.soc <= 1.0
    power = (before.energy_terminal - state.energy_terminal) / dt
    assert (state.energy_heat - before.energy_heat) / dt == pytest.approx(power, rel=0.02)


def test_a_nickel_battery_loses_a_tenth_a_day() -> None:
    pack = nickel(thermal_conductance=100.0)
    state = pack.initial_state(1.0, 293.15)
    for _ in range(24):
        state = pack.step(state, 0.0, 3600.0, 293.15)
    assert state.soc == pytest.approx(0.9, abs=1e-3)
    assert pack.pressure(state) == pytest.approx(3e5 + 0.9 * 3.7e6, rel=1e-3)
    assert NickelCadmiumParams.model_fields["kind"].default == "nickel_cadmium"


@settings(max_examples=80, deadline=None)
@given(
    which=st.sampled_from(
        [primary(), primary(1.0, self_discharge_per_year=0.5), nickel(), nickel(acceptance_knee=0.3)]
    ),
    currents=st.lists(st.floats(-8.0, 16.0), min_size=1, max_size=40),
    dt=st.sampled_from([0.02, 60.0, 600.0]),
    soc=st.floats(0.4, 0.9),
)
def test_energy_is_kept(which: BatteryParams, currents: list[float], dt: float, soc: float) -> None:
    """Chemical energy out is terminal energy, heat, and what the polarisation holds."""
    first = state = which.initial_state(soc, 290.0)
    for current in currents:
        flows = max(current, 0.0) if isinstance(which, PrimaryBatteryParams) else current
        state = which.step(state, flows if state.soc > 0.0 else 0.0, dt, 290.0)
    out = which.stored_energy(first.soc) - which.stored_energy(state.soc)
    held = 0.5 * which.capacitance * state.polarisation_voltage**2
    turned = which.stored_energy(1.0)
    assert abs(out - state.energy_terminal - state.energy_heat - held) < 1e-9 * turned
    assert which.heat_given(first, state) == pytest.approx(
        state.energy_heat - which.tables.heat_capacity * (state.temperature - 290.0), abs=1e-6
    )


def test_an_empty_pack_does_not_go_on_losing() -> None:
    for pack in (primary(self_discharge_per_year=0.9), nickel()):
        state = PackState(soc=0.0, polarisation_voltage=0.0, temperature=290.0)
        assert pack.step(state, 0.0, 1e6, 290.0).soc == 0.0


def test_all_kinds_are_registered() -> None:
    for name in ("nickel_cadmium", "nickel_hydrogen", "primary_battery"):
        assert STORES.get(name).model_fields["kind"].default == name


@pytest.mark.parametrize(
    "values",
    [
        {"peukert": 0.9},
        {"rated_hours": 0.0},
        {"part_points": (1.0, 0.5)},
        {"part_points": (1.5,)},
        {"part_temperatures": (300.0, 290.0), "part_points": (1.0, 0.9)},
        {"charge_current_limit": 4.0},
        {"acceptance_knee": 0.8},
    ],
)
def test_parameters_of_another_chemistry_are_refused(values: dict[str, object]) -> None:
    with pytest.raises(ValidationError):
        primary(**values)


def test_a_lithium_battery_is_what_it_was() -> None:
    """Its losses are its coulombic efficiency and nothing else."""
    pack = BatteryParams(**BATTERY)
    assert pack.losses(pack.initial_state(0.5), 3.0, 1.0) == (BATTERY["coulombic_efficiency"], 0.0)
