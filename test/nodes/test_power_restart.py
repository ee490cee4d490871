"""A power manager whose process was started again: loads stay as they were asked for, or come back in stages."""

import json
from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from sojourn_config.scenario import load_scenario
from sojourn_contract.app import App, Period
from sojourn_contract.disturbed_app import disturbed
from sojourn_contract.heartbeat import status_message, status_values
from sojourn_contract.kept_data import Kept
from sojourn_contract.messages import battery_state
from sojourn_contract.run_table import table_of
from sojourn_contract.stamps import NANOSECONDS
from sojourn_contract.state_tree import packed, unpacked
from sojourn_contract.values import NOT_MEASURED
from sojourn_flight.power_manager.kalman import CHARGE
from sojourn_flight.power_manager.string_watch import StringState
from sojourn_flight.power_manager.switch_watch import StuckSwitch
from sojourn_machine.disturbance import Disturbance
from sojourn_power.app import PowerApp
from sojourn_power.memory import PowerState

EVERY = NANOSECONDS // 10
"""From telemetry to telemetry [ns]."""
HIGH = 29.5
"""Voltage of the battery at rest, well charged [V]."""
AT = 30 * EVERY
ALARM = "the power manager was restarted: it goes on with what was asked of it, from a charge of "
FORGOTTEN = "the power manager was restarted and does not know what was asked of it"
ASKED = {"cameras": "off", "sleep": "on"}


def app_of(*told: str) -> PowerApp:
    return PowerApp.of(load_scenario("flat_drive", ["steps=[]", *told]))


@pytest.fixture(scope="module")
def app() -> PowerApp:
    return app_of()


def run(
    app: App[Any], state: Any, steps: Iterable[int], asked: dict[int, dict[str, str]] | None = None
) -> tuple[Any, dict[str, Any]]:
    """The state after so many steps, and what was said last on each topic."""
    stores = [name for name in ("/bus/state", "/bus/state/auxiliary")]
    said: dict[str, Any] = {}
    for step in steps:
        stamp = step * EVERY
        telemetry = battery_state(stamp, HIGH, 2.0, 290.0, NOT_MEASURED, NOT_MEASURED, NOT_MEASURED)
        words = (asked or {}).get(step)
        goals = [("/power/request", status_message(stamp, "request", words))] if words else []
        state, answer = app.step(state, Period(stamp, dict.fromkeys(stores, telemetry), goals))
        said |= dict(answer.messages)
        assert not answer.errors
    return state, said


def values(said: dict[str, Any], topic: str) -> dict[str, str]:
    return status_values(said[topic])


def kept_of(app: PowerApp, state: PowerState, stamp: int = AT) -> Kept:
    return Kept(stamp, json.loads(json.dumps(app.to_keep(state))))


def asked_to_sleep(app: PowerApp) -> PowerState:
    state: PowerState = run(app, app.initial_state(), range(1, 31), {3: ASKED})[0]
    return state


@pytest.mark.parametrize(
    "end",
    [Disturbance("restarted", "", "power", AT + EVERY), Disturbance("killed", "", "power", AT - EVERY, AT + EVERY)],
)
def test_what_was_asked_for_outlasts_the_process(app: PowerApp, end: Disturbance) -> None:
    among = disturbed(app, table_of(load_scenario("flat_drive")), [end])
    before, told = run(among, among.initial_state(), range(1, 31), {3: ASKED})
    assert among.heartbeat_values(before, AT) == {} and "restarted" not in values(told, "/power/status")["reason"]
    state, said = run(among, before, range(31, 41))
    assert state.restarts == 1
    assert values(said, "/power/switches") == values(told, "/power/switches")
    assert {"cameras", "computer", "drive"} <= {
        name for name, mode in values(said, "/power/switches").items() if mode == "off"
    }
    status = values(said, "/power/status")
    assert (status["request"], status["request_state"], status["mode"]) == ("cameras off, sleep on", "done", "SLEEP")
    alarm = among.heartbeat_values(state, AT)["alarm"]
    assert alarm.startswith(ALARM) and status["reason"].startswith(alarm) and said["/power/status"].status[0].level == 1
    state, said = run(among, state, range(41, 51), {41: {"sleep": "off"}})
    assert among.heartbeat_values(state, AT) == {} and "restarted" not in values(said, "/power/status")["reason"]
    assert values(said, "/power/switches")["computer"] == "on"
    state, said = run(among, state, range(51, 51 + 3000))
    switches = values(said, "/power/switches")
    assert [name for name, mode in switches.items() if mode == "off"] == ["cameras"]


def test_a_request_that_is_refused_leaves_the_alarm(app: PowerApp) -> None:
    again = app.started_again(app.initial_state(), AT + EVERY, kept_of(app, asked_to_sleep(app)))
    state, _ = run(app, again, [31], {31: {"camera": "off"}})
    assert app.heartbeat_values(state, AT)["alarm"].startswith(ALARM)


def test_without_anything_kept_loads_come_back_one_level_after_another(app: PowerApp) -> None:
    again = app.started_again(app.initial_state(), AT, None)
    assert app.heartbeat_values(again, AT)["alarm"].startswith(FORGOTTEN)
    state, said = run(app, again, range(30, 41))
    assert values(said, "/power/status")["reason"].startswith(FORGOTTEN)
    levels = len(app.params.shed_priorities)
    seen = [state.manager.level_by_voltage]
    for first in range(41, 2000, 10):
        state, said = run(app, state, range(first, first + 10))
        if state.manager.level_by_voltage != seen[-1]:
            seen.append(state.manager.level_by_voltage)
    assert seen == list(range(levels, -1, -1)) and "off" not in values(said, "/power/switches").values()


def known(state: PowerState) -> PowerState:
    """With faults that it has recognised."""
    faults = state.manager.faults
    strings = (StringState(failed=1, evidence=16.0, squares=2.0, products=4.0),)
    switches = replace(faults.switches, stuck=(StuckSwitch("cameras", "switch stuck on", "9.0 W"),))
    return replace(state, manager=replace(state.manager, faults=replace(faults, strings=strings, switches=switches)))


@pytest.mark.parametrize("estimator", ["coulomb", "kalman"])
def test_what_it_believes_goes_through_json_to_the_last_bit(estimator: str) -> None:
    app = app_of(f"power_manager.estimator={estimator}", "battery.cells_parallel=2")
    before = replace(known(run(app, app.initial_state(), range(1, 31), {3: ASKED})[0]), clean=0.7, held=1.3)
    after = app.started_again(app.initial_state(), before.stepped_at + 1, kept_of(app, before, before.stepped_at))
    old, new = before.manager, after.manager
    assert (new.wanted, new.sleep, new.drive_fraction) == (old.wanted, old.sleep, old.drive_fraction)
    assert (new.level_by_charge, new.level_by_voltage) == (old.level_by_charge, old.level_by_voltage)
    assert new.faults.strings == old.faults.strings and new.faults.switches.stuck == old.faults.switches.stuck
    assert [store.soc for store in new.stores] == [store.soc for store in old.stores]
    for store, was in zip(new.stores, old.stores, strict=True):
        assert (store.filter is None) == (was.filter is None) == (estimator == "coulomb")
        if store.filter is not None:
            np.testing.assert_array_equal(store.filter.mean, was.filter.mean)
            np.testing.assert_allclose(store.filter.covariance, was.filter.covariance, rtol=0.0, atol=1e-18)
    same = ("request", "stepped_at", "looked_at", "clean", "held")
    assert [getattr(after, name) for name in same] == [getattr(before, name) for name in same]
    _, said = run(app, after, range(31, 41))
    faults = values(said, "/power/status")["faults"]
    assert "failed string" in faults and "cameras switch stuck on: 9.0 W" in faults


def test_a_charge_is_as_unsure_as_it_may_have_been_drawn_on_meanwhile() -> None:
    app = app_of("power_manager.estimator=kalman")
    before = run(app, app.initial_state(), range(1, 31))[0]
    (store,), (was,) = app.params.stores, before.manager.stores
    most = sum(load.power_w for load in app.params.loads) / store.open_circuit_voltage(0.5)
    for seconds in (0.1, 10.0, 1e6):
        stamp = before.stepped_at + round(seconds * NANOSECONDS)
        after = app.started_again(app.initial_state(), stamp, kept_of(app, before))
        (now,) = after.manager.stores
        assert was.filter is not None and now.filter is not None
        drawn = min(most * seconds / store.charge_capacity, 1.0)
        grown = now.filter.covariance - was.filter.covariance
        assert grown[CHARGE, CHARGE] == pytest.approx(drawn**2) and np.count_nonzero(grown) == 1


def test_what_was_drawn_meanwhile_is_counted(app: PowerApp) -> None:
    before = run(app, app.initial_state(), range(1, 31))[0]
    again = app.started_again(app.initial_state(), AT + 100 * EVERY, kept_of(app, before))
    counted, _ = run(app, again, [130])
    drawn = before.manager.stores[0].soc - counted.manager.stores[0].soc
    assert drawn == pytest.approx(2.0 * 10.0 / app.params.stores[0].charge_capacity)


def test_the_heat_that_is_believed_stays() -> None:
    app = app_of("machine=explorer_night")
    state = run(app, app.initial_state(), [1])[0]
    assert state.heat is not None
    warm = replace(state.heat, thermal=replace(state.heat.thermal, temperatures=state.heat.thermal.temperatures - 20.0))
    before = replace(state, heat=warm, looked_at=7 * EVERY)
    after = app.started_again(app.initial_state(), AT, kept_of(app, before))
    assert after.heat is not None and after.looked_at == 7 * EVERY
    np.testing.assert_array_equal(after.heat.thermal.temperatures, warm.thermal.temperatures)
    assert after.heat.thermal.age == pytest.approx(0.7)
    run(app, after, range(31, 41))


SPOILT: list[dict[str, Any]] = [
    {"manager": None},
    {"manager": {}},
    {"request": 7},
    {"held": float("nan")},
    {"heat": {"temperatures": [250.0], "heating": [], "duty": []}},
    {"stepped_at": "now"},
]
SPOILT_MANAGER: list[dict[str, Any]] = [
    {"wanted": {"nothing": True}},
    {"wanted": {"computer": False}},
    {"wanted": {"cameras": "perhaps"}},
    {"sleep": {"asleep": "deep"}},
    {"level_by_charge": 99},
    {"level_by_voltage": -1},
    {"stores": {}},
    {"stores": {"another": {"soc": 0.5, "filter": None, "strings": {}}}},
    {"stores": {"battery": {"soc": 1.5, "filter": None, "strings": {}}}},
    {"stores": {"battery": {"soc": 0.5, "filter": {"mean": [1.0], "covariance": []}, "strings": {}}}},
    {
        "stores": {
            "battery": {"soc": 0.5, "filter": {"mean": [1.0] * 6, "covariance": [[1.0], [1.0, 2.0]]}, "strings": {}}
        }
    },
    {"stores": {"battery": {"soc": 0.5, "filter": {"mean": [0.0] * 6, "covariance": [[1.0] * 6] * 6}, "strings": {}}}},
    {"stores": {"battery": {"soc": 0.5, "filter": {"mean": [1.0] * 6, "covariance": [[-1.0] * 6] * 6}, "strings": {}}}},
    {"stores": {"battery": {"soc": 0.5, "filter": None, "strings": {"failed": 9}}}},
    {"stuck": [{"load": 7}]},
    {"drive_fraction": float("inf")},
]


@pytest.mark.parametrize(
    ("spoilt", "of_manager"), [*((each, False) for each in SPOILT), *((each, True) for each in SPOILT_MANAGER)]
)
def test_what_cannot_be_used_is_left_and_named(app: PowerApp, spoilt: dict[str, Any], of_manager: bool) -> None:
    kept = kept_of(app, asked_to_sleep(app)).values
    kept |= {"manager": {**kept["manager"], **spoilt}} if of_manager else spoilt
    after = app.started_again(app.initial_state(), AT, Kept(AT, kept))
    assert after.alarm.startswith(FORGOTTEN) and "; what was kept cannot be used: " in after.alarm
    assert after.manager.level_by_voltage == len(app.params.shed_priorities) and all(after.manager.wanted)
    run(app, after, range(31, 36))


def test_sleep_that_the_law_does_not_know_is_left() -> None:
    sleeper = app_of()
    kept = kept_of(sleeper, asked_to_sleep(sleeper))
    app = app_of("power_manager.sleep=null")
    assert "sleep.asleep" in app.started_again(app.initial_state(), AT, kept).alarm


def test_what_was_kept_before_any_telemetry_is_used_too(app: PowerApp) -> None:
    state, _ = app.step(
        app.initial_state(), Period(EVERY, {}, [("/power/request", status_message(9, "request", ASKED))])
    )
    after = app.started_again(app.initial_state(), AT, kept_of(app, state, EVERY))
    _, said = run(app, after, [31])
    assert values(said, "/power/switches")["cameras"] == "off"
    assert after.alarm == "the power manager was restarted: it goes on with what was asked of it"


def test_two_stores_are_kept_by_their_names() -> None:
    scenario = load_scenario("test/stack/two_stores.yaml")
    app = PowerApp.of(scenario)
    names = [name for name in scenario.power.all_stores]
    kept = app.to_keep(app.initial_state())
    assert list(kept["manager"]["stores"]) == names and len(names) == 2


def test_a_state_after_a_restart_is_saved_and_resumed(app: PowerApp) -> None:
    again = app.started_again(app.initial_state(), AT + EVERY, kept_of(app, asked_to_sleep(app)))
    for steps in (0, 4):
        state = run(app, again, range(31, 31 + steps))[0]
        read = unpacked(packed(state, "power"), "power")
        told = [run(app, each, range(31 + steps, 41))[1] for each in (state, read)]
        assert told[0] == told[1]


def test_a_first_process_has_no_alarm(app: PowerApp) -> None:
    assert app.heartbeat_values(app.initial_state(), EVERY) == {}
