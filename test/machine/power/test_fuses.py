"""Fuses and breakers: the law of their melting, what they do in a network, and checks before a run."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError
from test_network import BATTERY, bus, load

from sojourn_config.errors import ConfigError
from sojourn_config.scenario import load_scenario
from sojourn_machine.power.battery import BatteryParams
from sojourn_machine.power.fuses import FuseParams, Fuses
from sojourn_machine.power.network import PowerNetwork
from sojourn_machine.power.power_params import PowerParams

PACK = BatteryParams(**BATTERY | {"capacity_ah": 80.0})


def network(**fuse: object) -> PowerNetwork:
    """A motor with a fuse, and a lamp without."""
    motor = load("motor", 300.0, fuse=FuseParams.model_validate({"rating_a": 5.0, "melting_i2t": 100.0} | fuse))
    return PowerNetwork(PowerParams(battery=PACK, bus=bus(motor, load("lamp", 20.0, kind="constant_power"))))


@given(st.floats(1.01, 20.0), st.floats(0.1, 1e4), st.sampled_from([0.001, 0.02]))
def test_a_constant_current_melts_it_after_the_time_of_the_law(times: float, i2t: float, dt: float) -> None:
    """t = I2t / (I^2 - I_r^2)."""
    fuses = Fuses([load("motor", 1.0, fuse=FuseParams(rating_a=2.0, melting_i2t=i2t))])
    current, expected = 2.0 * times, i2t / (4.0 * (times**2 - 1.0))
    state, steps = fuses.first(), 0
    while not state.blown[0] and steps < 2000:
        state, steps = fuses.after(state, np.ones(1), np.array([current]), dt), steps + 1
    assert abs(min(expected, 2000 * dt) - steps * dt) <= dt * (1.0 + 1e-6)


def test_at_its_rating_it_carries_for_ever_and_forgets() -> None:
    fuses = Fuses([load("motor", 1.0, fuse=FuseParams(rating_a=2.0, melting_i2t=10.0)), load("lamp", 1.0)])
    state = fuses.after(fuses.first(), np.ones(2), np.array([4.0, 1e3]), 0.5)
    assert state.heat.tolist() == [6.0, 0.0] and not state.blown.any()
    for _ in range(100):
        state = fuses.after(state, np.ones(2), np.array([1.0, 1e3]), 0.5)
    assert state.heat[0] == 0.0 and not state.blown.any()
    state = fuses.after(state, np.ones(2), np.array([2.0, 0.0]), 1e6)
    assert not state.blown.any()


def test_an_open_fuse_takes_its_load_off_for_good_and_no_other() -> None:
    grid = network()
    state = grid.initial_state(0.8)
    powers = []
    for _ in range(300):
        state, output = grid.step(state, (1.0, 1.0), (280.0, 0.0), 0.1)
        powers.append(output.load_power.tolist())
    assert powers[0][0] == pytest.approx(280.0) and powers[-1][0] == 0.0
    assert all(lamp == pytest.approx(20.0) for _, lamp in powers)
    assert np.asarray(grid.served_at_loads(state)).tolist() == [0.0, 1.0]
    state, _ = grid.step(state, (0.0, 1.0), (0.0, 0.0), 1.0)
    _, output = grid.step(state, (1.0, 1.0), (50.0, 0.0), 1.0)
    assert output.load_power[0] == 0.0


def test_a_breaker_closes_when_its_load_has_been_off() -> None:
    grid = network(resets=True)
    state = grid.initial_state(0.8)
    for _ in range(300):
        state, output = grid.step(state, (1.0, 1.0), (280.0, 0.0), 0.1)
    assert output.load_power[0] == 0.0
    state, _ = grid.step(state, (0.0, 1.0), (50.0, 0.0), 0.1)
    _, output = grid.step(state, (1.0, 1.0), (50.0, 0.0), 0.1)
    assert output.load_power[0] == pytest.approx(50.0)


def test_a_network_without_fuses_remembers_none() -> None:
    grid = PowerNetwork(PowerParams(battery=PACK, bus=bus(load("lamp", 20.0))))
    assert grid.fuses is None and grid.initial_state(0.5).fuses is None


def test_a_fuse_smaller_than_its_load_is_said_before_the_run() -> None:
    loads = [load.name for load in load_scenario("flat_drive").power.loads]
    key = f"bus.loads[{loads.index('computer')}].fuse"
    with pytest.raises(ConfigError, match=r"fuse.rating_a = 0.5.*allowed is at least 1\.\d+ A, which computer takes"):
        load_scenario("flat_drive", [key + "={rating_a: 0.5, melting_i2t: 10.0}"])
    with pytest.raises(ValidationError):
        FuseParams(rating_a=0.0, melting_i2t=1.0)
