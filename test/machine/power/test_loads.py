"""The bus against bisection, Ohm's law, and the promises of the lockout."""

import copy
from math import nan

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from ideal_store import IdealStore, one_bus
from pydantic import ValidationError

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.power.bus_kernels import solve_bus
from sojourn_machine.power.loads import BusParams, BusState, LoadParams
from sojourn_machine.power.power_params import PowerParams

LOADS = (
    LoadParams(name="computer", kind="constant_power", power_w=30.0, essential=True, priority=9),
    LoadParams(
        name="heater",
        kind="resistive",
        power_w=20.0,
        voltage_nominal=28.0,
        essential=False,
        priority=1,
    ),
    LoadParams(name="drive", kind="commanded", power_w=200.0, essential=False, priority=5),
)
BUS = BusParams(loads=LOADS, lockout_voltage=21.0, lockout_reset_voltage=25.0, lockout_reset_time=2.0)
ALL_ON = (1.0, 1.0, 1.0)


def bisect(source: float, resistance: float, power: float, conductance: float, current: float) -> float:
    """Largest V with V = source - resistance (power / V + conductance V + current), by halving."""

    def excess(voltage: float) -> float:
        drawn = power / voltage + conductance * voltage + current
        return source - resistance * drawn - voltage

    # V excess is a downward parabola: its top lies between the two roots.
    low = (source - resistance * current) / (2.0 * (1.0 + resistance * conductance))
    high = 10.0 * (source + resistance * (abs(power) + abs(current)) + 1.0)
    for _ in range(200):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if excess(middle) > 0.0 else (low, middle)
    return 0.5 * (low + high)


@settings(max_examples=150, deadline=None)
@given(
    source=st.floats(5.0, 60.0),
    resistance=st.floats(1e-4, 2.0),
    part=st.floats(-1.0, 0.999),
    conductance=st.floats(0.0, 2.0),
    current=st.floats(-2.0, 2.0),
)
def test_operating_point_is_the_upper_root_found_by_bisection(
    source: float, resistance: float, part: float, conductance: float, current: float
) -> None:
    most = (source - resistance * current) ** 2 / (4.0 * resistance * (1.0 + resistance * conductance))
    power = part * most
    voltage, served = solve_bus(source, resistance, power, conductance, current)
    assert served == 1.0
    assert voltage == pytest.approx(bisect(source, resistance, power, conductance, current), rel=1e-6)


@settings(max_examples=80, deadline=None)
@given(source=st.floats(1.0, 60.0), resistance=st.floats(1e-3, 2.0), over=st.floats(1.001, 50.0))
def test_brown_out_serves_the_most_power_the_source_can_give(source: float, resistance: float, over: float) -> None:
    most = source**2 / (4.0 * resistance)
    voltage, served = solve_bus(source, resistance, over * most, 0.0, 0.0)
    assert served == pytest.approx(1.0 / over)
    assert voltage == pytest.approx(source / 2.0)
    scan = np.linspace(0.0, source, 401)
    assert np.max(scan * (source - scan) / resistance) == pytest.approx(served * over * most, rel=1e-4)


def test_ideal_source_and_dead_source() -> None:
    assert solve_bus(28.0, 0.0, 500.0, 0.3, 1.0) == (28.0, 1.0)
    assert solve_bus(0.0, 0.05, 10.0, 0.1, 0.0) == (0.0, 0.0)
    assert solve_bus(0.0, 0.05, 0.0, 0.1, 0.0) == (0.0, 1.0)


def test_power_and_current_add_up_for_mixed_loads() -> None:
    state, out = one_bus(BUS, BusState(), 30.0, 0.06, (1.0, 0.5, 0.8), (0.0, 0.0, 120.0), 0.02)
    assert not state.locked_out and not out.brownout
    assert out.voltage == pytest.approx(30.0 - 0.06 * out.store_currents[0])
    assert out.load_power == pytest.approx([30.0, 0.5 * 20.0 * (out.voltage / 28.0) ** 2, 120.0])
    assert out.load_current.sum() == pytest.approx(out.store_currents[0])
    assert out.load_power.sum() == pytest.approx(out.voltage * out.store_currents[0])


def test_the_fraction_caps_what_a_commanded_load_may_draw() -> None:
    _, out = one_bus(BUS, BusState(), 30.0, 0.06, (1.0, 0.0, 0.25), (0.0, 0.0, 150.0), 0.02)
    assert out.load_power == pytest.approx([30.0, 0.0, 50.0])


def test_returned_power_raises_the_bus_and_is_refused_by_an_open_switch() -> None:
    _, out = one_bus(BUS, BusState(), 28.0, 0.06, (1.0, 0.0, 1.0), (0.0, 0.0, -80.0), 0.02)
    assert out.store_currents[0] < 0.0 and out.voltage > 28.0
    _, out = one_bus(BUS, BusState(), 28.0, 0.06, (1.0, 0.0, 0.0), (0.0, 0.0, -80.0), 0.02)
    assert out.load_power[2] == 0.0


def test_brown_out_is_reported_and_power_balances_when_a_load_returns_power() -> None:
    extra = LoadParams(name="arm", kind="commanded", power_w=80.0, essential=True, priority=2)
    keep = [load.model_copy(update={"essential": True}) for load in LOADS]
    bus = BUS.model_copy(update={"loads": (*keep, extra)})
    _, out = one_bus(bus, BusState(), 24.0, 1.0, (1.0, 0.0, 1.0, 1.0), (0.0, 0.0, 190.0, -20.0), 0.02)
    assert out.brownout and 0.0 < out.served[0] < 1.0
    assert out.voltage == pytest.approx(12.0)
    assert out.load_power[3] == pytest.approx(-20.0)
    assert out.load_power.sum() == pytest.approx(out.voltage * out.store_currents[0])
    assert out.voltage == pytest.approx(24.0 - out.store_currents[0])


def test_lockout_sheds_all_but_essential_loads_and_waits_before_it_resets() -> None:
    state, out = one_bus(BUS, BusState(), 24.0, 0.5, ALL_ON, (0.0, 0.0, 200.0), 0.5)
    assert state.locked_out and out.locked_out[0]
    assert out.load_power == pytest.approx([30.0, 0.0, 0.0])
    state, out = one_bus(BUS, state, 25.2, 0.5, ALL_ON, (0.0, 0.0, 20.0), 0.5)
    assert out.voltage < 25.0 and state.recovered_for == 0.0
    for _ in range(4):
        state, out = one_bus(BUS, state, 28.0, 0.1, ALL_ON, (0.0, 0.0, 20.0), 0.5)
        assert out.load_power[2] == 0.0
    assert state.locked_out
    state, _ = one_bus(BUS, state, 28.0, 0.1, ALL_ON, (0.0, 0.0, 20.0), 0.5)
    _, out = one_bus(BUS, state, 28.0, 0.1, ALL_ON, (0.0, 0.0, 20.0), 0.5)
    assert not out.locked_out[0] and out.load_power[2] == pytest.approx(20.0)


def test_a_dead_battery_gives_nothing_and_no_nan() -> None:
    state, out = one_bus(BUS, BusState(), 0.0, 0.1, ALL_ON, (0.0, 0.0, 50.0), 0.02)
    assert state.locked_out and out.brownout
    assert out.voltage == 0.0 and out.store_currents[0] == 0.0
    assert np.array_equal(out.load_power, np.zeros(3))


@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        ((28.0, 0.1, (1.0, 1.0), (0.0, 0.0, 1.0), 0.02), "load fractions"),
        ((28.0, 0.1, (1.0, 1.2, 1.0), (0.0, 0.0, 1.0), 0.02), "load fractions"),
        ((28.0, 0.1, (1.0, nan, 1.0), (0.0, 0.0, 1.0), 0.02), "load fractions"),
        ((28.0, 0.1, ALL_ON, (0.0, 0.0, nan), 0.02), "load demand"),
        ((28.0, 0.1, ALL_ON, (0.0, 0.0, 1.0), 0.0), "dt"),
    ],
)
def test_bad_input_is_refused_by_name(
    arguments: tuple[float, float, tuple[float, ...], tuple[float, ...], float], name: str
) -> None:
    with pytest.raises(InvalidValueError, match=name):
        one_bus(BUS, BusState(), *arguments)


def test_bad_parameters_are_refused() -> None:
    with pytest.raises(ValidationError, match="lockout_reset_voltage"):
        BusParams(loads=LOADS, lockout_voltage=25.0, lockout_reset_voltage=25.0, lockout_reset_time=1.0)
    twice = BusParams(
        loads=(*LOADS, LOADS[2]), lockout_voltage=21.0, lockout_reset_voltage=25.0, lockout_reset_time=1.0
    )
    with pytest.raises(ValidationError, match=r"'drive'.*allowed is another name: a load of main has it"):
        PowerParams(stores={"ideal": IdealStore()}, bus=twice)
    with pytest.raises(ValidationError, match="kind"):
        LoadParams.model_validate(LOADS[0].model_dump() | {"kind": "magic"})


def test_parameters_are_values() -> None:
    assert one_bus(BUS, BusState(), 30.0, 0.06, ALL_ON, (0.0, 0.0, 0.0), 0.02)[1].served == (1.0,)
    assert copy.deepcopy(BUS) == BUS and BUS.model_copy() == BUS
