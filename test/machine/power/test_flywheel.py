"""The flywheel against closed forms, an integrator, a capacitor of the same charge, and published figures."""

import math

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from pydantic import ValidationError
from scipy.integrate import solve_ivp

from sojourn_config.load import load_params
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.power.flywheel import SERIES, FlywheelParams, means_over_step
from sojourn_machine.power.flywheel_rotor import RotorParams
from sojourn_machine.power.loads import BusParams, LoadParams
from sojourn_machine.power.network import PowerNetwork
from sojourn_machine.power.power_params import PowerParams
from sojourn_machine.power.supercapacitor import SupercapacitorParams

GLENN = load_params("parts", "flywheel_glenn", FlywheelParams)
RING = RotorParams(shape="ring", mass=2.0, radius=0.2, density=1550.0, strength=1.5e9, safety_factor=1.0)
DISC = RING.model_copy(update={"shape": "disc"})


def wheel(**changes: object) -> FlywheelParams:
    return FlywheelParams.model_validate(GLENN.model_dump() | changes)


@pytest.mark.published
@pytest.mark.parametrize(("rotor", "factor", "within"), [(RING, 0.5, 1e-12), (DISC, 0.606, 2e-4)])
def test_the_shape_factor_is_the_published_one(rotor: RotorParams, factor: float, within: float) -> None:
    """Energy over mass of a rotor at its strength, over strength and density."""
    energy = 0.5 * rotor.inertia * rotor.allowed_speed**2
    assert energy / rotor.mass / (rotor.strength / rotor.density) == pytest.approx(factor, rel=within / factor)


@pytest.mark.published
def test_a_carbon_fibre_ring_stores_the_published_energy() -> None:
    """134 Wh/kg before a safety factor."""
    assert 0.5 * RING.inertia * RING.allowed_speed**2 / RING.mass / 3600.0 == pytest.approx(134.0, abs=0.5)


def test_the_disc_is_stressed_as_the_equation_of_equilibrium_asks() -> None:
    """Radial and hoop stress by integration of equilibrium and compatibility from the centre; the rim is free."""
    ratio, radius, density, speed = DISC.poisson_ratio, DISC.radius, DISC.density, 1500.0

    def slopes(r: float, stress: np.ndarray) -> list[float]:
        """Of radial and hoop stress (2,)."""
        radial, hoop = stress
        load = density * speed**2 * r
        slope = (hoop - radial) / r - load
        return [slope, ratio * slope - (1.0 + ratio) * (hoop - radial) / r]

    centre = DISC.stress(speed)
    # Near the centre both fall with the square of the radius, as the series of the same equations has it.
    start = 1e-4 * radius
    square = density * (speed * start) ** 2 / 8.0
    first = [centre - (3.0 + ratio) * square, centre - (1.0 + 3.0 * ratio) * square]
    found = solve_ivp(slopes, (start, radius), first, rtol=1e-10, atol=1.0).y
    assert abs(found[0, -1]) < 1e-6 * centre
    assert found.max() <= centre


@pytest.mark.published
def test_the_part_stores_the_published_energy_at_the_published_speed() -> None:
    """0.395 kWh at 60 000 rpm (NASA Glenn)."""
    assert GLENN.speed_full * 60.0 / (2.0 * math.pi) == pytest.approx(60000.0, rel=1e-6)
    assert 0.5 * GLENN.rotor.inertia * GLENN.speed_full**2 / 3.6e6 == pytest.approx(0.395, rel=1e-3)
    assert GLENN.stored_energy(1.0) / (0.5 * GLENN.rotor.inertia * GLENN.speed_full**2) == pytest.approx(8.0 / 9.0)


@settings(max_examples=60, deadline=None)
@given(
    soc=st.floats(0.0, 1.0),
    current=st.floats(-60.0, 60.0),
    dt=st.floats(0.001, 2000.0),
    friction=st.floats(0.0, 1e-3),
    viscous=st.sampled_from([0.0, 1e-9, 1e-7, 1e-5, 1e-3]),
)
@example(soc=0.0, current=1.2e-308, dt=1.0, friction=0.0, viscous=1e-5)
def test_a_step_is_what_an_integrator_finds(
    soc: float, current: float, dt: float, friction: float, viscous: float
) -> None:
    params = wheel(friction_torque=friction, viscous_friction=viscous)
    inertia, constant = params.rotor.inertia, params.emf_constant
    before = params.initial_state(soc)
    after = params.step(before, current, dt)
    speed = params.speed(after.soc)

    def slopes(_: float, state: np.ndarray) -> list[float]:
        """Of speed and angle (2,)."""
        return [-(constant * current + friction + viscous * state[0]) / inertia, state[0]]

    def stopped(_: float, state: np.ndarray) -> float:
        """Ends the integration at rest."""
        return float(state[0])

    stopped.terminal = True  # type: ignore[attr-defined]
    found = solve_ivp(slopes, (0.0, dt), [params.speed(soc), 0.0], method="LSODA", events=stopped, rtol=1e-9, atol=1e-7)
    assert speed == pytest.approx(found.y[0, -1], rel=1e-6, abs=1e-2)
    terminal = constant * current * found.y[1, -1] - params.resistance * current**2 * dt
    scale = abs(constant * current * found.y[1, -1]) + params.resistance * current**2 * dt + 1.0
    assert after.energy_terminal == pytest.approx(terminal, abs=1e-6 * scale)


@pytest.mark.parametrize("current", [0.0, 5e-324, 1.2e-308, -1.2e-308])
@pytest.mark.parametrize("viscous", [0.0, 5e-324, 1e-5, 1e-3])
def test_a_torque_as_small_as_a_number_can_be_leaves_a_speed(current: float, viscous: float) -> None:
    """The time in which it would bring the rotor to rest is beyond all numbers."""
    params = wheel(friction_torque=0.0, viscous_friction=viscous)
    after = params.step(params.initial_state(0.5), current, 1000.0)
    slowed = math.exp(-viscous * 1000.0 / params.rotor.inertia)
    assert params.speed(after.soc) == pytest.approx(slowed * params.speed(0.5))


@given(x=st.one_of(st.floats(0.0, 0.1), st.floats(0.1, 50.0), st.sampled_from([SERIES, math.nextafter(SERIES, 1.0)])))
def test_the_means_over_a_step_are_integrals(x: float) -> None:
    """Of e^(-x s) and of its integral, s from 0 to 1, by quadrature on either side of where the series ends."""
    nodes, weights = np.polynomial.legendre.leggauss(60)
    s, weight = 0.5 * (nodes + 1.0), 0.5 * weights
    decay = np.exp(-x * s)
    assert means_over_step(x) == pytest.approx((weight @ decay, weight @ ((1.0 - s) * decay)), rel=1e-12)


@settings(max_examples=60, deadline=None)
@given(
    soc=st.floats(0.0, 1.0),
    currents=st.lists(st.floats(-60.0, 60.0), min_size=1, max_size=20),
    dt=st.sampled_from([0.02, 1.0, 30.0]),
)
def test_no_energy_is_lost_and_none_is_made(soc: float, currents: list[float], dt: float) -> None:
    state = start = GLENN.initial_state(soc)
    for current in currents:
        heat = state.energy_heat
        state = GLENN.step(state, current, dt)
        assert state.energy_heat >= heat - 1e-9 * GLENN.stored_energy(1.0)
    given_up = GLENN.stored_energy(start.soc) - GLENN.stored_energy(state.soc)
    turned = GLENN.stored_energy(1.0) + abs(state.energy_terminal)
    assert given_up == pytest.approx(state.energy_terminal + state.energy_heat, abs=1e-9 * turned)


@settings(max_examples=60, deadline=None)
@given(soc=st.floats(0.1, 0.9), current=st.floats(-60.0, 60.0), dt=st.floats(0.01, 20.0))
def test_without_friction_it_is_a_capacitor(soc: float, current: float, dt: float) -> None:
    """Of its inertia over the square of its constant."""
    params = wheel(friction_torque=0.0, viscous_friction=0.0)
    bank = SupercapacitorParams(
        capacitance=params.rotor.inertia / params.emf_constant**2,
        resistance=params.resistance,
        leak_resistance=1e9,
        voltage_empty=params.open_circuit_voltage(0.0),
        voltage_full=params.open_circuit_voltage(1.0),
        current_limit=params.current_limit,
        temperature_surroundings=290.0,
    )
    assert params.charge_capacity == pytest.approx(bank.charge_capacity)
    mine, other = params.step(params.initial_state(soc), current, dt), bank.step(bank.initial_state(soc), current, dt)
    assert mine.soc == pytest.approx(other.soc, abs=1e-9)
    assert mine.energy_terminal == pytest.approx(other.energy_terminal, rel=1e-6, abs=1e-3)
    assert params.stored_energy(soc) == pytest.approx(bank.stored_energy(soc))


def test_one_that_coasts_comes_to_rest_when_friction_has_taken_its_energy() -> None:
    params = wheel(friction_torque=0.05, viscous_friction=0.0)
    all_of_it = 0.5 * params.rotor.inertia * params.speed_full**2
    duration = params.rotor.inertia * params.speed_full / 0.05
    moving = params.step(params.initial_state(1.0), 0.0, 0.999 * duration)
    assert params.speed(moving.soc) == pytest.approx(0.001 * params.speed_full, rel=1e-6)
    resting = params.step(moving, 0.0, duration)
    assert params.momentum(resting) == pytest.approx(0.0, abs=1e-9)
    assert resting.energy_heat == pytest.approx(all_of_it)
    still = params.step(resting, -0.05 / params.emf_constant, 100.0)  # the motor is as strong as the friction
    assert params.momentum(still) == pytest.approx(0.0, abs=1e-9)
    assert params.momentum(params.step(still, -20.0, 100.0)) == pytest.approx(
        (20.0 * params.emf_constant - 0.05) * 100.0
    )


def test_a_motor_that_returns_power_does_not_overspeed_it() -> None:
    """What it cannot take goes into the shunt of its bus."""
    motor = LoadParams(name="motor", kind="commanded", power_w=500.0, essential=False, priority=1)
    bus = BusParams(loads=(motor,), lockout_voltage=0.0, lockout_reset_voltage=1.0, lockout_reset_time=1.0)
    network = PowerNetwork(PowerParams(stores={"wheel": GLENN}, bus=bus))
    state, output = network.step(network.initial_state(1.0), (1.0,), (-100.0,), 1.0)
    assert output.store_currents == (0.0,)
    assert state.energy.shunts == pytest.approx(100.0)
    state, output = network.step(network.initial_state(0.5), (1.0,), (-100.0,), 1.0)
    assert output.store_currents[0] * output.voltage == pytest.approx(-100.0)
    assert state.energy.shunts == 0.0


@settings(max_examples=30, deadline=None)
@given(soc=st.floats(0.2, 0.9), demand=st.lists(st.floats(-300.0, 400.0), min_size=5, max_size=30))
def test_a_bus_on_it_keeps_its_energy(soc: float, demand: list[float]) -> None:
    """Its own account agrees with its bus within what its voltage moves in a period of a tenth of a second."""
    motor = LoadParams(name="motor", kind="commanded", power_w=500.0, essential=False, priority=1)
    bus = BusParams(loads=(motor,), lockout_voltage=0.0, lockout_reset_voltage=1.0, lockout_reset_time=1.0)
    network = PowerNetwork(PowerParams(stores={"wheel": GLENN}, bus=bus))
    state = network.initial_state(soc)
    for power in demand:
        state, _ = network.step(state, (1.0,), (power,), 0.1)
    energy, after = state.energy, state.stores[0]
    turned = 0.1 * sum(abs(power) for power in demand) + 1.0
    assert abs(energy.sources + energy.stores - energy.loads - energy.shunts) < 1e-9 * turned
    assert abs(after.energy_terminal - energy.stores) < 1e-3 * turned  # type: ignore[attr-defined]


@given(soc=st.floats(0.0, 1.0))
def test_its_voltage_tells_its_charge(soc: float) -> None:
    assert GLENN.soc_from_open_circuit_voltage(GLENN.open_circuit_voltage(soc)) == pytest.approx(soc, abs=1e-12)
    point = GLENN.point(GLENN.initial_state(soc))
    assert point.ceiling <= GLENN.open_circuit_voltage(1.0)
    assert (point.ceiling - point.source) / point.resistance <= GLENN.current_limit * (1.0 + 1e-9)


def test_a_rotor_that_would_burst_is_refused_in_words() -> None:
    with pytest.raises((ValidationError, InvalidValueError)) as told:
        wheel(speed_full=9000.0)
    assert "speed_full" in str(told.value) and "safety factor" in str(told.value)
    with pytest.raises((ValidationError, InvalidValueError), match="above speed_empty"):
        wheel(speed_empty=6283.185)


@pytest.mark.parametrize(("current", "dt", "around"), [(math.nan, 1.0, 290.0), (1.0, 0.0, 290.0), (1.0, 1.0, math.inf)])
def test_what_is_not_a_number_does_not_enter_the_state(current: float, dt: float, around: float) -> None:
    with pytest.raises(InvalidValueError):
        GLENN.step(GLENN.initial_state(0.5), current, dt, around)
    for soc, temperature in ((1.5, None), (math.nan, None), (0.5, -1.0)):
        with pytest.raises(InvalidValueError):
            GLENN.initial_state(soc, temperature)
    assert GLENN.limits_exceeded(290.0, 61.0) and not GLENN.limits_exceeded(290.0, -60.0)
