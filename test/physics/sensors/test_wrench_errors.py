"""Errors of a force sensor beside bias and noise: each by itself, and none where the file names none."""

import math

import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from sojourn_config.errors import ConfigError
from sojourn_config.extends import PARTS
from sojourn_config.paths import config_folder
from sojourn_config.scenario import load_scenario
from sojourn_machine.params import FloatArray
from sojourn_physics.sensors import wrench
from sojourn_physics.sensors.params import read_sensor
from sojourn_physics.sensors.wrench import WrenchSensorParams
from sojourn_physics.sensors.wrench_errors import WrenchConditions, WrenchErrorsParams

RANGE = np.array([200.0] * 3 + [10.0] * 3)


def params(**errors: object) -> WrenchSensorParams:
    return WrenchSensorParams.model_validate({
        "force": {"resolution": 1e-4, "noise": 0.0, "bias": 0.0, "largest": 200.0},
        "moment": {"resolution": 1e-5, "noise": 0.0, "bias": 0.0, "largest": 10.0},
        "errors": errors,
    })  # fmt: skip


def readings(of: WrenchSensorParams, loads: list[FloatArray], now: WrenchConditions, seed: int = 1) -> FloatArray:
    state, rows = wrench.initial_state(of, seed), []
    for load in loads:
        state, row = wrench.step(state, load, now)
        rows.append(row)
    return np.array(rows)


def one(of: WrenchSensorParams, load: FloatArray, seed: int = 1, temperature: float | None = None) -> FloatArray:
    return readings(of, [load], WrenchConditions(0.02, temperature), seed)[0]


def test_without_errors_nothing_is_drawn_for_them() -> None:
    assert wrench.initial_state(params(), 1).errors is None


def test_crosstalk_is_that_part_of_the_range_at_full_load() -> None:
    of = params(crosstalk=0.01)
    for axis in (0, 4):
        load = np.zeros(6)
        load[axis] = RANGE[axis] * 0.5
        seen = np.array([one(of, load, seed) for seed in range(400)]) / RANGE
        others = np.delete(seen, axis, axis=1)
        assert others.std() == pytest.approx(0.005, rel=0.05) and abs(others.mean()) < 0.0005
        assert seen[:, axis] == pytest.approx(0.5, abs=1e-5)


@settings(max_examples=50)
@given(st.integers(0, 10**6), st.lists(st.floats(-0.4, 0.4), min_size=6, max_size=6), st.floats(0.1, 1.0))
def test_crosstalk_is_linear(seed: int, parts: list[float], factor: float) -> None:
    of, load = params(crosstalk=0.02), np.array(parts) * RANGE
    whole, part = one(of, load, seed), one(of, factor * load, seed)
    assert part == pytest.approx(factor * whole, abs=1e-3)


def test_drift_is_a_random_walk() -> None:
    """0.01 of the range in an hour is 0.01 sqrt(1/4) of it in a quarter; steps have nothing to do with each other."""
    of = params(drift=0.01)
    dt = 9.0
    walks = np.array([readings(of, [np.zeros(6)] * 100, WrenchConditions(dt), seed) for seed in range(150)]) / RANGE
    for count in (25, 100):
        expected = 0.01 * math.sqrt(count * dt / 3600.0)
        assert walks[:, count - 1].std() == pytest.approx(expected, rel=0.08)
    steps = np.diff(walks, axis=1)
    assert abs(np.mean(steps[:, 1:] * steps[:, :-1])) < 0.05 * np.mean(steps**2)


def test_each_axis_drifts_with_the_temperature_by_a_slope_of_its_own() -> None:
    of = params(temperature_drift=1e-3)
    at = {kelvin: one(of, np.zeros(6), 3, kelvin) for kelvin in (293.15, 303.15, 313.15)}
    assert at[293.15] == pytest.approx(np.zeros(6), abs=1e-6)
    assert at[313.15] == pytest.approx(2.0 * at[303.15], abs=2e-4)
    slopes = np.array([one(of, np.zeros(6), seed, 303.15) for seed in range(300)]) / RANGE / 10.0
    assert slopes.std() == pytest.approx(1e-3, rel=0.06)


@settings(max_examples=60)
@given(st.lists(st.floats(-20.0, 20.0), min_size=1, max_size=20))
def test_an_overload_leaves_what_the_largest_has_left(parts: list[float]) -> None:
    """Along one axis, in parts of its range: nothing below the overload, a tenth of what was beyond, never less."""
    of = params(overload=5.0, overload_offset=0.1)
    loads = [np.array([200.0 * part, 0, 0, 0, 0, 0]) for part in parts]
    left = readings(of, [*loads, np.zeros(6)], WrenchConditions(0.02))[-1]
    beyond = [math.copysign(max(abs(part) - 5.0, 0.0), part) for part in parts]
    largest = max(beyond, key=abs)
    assert abs(left[0]) == pytest.approx(min(abs(0.1 * largest), 1.0) * 200.0, abs=1e-3)
    assert not left[1:].any()


def test_beyond_its_range_an_axis_is_held_or_says_nothing() -> None:
    load = np.array([250.0, -3.0, 0.0, 0.0, -11.0, 1.0])
    held, silent = one(params(), load), one(params(beyond="nan"), load)
    assert held[[0, 4]] == pytest.approx([200.0, -10.0]) and held[1] == pytest.approx(-3.0)
    assert np.isnan(silent).tolist() == [True, False, False, False, True, False]
    assert one(params(beyond="nan"), 0.5 * load) == pytest.approx(0.5 * load, abs=1e-4)


def test_errors_have_a_stream_of_their_own() -> None:
    """What bias and noise are does not depend on which other errors there are."""
    noisy = params().model_copy(update={"force": params().force.model_copy(update={"noise": 0.3, "bias": 1.0})})
    more = noisy.model_copy(update={"errors": WrenchErrorsParams(drift=0.1, overload_offset=0.5)})
    loads = [np.zeros(6)] * 20
    assert np.array_equal(readings(noisy, loads, WrenchConditions(0.0)), readings(more, loads, WrenchConditions(0.0)))


@pytest.mark.parametrize("errors", [{"crosstalk": 0.9}, {"overload": 0.5}, {"beyond": "wrapped"}, {"drft": 0.1}])
def test_errors_that_cannot_be_are_refused(errors: dict[str, object]) -> None:
    with pytest.raises(ValidationError, match=next(iter(errors))):
        params(**errors)


def test_the_part_is_that_of_the_data_sheet() -> None:
    table = yaml.safe_load((config_folder() / PARTS / "ati_mini45.yaml").read_text(encoding="utf-8"))
    part: WrenchSensorParams = read_sensor("wrist", table)
    assert (part.force.largest, part.moment.largest, part.force.resolution) == (290.0, 10.0, 1 / 8)
    assert part.moment.resolution == pytest.approx(1 / 376, rel=2e-3)
    assert part.errors is not None and part.errors.overload * 290.0 <= 5100.0 and part.errors.overload * 10.0 <= 110.0


def test_the_node_that_a_wrist_is_as_warm_as_must_be_there() -> None:
    with pytest.raises(ConfigError, match=r"wrist\.node = 'bx': is no node of the machine's heat"):
        load_scenario("lunar_night", ["arm.wrist.node=bx"])
