"""Telemetry that a bit on its way has made absurd: the power manager refuses it with its reason and goes on."""

from functools import cache

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_config.scenario import load_scenario
from sojourn_contract.app import Period
from sojourn_contract.heartbeat import status_values
from sojourn_contract.stamps import CONTROL_PERIOD_NS
from sojourn_contract.topics import topic
from sojourn_contract.values import BatteryState
from sojourn_flight.power_manager.forecast import Known, PowerForecast
from sojourn_flight.power_manager.reading import LARGEST
from sojourn_machine.errors import InvalidValueError
from sojourn_power.app import BUS, FORECAST, SWITCHES, PowerApp

EVERY = 100_000_000
"""[ns]"""
GOOD = {"voltage": 29.5, "current": -2.0, "temperature": 10.0}


@cache
def app_of_flat_drive() -> PowerApp:
    return PowerApp.of(load_scenario("flat_drive"))


@pytest.fixture
def app() -> PowerApp:
    return app_of_flat_drive()


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
    ((name, refusal),) = answer.refusals
    assert name == BUS and key in refusal
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


def test_where_nothing_can_be_foreseen_it_says_so_and_the_switches_are_set(
    app: PowerApp, monkeypatch: pytest.MonkeyPatch
) -> None:
    def unable(known: Known) -> PowerForecast:
        raise InvalidValueError("battery temperature [K]", 2e6, "a number")

    monkeypatch.setattr(app._forecaster, "forecast", unable)
    minute = topic(FORECAST).every * CONTROL_PERIOD_NS
    state, answer = app.step(app.initial_state(), Period(minute, {BUS: BatteryState(minute, **GOOD)}))
    messages = dict(answer.messages)
    assert messages[FORECAST].points == () and status_values(messages[SWITCHES])["drive"] == "on"
    assert "nothing can be foreseen: battery temperature" in state.ahead
    assert answer.errors == [state.ahead]
    monkeypatch.undo()
    later = 2 * minute
    state, answer = app.step(state, Period(later, {BUS: BatteryState(later, **GOOD)}))
    assert len(dict(answer.messages)[FORECAST].points) > 1 and not answer.errors


@settings(max_examples=30, deadline=None)
@given(
    voltage=st.floats(-LARGEST, LARGEST), current=st.floats(-LARGEST, LARGEST), celsius=st.floats(-273.0, 0.9 * LARGEST)
)
def test_whatever_is_measured_the_look_ahead_ends_nobody(voltage: float, current: float, celsius: float) -> None:
    app, minute = app_of_flat_drive(), topic(FORECAST).every * CONTROL_PERIOD_NS
    message = BatteryState(minute, voltage=voltage, current=current, temperature=celsius)
    _, answer = app.step(app.initial_state(), Period(minute, {BUS: message}))
    assert FORECAST in dict(answer.messages)
