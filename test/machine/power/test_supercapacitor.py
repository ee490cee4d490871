"""A bank of capacitors and a flywheel that give and take a constant power, against the equations of their circuits."""

import math
from collections.abc import Callable

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from sojourn_config.load import load_params
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.evolution import replace
from sojourn_machine.power.flywheel import FlywheelParams
from sojourn_machine.power.loads import BusParams, LoadParams
from sojourn_machine.power.network import PowerNetwork
from sojourn_machine.power.power_params import PowerParams
from sojourn_machine.power.stores import StoreParams
from sojourn_machine.power.supercapacitor import SupercapacitorParams

BANK = SupercapacitorParams(
    capacitance=90.0, resistance=0.05, leak_resistance=800.0, voltage_empty=12.0, voltage_full=28.0,
    current_limit=60.0, temperature_surroundings=290.0,
)  # fmt: skip
WHEEL = load_params("parts", "flywheel_glenn", FlywheelParams)


def network_of(stores: dict[str, StoreParams]) -> PowerNetwork:
    """On one bus, with a motor alone."""
    motor = LoadParams(name="motor", kind="commanded", power_w=500.0, essential=False, priority=1)
    bus = BusParams(loads=(motor,), lockout_voltage=0.0, lockout_reset_voltage=1.0, lockout_reset_time=1.0)
    return PowerNetwork(PowerParams(stores=stores, bus=bus))


def charge_after(store: StoreParams, soc: float, power: float, duration: float, dt: float) -> float:
    """On a bus with a load of so many watts alone, or a motor that returns them [1]."""
    network = network_of({"store": store})
    state = network.initial_state(soc)
    for _ in range(round(duration / dt)):
        state, _ = network.step(state, (1.0,), (power,), dt)
    return state.stores[0].soc


def current(force: float, resistance: float, power: float) -> float:
    """That gives a power behind a resistance: P = (E - R I) I."""
    return (force - math.sqrt(force**2 - 4.0 * resistance * power)) / (2.0 * resistance)


def solved(slope: Callable[[float], float], start: float, duration: float) -> float:
    """Of an equation of first order, at the end."""

    def slopes(_: float, state: np.ndarray) -> list[float]:
        return [slope(float(state[0]))]

    return float(solve_ivp(slopes, (0.0, duration), [start], rtol=1e-10, atol=1e-10).y[0, -1])


@pytest.mark.parametrize(("soc", "power"), [(0.95, 30.0), (0.95, 150.0), (0.6, -80.0)])
def test_a_bank_under_constant_power_follows_its_circuit(soc: float, power: float) -> None:
    """The voltage falls faster and faster, as the current grows that a power asks."""

    def slope(force: float) -> float:
        return -(current(force, BANK.resistance, power) + force / BANK.leak_resistance) / BANK.capacitance

    expected = BANK.soc_from_open_circuit_voltage(solved(slope, BANK.open_circuit_voltage(soc), 60.0))
    assert charge_after(BANK, soc, power, 60.0, 0.1) == pytest.approx(expected, abs=5e-5)
    assert charge_after(BANK, soc, power, 60.0, 1.0) == pytest.approx(expected, abs=5e-4)  # the first order in dt


def test_a_bank_that_stands_leaks_by_the_law_of_a_discharge() -> None:
    state = BANK.initial_state(1.0)
    for _ in range(3600):
        state = BANK.step(state, 0.0, 10.0)
    left = 28.0 * math.exp(-36000.0 / (800.0 * 90.0))
    assert BANK.open_circuit_voltage(state.soc) == pytest.approx(left, rel=1e-4)
    assert state.energy_heat == pytest.approx(45.0 * (28.0**2 - left**2), rel=1e-4)
    assert state.energy_terminal == 0.0


@pytest.mark.parametrize(("soc", "power"), [(0.5, 200.0), (0.5, -300.0)])
def test_a_flywheel_under_constant_power_follows_its_equation_of_motion(soc: float, power: float) -> None:
    def slope(speed: float) -> float:
        constant = WHEEL.emf_constant
        torque = constant * current(constant * speed, WHEEL.resistance, power) + WHEEL.friction_torque
        return -(torque + WHEEL.viscous_friction * speed) / WHEEL.rotor.inertia

    expected = solved(slope, WHEEL.speed(soc), 600.0)
    assert WHEEL.speed(charge_after(WHEEL, soc, power, 600.0, 0.5)) == pytest.approx(expected, rel=2e-5)


@pytest.mark.parametrize(("asked", "dt"), [(math.nan, 1.0), (1.0, 0.0)])
def test_no_numbers_are_refused(asked: float, dt: float) -> None:
    with pytest.raises(InvalidValueError):
        BANK.step(BANK.initial_state(0.5), asked, dt)
    with pytest.raises(InvalidValueError):
        BANK.initial_state(-0.1)


@pytest.mark.parametrize("dt", [1.0, 60.0, 600.0, 3600.0])
@pytest.mark.parametrize(("first", "second"), [(0.9, 0.3), (0.2, 0.95)])
def test_two_banks_level_each_other_out_however_long_the_step(first: float, second: float, dt: float) -> None:
    """Two capacitances in parallel share their charge, but for what leaks: closed form. Neither passes the other."""
    small, large = BANK.model_copy(update={"capacitance": 30.0, "leak_resistance": 1e9}), BANK
    large = large.model_copy(update={"capacitance": 900.0, "leak_resistance": 1e9})
    network = network_of({"small": small, "large": large})
    begun = (small.initial_state(first), large.initial_state(second))
    state = replace(network.initial_state(0.5), stores=begun)
    for _ in range(max(4, round(1000.0 / dt))):
        state, _ = network.step(state, (1.0,), (0.0,), dt)
        charges = [store.soc for store in state.stores]
        assert min(first, second) - 1e-9 <= min(charges) and max(charges) <= max(first, second) + 1e-9
    shared = (30.0 * first + 900.0 * second) / 930.0
    assert charges == pytest.approx([shared, shared], abs=2e-3)


@pytest.mark.parametrize("soc", [-0.1, 0.0, 0.4, 1.0])
def test_the_elastance_of_a_bank_is_the_slope_of_its_force(soc: float) -> None:
    state = replace(BANK.initial_state(0.5), soc=soc)
    assert BANK.elastance(state) == pytest.approx(StoreParams.elastance(BANK, state), rel=1e-12)


def test_levelling_out_follows_the_circuit() -> None:
    """In short steps: the difference of two equal banks decays with R C."""
    same = BANK.model_copy(update={"leak_resistance": 1e9})
    network = network_of({"one": same, "other": same})
    state = replace(network.initial_state(0.5), stores=(same.initial_state(0.8), same.initial_state(0.6)))
    for _ in range(450):
        state, _ = network.step(state, (1.0,), (0.0,), 0.02)
    left = math.exp(-9.0 / (same.resistance * same.capacitance))
    one, other = (store.soc for store in state.stores)
    assert one - other == pytest.approx(0.2 * left, rel=0.01) and one + other == pytest.approx(1.4, abs=1e-6)
