"""A reactor that follows its load by itself: as its class does, its account, its kinetics by another way."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError
from scipy.integrate import solve_ivp

from sojourn_config.load import load_params
from sojourn_machine.power.fission_reactor import FissionReactorParams, ReactorState
from sojourn_machine.power.reactor_kernels import DECAYS, SHARES

KRUSTY = load_params("parts", "krusty", FissionReactorParams)


def run(params: FissionReactorParams, state: ReactorState, power: float, hours: float) -> list[ReactorState]:
    states = [state]
    for _ in range(round(hours * 60.0)):
        states.append(params.step(states[-1], power, 60.0))
    return states


def test_it_is_of_the_class_of_the_ground_test() -> None:
    """One kilowatt class, a core near 800 C."""
    assert 900.0 < KRUSTY.most_power < 1300.0
    assert KRUSTY.point(KRUSTY.initial_state()).power == pytest.approx(KRUSTY.most_power)


def test_it_stands_still_without_a_load() -> None:
    """Its leak is what its core makes."""
    states = run(KRUSTY, KRUSTY.initial_state(), 0.0, 10.0)
    assert all(state.temperature == pytest.approx(1073.0, abs=0.1) for state in states)
    assert KRUSTY.fission(states[-1]) == pytest.approx(0.4 * (1073.0 - 293.15), rel=1e-3)


def test_more_load_brings_more_fission_at_the_same_temperature() -> None:
    """No control acts: the core cools a little, comes up, and is where it was, for half of the load and for all."""
    state = KRUSTY.initial_state()
    for power in (500.0, 1000.0):
        states = run(KRUSTY, state, power, 4.0)
        state = states[-1]
        assert min(one.temperature for one in states) > 1010.0
        assert state.temperature == pytest.approx(1073.0, abs=2.0)
        heat = power / KRUSTY.efficiency(state.temperature) + 0.4 * (state.temperature - 293.15)
        assert KRUSTY.fission(state) == pytest.approx(heat, rel=0.01)
    gone = run(KRUSTY, state, 0.0, 20.0)
    assert max(one.temperature for one in gone) < 1073.0 + 80.0
    assert gone[-1].temperature == pytest.approx(1073.0, abs=5.0)


def test_it_starts_cold_within_hours_and_is_kept_in_its_limits() -> None:
    cold = KRUSTY.model_copy(update={"running": False})
    states = run(cold, cold.initial_state(), 0.0, 8.0)
    assert states[0].temperature == 293.15 and cold.point(states[0]).power == 0.0
    warm = next(place for place, one in enumerate(states) if one.temperature > 1050.0)
    assert 20.0 < warm < 180.0  # minutes; the ground test took about 90
    assert max(cold.fission(one) for one in states) < 2.0 * KRUSTY.start_power
    assert states[-1].temperature == pytest.approx(1073.0, abs=20.0)


@settings(max_examples=20, deadline=None)
@given(
    loads=st.lists(st.floats(0.0, 1.0), min_size=1, max_size=30),
    dt=st.sampled_from([0.02, 1.0, 60.0]),
    running=st.booleans(),
)
def test_energy_is_kept(loads: list[float], dt: float, running: bool) -> None:
    """Fission is power, heat that goes out, and warmth of the core."""
    reactor = KRUSTY.model_copy(update={"running": running})
    first = state = reactor.initial_state()
    heat = 0.0
    for load in loads:
        after = reactor.step(state, load * reactor.point(state).power, dt)
        heat += reactor.heat_given(state, after)
        state = after
    stored = KRUSTY.heat_capacity * (state.temperature - first.temperature)
    assert state.energy_fission == pytest.approx(state.energy + heat + stored, rel=1e-9, abs=1e-6)


def test_its_kinetics_are_those_of_an_integrator() -> None:
    """Half of the load at once, ten minutes of it, by an implicit integrator of high order."""
    drawn = 500.0 / KRUSTY.efficiency(1073.0)
    first = KRUSTY.initial_state()

    def flow(t: float, x: np.ndarray) -> Any:
        rho = first.rod + KRUSTY.feedback * (x[6] - 293.15)
        power = x[:6].sum() / (1.0 - rho)
        warming = (power - drawn - KRUSTY.leak * (x[6] - 293.15)) / KRUSTY.heat_capacity
        return np.append(DECAYS * (SHARES * power - x[:6]), warming)

    start = np.append(first.groups, first.temperature)
    path = solve_ivp(flow, (0.0, 600.0), start, method="Radau", rtol=1e-8, atol=1e-8, t_eval=np.arange(0.0, 601.0))
    steady = KRUSTY.model_copy(update={"carnot_fraction": 1e-9, "leak": KRUSTY.leak})  # takes what it is told
    state, seen = first, []
    for _ in range(600):
        power = drawn * steady.efficiency(state.temperature)
        state = steady.step(state, power, 1.0)
        seen.append(state.temperature)
    assert np.array(seen) == pytest.approx(path.y[6, 1:], abs=0.5)


def test_a_load_changes_the_temperature_only_as_it_should() -> None:
    """Groups sum to one, so a steady core bears all of its delayed neutrons."""
    assert SHARES.sum() == pytest.approx(1.0, abs=1e-3)
    state = KRUSTY.initial_state()
    assert state.groups.sum() == pytest.approx(KRUSTY.fission(state), rel=1e-3)


@pytest.mark.parametrize(
    "change", [{"feedback": 0.001}, {"least_temperature": 1200.0}, {"cold_end": 900.0}, {"heat_capacity": -1.0}]
)
def test_a_reactor_that_cannot_be_is_refused(change: dict[str, float]) -> None:
    with pytest.raises(ValidationError):
        FissionReactorParams(**(KRUSTY.model_dump() | change))
