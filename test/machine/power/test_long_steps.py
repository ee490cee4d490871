"""Steps of a minute, of ten and of an hour: what a bus is given is what its members had, and comes to what short steps
come to."""

import math

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from test_network import CAPACITOR, IdealSource, bus, imbalance, load
from test_supercapacitor import BANK, WHEEL, network_of

from sojourn_config.load import load_params
from sojourn_config.scenario import load_scenario
from sojourn_machine.power.battery import BatteryParams
from sojourn_machine.power.fuel_cell import FuelCellParams
from sojourn_machine.power.heat_engine import HeatEngineParams, OttoCycle
from sojourn_machine.power.network import PowerNetwork
from sojourn_machine.power.power_params import PowerParams
from sojourn_machine.power.primary_battery import PrimaryBatteryParams
from sojourn_machine.power.sources import SourceParams
from sojourn_machine.power.stores import StoreParams

LONG = [60.0, 600.0, 3600.0]
PACK = load_scenario("flat_drive").power.all_stores["battery"]
TIGHT = BANK.model_copy(update={"leak_resistance": 1e9})
EMPTY_AT_ZERO = TIGHT.model_copy(update={"voltage_empty": 0.0})
STACK = load_params("parts", "ballard_mark_v", FuelCellParams).model_copy(update={"hydrogen": 0.004, "warm_up_s": 0.0})
ENGINE = HeatEngineParams(engine=OttoCycle(compression_ratio=10.0), heating_value=1e7, rated_w=500.0, propellant=0.1)
IDLING = ENGINE.model_copy(update={"idle_rate": 1e-4})


def charged_to(pack: StoreParams, soc: float, hours: float, dt: float) -> tuple[float, float]:
    """Charge and hottest temperature under more light than it can take [1], [K]."""
    params = PowerParams(stores={"pack": pack}, sources={"sun": IdealSource(power=300.0)}, bus=bus(load("motor", 1.0)))
    network = PowerNetwork(params)
    state, hottest = network.initial_state(soc), 0.0
    for _ in range(round(hours * 3600.0 / dt)):
        state, _ = network.step(state, (1.0,), (0.0,), dt)
        hottest = max(hottest, state.stores[0].temperature)
    return state.stores[0].soc, hottest


@pytest.mark.parametrize("dt", LONG)
def test_a_lone_battery_is_charged_to_full_and_no_further(dt: float) -> None:
    """It took the current of the step's start for all of the step: what it could not store had made 64 C of it."""
    charge, hottest = charged_to(PACK, 0.3, 12.0, dt)
    expected, warm = charged_to(PACK, 0.3, 12.0, 10.0)
    assert charge == pytest.approx(expected, abs=0.01) and charge <= 1.0 + 1e-9
    assert hottest - PACK.initial_state(0.3).temperature < 1.2 * (warm - PACK.initial_state(0.3).temperature) + 0.5


@settings(max_examples=60, deadline=None)
@given(
    soc=st.floats(0.0, 1.0),
    powers=st.lists(st.floats(-100.0, 400.0), min_size=1, max_size=12),
    dt=st.sampled_from(LONG),
    light=st.sampled_from([0.0, 150.0]),
)
@example(soc=1.0, powers=[1.9e-31], dt=60.0, light=0.0)
@example(soc=1.0, powers=[9.7e-22], dt=60.0, light=0.0)
@example(soc=5e-324, powers=[5e-324], dt=60.0, light=0.0)
@example(soc=5.960464477539063e-08, powers=[151.0], dt=3600.0, light=150.0)
@example(soc=0.34375, powers=[157.0, 151.0, 151.0, 151.0, 151.0, 150.0], dt=600.0, light=150.0)
@example(soc=2.2250738585e-313, powers=[150.0], dt=60.0, light=150.0)
def test_a_lone_bank_gives_its_bus_the_energy_that_it_loses(
    soc: float, powers: list[float], dt: float, light: float
) -> None:
    """However long the steps: no charge below empty, no voltage below 0, none over the ceiling of what charges it."""
    bank = EMPTY_AT_ZERO
    params = PowerParams(stores={"b": bank}, sources={"sun": IdealSource(power=light)}, bus=bus(load("motor", 500.0)))
    network = PowerNetwork(params)
    state, rounded = network.initial_state(soc), 0.0
    for power in powers:
        before = state.stores[0].soc
        state, output = network.step(state, (1.0,), (power,), dt)
        # at a microvolt the load's current is 1e8 A, and the bank's the difference of two of that size
        rounded += 4.0 * np.finfo(float).eps * float(output.load_current.sum()) * dt / bank.charge_capacity
        assert output.voltage >= 0.0 and state.stores[0].soc >= -1e-9 - rounded
        assert power < 0.0 or state.stores[0].soc <= max(before, 1.0) + 1e-9
    lost = bank.stored_energy(soc) - bank.stored_energy(state.stores[0].soc) - state.stores[0].energy_heat
    turned = sum(abs(power) * dt for power in powers) + bank.stored_energy(1.0)
    assert lost == pytest.approx(state.stores[0].energy_terminal, abs=1e-6 * turned)
    assert lost == pytest.approx(state.energy.stores, abs=1e-6 * turned)
    # what changes no digit of the energy that is stored (1e-9 of 1e-7 of it) is not seen to go
    assert imbalance(state, 1e-7 * turned) < 1e-9 or turned < 1e-6


@pytest.mark.parametrize("store", [TIGHT, CAPACITOR, WHEEL, PACK], ids=["to_12_volts", "to_22_volts", "wheel", "pack"])
@pytest.mark.parametrize("dt", LONG)
def test_no_store_gives_more_than_it_has_in_the_step_that_empties_it(store: StoreParams, dt: float) -> None:
    network = network_of({"store": store})
    state, given_out = network.initial_state(1.0), 0.0
    for _ in range(round(36000.0 / dt)):
        state, output = network.step(state, (1.0,), (120.0,), dt)
        given_out += float(output.load_power.sum()) * dt
        assert state.stores[0].soc > -0.02  # what friction and leak took
        if state.stores[0].soc <= 0.0:
            break
    assert state.stores[0].soc <= 0.0
    assert 0.8 * store.stored_energy(1.0) < given_out <= store.stored_energy(1.0) * (1.0 + 1e-9)


@pytest.mark.parametrize("dt", [0.02, 60.0, 3600.0])
def test_a_bank_that_leaks_fast_leaks_no_more_than_it_has(dt: float) -> None:
    leaking = EMPTY_AT_ZERO.model_copy(update={"leak_resistance": 0.01})
    state = leaking.initial_state(1.0)
    for _ in range(500):
        state = leaking.step(state, 0.0, dt)
        assert state.soc >= 0.0
    assert state.energy_heat == pytest.approx(leaking.stored_energy(1.0), rel=1e-3)


@pytest.mark.parametrize("dt", LONG)
def test_a_battery_of_peukert_gives_no_more_than_its_law(dt: float) -> None:
    """t = H (C / (I H))^k: emptied at 2.5 times its rated current it gives 2.5^(1 - k) of its charge."""
    values = PACK.model_dump(exclude={"kind", "coulombic_efficiency", "charge_current_limit", "temperature_charge_min"})
    pack = PrimaryBatteryParams(**values | {"rated_hours": 5.0, "peukert": 1.2, "age": None})
    watts = 2.5 * pack.charge_capacity / 18000.0 * pack.open_circuit_voltage(0.5)
    network = network_of({"pack": pack})
    state, drawn = network.initial_state(1.0), 0.0
    while state.stores[0].soc > 0.0:
        state, output = network.step(state, (1.0,), (watts,), dt)
        drawn += output.store_currents[0] * dt
    assert state.stores[0].soc > -1e-6
    assert drawn / pack.charge_capacity == pytest.approx(2.5**-0.2, rel=0.05)


def energy_of(source: SourceParams, dt: float) -> float:
    """That 500 W are given until nothing is left [J]."""
    network = PowerNetwork(
        PowerParams(sources={"it": source}, bus=bus(load("lamp", 500.0, "constant_power"), voltage=28.0))
    )
    state = network.initial_state(1.0)
    for _ in range(max(round(7200.0 / dt), 2)):
        state, _ = network.step(state, (1.0,), (0.0,), dt)
    return state.energy.sources


@pytest.mark.parametrize(
    ("source", "near"), [(STACK, 1.015), (ENGINE, 1.0), (IDLING, 1.0)], ids=["cell", "engine", "idles"]
)
def test_a_tank_gives_no_more_in_the_step_that_empties_it(source: SourceParams, near: float) -> None:
    """A stack at less than its most power makes a little more of its hydrogen, an engine does not."""
    exact = energy_of(source, 1.0)
    for dt in (60.0, 600.0):
        assert energy_of(source, dt) == pytest.approx(exact, rel=near - 1.0 + 2e-3)
    assert energy_of(source, 3600.0) < 1.2 * exact


def test_what_is_left_of_a_tank_is_nothing() -> None:
    for source, left in ((STACK, "hydrogen"), (ENGINE, "propellant"), (IDLING, "propellant")):
        state = source.initial_state()
        power = min(source.point(state).power, source.lasting(state, 3600.0))
        after = source.step(state, power, 3600.0)
        assert 0.0 < power < 500.0 and getattr(after, left) == pytest.approx(0.0, abs=1e-9)
        assert after.energy_heat >= 0.0


@pytest.mark.parametrize("dt", LONG)
def test_two_stores_are_charged_with_all_that_they_can_take(dt: float) -> None:
    """The ceiling of a limited current stood as if the step were short: it let ten times less flow in a long one."""
    pack = PACK.model_copy(update={"charge_current_limit": 1.0})
    assert isinstance(pack, BatteryParams)
    params = PowerParams(
        stores={"one": pack, "two": pack}, sources={"sun": IdealSource(power=2000.0)}, bus=bus(load("motor", 1.0))
    )
    network = PowerNetwork(params)
    state = network.initial_state(0.3)
    state, output = network.step(state, (1.0,), (0.0,), dt)
    assert output.store_currents == pytest.approx((-pack.cells_parallel,) * 2, rel=1e-6)


def test_a_short_period_has_the_force_of_its_start() -> None:
    state = BANK.initial_state(0.5)
    assert BANK.over(state, 0.02, True)[:5] == BANK.point(state)[:5]
    assert math.isclose(BANK.over(state, 0.02, False).resistance, BANK.resistance + 0.02 / BANK.capacitance)
