"""The thermal network against closed forms, its own balance solved elsewhere, its account, a lunar night."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError
from scipy.optimize import brentq

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.thermal.network import ThermalNetwork, ThermalState, ThermalSurroundings
from sojourn_machine.thermal.thermal_params import ThermalParams

SIGMA = 5.670374419e-8
NIGHT = ThermalSurroundings(ground=100.0, sky=2.7)


def network(**tables: object) -> ThermalNetwork:
    return ThermalNetwork(ThermalParams.model_validate(tables))


def rover(radioisotope_heaters: int) -> ThermalNetwork:
    """A rover with a warm box: ten nodes, a heater of 20 W at the battery."""
    units = [{"node": "battery", "count": radioisotope_heaters}] if radioisotope_heaters else []
    motors = {
        f"motor_{i}": {
            "heat_capacity": 900.0, "temperature": 200.0, "emissivity": 0.8, "area_to_sky": 0.01,
            "area_to_ground": 0.01,
        }
        for i in range(5)
    }  # fmt: skip
    return network(
        nodes={
            "battery": {"heat_capacity": 9000.0, "temperature": 293.0},
            "electronics": {"heat_capacity": 12000.0, "temperature": 293.0},
            "body": {"heat_capacity": 2e4, "temperature": 280.0, "emissivity": 0.05, "area_to_sky": 1.2,
                     "area_to_ground": 0.6},
            "radiator": {"heat_capacity": 2000.0, "temperature": 280.0, "emissivity": 0.85, "area_to_sky": 0.05},
            "array": {"heat_capacity": 5000.0, "temperature": 200.0, "emissivity": 0.85, "area_to_sky": 0.6,
                      "area_to_ground": 0.6},
            **motors,
        },
        conductors=[
            {"between": ("battery", "electronics"), "conductance": 2.0},
            {"between": ("battery", "body"), "conductance": 0.03},
            {"between": ("electronics", "body"), "conductance": 0.03, "radiating_area": 0.01},
            {"between": ("electronics", "radiator"), "conductance": 0.01},
            {"between": ("body", "array"), "conductance": 0.02},
            {"between": ("motor_0", "ground"), "conductance": 0.02},
            *({"between": ("body", name), "conductance": 0.01} for name in motors),
        ],
        heaters={"battery_heater": {"node": "battery", "power_w": 20.0, "on_below": 253.0, "off_above": 258.0}},
        radioisotope_heaters=units,
        warms={"computer": "electronics"},
    )  # fmt: skip


def through_the_night(machine: ThermalNetwork, fed: float, dt: float = 600.0, days: float = 14.0) -> ThermalState:
    state = machine.initial_state()
    heat = machine.heat_to_nodes({"computer": 1.0, "camera": 7.0})
    for _ in range(round(days * 86400.0 / dt)):
        state = machine.step(state, NIGHT, heat, dt, np.array([fed]))
    return state


@settings(max_examples=60, deadline=None)
@given(
    capacities=st.tuples(st.floats(10.0, 1e5), st.floats(10.0, 1e5)),
    start=st.tuples(st.floats(50.0, 450.0), st.floats(50.0, 450.0)),
    conductance=st.floats(1e-3, 50.0),
    dt=st.floats(0.01, 3600.0),
)
def test_two_nodes_meet_as_their_closed_form_has_it(
    capacities: tuple[float, float], start: tuple[float, float], conductance: float, dt: float
) -> None:
    pair = network(
        nodes={f"n{i}": {"heat_capacity": capacities[i], "temperature": start[i]} for i in (0, 1)},
        conductors=[{"between": ("n0", "n1"), "conductance": conductance}],
    )
    state = pair.initial_state()
    for _ in range(3):
        state = pair.step(state, NIGHT, np.zeros(2), dt)
    left = math.exp(-conductance * (1.0 / capacities[0] + 1.0 / capacities[1]) * 3.0 * dt)
    mean = (capacities[0] * start[0] + capacities[1] * start[1]) / sum(capacities)
    difference = (start[0] - start[1]) * left
    for i, sign in ((0, 1.0), (1, -1.0)):
        expected = mean + sign * difference * capacities[1 - i] / sum(capacities)
        assert state.temperatures[i] == pytest.approx(expected, abs=0.1)


@pytest.mark.parametrize("dt", [0.02, 20.0, 600.0, 86400.0])
def test_a_body_radiates_into_the_dark_as_its_closed_form_has_it(dt: float) -> None:
    """1/T^3 = 1/T0^3 + 3 eps sigma A t / C."""
    body = network(nodes={"b": {"heat_capacity": 5e3, "temperature": 350.0, "emissivity": 0.8, "area_to_sky": 0.5}})
    state = body.initial_state()
    steps = min(50, int(864000.0 / dt))
    for _ in range(steps):
        state = body.step(state, ThermalSurroundings(ground=0.0, sky=0.0), np.zeros(1), dt)
    expected = (350.0**-3 + 3.0 * 0.8 * SIGMA * 0.5 * steps * dt / 5e3) ** (-1.0 / 3.0)
    assert state.temperatures[0] == pytest.approx(expected, rel=1e-3)


@settings(max_examples=30, deadline=None)
@given(absorptivity=st.floats(0.05, 1.0), emissivity=st.floats(0.05, 1.0), flux=st.floats(10.0, 3000.0))
def test_a_plate_in_the_sun_comes_to_the_temperature_of_stefan_and_boltzmann(
    absorptivity: float, emissivity: float, flux: float
) -> None:
    plate = network(
        nodes={
            "plate": {"heat_capacity": 100.0, "temperature": 200.0, "emissivity": emissivity, "area_to_sky": 2.0,
                      "absorptivity": absorptivity, "area_to_sun": 1.0}
        }
    )  # fmt: skip
    state = plate.initial_state()
    for _ in range(20):
        state = plate.step(state, ThermalSurroundings(0.0, 0.0, np.array([flux])), np.zeros(1), 86400.0)
    expected = (absorptivity * flux / (2.0 * emissivity * SIGMA)) ** 0.25
    assert state.temperatures[0] == pytest.approx(expected, abs=0.05)


def test_air_takes_heat_and_the_balance_is_that_of_a_root_found_elsewhere() -> None:
    box = network(
        nodes={
            "inside": {"heat_capacity": 500.0, "temperature": 250.0},
            "skin": {"heat_capacity": 500.0, "temperature": 250.0, "emissivity": 0.6, "area_to_sky": 0.4,
                     "area_to_ground": 0.3, "area_to_air": 0.9},
        },
        conductors=[{"between": ("inside", "skin"), "conductance": 0.4, "radiating_area": 0.1}],
    )  # fmt: skip
    state = box.initial_state()
    for _ in range(20):
        state = box.step(state, ThermalSurroundings(230.0, 160.0, None, 220.0, 1.5), np.array([30.0, 0.0]), 86400.0)
    skin = brentq(
        lambda t: 30.0 + 0.6 * SIGMA * (0.4 * (160.0**4 - t**4) + 0.3 * (230.0**4 - t**4)) + 1.5 * 0.9 * (220.0 - t),
        100.0,
        600.0,
    )
    inside = brentq(lambda t: 0.4 * (t - skin) + 0.1 * SIGMA * (t**4 - skin**4) - 30.0, skin, 600.0)
    assert state.temperatures == pytest.approx([inside, skin], abs=0.02)


@settings(max_examples=60, deadline=None)
@given(data=st.data(), count=st.integers(1, 6), dt=st.floats(0.02, 7200.0))
def test_the_account_closes_for_any_network(data: st.DataObject, count: int, dt: float) -> None:
    names = [f"n{i}" for i in range(count)]
    number = st.floats(0.0, 1.0)
    area = [data.draw(number) for _ in names]
    machine = network(
        nodes={
            name: {"heat_capacity": data.draw(st.floats(50.0, 5e4)), "temperature": data.draw(st.floats(100.0, 400.0)),
                   "emissivity": 0.8, "area_to_sky": a, "area_to_ground": 0.5 * a, "area_to_air": a,
                   "absorptivity": 0.4, "area_to_sun": a}
            for name, a in zip(names, area, strict=True)
        },
        conductors=[
            {"between": pair, "conductance": data.draw(number), "radiating_area": data.draw(number)}
            for pair in [(names[i], names[i + 1]) for i in range(count - 1)] + [(names[0], "ground")]
        ],
        heaters={"h": {"node": names[-1], "power_w": 25.0, "on_below": 250.0, "off_above": 255.0}},
        radioisotope_heaters=[{"node": names[0], "count": 3}],
    )  # fmt: skip
    state = machine.initial_state()
    before = machine.stored(state)
    for _ in range(5):
        around = ThermalSurroundings(260.0, 150.0, np.full(count, data.draw(st.floats(0.0, 1000.0))), 240.0, 2.0)
        state = machine.step(state, around, np.full(count, 4.0), dt, np.array([0.7]))
    turned_over = math.fsum(abs(term) for term in state.account)
    assert machine.stored(state) - before == pytest.approx(state.account.taken_in, abs=1e-6 * turned_over + 1e-4)
    assert state.heater_energy is not None
    assert state.heater_energy.sum() == pytest.approx(state.account.heaters, rel=1e-9, abs=1e-9)


def test_long_steps_have_the_same_night_as_short_ones() -> None:
    machine = rover(radioisotope_heaters=0)
    long, short = (through_the_night(machine, fed=1.0, dt=dt) for dt in (3600.0, 60.0))
    assert long.account.heaters == pytest.approx(short.account.heaters, rel=0.01)
    cold = [through_the_night(machine, fed=0.0, dt=dt).temperatures for dt in (3600.0, 60.0)]
    assert cold[0] == pytest.approx(cold[1], rel=1e-3)


def test_a_battery_lives_through_a_lunar_night_by_radioisotope_heaters_or_a_fed_heater_and_else_does_not() -> None:
    """Fourteen days over ground of 100 K: without anything below 150 K, with eight units of 1 W above 260 K."""
    without, with_units = (rover(units) for units in (0, 8))
    cold = through_the_night(without, fed=0.0)
    warm = through_the_night(with_units, fed=0.0)
    heated = through_the_night(without, fed=1.0)
    assert without.temperature(cold, "battery") < 150.0
    assert 260.0 < with_units.temperature(warm, "battery") < 275.0
    assert warm.account.radioisotope == pytest.approx(8.0 * 14.0 * 86400.0, rel=1e-3)
    assert 252.5 < without.temperature(heated, "battery") < 258.5
    assert 1800.0 < heated.account.heaters / 3600.0 < 2300.0  # Wh: 6 W through the night


@pytest.mark.parametrize("dt", [1.0, 600.0, 86400.0])
def test_a_thermostat_keeps_its_band_whatever_the_step(dt: float) -> None:
    machine = rover(radioisotope_heaters=0)
    state = through_the_night(machine, fed=1.0, days=7.0)
    for _ in range(50):
        state = machine.step(state, NIGHT, np.zeros(10), dt)
        assert 252.9 < machine.temperature(state, "battery") < 258.1


def test_a_radioisotope_heater_halves_in_its_half_life() -> None:
    unit = {"node": "b", "power_w": 1.0, "age_years": 87.7}
    one = network(nodes={"b": {"heat_capacity": 1.0, "temperature": 200.0}}, radioisotope_heaters=[unit])
    assert one.radioisotope_heat(0.0) == pytest.approx([0.5], rel=1e-12)
    assert one.radioisotope_heat(87.7 * 365.25 * 86400.0) == pytest.approx([0.25], rel=1e-12)


def test_what_does_not_fit_together_is_refused_in_words() -> None:
    node = {"heat_capacity": 1.0, "temperature": 200.0}
    for tables, words in (
        ({"nodes": {"a": node}, "conductors": [{"between": ("a", "b")}]}, r"conductors\[0\].between\[1\] = 'b'"),
        ({"nodes": {"a": node}, "conductors": [{"between": ("a", "a")}]}, "two different nodes"),
        ({"nodes": {"ground": node}}, "any name but 'ground'"),
        ({"nodes": {"a": node}, "warms": {"computer": "b"}}, "warms.computer"),
        ({"nodes": {"a": node}, "radioisotope_heaters": [{"node": "b"}]}, r"radioisotope_heaters\[0\].node"),
        (
            {"nodes": {"a": node}, "heaters": {"h": {"node": "a", "power_w": 1, "on_below": 250, "off_above": 250}}},
            "off_above",
        ),
    ):
        with pytest.raises(ValidationError, match=words):
            network(**tables)  # type: ignore[arg-type]
    one = network(nodes={"a": node})
    state = one.initial_state()
    with pytest.raises(InvalidValueError, match="dt"):
        one.step(state, NIGHT, np.zeros(1), 0.0)
    with pytest.raises(InvalidValueError, match="heat at the nodes"):
        one.step(state, NIGHT, np.array([math.nan]), 1.0)
    with pytest.raises(InvalidValueError, match="ground"):
        one.step(state, ThermalSurroundings(-1.0, 2.7), np.zeros(1), 1.0)
    with pytest.raises(InvalidValueError, match="node"):
        one.temperature(state, "b")
