"""Heat beside power: what heaters draw is heat in their node, stores feel what is round them."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_machine.params import FloatArray
from sojourn_machine.power.battery import BatteryParams
from sojourn_machine.power.loads import BusParams, LoadParams
from sojourn_machine.power.network import PowerNetwork
from sojourn_machine.power.power_params import PowerParams
from sojourn_machine.power.surroundings import DARK
from sojourn_machine.thermal.machine_heat import MachineHeat, Supplied
from sojourn_machine.thermal.network import ThermalNetwork, ThermalSurroundings
from sojourn_machine.thermal.thermal_params import ThermalParams

COLD = ThermalSurroundings(ground=110.0, sky=2.7)
LOADS = ("computer", "box_heater", "motor_heater")
ON = np.ones(3)


# A box and motors, each with a heater; the battery is in the box.
COLD_BOX = ThermalParams.model_validate(
    {
        "nodes": {
            "box": {"heat_capacity": 9000.0, "temperature": 262.0},
            "motors": {
                "heat_capacity": 2000.0, "temperature": 250.0, "emissivity": 0.8, "area_to_sky": 0.05,
                "area_to_ground": 0.05,
            },
        },
        "conductors": [{"between": ("box", "motors"), "conductance": 0.1}],
        "radioisotope_heaters": [{"node": "box", "count": 2}],
        "heaters": {
            "box_heater": {"node": "box", "power_w": 20.0, "on_below": 260.0, "off_above": 263.0},
            "motor_heater": {"node": "motors", "power_w": 8.0, "on_below": 240.0, "off_above": 242.0},
        },
        "warms": {"computer": "box", "battery": "box"},
    }
)  # fmt: skip


BATTERY: dict[str, Any] = {
    "name": "cell", "cells_series": 8, "cells_parallel": 1, "capacity_ah": 40.0, "soc_points": (0.0, 1.0),
    "ocv_points": (3.0, 4.1), "resistance_temperatures": (290.0,), "resistance_ohmic": (0.01,),
    "resistance_polarisation": (0.005,), "capacitance_polarisation": 6000.0, "coulombic_efficiency": 1.0,
    "charge_current_limit": 4.0, "discharge_current_limit": 16.0, "heat_capacity": 300.0, "thermal_conductance": 0.1,
    "temperature_surroundings": 290.0, "temperature_discharge_min": 203.0, "temperature_charge_min": 273.0,
    "temperature_max": 330.0,
}  # fmt: skip


def power(**more: object) -> PowerParams:
    """A battery that feeds a computer and both heaters."""
    loads = tuple(
        [
            LoadParams(name=name, kind="constant_power", power_w=watts, essential=False, priority=1)
            for name, watts in zip(LOADS, (12.0, 20.0, 8.0), strict=True)
        ]
    )
    bus = BusParams(loads=loads, lockout_voltage=0.0, lockout_reset_voltage=1.0, lockout_reset_time=1.0)
    return PowerParams(battery=BatteryParams(**BATTERY | more), bus=bus)


class Run:
    """A machine that stands in the cold, step by step."""

    def __init__(self, thermal: ThermalParams, electric: PowerParams, soc: float = 0.9) -> None:
        self.heat, self.network = MachineHeat(thermal, electric), PowerNetwork(electric)
        self.warm, self.powered = self.heat.initial_state(), self.network.initial_state(soc)
        self.drawn: list[list[float]] = []

    def step(self, fractions: FloatArray, around: ThermalSurroundings, dt: float) -> None:
        """One step of both networks."""
        switches = self.heat.through_thermostats(self.warm, fractions)
        lit = DARK._replace(round_stores=self.heat.store_surroundings(self.warm, self.powered.stores, dt))
        after, output = self.network.step(self.powered, switches, np.zeros(3), dt, lit)
        self.drawn.append(output.load_power.tolist())
        supplied = Supplied(self.powered, after, fractions, output.load_power)
        self.warm, self.powered = self.heat.step(self.warm, around, supplied, dt), after

    @property
    def temperatures(self) -> FloatArray:
        """Of box and motors [K]."""
        return self.warm.thermal.temperatures


@settings(max_examples=40, deadline=None)
@given(
    fractions=st.lists(st.tuples(*(st.sampled_from([0.0, 0.5, 1.0]) for _ in LOADS)), min_size=3, max_size=40),
    dt=st.sampled_from([0.02, 1.0, 60.0, 600.0]),
    box=st.floats(220.0, 300.0),
    soc=st.floats(0.0, 1.0),
)
def test_all_heat_is_accounted_for(fractions: list[tuple[float, ...]], dt: float, box: float, soc: float) -> None:
    """Nodes and battery together gain what loads, heaters and cells release, less what goes out."""
    nodes = {**COLD_BOX.nodes, "box": COLD_BOX.nodes["box"].model_copy(update={"temperature": box})}
    run = Run(COLD_BOX.model_copy(update={"nodes": nodes}), power(), soc)
    cells: Any = run.powered.stores[0]
    capacity = BATTERY["heat_capacity"] * 8
    stored = run.heat.network.stored(run.warm.thermal) + capacity * cells.temperature
    for row in fractions:
        run.step(np.array(row), COLD, dt)
    after: Any = run.powered.stores[0]
    gained = run.heat.network.stored(run.warm.thermal) + capacity * after.temperature - stored
    account = run.warm.thermal.account
    computer = dt * sum(row[0] for row in run.drawn)
    released = computer + after.energy_heat + account.heaters + account.radioisotope + account.outside
    scale = abs(computer) + abs(account.outside) + account.heaters + account.radioisotope + capacity
    assert abs(gained - released) < 1e-6 * scale


@settings(max_examples=40, deadline=None)
@given(
    fractions=st.lists(st.sampled_from([0.25, 1.0]), min_size=2, max_size=60),
    dt=st.sampled_from([0.02, 1.0, 60.0, 600.0]),
)
def test_what_heaters_draw_is_heat_one_step_later(fractions: list[float], dt: float) -> None:
    """The duty that the thermostat had in a step is what the load draws in the next one."""
    run = Run(COLD_BOX, power())
    first = run.warm.duty.copy()
    for fraction in fractions:
        run.step(np.full(3, fraction), COLD, dt)
        heat = run.warm.thermal.account.heaters
    electric = dt * sum(row[1] + row[2] for row in run.drawn[1:])
    spread = max(fractions) - min(fractions)
    # what is drawn goes by this step's switch, the duty by the last one's: equal where the switch stays
    last = dt * float(run.warm.duty @ np.array([20.0, 8.0])) * fractions[-1]
    if spread == 0.0:
        assert electric + last == pytest.approx(heat, rel=1e-9, abs=1e-9)
    assert first.tolist() == [0.0, 0.0]


def test_a_thermostat_holds_its_node_while_it_is_fed() -> None:
    """Between its two temperatures, in steps much longer than its cycle too."""
    for dt in (1.0, 60.0, 600.0):
        run = Run(COLD_BOX, power(capacity_ah=1000.0))
        seen = []
        for _ in range(round(40 * 3600 / dt)):
            run.step(ON, COLD, dt)
            seen.append(run.temperatures.copy())
        settled = np.array(seen)[len(seen) // 2 :]
        assert settled[:, 1].min() > 239.0 and settled[:, 1].max() < 243.0, dt
        assert settled[:, 0].min() > 259.9, dt


def test_a_heater_that_is_switched_off_or_has_no_energy_left_warms_nothing() -> None:
    off = Run(COLD_BOX, power())
    dead = Run(COLD_BOX, power(), soc=0.0)
    for _ in range(6000):
        off.step(np.array([1.0, 0.0, 0.0]), COLD, 60.0)
        dead.step(ON, COLD, 60.0)
    assert off.warm.thermal.account.heaters == 0.0
    assert dead.temperatures[1] < 200.0 and dead.temperatures[0] < 230.0
    assert dead.warm.thermal.account.heaters < 0.01 * 6000 * 60.0 * 28.0


def test_a_store_comes_to_the_temperature_of_what_is_round_it() -> None:
    run = Run(COLD_BOX, power(thermal_conductance=2.0, capacity_ah=1000.0))
    for _ in range(3000):
        run.step(np.array([1.0, 1.0, 0.0]), COLD, 60.0)
    cells: Any = run.powered.stores[0]
    assert cells.temperature == pytest.approx(run.temperatures[0], abs=0.5)
    other = Run(COLD_BOX.model_copy(update={"warms": {}}), power())
    assert other.heat.store_surroundings(other.warm, other.powered.stores, 60.0) == (None,)


def closed_box(capacity: float, temperature: float, *stores: str) -> ThermalParams:
    """A node [J/K], [K] with stores in it, and no other way for heat."""
    node = {"heat_capacity": capacity, "temperature": temperature}
    return ThermalParams.model_validate({"nodes": {"box": node}, "warms": dict.fromkeys(stores, "box")})


@settings(max_examples=60, deadline=None)
@given(
    dt=st.floats(0.02, 1e5),
    capacity=st.floats(20.0, 1e5),
    conductance=st.floats(0.01, 50.0),
    box=st.floats(150.0, 350.0),
)
def test_a_store_and_its_node_by_themselves_go_to_one_temperature_however_long_the_step(
    dt: float, capacity: float, conductance: float, box: float
) -> None:
    """Two bodies and a conductor, in closed form. Other than by their exchange the box is closed."""
    run = Run(closed_box(capacity, box, "battery"), power(thermal_conductance=conductance))
    cells: Any = run.powered.stores[0]
    begin, of_store = cells.temperature, run.network.stores[0].exchange[1]
    both = (of_store * begin + capacity * box) / (of_store + capacity)
    for count in range(1, 4):
        run.step(np.zeros(3), COLD, dt)
        left = math.exp(-count * dt * conductance * (1.0 / of_store + 1.0 / capacity))
        cells = run.powered.stores[0]
        assert cells.temperature == pytest.approx(both + (begin - both) * left, abs=1e-6)
        assert run.temperatures[0] == pytest.approx(both + (box - both) * left, abs=1e-6)


def test_two_stores_in_a_small_box_do_not_run_away() -> None:
    """Steps of an hour, the box of a hundredth of a cell's heat capacity: never out of the range of the beginning."""
    plain = power(thermal_conductance=5.0)
    two = plain.model_copy(update={"stores": {"second": plain.battery.model_copy()}})
    run = Run(closed_box(40.0, 200.0, "battery", "second"), two)
    warmest = max(store.temperature for store in run.powered.stores)
    for _ in range(100):
        run.step(np.zeros(3), COLD, 3600.0)
        now = [*run.temperatures, *(store.temperature for store in run.powered.stores)]
        assert min(now) >= 200.0 - 1e-6 and max(now) <= warmest + 1e-6
    assert max(now) - min(now) < 0.5


def test_a_thermal_switch_opens_in_the_cold() -> None:
    """By day the box loses 10 W/K to its radiator, by night nothing, and the kink is passed in proportion."""
    joint = [{"between": ("box", "motors"), "conductance": 10.0, "opens_below": 283.0, "switch_width": 10.0}]
    for temperature, conductance in ((300.0, 10.0), (288.0, 5.0), (270.0, 0.0)):
        nodes = {
            "box": {"heat_capacity": 9000.0, "temperature": temperature},
            "motors": {"heat_capacity": 2000.0, "temperature": 250.0},
        }
        network = ThermalNetwork(ThermalParams.model_validate({"nodes": nodes, "conductors": joint}))
        state = network.step(network.initial_state(), COLD, np.zeros(2), 0.01)
        passed = 9000.0 * (temperature - network.temperature(state, "box")) / 0.01
        assert passed == pytest.approx(conductance * (temperature - 250.0), rel=1e-3, abs=1e-6)
