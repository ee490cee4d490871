"""Telemetry that a bit on its way has made absurd: the power manager refuses it with its reason and goes on."""

import pytest

from sojourn_config.scenario import load_scenario
from sojourn_contract.app import Period
from sojourn_contract.values import BatteryState
from sojourn_flight.power_manager.reading import LARGEST
from sojourn_power.app import BUS, PowerApp

EVERY = 100_000_000
"""[ns]"""
GOOD = {"voltage": 29.5, "current": -2.0, "temperature": 10.0}


@pytest.fixture(scope="module")
def app() -> PowerApp:
    return PowerApp.of(load_scenario("flat_drive"))


@pytest.mark.parametrize("key", GOOD)
@pytest.mark.parametrize("value", [1e200, -1e200, 1e10, float("nan"), float("inf")])
def test_what_no_sensor_can_mean_is_refused(app: PowerApp, key: str, value: float) -> None:
    """A voltage of 1e200 V ended the role: its square is no number."""
    state = app.initial_state()
    for step in range(1, 6):
        state, _ = app.step(state, Period(step * EVERY, {BUS: BatteryState(step * EVERY, **GOOD)}))
    known = state.telemetry
    absurd = BatteryState(6 * EVERY, **{**GOOD, key: value})
    state, answer = app.step(state, Period(6 * EVERY, {BUS: absurd}))
    ((topic, refusal),) = answer.refusals
    assert topic == BUS and key in str(refusal)
    assert state.telemetry == known


def test_whatever_is_not_refused_can_be_reckoned_with(app: PowerApp) -> None:
    """At the limits themselves, both ways, all numbers of the law stay numbers."""
    state = app.initial_state()
    for step, sign in enumerate((1.0, -1.0, 1.0, 1.0, -1.0), start=1):
        readings = {"voltage": sign * LARGEST, "current": sign * LARGEST, "temperature": 0.9 * LARGEST}
        message = BatteryState(step * EVERY, **readings)
        state, answer = app.step(state, Period(step * EVERY, {BUS: message}))
        assert not answer.refusals
        assert 0.0 <= state.manager.stores[0].soc <= 1.0
