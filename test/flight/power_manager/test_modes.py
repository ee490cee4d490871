"""Modes: what each means, sleep and waking, and that no noise makes them oscillate."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from sojourn_config.scenario import load_scenario
from sojourn_flight.power_manager import law as manager
from sojourn_flight.power_manager import modes
from sojourn_flight.power_manager.law import PowerManagerInput, PowerManagerOutput, PowerManagerState
from sojourn_flight.power_manager.modes import SleepParams, SleepState, Supply
from sojourn_flight.power_manager.params import PowerManagerParams
from sojourn_flight.power_manager.reading import StoreReading
from sojourn_machine.errors import InvalidValueError

PARAMS = load_scenario("flat_drive").power_manager
LAW = PARAMS.law
assert LAW.sleep is not None
SLEEP = LAW.sleep
COMPUTER = next(load.power_w for load in PARAMS.loads if load.name == "computer")


def step(
    state: PowerManagerState, soc: float, voltage: float, current: float = 2.0, dt: float = 0.1
) -> tuple[PowerManagerState, PowerManagerOutput]:
    """One period at a charge that is known."""
    state = replace(state, stores=(replace(state.stores[0], soc=soc),))
    return manager.step(PARAMS, state, PowerManagerInput((StoreReading(voltage, current, 290.0),)), dt)


def off(output: PowerManagerOutput) -> set[str]:
    return {switch.name for switch in output.switches if switch.mode == "off"}


def asleep() -> PowerManagerState:
    state = manager.initial_state(PARAMS, 0.04)
    for _ in range(70):
        state, output = step(state, 0.04, 28.0, 2.0, 1.0)
    assert output.mode == "SLEEP"
    return state


def test_each_mode_is_what_it_says() -> None:
    essential = {load.name for load in PARAMS.loads if load.essential}
    state, seen = manager.initial_state(PARAMS, 0.9), list[str]()
    for soc in np.linspace(0.4, 0.06, 400):
        state, output = step(state, soc, 29.0)
        if not seen or seen[-1] != output.mode:
            seen.append(output.mode)
        gone = off(output)
        moving = {"drive", "steer", "arm"}
        assert (output.mode == "NOMINAL") == (not gone)
        assert output.mode != "LOW" or not moving <= gone
        assert output.mode != "SAFE" or moving <= gone
        assert (output.mode == "SURVIVAL") == (gone == {load.name for load in PARAMS.loads} - essential)
    assert seen == ["NOMINAL", "LOW", "SAFE", "SURVIVAL"]
    assert "charge was below 8.0%" in output.mode_reason
    back = []
    for soc in np.linspace(0.06, 0.4, 400):
        state, output = step(state, soc, 29.0)
        if not back or back[-1] != output.mode:
            back.append(output.mode)
    assert back == seen[::-1]


def test_it_sleeps_when_the_charge_falls_on_and_only_then() -> None:
    state = manager.initial_state(PARAMS, 0.06)
    for _ in range(200):
        state, output = step(state, 0.06, 28.0, 2.0, 1.0)
    assert output.mode == "SURVIVAL"
    for _ in range(int(SLEEP.enter_time) - 1):
        state, output = step(state, 0.04, 28.0, 2.0, 1.0)
    assert output.mode == "SURVIVAL"
    state, output = step(state, 0.04, 28.0, 2.0, 1.0)
    assert output.mode == "SLEEP" and "below 5.0%" in output.mode_reason
    on = {switch.name for switch in output.switches if switch.mode == "on"}
    assert on == {"receiver", "survival_heater"}, "keep-alive heaters and receiver"


def test_it_wakes_by_itself_when_light_returns_and_loads_come_back_one_after_another() -> None:
    state = asleep()
    weak = 0.9 * COMPUTER / 30.0
    for _ in range(1000):
        state, output = step(state, 0.045, 30.0, -weak, 1.0)
    assert output.mode == "SLEEP", "not by less than the computer needs"
    strong, took = 1.2 * COMPUTER / 30.0, 0
    while output.mode == "SLEEP":
        state, output = step(state, 0.045, 30.0, -strong, 1.0)
        took += 1
    assert took == pytest.approx(SLEEP.wake_time, abs=5.0)
    assert output.mode == "SURVIVAL" and "computer" not in off(output)
    lit = state
    for _ in range(100):  # there is light: it does not fall asleep again
        lit, output = step(lit, 0.045, 30.0, -0.1, 1.0)
    assert output.mode == "SURVIVAL"
    counts = []
    for _ in range(300):
        state, output = step(state, 0.5, 30.0, -strong, 1.0)
        counts.append(len(off(output)))
    assert counts == sorted(counts, reverse=True) and counts[-1] == 0 and len(set(counts)) > 3


def test_it_wakes_when_the_charge_is_back() -> None:
    _, output = step(asleep(), 0.13, 30.0, -0.5)
    assert output.mode != "SLEEP"
    assert "computer" not in off(output)


def test_sleep_on_request_lasts_until_the_next_light_or_another_request() -> None:
    state = manager.requested(PARAMS, manager.initial_state(PARAMS, 0.8), {"sleep": True})
    for _ in range(1000):  # it is light all the time
        state, output = step(state, 0.8, 31.0, -3.0, 1.0)
    assert output.mode == "SLEEP" and output.mode_reason == "asked by the operator"
    assert off(output) == {load.name for load in PARAMS.loads} - {"receiver", "survival_heater"}
    for _ in range(100):
        state, output = step(state, 0.8, 29.0, 1.0, 1.0)
    woken, _ = step(manager.requested(PARAMS, state, {"sleep": False}), 0.8, 29.0)
    assert not woken.sleep.asleep
    for _ in range(400):
        state, output = step(state, 0.8, 31.0, -3.0, 1.0)
    assert output.mode != "SLEEP"


def test_a_machine_without_a_table_for_it_never_sleeps() -> None:
    params = PARAMS.model_copy(update={"law": LAW.model_copy(update={"sleep": None})})
    state = manager.initial_state(params, 0.01)
    for _ in range(300):
        state, output = manager.step(params, state, PowerManagerInput((StoreReading(25.0, 2.0, 290.0),)), 1.0)
    assert output.mode == "SURVIVAL"
    with pytest.raises(InvalidValueError, match=r"sleep.*not given"):
        manager.requested(params, state, {"sleep": True})


def test_bad_tables_are_refused_by_name() -> None:
    with pytest.raises(ValidationError, match="wake_soc"):
        SleepParams(loads=("computer",), below_soc=0.2, wake_soc=0.1, enter_time=1.0, wake_time=1.0)
    for name in ("computr", "drive"):
        sleep = SLEEP.model_copy(update={"loads": (name,)})
        with pytest.raises(ValidationError, match=r"sleep\.loads.*essential load"):
            PowerManagerParams(power=PARAMS.power, law=LAW.model_copy(update={"sleep": sleep}))


def changes(seen: list[str]) -> int:
    return sum(before != after for before, after in pairwise(seen))


@settings(max_examples=60, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    centre=st.floats(0.05, 0.3),
    noise=st.floats(0.0, 0.5),
    volts=st.floats(24.0, 28.0),
    swing=st.floats(0.0, 6.0),
)
def test_noise_changes_the_mode_no_oftener_than_hysteresis_allows(
    seed: int, centre: float, noise: float, volts: float, swing: float
) -> None:
    """A charge that is noisy within the hysteresis, on a bus that is noisy without bound."""
    random, levels = np.random.default_rng(seed), len(PARAMS.shed_priorities)
    state, seen, seconds = manager.initial_state(PARAMS, centre), list[str](), 400.0
    within = 0.49 * noise * 2.0 * LAW.shed_soc_hysteresis
    for _ in range(int(seconds / 0.5)):
        soc = max(centre + within * random.uniform(-1.0, 1.0), 0.0)
        state, output = step(state, soc, volts + swing * random.standard_normal(), 3.0 * random.standard_normal(), 0.5)
        seen.append(output.mode)
    by_voltage = 2.0 * (seconds / LAW.restore_interval + 1.0) + levels  # each level back needs its time above
    by_sleep = 2.0 * (seconds / SLEEP.enter_time + 1.0)
    assert changes(seen) <= by_voltage + by_sleep + 1


@pytest.mark.parametrize("seed", range(20))
def test_a_noisy_bus_and_a_noisy_charge_beside_a_threshold_do_not_make_it_oscillate(seed: int) -> None:
    """Charge at a threshold and voltage at the limit, both with the noise of a bad sensor: two changes in an hour."""
    random = np.random.default_rng(seed)
    threshold = float(random.choice(PARAMS.shed_thresholds))
    state, seen = manager.initial_state(PARAMS, threshold), list[str]()
    for _ in range(3600):
        soc = threshold + 0.4 * LAW.shed_soc_hysteresis * random.uniform(-1.0, 1.0)
        voltage = LAW.shed_voltage + 0.5 * LAW.shed_voltage_hysteresis + 0.3 * random.standard_normal()
        state, output = step(state, soc, voltage, 2.0 + 0.5 * random.standard_normal(), 1.0)
        seen.append(output.mode)
    assert changes(seen) <= 2


@settings(max_examples=100, deadline=None)
@given(st.lists(st.tuples(st.floats(0.0, 0.2), st.floats(-200.0, 200.0)), min_size=2, max_size=200))
def test_between_waking_and_sleeping_lies_the_time_that_the_law_says(days: list[tuple[float, float]]) -> None:
    state, since, dt = SleepState(), 0.0, 10.0
    for charge, intake in days:
        after = modes.after(SLEEP, PARAMS.loads, state, Supply(True, charge, intake), dt)
        since += dt
        if after.asleep != state.asleep:
            if after.asleep:
                assert since >= SLEEP.enter_time
            else:
                assert since >= SLEEP.wake_time or charge > SLEEP.wake_soc
            since = 0.0
        state = after


@given(st.lists(st.floats(0.0, 1.0), min_size=1, max_size=60))
def test_foreseen_sleep_begins_and_ends_with_its_own_hysteresis(leasts: list[float]) -> None:
    params, state = SLEEP.model_copy(update={"reserve": 0.2}), modes.AWAKE
    turned = [state.asleep]
    for least in leasts:
        before = state.asleep
        state = modes.foreseen(params, state, least, 24.0)
        assert state.asleep == (least <= 0.25 if before else least < 0.2)
        # neither charge nor light ends it
        assert modes.after(params, PARAMS.loads, state, Supply(False, 1.0, 500.0), 1e4).asleep == state.asleep
        turned.append(state.asleep)
    assert sum(a != b for a, b in pairwise(turned)) <= len(leasts)


def test_an_operator_ends_a_foreseen_sleep_and_none_is_foreseen_in_a_requested_one() -> None:
    params = SLEEP.model_copy(update={"reserve": 0.2})
    asleep = modes.foreseen(params, modes.AWAKE, 0.1, 24.0)
    assert "asleep it will come to 10.0% within 24 h" in asleep.reason
    assert not modes.requested(asleep, False).asleep
    requested = modes.requested(modes.AWAKE, True)
    assert modes.foreseen(params, requested, 0.9, 24.0) is requested
    assert modes.foreseen(SLEEP, modes.AWAKE, 0.0, 24.0) is modes.AWAKE
