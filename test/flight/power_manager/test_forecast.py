"""Power and charge ahead: what is planned, previews beside fine steps, bounds beside what comes."""

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_config.expected_heat import heat_at_start
from sojourn_config.expected_light import expected_light
from sojourn_config.scenario import LoadedScenario, load_scenario
from sojourn_contract.stamps import CONTROL_PERIOD_S
from sojourn_contract.topics import topic
from sojourn_flight.power_manager import law
from sojourn_flight.power_manager.activities import Activities, ActivityParams
from sojourn_flight.power_manager.forecast import COLUMNS, LOOKS_APART, Forecaster, Known, PowerForecast
from sojourn_flight.power_manager.params import PowerManagerParams
from sojourn_flight.power_manager.preview import Preview
from sojourn_flight.power_manager.reading import StoreReading
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.power.network import PowerNetwork
from sojourn_machine.power.power_params import PowerParams
from sojourn_machine.power.surroundings import DARK, PowerSurroundings

SOLAR = Path(__file__).parents[2] / "stack" / "solar"
MARS = ["body=mars", "site={latitude_deg: -1.95, longitude_deg: 354.47}",
        "sun={time: '2004-01-25T05:05:00Z', optical_depth: 0.5}"]  # fmt: skip
EXPLORER = load_scenario("flat_drive")
UNDER_THE_SUN = load_scenario("flat_drive", [f"machine={SOLAR}", *MARS])


def forecast(scenario: LoadedScenario, soc: float, activities: Sequence[ActivityParams] = ()) -> PowerForecast:
    params = scenario.power_manager
    forecaster = Forecaster(params, activities, expected_light(scenario.as_believed()), heat_at_start(scenario))
    return forecaster.forecast(Known(0.0, law.initial_state(params, soc), telemetry(scenario, soc)))


def telemetry(scenario: LoadedScenario, soc: float) -> tuple[StoreReading]:
    """Of the only store, at rest."""
    store = scenario.power_manager.stores[0]
    return (StoreReading(store.open_circuit_voltage(soc), 0.0, store.initial_state(soc).temperature),)


@given(st.floats(0.0, 40.0), st.floats(0.1, 20.0), st.one_of(st.none(), st.floats(0.1, 30.0)), st.floats(0.0, 200.0))
def test_an_activity_is_on_where_one_of_its_spans_is(start: float, hours: float, gap: float | None, now: float) -> None:
    every = None if gap is None else hours + gap
    activity = ActivityParams(load="drive", power_w=10.0, start_h=start, hours=hours, every_h=every)
    starts = [start] if every is None else [start + k * every for k in range(int(now / every) + 2)]
    distance = min(min(abs(now - begin), abs(now - begin - hours)) for begin in starts)
    if distance > 1e-6:  # at an edge a rounding decides
        assert activity.is_on(3600.0 * now) == any(begin <= now < begin + hours for begin in starts)


def test_demands_add_up_and_what_is_off_comes_back() -> None:
    planned = Activities(
        EXPLORER.power_manager,
        [
            ActivityParams(load="drive", power_w=60.0, start_h=1.0, hours=2.0),
            ActivityParams(load="drive", power_w=20.0, start_h=2.0, hours=2.0),
            ActivityParams(load="cameras", start_h=1.0, hours=1.0),
        ],
    )
    drive = [load.name for load in EXPLORER.power.loads].index("drive")
    assert [planned.demand(3600.0 * hour)[drive] for hour in (0.5, 1.5, 2.5, 3.5, 4.5)] == [0.0, 60.0, 80.0, 20.0, 0.0]
    assert [planned.asked(3600.0 * hour)["cameras"] for hour in (0.5, 1.5, 2.5)] == [True, False, True]


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"load": "drives"}, "did you mean drive"),
        ({"load": "computer"}, "essential and never off"),
        ({"load": "cameras", "power_w": 5.0}, "cameras draws 9 W while on"),
        ({"load": "drive", "power_w": 500.0}, "at most the 200 W of drive"),
        ({"load": "sleep", "power_w": 5.0}, "none while the machine sleeps"),
    ],
)
def test_what_a_machine_cannot_do_is_said(values: dict[str, object], words: str) -> None:
    activity = ActivityParams.model_validate({"start_h": 0.0, "hours": 1.0, **values})
    with pytest.raises(InvalidValueError, match=words):
        Activities(EXPLORER.power_manager, [activity])


def test_steps_of_ten_minutes_come_to_what_steps_of_two_seconds_do() -> None:
    """All that the law does in seconds included: it sheds level after level, falls asleep and wakes."""
    params = UNDER_THE_SUN.power_manager
    planned = Activities(params, [ActivityParams(load="drive", power_w=40.0, start_h=3.0, hours=1.0)])
    charges = {}
    for dt in (2.0, 600.0):
        preview = Preview(params, PowerNetwork(params.power), planned, expected_light(UNDER_THE_SUN.as_believed()))
        steps = preview.run(preview.initial_state(0.6), dt, round(6.0 * 3600.0 / dt))
        charges[dt] = np.interp(
            np.arange(600.0, 21601.0, 600.0), [s.time for s in steps], [s.charges[0] for s in steps]
        )
    assert np.abs(charges[2.0] - charges[600.0]).max() < 0.01


def test_it_tells_the_first_limit_and_the_end() -> None:
    found = forecast(EXPLORER, 0.8)
    assert found.values.shape == (144, len(COLUMNS)) and found.times[0] == 600.0 and found.times[-1] == 86400.0
    assert "LOW (1 of 5 levels shed: charge was below 25.0%) in 3.3 h" in found.words
    assert "empty in 5.3 h" in found.words and "at the earliest" in found.words
    charge, low, high, offered, used = found.values.T
    assert (low <= charge).all() and (charge <= high).all() and not offered.any() and used[0] > 80.0 > 60.0 > used[24]
    assert (found.values[:, :3] >= 0.0).all() and (found.values[:, :3] <= 1.0).all()


def test_under_the_sun_it_tells_of_the_night() -> None:
    found = forecast(UNDER_THE_SUN, 0.9)
    offered = found.values[:, 3]
    noon = int(np.argmax(offered))
    assert 100.0 < offered[noon] < 200.0 and (offered == 0.0).mean() == pytest.approx(0.5, abs=0.05)


def test_a_site_that_never_sees_the_sun_is_said() -> None:
    """A crater at the pole of Mars in its winter: the array is there, and gives nothing."""
    there = "site={latitude_deg: 89.0, longitude_deg: 0.0}"
    dark = load_scenario("flat_drive", [f"machine={SOLAR}", MARS[0], there, MARS[2]])
    assert "no source gives anything" in forecast(dark, 0.9).words
    assert "no source" not in forecast(UNDER_THE_SUN, 0.9).words and "no source" not in forecast(EXPLORER, 0.9).words


def test_a_heater_is_foreseen_by_its_thermostat() -> None:
    """A warm box needs none for hours; without its radioisotope heat it asks for more and more of it."""
    warm, cold = "thermal.nodes.box.temperature=290.0", "thermal.radioisotope_heaters=[]"
    night = load_scenario("lunar_night", [warm, "activities=[{load: sleep, start_h: 0.0, hours: 600.0}]"])
    without = load_scenario("lunar_night", [warm, cold, "activities=[{load: sleep, start_h: 0.0, hours: 600.0}]"])
    plans = [forecast(one, 0.9, one.config.activities) for one in (night, without)]
    used, used_cold = (plan.values[:, COLUMNS.index("used_w")] for plan in plans)
    heater = 10.0 * (8 * 4.2 / 28.0) ** 2  # a resistor, at most at the voltage of the full pack
    assert used.max() - used.min() < 1.0 and used[0] == pytest.approx(used_cold[0], abs=0.5)
    assert heater * 0.3 < used_cold[-36:].mean() - used[-36:].mean() <= heater
    known = Known(0.0, law.initial_state(night.power_manager, 0.9), telemetry(night, 0.9))
    forecaster = Forecaster(night.power_manager, (), expected_light(night.as_believed()), heat_at_start(night))
    followed = forecaster.heat_after(known, 6 * 3600.0)
    assert followed is not None and followed.thermal.age == pytest.approx(6 * 3600.0)
    assert followed.thermal.temperatures[0] < 290.0
    assert forecaster.heat_after(known._replace(time=9.0), 9.0) is not None


def test_what_is_planned_is_in_it() -> None:
    plain, busy = (
        forecast(EXPLORER, 1.0, plan)
        for plan in ((), (ActivityParams(load="drive", power_w=100.0, start_h=1.0, hours=1.0),))
    )
    taken = float((busy.values[:, 4] - plain.values[:, 4])[:18].sum()) * 600.0 / 3600.0
    assert taken == pytest.approx(100.0, rel=0.05), "heaters take a little less from a bus that sags"


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_what_comes_lies_within_its_bounds(seed: int) -> None:
    """Light and loads up to a tenth off, charges by two deviations: whatever the law sheds of it when."""
    random = np.random.default_rng(seed)
    params = UNDER_THE_SUN.power_manager
    soc, plan = (
        float(random.uniform(0.3, 0.9)),
        (ActivityParams(load="drive", power_w=40.0, start_h=float(random.uniform(0.0, 10.0)), hours=2.0),),
    )
    found = forecast(UNDER_THE_SUN, soc, plan)
    light, load = random.uniform(0.9, 1.1, 2)
    true = soc + float(random.uniform(-0.04, 0.04))

    def around(time: float) -> PowerSurroundings:
        here = expected(time)
        return here._replace(direct=light * here.direct, diffuse=light * here.diffuse)

    expected = expected_light(UNDER_THE_SUN.as_believed())
    truth = Preview(params, PowerNetwork(_drawing(params.power, load)), Activities(params, plan).times(load), around)
    state = truth.initial_state(true)
    steps = truth.run(state._replace(manager=law.initial_state(params, soc)), 600.0, 144)
    charge = np.clip([step.charges[0] for step in steps], 0.0, 1.0)
    # A load is shed a step earlier or later, and what is left on takes more or less of what comes after.
    assert (charge > found.values[:, 1] - 0.02).all() and (charge < found.values[:, 2] + 0.02).all()


def _drawing(power: PowerParams, factor: float) -> PowerParams:
    loads = tuple(load.model_copy(update={"power_w": factor * load.power_w}) for load in power.bus.loads)
    return power.model_copy(update={"bus": power.bus.model_copy(update={"loads": loads})})


def test_a_machine_without_light_expects_none() -> None:
    assert expected_light(EXPLORER.as_believed())(0.0) is DARK


def test_the_plan_is_checked_with_the_scenario() -> None:
    from sojourn_config.errors import ConfigError

    with pytest.raises(ConfigError, match="drives"):
        load_scenario("flat_drive", ["activities=[{load: drives, power_w: 10.0, start_h: 0.0, hours: 1.0}]"])
    params: PowerManagerParams = EXPLORER.power_manager
    assert math.isclose(params.law.forecast.hours, 24.0)


def test_light_is_asked_for_once_and_what_has_passed_is_not_kept() -> None:
    """For a day it was kept, with that of the hours ahead: by two megabytes and a half the node grew."""
    scenario = load_scenario("flat_drive", [f"machine={SOLAR}", *MARS])
    params = scenario.power_manager
    settings = params.law.forecast.model_copy(update={"hours": 2.0})
    params = params.model_copy(update={"law": params.law.model_copy(update={"forecast": settings})})
    light, asked = expected_light(scenario.as_believed()), list[float]()

    def around(time: float) -> PowerSurroundings:
        asked.append(time)
        return light(time)

    forecaster = Forecaster(params, (), around)
    known = Known(0.0, law.initial_state(params, 0.9), telemetry(scenario, 0.9))
    looks_in_a_step, hours = round(settings.step / LOOKS_APART), 5
    for look in range(60 * hours):
        if look == looks_in_a_step:
            asked.clear()
        forecaster.forecast(known._replace(time=round(LOOKS_APART * look * 1e9) * 1e-9))
    ends = 3 * (60 * hours - looks_in_a_step)  # of each look the end of its hours, and what a last bit makes another
    assert ends <= len(asked) < 1.3 * ends
    live = settings.count * looks_in_a_step
    assert all(preview.around.cache_info().currsize < 1.3 * live + 64 for preview in forecaster._previews)


def test_a_look_comes_with_each_forecast_that_is_told() -> None:
    assert topic("/power/forecast").every * CONTROL_PERIOD_S == LOOKS_APART
