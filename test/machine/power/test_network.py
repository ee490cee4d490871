"""The power network: its balance, against bisection, and what each kind of member promises."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from ideal_store import IdealState, IdealStore
from pydantic import ConfigDict, ValidationError

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.evolution import replace
from sojourn_machine.power.battery import BatteryParams
from sojourn_machine.power.bus_kernels import floating_voltage, solve_bus
from sojourn_machine.power.converters import ConverterParams
from sojourn_machine.power.loads import BusParams, LoadParams
from sojourn_machine.power.network import PowerNetwork
from sojourn_machine.power.network_state import NetworkOutput, NetworkState
from sojourn_machine.power.power_params import PowerParams
from sojourn_machine.power.sources import SourceParams, SourcePoint
from sojourn_machine.power.stores import STORES, StoreParams
from sojourn_machine.power.supercapacitor import SupercapacitorParams
from sojourn_machine.power.surroundings import DARK, PowerSurroundings

DT = 0.02
NO_LOCKOUT = {"lockout_voltage": 0.0, "lockout_reset_voltage": 1.0, "lockout_reset_time": 1.0}


class IdealSource(SourceParams):
    """Gives what its parameters say."""

    kind: str = "ideal"
    power: float
    current: float = math.inf
    model_config = ConfigDict(allow_inf_nan=True)

    def initial_state(self) -> float:
        """Energy given [J]."""
        return 0.0

    def point(self, state: float, surroundings: PowerSurroundings = DARK) -> SourcePoint:
        """Always the same."""
        return SourcePoint(self.power, self.current)

    def step(self, state: float, power: float, dt: float, surroundings: PowerSurroundings = DARK) -> float:
        """Counts."""
        return state + power * dt


def load(name: str, power: float, kind: Any = "commanded", **more: Any) -> LoadParams:
    return LoadParams(name=name, kind=kind, power_w=power, **{"essential": False, "priority": 1, **more})


def bus(*loads: LoadParams, voltage: float | None = None, **lockout: float) -> BusParams:
    return BusParams(loads=loads, voltage=voltage, **(NO_LOCKOUT | lockout))


def ideal(**more: Any) -> IdealStore:
    return IdealStore(**more)


def stepped(
    params: PowerParams, demand: tuple[float, ...], stores: tuple[IdealState, ...] = ()
) -> tuple[NetworkState, NetworkOutput]:
    network = PowerNetwork(params)
    state = network.initial_state(0.5)
    if stores:
        state = replace(state, stores=stores)
    return network.step(state, (1.0,) * len(params.loads), demand, DT)


def imbalance(state: NetworkState, least: float = 1e-30) -> float:
    """Energy that is missing, of the largest term, or of `least` [J] where that is more [1]."""
    energy = state.energy
    terms = energy.sources, energy.stores, -energy.loads, -energy.converters, -energy.shunts
    return abs(sum(terms)) / max(*map(abs, terms), least)


STORE_STATES = st.builds(IdealState, source=st.floats(5.0, 40.0), resistance=st.floats(1e-3, 1.0))
STORE_KINDS = st.builds(
    IdealStore,
    ceiling=st.floats(20.0, 45.0),
    discharges=st.booleans(),
    charges=st.booleans(),
    bus=st.sampled_from(["main", "side"]),
)
SOURCES = st.builds(
    IdealSource,
    power=st.floats(0.0, 200.0),
    current=st.one_of(st.just(math.inf), st.floats(0.1, 10.0)),
    bus=st.sampled_from(["main", "side"]),
)


@settings(max_examples=300, deadline=None)
@given(
    stores=st.lists(st.tuples(STORE_KINDS, STORE_STATES), min_size=0, max_size=4),
    sources=st.lists(SOURCES, max_size=3),
    powers=st.tuples(*(st.floats(-60.0, 300.0) for _ in range(2))),
    fixed=st.tuples(st.floats(1.0, 100.0), st.floats(1.0, 100.0)),
    converter=st.builds(
        ConverterParams,
        input=st.just("main"),
        output=st.just("side"),
        rating_w=st.floats(1.0, 300.0),
        efficiency=st.floats(0.5, 1.0),
        ohmic_loss=st.sampled_from([0.0, 0.02, 0.1]),
        standby_w=st.floats(0.0, 5.0),
        both_ways=st.booleans(),
    ),
    lockout=st.floats(0.0, 20.0),
    held=st.floats(5.0, 40.0),
)
def test_energy_is_conserved_whatever_is_on_the_buses(
    stores: list[tuple[IdealStore, IdealState]],
    sources: list[IdealSource],
    powers: tuple[float, float],
    fixed: tuple[float, float],
    converter: ConverterParams,
    lockout: float,
    held: float,
) -> None:
    params = PowerParams(
        stores={"keel": ideal(), **{f"store_{k}": kind for k, (kind, _) in enumerate(stores)}},
        sources={f"source_{k}": kind for k, kind in enumerate(sources)},
        converters={"converter": converter},
        bus=bus(
            load("motor", 300.0), load("heater", fixed[0], "resistive"),
            lockout_voltage=lockout, lockout_reset_voltage=lockout + 1.0,
        ),
        buses={"side": bus(load("arm", 300.0), load("lamp", fixed[1], "resistive"), voltage=held)},
    )  # fmt: skip
    state, output = stepped(params, (powers[0], 0.0, powers[1], 0.0), (IdealState(28.0, 0.1), *(s for _, s in stores)))
    assert imbalance(state) < 1e-9
    assert all(math.isfinite(value) for value in (*output.voltages, *output.store_currents, *output.source_powers))
    assert all(0.0 <= served <= 1.0 + 1e-12 for served in output.served)
    assert state.energy.shunts >= 0.0 and state.energy.converters >= -1e-9
    for current, kind in zip(output.store_currents, params.all_stores.values(), strict=True):
        assert (current <= 1e-9 or kind.discharges) and (current >= -1e-9 or kind.charges)
    for power, (kind, place) in zip(
        output.source_powers, ((k, 0 if k.bus == "main" else 1) for k in sources), strict=True
    ):
        assert 0.0 <= power <= min(kind.power, kind.current * output.voltages[place]) * (1.0 + 1e-12)


@pytest.mark.parametrize("power", [1e-308, 1e-14])
def test_a_store_that_may_not_discharge_gives_nothing_to_a_dead_bus(power: float) -> None:
    """What is left of the sum of the others is rounding, and the voltage that it was divided by next to none."""
    params = PowerParams(
        stores={"keel": ideal(), "spare": ideal(discharges=False, charges=False, bus="side")},
        sources={"speck": IdealSource(power=power, current=2.0, bus="side")},
        converters={"converter": ConverterParams(input="main", output="side", rating_w=1.0, efficiency=1.0)},
        bus=bus(load("motor", 300.0)),
        buses={"side": bus(load("arm", 300.0), load("lamp", 1.0, "resistive"), voltage=5.0)},
    )
    state, output = stepped(params, (0.0, 2.0, 0.0), (IdealState(28.0, 0.1), IdealState(5.0, 1.0)))
    assert output.store_currents[1] == 0.0
    assert imbalance(state) < 1e-9


def balance(stores: np.ndarray, sources: np.ndarray, power: float, conductance: float, voltage: float) -> float:
    """Power that the stores and sources give at a voltage, less what the loads ask [W]."""
    given = 0.0
    for force, resistance, _, discharges, charges, largest in stores:
        current = min((force - voltage) / resistance, largest)
        given += voltage * current if (discharges if current > 0.0 else charges) else 0.0
    given += sum(min(most, current * voltage) for most, current in sources)
    return given - power - conductance * voltage**2


@settings(max_examples=200, deadline=None)
@given(
    rows=st.lists(
        st.tuples(
            st.floats(5.0, 40.0),
            st.floats(1e-2, 1.0),
            st.booleans(),
            st.booleans(),
            st.one_of(st.just(math.inf), st.floats(0.1, 50.0)),
        ),
        min_size=1,
        max_size=4,
    ),
    sources=st.lists(st.tuples(st.floats(1.0, 100.0), st.floats(0.1, 10.0)), max_size=3),
    power=st.floats(0.0, 400.0),
    conductance=st.floats(0.0, 0.5),
)
def test_the_voltage_is_the_highest_at_which_all_powers_balance(
    rows: list[tuple[float, float, bool, bool, float]],
    sources: list[tuple[float, float]],
    power: float,
    conductance: float,
) -> None:
    first = (40.0, 0.5, 0.0, 1.0, 1.0, math.inf)
    stores = np.array([first, *((e, r, 0.0, d, c, largest) for e, r, d, c, largest in rows)])
    table = np.array(sources).reshape(-1, 2)
    voltage, got = floating_voltage(stores, table, power, conductance)
    scan = np.linspace(1e-3, 60.0, 6001)
    surplus = np.array([balance(stores, table, power, conductance, each) for each in scan])
    if got < power:  # browned out: nowhere is there enough
        assert surplus.max() < 1e-6
        assert balance(stores, table, got, conductance, voltage) == pytest.approx(0.0, abs=1e-6 * (1.0 + power))
        assert surplus.max() <= got - power + 1e-6 * (1.0 + power)
    else:
        assert balance(stores, table, power, conductance, voltage) == pytest.approx(0.0, abs=1e-7 * (1.0 + power))
        assert surplus[scan > voltage * (1.0 + 1e-9)].max(initial=-1.0) <= 0.0


def test_two_stores_share_the_current_by_their_resistances() -> None:
    params = PowerParams(stores={"one": ideal(), "two": ideal()}, bus=bus(load("motor", 200.0)))
    _, output = stepped(params, (120.0,), (IdealState(28.0, 0.1), IdealState(28.0, 0.3)))
    first, second = output.store_currents
    assert first == pytest.approx(3.0 * second)
    assert output.voltage * (first + second) == pytest.approx(120.0)


def test_a_lower_store_is_charged_by_a_higher_one_unless_a_diode_forbids_it() -> None:
    states = (IdealState(30.0, 0.1), IdealState(26.0, 0.1))
    for charges in (True, False):
        params = PowerParams(stores={"one": ideal(), "two": ideal(charges=charges)}, bus=bus(load("motor", 200.0)))
        _, output = stepped(params, (10.0,), states)
        assert output.store_currents[1] == pytest.approx(-19.8, abs=0.2) if charges else output.store_currents[1] == 0.0


def test_a_source_feeds_the_loads_then_charges_up_to_the_ceiling_and_no_further() -> None:
    for power, current, voltage in ((60.0, -(60.0 - 40.0) / 28.07, 28.07), (400.0, -10.0, 29.0)):
        params = PowerParams(
            stores={"one": ideal(ceiling=29.0)},
            sources={"sun": IdealSource(power=power)},
            bus=bus(load("motor", 200.0)),
        )
        _, output = stepped(params, (40.0,), (IdealState(28.0, 0.1),))
        assert output.voltage == pytest.approx(voltage, abs=0.01)
        assert output.store_currents[0] == pytest.approx(current, rel=0.01)
        assert output.source_powers[0] == pytest.approx(min(power, 40.0 + 29.0 * 10.0), rel=1e-9)


def test_the_first_source_is_used_before_the_next() -> None:
    params = PowerParams(
        stores={"one": ideal(ceiling=28.0)},
        sources={"first": IdealSource(power=30.0), "second": IdealSource(power=100.0)},
        bus=bus(load("motor", 200.0)),
    )
    _, output = stepped(params, (50.0,), (IdealState(28.0, 0.1),))
    assert output.source_powers == pytest.approx((30.0, 20.0))
    assert output.store_currents[0] == pytest.approx(0.0, abs=1e-12)


def test_sources_alone_hold_their_bus_and_brown_out_beyond_what_they_can() -> None:
    for asked, voltage, served in ((80.0, 12.0, 1.0), (150.0, 12.0, 100.0 / 150.0)):
        params = PowerParams(sources={"sun": IdealSource(power=100.0)}, bus=bus(load("motor", 200.0), voltage=12.0))
        state, output = stepped(params, (asked,))
        assert (output.voltage, output.served[0]) == (pytest.approx(voltage), pytest.approx(served))
        assert output.load_power[0] == pytest.approx(min(asked, 100.0)) and imbalance(state) < 1e-12


def test_power_that_nothing_takes_goes_into_the_shunt() -> None:
    params = PowerParams(stores={"cell": ideal(charges=False)}, bus=bus(load("motor", 200.0)))
    state, output = stepped(params, (-50.0,), (IdealState(28.0, 0.1),))
    assert output.voltage == pytest.approx(28.0) and output.store_currents == (0.0,)
    assert state.energy.shunts == pytest.approx(50.0 * DT)


def side_bus(**converter: Any) -> PowerParams:
    return PowerParams(
        stores={"one": ideal()},
        converters={"down": ConverterParams(**({"output": "side", "rating_w": 100.0, "efficiency": 0.9} | converter))},
        bus=bus(load("motor", 200.0)),
        buses={"side": bus(load("lamp", 400.0), voltage=12.0)},
    )


def test_a_converter_holds_its_bus_with_its_losses_and_up_to_its_rating() -> None:
    state, output = stepped(side_bus(standby_w=2.0), (0.0, 45.0))
    assert output.voltages[1] == 12.0 and output.converter_powers == (pytest.approx(45.0),)
    assert output.voltages[0] * output.store_currents[0] == pytest.approx(45.0 / 0.9 + 2.0)
    assert state.energy.converters == pytest.approx((45.0 / 0.9 + 2.0 - 45.0) * DT)
    _, output = stepped(side_bus(), (0.0, 250.0))
    assert output.served == (1.0, pytest.approx(0.4)) and output.load_power[1] == pytest.approx(100.0)


@given(st.floats(0.0, 0.3), st.floats(0.6, 1.0), st.floats(0.1, 5.0), st.floats(0.0, 100.0))
def test_what_a_converter_gives_is_what_it_draws_for_it(q: float, eff: float, standby: float, power: float) -> None:
    """Both ways through its losses; best where the constant and the ohmic loss are equal."""
    one = ConverterParams(output="side", rating_w=100.0, efficiency=eff, ohmic_loss=q, standby_w=standby)
    assert one.given(one.drawn(power)) == pytest.approx(power, abs=1e-9)
    assert one.drawn(power) >= power + standby - 1e-12
    if q > 1e-3:
        best = math.sqrt(standby * 100.0 / q)
        assert best / one.drawn(best) >= max(p / one.drawn(p) for p in (0.9 * best, 1.1 * best))


def test_a_converter_gives_back_only_where_it_can() -> None:
    _, output = stepped(side_bus(both_ways=True), (0.0, -40.0))
    assert output.voltages[0] * output.store_currents[0] == pytest.approx(-36.0)
    state, output = stepped(side_bus(), (0.0, -40.0))
    assert output.store_currents[0] == pytest.approx(0.0) and state.energy.shunts == pytest.approx(40.0 * DT)


def test_motors_lift_a_bus_whose_store_has_no_force() -> None:
    """E = 0: V (V - E) / R = P, so V = sqrt(R P). It stayed at 0 V, and what the motors returned was nowhere."""
    params = PowerParams(stores={"one": ideal(discharges=False)}, bus=bus(load("motor", 200.0)))
    state, output = stepped(params, (-40.0,), (IdealState(0.0, 0.1),))
    assert output.voltage == pytest.approx(2.0) and output.load_power[0] == -40.0
    assert output.store_currents[0] == pytest.approx(-20.0) and imbalance(state) < 1e-12


@pytest.mark.parametrize("returned", [0.0, 5.0, 45.0 / 0.9, 80.0])
def test_a_converter_gives_nothing_of_a_bus_without_power(returned: float) -> None:
    """What it gave from a bus at 0 V was booked as a loss below nothing."""
    params = side_bus()
    state, output = stepped(params, (-returned, 45.0), (IdealState(0.0, 0.1),))
    assert imbalance(state) < 1e-9 and state.energy.converters >= -1e-9
    fed = returned - 45.0 / 0.9 > 0.0
    assert output.load_power[1] == pytest.approx(45.0 if fed else 0.9 * returned if output.voltage > 0.0 else 0.0)


@settings(max_examples=200, deadline=None)
@given(
    source=st.floats(0.0, 40.0),
    resistance=st.floats(1e-3, 1.0),
    power=st.floats(-500.0, -1e-3),
    conductance=st.floats(0.0, 2.0),
)
def test_what_is_returned_is_kept_at_any_force(
    source: float, resistance: float, power: float, conductance: float
) -> None:
    voltage, served = solve_bus(source, resistance, power, conductance, 0.0)
    assert served == 1.0 and voltage > 0.0
    left = (source - voltage) / resistance * voltage - power - conductance * voltage**2
    assert left == pytest.approx(0.0, abs=1e-9 * (1.0 + voltage**2 / resistance))


def test_a_brown_out_of_the_feeding_bus_reaches_the_fed_one() -> None:
    params = side_bus(rating_w=1000.0, efficiency=0.8)
    state, output = stepped(params, (200.0, 400.0), (IdealState(28.0, 1.0),))
    assert output.served[0] < 1.0
    assert output.voltages[0] == pytest.approx(14.0)
    asked = 200.0 + 400.0 / 0.8
    assert output.load_power == pytest.approx([200.0 * 196.0 / asked, 400.0 * 196.0 / asked])
    assert imbalance(state) < 1e-12


BATTERY: dict[str, Any] = {
    "name": "cell", "cells_series": 8, "cells_parallel": 1, "capacity_ah": 8.0, "soc_points": (0.0, 1.0),
    "ocv_points": (3.0, 4.1), "resistance_temperatures": (290.0,), "resistance_ohmic": (0.01,),
    "resistance_polarisation": (0.005,), "capacitance_polarisation": 6000.0, "coulombic_efficiency": 1.0,
    "charge_current_limit": 4.0, "discharge_current_limit": 16.0, "heat_capacity": 300.0, "thermal_conductance": 0.1,
    "temperature_surroundings": 290.0, "temperature_discharge_min": 253.0, "temperature_charge_min": 273.0,
    "temperature_max": 330.0,
}  # fmt: skip
CAPACITOR = SupercapacitorParams(
    capacitance=150.0, resistance=0.02, leak_resistance=5000.0, voltage_empty=22.0, voltage_full=33.0,
    current_limit=100.0, temperature_surroundings=290.0,
)  # fmt: skip


@settings(max_examples=40, deadline=None)
@given(soc=st.floats(0.1, 0.9), demand=st.lists(st.floats(-50.0, 400.0), min_size=5, max_size=20))
def test_battery_capacitor_and_source_keep_their_energy(soc: float, demand: list[float]) -> None:
    """Buses to rounding; the stores' own accounts within what their voltages move in a period."""
    params = PowerParams(
        battery=BatteryParams(**BATTERY),
        stores={"bank": CAPACITOR},
        sources={"sun": IdealSource(power=110.0)},
        bus=bus(load("motor", 500.0)),
    )
    network = PowerNetwork(params)
    state = network.initial_state(soc)
    bank = state.stores[1]
    for power in demand:
        state, _ = network.step(state, (1.0,), (power,), DT)
    assert imbalance(state) < 1e-9
    after: Any = state.stores
    terminal = after[0].energy_terminal + after[1].energy_terminal
    turned = abs(after[0].energy_terminal) + abs(after[1].energy_terminal) + 1.0
    assert abs(terminal - state.energy.stores) < 1e-3 * turned
    held = CAPACITOR.stored_energy(bank.soc) - CAPACITOR.stored_energy(after[1].soc)
    assert held == pytest.approx(
        after[1].energy_terminal + after[1].energy_heat, abs=1e-7 * CAPACITOR.stored_energy(1.0)
    )


def test_an_empty_battery_gives_nothing_and_takes_charge_from_a_source() -> None:
    params = PowerParams(
        battery=BatteryParams(**BATTERY), sources={"sun": IdealSource(power=60.0)}, bus=bus(load("motor", 500.0))
    )
    network = PowerNetwork(params)
    state, output = network.step(network.initial_state(0.0), (1.0,), (20.0,), DT)
    assert output.load_power[0] == pytest.approx(20.0) and output.store_currents[0] == pytest.approx(
        -40.0 / 24.1, rel=0.01
    )
    assert state.stores[0].soc > 0.0
    _, output = network.step(network.initial_state(0.0), (1.0,), (90.0,), DT)
    assert output.served[0] < 1.0 and output.store_currents[0] <= 0.0 and output.load_power[0] == pytest.approx(60.0)


def test_a_cold_battery_is_not_charged_by_a_source() -> None:
    cold = BatteryParams(**BATTERY | {"temperature_surroundings": 260.0})
    params = PowerParams(battery=cold, sources={"sun": IdealSource(power=60.0)}, bus=bus(load("motor", 500.0)))
    _, output = stepped(params, (20.0,))
    assert output.source_powers[0] == pytest.approx(20.0) and output.store_currents[0] == pytest.approx(0.0, abs=1e-9)


def test_kinds_are_found_by_their_names() -> None:
    assert {"battery", "flywheel", "regenerative_fuel_cell", "supercapacitor"} <= set(STORES.names())
    for name in STORES.names():
        assert issubclass(STORES.get(name), StoreParams) and STORES.get(name).model_fields["kind"].default == name


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"stores": {"x": {"kind": "batery"}}}, "batery"),
        ({"stores": {"x": ideal(bus="mian")}}, "mian"),
        ({"stores": {}}, "a store, a source or the output of a converter"),
        ({"sources": {"one": IdealSource(power=1.0)}}, "stores has it"),
        ({"stores": {"one": ideal(), "motor": ideal()}}, "stores has it"),
        ({"buses": {"side": bus(load("lamp", 1.0))}}, "a store, a source or the output of a converter"),
        ({"buses": {"side": bus(load("lamp", 1.0)), "b": bus()}, "converters": {
            "c": ConverterParams(input="b", output="side", rating_w=1.0, efficiency=1.0),
            "d": ConverterParams(input="side", output="b", rating_w=1.0, efficiency=1.0)}}, "side <- b <- side"),
        ({"buses": {"side": bus(load("lamp", 1.0))}, "converters": {
            "c": ConverterParams(output="side", rating_w=1.0, efficiency=1.0)}}, "its converter holds it"),
        ({"bus": bus()}, "at least one load"),
        ({"stores": {"one two": ideal()}}, "letters, digits and underscores"),
    ],
)  # fmt: skip
def test_what_does_not_fit_together_is_refused_in_words(changes: dict[str, Any], words: str) -> None:
    good: dict[str, Any] = {"stores": {"one": ideal()}, "bus": bus(load("motor", 10.0))}
    with pytest.raises((ValidationError, InvalidValueError)) as told:
        PowerParams(**(good | changes))
    assert words in str(told.value)


def test_a_load_that_nothing_can_feed_is_named() -> None:
    params = PowerParams(sources={"sun": IdealSource(power=50.0)}, bus=bus(load("motor", 60.0), voltage=12.0))
    ((path, value, allowed),) = params.load_problems()
    assert path == ("bus", "loads", 0, "power_w") and value == 60.0 and "50 W" in allowed


def test_a_load_behind_a_converter_gets_no_more_than_what_is_before_it() -> None:
    """A converter rated for 60 kW made 50 kW of a battery seem enough for any load."""
    far = bus(load("drill", 50.0), load("lamp", 45.0), voltage=5.0)
    converter = ConverterParams(output="far", rating_w=1000.0, efficiency=0.98, standby_w=1.0)
    fed: dict[str, Any] = {"buses": {"far": far}, "converters": {"down": converter}}
    near = bus(load("motor", 10.0), voltage=12.0)
    params = PowerParams(sources={"sun": IdealSource(power=50.0)}, bus=near, **fed)
    assert params.most_power("far") == pytest.approx(0.98 * 49.0)
    ((path, value, allowed),) = params.load_problems()
    assert path == ("buses", "far", "loads", 0, "power_w") and value == 50.0 and "48.02 W" in allowed
    assert not list(PowerParams(stores={"one": ideal()}, bus=bus(load("motor", 10.0)), **fed).load_problems())


def test_a_converter_that_goes_both_ways_feeds_its_input() -> None:
    far = bus(load("lamp", 5.0), voltage=5.0)
    converter = ConverterParams(output="far", rating_w=30.0, efficiency=0.9, both_ways=True)
    battery = IdealSource(power=100.0, bus="far")
    near = bus(load("motor", 60.0), voltage=12.0)
    params = PowerParams(
        sources={"sun": IdealSource(power=40.0), "far_one": battery},
        bus=near,
        buses={"far": far},
        converters={"down": converter},
    )
    assert params.most_power("main") == pytest.approx(40.0 + 30.0)
    assert params.most_power("far") == pytest.approx(100.0 + 30.0)
    assert not list(params.load_problems())
