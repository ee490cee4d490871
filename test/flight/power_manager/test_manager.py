"""The power manager: charge estimate against closed forms, and what it promises about loads."""

from dataclasses import replace
from math import exp, inf, isinf, nan

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from sojourn_flight.power_manager import law as manager
from sojourn_flight.power_manager.law import PowerManagerInput, PowerManagerOutput, PowerManagerState
from sojourn_flight.power_manager.params import PowerLawParams, PowerManagerParams
from sojourn_flight.power_manager.reading import StoreReading
from sojourn_flight.power_manager.requests import parse_switches
from sojourn_machine.errors import InvalidValueError, UnknownNameError
from sojourn_machine.power import battery
from sojourn_machine.power.battery import BatteryParams
from sojourn_machine.power.bus_kernels import solve_bus
from sojourn_machine.power.loads import BusParams, LoadParams
from sojourn_machine.power.power_params import PowerParams

PACK = BatteryParams(
    name="pack",
    cells_series=8,
    cells_parallel=2,
    capacity_ah=8.0,
    soc_points=(0.0, 0.1, 0.5, 1.0),
    ocv_points=(2.85, 3.33, 3.69, 4.18),
    resistance_temperatures=(298.15,),
    resistance_ohmic=(0.0095,),
    resistance_polarisation=(0.005,),
    capacitance_polarisation=6000.0,
    coulombic_efficiency=0.98,
    charge_current_limit=4.0,
    discharge_current_limit=16.0,
    heat_capacity=320.0,
    thermal_conductance=0.5,
    temperature_surroundings=298.15,
    temperature_discharge_min=253.15,
    temperature_charge_min=273.15,
    temperature_max=303.15,
)
LOADS = (
    LoadParams(name="computer", kind="constant_power", power_w=30.0, essential=True, priority=0),
    LoadParams(name="drive", kind="commanded", power_w=200.0, essential=False, priority=50),
    LoadParams(name="arm", kind="commanded", power_w=80.0, essential=False, priority=40),
    LoadParams(name="camera", kind="constant_power", power_w=9.0, essential=False, priority=40),
    LoadParams(name="heater", kind="resistive", power_w=15.0, essential=False, priority=10),
)
LAW = PowerLawParams(
    rest_current=3.2,
    rest_time=300.0,
    correction_time_constant=200.0,
    filter_time_constant=2.0,
    shed_soc_first=0.3,
    shed_soc_last=0.1,
    shed_soc_hysteresis=0.04,
    shed_voltage=25.0,
    shed_voltage_hysteresis=1.0,
    shed_interval=5.0,
    restore_interval=30.0,
    derate_start_voltage=27.0,
    derate_stop_voltage=25.0,
    derate_time_constant=0.4,
    recovery_rate=0.1,
    load_limits={"drive": 200.0, "arm": 60.0},
)
BUS = BusParams(loads=LOADS, lockout_voltage=20.0, lockout_reset_voltage=24.0, lockout_reset_time=10.0)
PARAMS = PowerManagerParams(power=PowerParams(battery=PACK, bus=BUS), law=LAW, derated=("drive",))


def telemetry(voltage: float = 30.0, current: float = 2.0, temperature: float = 298.15) -> PowerManagerInput:
    return PowerManagerInput((StoreReading(voltage, current, temperature),))


def charged(state: PowerManagerState, soc: float) -> PowerManagerState:
    return replace(state, stores=(replace(state.stores[0], soc=soc),))


def run(
    state: PowerManagerState, inputs: PowerManagerInput, dt: float, steps: int
) -> tuple[PowerManagerState, PowerManagerOutput]:
    for _ in range(steps):
        state, output = manager.step(PARAMS, state, inputs, dt)
    return state, output


def modes(output: PowerManagerOutput) -> dict[str, str]:
    return {switch.name: switch.mode for switch in output.switches}


@pytest.mark.parametrize(("current", "efficiency"), [(8.0, 1.0), (-8.0, 0.98)])
def test_coulomb_counting_is_the_closed_form(current: float, efficiency: float) -> None:
    _, output = run(manager.initial_state(PARAMS, 0.5), telemetry(current=current), 1.0, 900)
    assert output.soc == pytest.approx(0.5 - efficiency * current * 900.0 / (16.0 * 3600.0))
    assert not output.correcting


def test_counting_follows_the_battery_it_counts() -> None:
    cell, state = battery.initial_state(PACK, 0.9), manager.initial_state(PARAMS, 0.9)
    for k in range(1200):
        current = 10.0 if k % 90 < 60 else -5.0
        voltage = battery.terminal_voltage(PACK, cell, current)
        cell = battery.step(PACK, cell, current, 1.0)
        state, output = manager.step(PARAMS, state, telemetry(voltage, current), 1.0)
    assert output.soc == pytest.approx(cell.soc, abs=1e-9)


def test_a_wrong_charge_converges_to_the_battery_while_it_rests_and_not_before() -> None:
    cell, state = battery.initial_state(PACK, 0.70), manager.initial_state(PARAMS, 0.55)
    errors = []
    for _ in range(1500):
        voltage = battery.terminal_voltage(PACK, cell, 2.0)
        cell = battery.step(PACK, cell, 2.0, 1.0)
        state, output = manager.step(PARAMS, state, telemetry(voltage, 2.0), 1.0)
        errors.append(output.soc - cell.soc)
    assert errors[299] == pytest.approx(-0.15, abs=1e-6)
    assert errors[500] == pytest.approx(-0.15 * exp(-201.0 / 200.0), abs=2e-3)
    assert abs(errors[-1]) < 2e-3


def test_a_working_battery_is_not_corrected() -> None:
    state = manager.initial_state(PARAMS, 0.5)
    for k in range(2000):
        state, output = manager.step(PARAMS, state, telemetry(33.0, 3.5 if k % 250 == 0 else 0.1), 1.0)
        assert not output.correcting


def test_without_a_charge_the_first_voltage_gives_it() -> None:
    voltage = battery.open_circuit_voltage(PACK, 0.62) - 0.058 * 4.0
    _, output = manager.step(PARAMS, manager.initial_state(PARAMS), telemetry(voltage, 4.0), 0.1)
    assert output.soc == pytest.approx(0.62)
    assert output.energy_remaining_wh == pytest.approx(battery.stored_energy(PACK, 0.62) / 3600.0)


def test_time_to_empty_is_the_charge_over_the_current() -> None:
    _, output = manager.step(PARAMS, manager.initial_state(PARAMS, 0.5), telemetry(current=4.0), 1e-3)
    assert output.time_to_empty == pytest.approx(0.5 * 16.0 * 3600.0 / 4.0, rel=1e-5)
    _, output = manager.step(PARAMS, manager.initial_state(PARAMS, 0.5), telemetry(current=-1.0), 1e-3)
    assert isinf(output.time_to_empty)


def test_loads_are_shed_by_priority_as_the_charge_falls_and_come_back_in_reverse() -> None:
    assert PARAMS.shed_priorities == (10, 40, 50)
    assert PARAMS.shed_thresholds == pytest.approx((0.3, 0.2, 0.1))
    state, seen = manager.initial_state(PARAMS, 0.35), []
    for soc in (0.35, 0.29, 0.33, 0.35, 0.19, 0.23, 0.09, 0.13, 0.15, 0.25, 0.345):
        state, output = manager.step(PARAMS, charged(state, soc), telemetry(), 1e-3)
        seen.append("".join(name[0] for name, mode in modes(output).items() if mode == "off"))
    assert seen == ["", "h", "h", "", "ach", "ach", "dach", "dach", "ach", "h", ""]
    assert [PARAMS.reserve(names) for names in (("drive",), ("drive", "heater"), ("computer",))] == pytest.approx(
        [0.1, 0.3, 0.0]
    )


@settings(max_examples=80, deadline=None)
@given(
    steps=st.lists(
        st.tuples(st.floats(0.0, 1.0), st.floats(15.0, 34.0), st.floats(0.05, 20.0)), min_size=1, max_size=30
    )
)
def test_what_is_shed_is_the_lowest_priorities_and_never_essential(
    steps: list[tuple[float, float, float]],
) -> None:
    state = manager.initial_state(PARAMS, 0.5)
    for soc, voltage, dt in steps:
        state, output = manager.step(PARAMS, charged(state, soc), telemetry(voltage, 0.0), dt)
        by_name = {switch.name: switch for switch in output.switches}
        assert by_name["computer"].mode == "on" and by_name["computer"].fraction == 1.0
        off = [load.priority for load in LOADS if by_name[load.name].reason.startswith("shed")]
        on = [
            load.priority for load in LOADS if not load.essential and not by_name[load.name].reason.startswith("shed")
        ]
        assert not off or not on or max(off) < min(on)
        assert len(set(off)) == output.shed_level
        assert all(0.0 <= switch.fraction <= 1.0 for switch in output.switches)


@settings(max_examples=80, deadline=None)
@given(centre=st.floats(0.05, 0.4), wobble=st.lists(st.floats(-0.0199, 0.0199), min_size=2, max_size=40))
def test_charge_noise_within_the_hysteresis_changes_a_level_once_at_most(centre: float, wobble: list[float]) -> None:
    state, levels = manager.initial_state(PARAMS, 0.5), []
    for noise in wobble:
        state, output = manager.step(PARAMS, charged(state, centre + noise), telemetry(), 1e-3)
        levels.append(output.shed_level)
    # A band narrower than the hysteresis holds one threshold at most: after it is crossed nothing returns.
    assert levels == sorted(levels)
    assert levels[-1] - levels[0] <= 1


def test_a_low_bus_sheds_one_level_at_a_time_and_restores_after_a_wait() -> None:
    state, output = run(manager.initial_state(PARAMS, 0.9), telemetry(24.0), 1.0, 5)
    assert output.shed_level == 0
    state, output = run(state, telemetry(24.0), 1.0, 1)
    assert output.shed_level == 1 and "bus was below 25.0 V" in output.switches[4].reason
    state, output = run(state, telemetry(24.0), 1.0, 6)
    assert output.shed_level == 2
    state, output = run(state, telemetry(25.5), 1.0, 300)  # inside the hysteresis: neither more nor less
    assert output.shed_level == 2
    state, output = run(state, telemetry(29.0), 1.0, 30)
    assert output.shed_level == 2
    state, output = run(state, telemetry(29.0), 1.0, 5)
    assert output.shed_level == 1
    state, output = run(state, telemetry(29.0), 1.0, 31)
    assert output.shed_level == 0


def test_a_low_bus_sheds_beyond_what_the_charge_has_shed() -> None:
    state = replace(manager.initial_state(PARAMS, 0.25), level_by_charge=1)
    _, output = run(state, telemetry(24.0, 0.0), 1.0, 6)
    assert output.shed_level == 2


@settings(max_examples=100, deadline=None)
@given(low=st.floats(0.0, 40.0), rise=st.floats(0.0, 5.0))
def test_the_drive_limit_never_falls_with_voltage(low: float, rise: float) -> None:
    assert 0.0 <= manager.derate_target(LAW, low) <= manager.derate_target(LAW, low + rise) <= 1.0


def test_the_drive_limit_is_smooth_from_none_to_all() -> None:
    assert manager.derate_target(LAW, 25.0) == 0.0 and manager.derate_target(LAW, 27.0) == 1.0
    assert manager.derate_target(LAW, 26.0) == pytest.approx(0.5)
    for edge in (25.0, 27.0):  # no slope at either end
        slope = (manager.derate_target(LAW, edge + 1e-4) - manager.derate_target(LAW, edge - 1e-4)) / 2e-4
        assert abs(slope) < 1e-3


def test_the_drive_follows_a_sag_and_recovers_along_a_ramp() -> None:
    state, output = run(manager.initial_state(PARAMS, 0.9), telemetry(24.5), 0.1, 1)
    assert output.drive_fraction == pytest.approx(exp(-0.1 / 0.4))
    state, output = run(state, telemetry(24.5), 0.1, 30)
    assert output.drive_fraction == 0.0 and modes(output)["drive"] == "off"
    state, output = run(state, telemetry(30.0), 0.1, 50)
    assert output.drive_fraction == pytest.approx(0.5) and modes(output)["drive"] == "limit"
    assert output.switches[1].fraction == pytest.approx(0.5)
    _, output = run(state, telemetry(30.0), 0.1, 100)
    assert output.drive_fraction == 1.0 and modes(output)["drive"] == "on"


def test_sag_and_limit_settle_together_on_a_weak_battery() -> None:
    """Manager and bus: the drive wants more than a cold pack gives; the limit finds a steady point."""
    state, fractions = manager.initial_state(PARAMS, 0.9), (1.0,) * 5
    voltages = []
    for _ in range(600):
        # the bus: 28.6 V behind 0.4 ohm, loads of constant power and a heater
        fixed = sum(f * load.power_w for f, load in zip(fractions, LOADS, strict=True) if load.kind == "constant_power")
        power = fixed + min(200.0, 200.0 * fractions[1])
        voltage, served = solve_bus(28.6, 0.4, power, fractions[4] * 15.0 / 28.0**2, 0.0)
        assert served == 1.0
        state, output = manager.step(PARAMS, state, telemetry(voltage, (28.6 - voltage) / 0.4), 0.1)
        fractions = output.fractions
        voltages.append(voltage)
    assert 25.0 < voltages[-1] < 27.0
    assert max(voltages[-100:]) - min(voltages[-100:]) < 1e-3
    assert 0.0 < output.drive_fraction < 1.0


def test_the_arm_is_limited_to_its_power() -> None:
    _, output = manager.step(PARAMS, manager.initial_state(PARAMS, 0.9), telemetry(), 0.1)
    arm = output.switches[2]
    assert (arm.mode, arm.fraction) == ("limit", pytest.approx(60.0 / 80.0))
    assert arm.reason == "arm limited to 60 W"


def test_an_operator_switches_loads_and_it_is_kept() -> None:
    state = manager.requested(PARAMS, manager.initial_state(PARAMS, 0.9), {"camera": False})
    state, output = run(state, telemetry(), 0.1, 2)
    assert modes(output)["camera"] == "off" and output.switches[3].reason == "switched off by the operator"
    state = manager.requested(PARAMS, state, {"camera": True, "computer": True})
    _, output = manager.step(PARAMS, state, telemetry(), 0.1)
    assert modes(output)["camera"] == "on"


def test_an_operator_cannot_switch_on_what_is_shed() -> None:
    state = manager.requested(PARAMS, manager.initial_state(PARAMS, 0.2), {"heater": True})
    _, output = manager.step(PARAMS, state, telemetry(), 0.1)
    assert modes(output)["heater"] == "off" and output.switches[4].reason == "shed: charge was below 30.0%"


def test_warnings_name_battery_limits_and_shedding() -> None:
    _, output = manager.step(PARAMS, manager.initial_state(PARAMS, 0.25), telemetry(26.0, 40.0, 310.0), 0.1)
    text = "; ".join(output.warnings)
    for words in (
        "battery discharge current above its limit",
        "battery too hot",
        "level 1 of 3",
        "drive limited",
    ):
        assert words in text


@pytest.mark.parametrize("bad", [nan, inf, -inf])
@pytest.mark.parametrize("name", ["voltage", "current", "temperature"])
def test_telemetry_that_is_no_number_is_refused_by_name(name: str, bad: float) -> None:
    with pytest.raises(InvalidValueError, match=name):
        manager.step(
            PARAMS,
            manager.initial_state(PARAMS, 0.5),
            PowerManagerInput((replace(telemetry().stores[0], **{name: bad}),)),
            0.1,
        )


def test_bad_requests_are_refused_with_the_names_that_are_right() -> None:
    state = manager.initial_state(PARAMS, 0.5)
    with pytest.raises(UnknownNameError, match=r"'camra'.*arm, camera, computer, drive, heater; did you mean camera"):
        manager.requested(PARAMS, state, {"drive": False, "camra": True})
    with pytest.raises(InvalidValueError, match="essential load computer"):
        manager.requested(PARAMS, state, {"drive": False, "computer": False})
    for text in ("dim", "", "0.5", "ON"):
        with pytest.raises(InvalidValueError, match="on or off"):
            parse_switches({"camera": text})
    with pytest.raises(InvalidValueError, match="at least one load"):
        parse_switches({})
    for dt in (0.0, nan, -1.0):
        with pytest.raises(InvalidValueError, match="dt"):
            manager.step(PARAMS, state, telemetry(), dt)
    with pytest.raises(InvalidValueError, match="state of charge"):
        manager.initial_state(PARAMS, 1.5)


@pytest.mark.parametrize(
    "changes",
    [
        {"shed_soc_last": 0.4},
        {"derate_stop_voltage": 27.0},
        {"recovery_rate": 0.0},
        {"shed_soc_first": 0.99},
        {"rest_current": 0.0},
        {"rest_amps": 1.0},
    ],
)
def test_bad_law_is_refused_by_name(changes: dict[str, float]) -> None:
    with pytest.raises(ValidationError, match=next(iter(changes))):
        PowerLawParams(**(LAW.model_dump() | changes))


def test_a_changed_copy_works_out_its_own_levels_and_limits() -> None:
    assert len(PARAMS.shed_thresholds) == len(PARAMS.shed_priorities) and len(PARAMS.granted) == len(PARAMS.loads)
    poor = PARAMS.law.model_copy(update={"load_limits": {"drive": 1e-3}, "shed_soc_first": 0.5})
    changed = PARAMS.model_copy(update={"law": poor})
    assert changed.shed_thresholds[0] == 0.5 != PARAMS.shed_thresholds[0]
    limited = {load.name for load, (fraction, _) in zip(PARAMS.loads, changed.granted, strict=True) if fraction < 1e-3}
    assert limited == {load.name for load in PARAMS.loads if load.name == "drive"} != set()
