"""Platinum thermometers and thermistors: their curves against published tables, their inverses, their errors."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError
from scipy.optimize import brentq

from sojourn_machine.errors import InvalidValueError
from sojourn_physics.sensors import platinum_thermometer, resistance_thermometer, thermistor
from sojourn_physics.sensors.platinum_thermometer import CLASSES, PlatinumThermometerParams, relative_resistance
from sojourn_physics.sensors.resistance_thermometer import ResistanceThermometerParams, ThermometerReading
from sojourn_physics.sensors.thermistor import ThermistorParams

YSI_44004 = (1.4733e-3, 2.372e-4, 1.074e-7)
FINE = {"bits": 24, "noise": 0.0, "gain_error": 0.0}


def platinum(**more: object) -> PlatinumThermometerParams:
    return PlatinumThermometerParams.model_validate({"tolerance": "none", **FINE, **more})


def ntc(**more: object) -> ThermistorParams:
    given_ = {"steinhart_hart": YSI_44004, "series_resistance": 7500.0, "series_tolerance": 0.0, "supply": 1.0}
    return ThermistorParams.model_validate({**given_, **FINE, **more})


def reading(params: ResistanceThermometerParams, kelvin: float, seed: int = 1) -> ThermometerReading:
    state = resistance_thermometer.initial_state(params, seed, "here", kelvin)
    return resistance_thermometer.step(params, state, kelvin, 1.0)[1]


@pytest.mark.published("IEC 60751")
@pytest.mark.parametrize(
    ("celsius", "ohm"),
    [(-200.0, 18.52), (-100.0, 60.26), (0.0, 100.0), (100.0, 138.51), (200.0, 175.86), (850.0, 390.48)],
)  # fmt: skip
def test_platinum_has_the_resistances_of_the_standard(celsius: float, ohm: float) -> None:
    found = platinum().element_resistance(celsius + 273.15, resistance_thermometer.NO_ERRORS)
    assert found == pytest.approx(ohm, abs=0.005)


@given(st.floats(-200.0, 850.0))
def test_the_inverse_of_the_platinum_curve_is_that_of_a_root_finder(celsius: float) -> None:
    relative = relative_resistance(celsius)
    by_bisection = brentq(lambda t: relative_resistance(t) - relative, -200.1, 850.1, xtol=1e-12)
    assert platinum_thermometer.temperature_of(relative) == pytest.approx(celsius, abs=1e-8)
    assert platinum_thermometer.temperature_of(relative) == pytest.approx(by_bisection, abs=1e-8)


@pytest.mark.parametrize("relative", [0.1, 4.0, -1.0, math.nan])
def test_a_resistance_that_platinum_never_has_is_refused(relative: float) -> None:
    with pytest.raises(InvalidValueError, match="-200 to 850 degC"):
        platinum_thermometer.temperature_of(relative)


@pytest.mark.published
@pytest.mark.parametrize(("celsius", "ohm"), [(0.0, 7355.0), (25.0, 2252.0), (50.0, 811.3), (100.0, 152.8)])
def test_the_thermistor_is_as_good_as_its_data_sheet(celsius: float, ohm: float) -> None:
    """YSI 44004: the curve through the published coefficients is within 0.1 % of the table."""
    found = math.exp(thermistor.log_resistance(YSI_44004, celsius + 273.15))
    assert found == pytest.approx(ohm, rel=1e-3)


@given(
    st.floats(1e-3, 3e-3), st.floats(1e-4, 4e-4), st.just(0.0) | st.floats(5e-9, 5e-7), st.floats(180.0, 420.0)
)  # fmt: skip
def test_the_inverse_of_the_thermistor_is_that_of_a_root_finder(a: float, b: float, c: float, kelvin: float) -> None:
    log = thermistor.log_resistance((a, b, c), kelvin)
    assert a + b * log + c * log**3 == pytest.approx(1.0 / kelvin, rel=1e-9)
    by_bisection = brentq(lambda x: a + b * x + c * x**3 - 1.0 / kelvin, -100.0, 100.0, xtol=1e-13)
    assert log == pytest.approx(by_bisection, abs=1e-6)


def test_beta_is_the_curve_without_a_cubic_term() -> None:
    params = ntc(steinhart_hart=None, resistance=10e3, beta=3950.0)
    found = params.element_resistance(273.15, resistance_thermometer.NO_ERRORS)
    assert found == pytest.approx(10e3 * math.exp(3950.0 * (1 / 273.15 - 1 / 298.15)), rel=1e-9)


@settings(max_examples=60)
@given(st.floats(80.0, 1120.0))
def test_without_errors_platinum_tells_the_truth(kelvin: float) -> None:
    assert reading(platinum(), kelvin).temperature == pytest.approx(kelvin, abs=2e-4)


@settings(max_examples=60)
@given(st.floats(200.0, 400.0))
def test_without_errors_a_thermistor_tells_the_truth(kelvin: float) -> None:
    assert reading(ntc(), kelvin).temperature == pytest.approx(kelvin, abs=5e-3)


@pytest.mark.parametrize("kind", ["AA", "A", "B", "C"])
@pytest.mark.parametrize("celsius", [-100.0, 0.0, 100.0])
def test_elements_are_within_their_class_and_fill_it(kind: str, celsius: float) -> None:
    errors = [reading(platinum(tolerance=kind), celsius + 273.15, seed).temperature for seed in range(400)]
    off = np.abs(np.array(errors) - celsius - 273.15)
    at_zero, growth = CLASSES[kind]
    limit = at_zero + growth * abs(celsius)
    assert off.max() <= limit + 1e-3
    assert off.max() > 0.8 * limit


def test_each_lead_counts_as_the_wires_say() -> None:
    """100.0 ohm and 2 ohm a lead: 4 ohm more are 10.26 K more; of three wires the mismatch is left."""
    two = reading(platinum(wires=2, lead_resistance=2.0), 273.15).temperature
    assert two - 273.15 == pytest.approx(platinum_thermometer.temperature_of(1.04), abs=1e-4)
    assert reading(platinum(wires=4, lead_resistance=2.0), 273.15).temperature == pytest.approx(273.15, abs=1e-4)
    three = [reading(platinum(wires=3, lead_resistance=2.0), 273.15, seed).temperature for seed in range(300)]
    off = np.array(three) - 273.15
    assert np.abs(off).max() <= 0.02 / 0.39083 + 1e-3 and off.std() == pytest.approx(0.0512 / math.sqrt(3), rel=0.1)


def test_its_own_power_warms_it() -> None:
    """1 mA through 100 ohm are 0.1 mW: 0.02 K at 200 K/W."""
    assert reading(platinum(self_heating=200.0), 273.15).temperature - 273.15 == pytest.approx(0.02, abs=1e-4)
    power = (1.0 / (7357.09 + 7500.0)) ** 2 * 7357.09
    warmer = reading(ntc(self_heating=1000.0), 273.15).temperature - 273.15
    assert warmer == pytest.approx(1000.0 * power, rel=0.01)


@settings(max_examples=40, deadline=None)
@given(st.floats(0.1, 100.0), st.floats(0.0, 500.0), st.floats(200.0, 300.0), st.floats(200.0, 300.0))
def test_it_follows_a_step_with_its_time_constant(tau: float, after: float, first: float, then: float) -> None:
    params = platinum(time_constant=tau)
    state = resistance_thermometer.initial_state(params, 1, "here", first)
    for part in (0.25, 0.75):
        state, seen = resistance_thermometer.step(params, state, then, part * after)
    assert seen.temperature == pytest.approx(then + (first - then) * math.exp(-after / tau), abs=1e-3)


def test_counts_are_those_of_the_converter() -> None:
    """12 bits over 400 ohm: 0.0977 ohm, 0.25 K a count."""
    params = platinum(bits=12)
    told = {round(reading(params, 273.15 + 0.01 * number).temperature, 9) for number in range(1000)}
    steps = np.diff(sorted(told))
    assert len(told) == pytest.approx(10.0 / 0.25, abs=2) and np.allclose(steps, 0.25, rtol=0.02)


@pytest.mark.parametrize(
    ("params", "kelvin"),
    [
        (platinum(tolerance="A", bits=14, noise=1.0, gain_error=2e-4, self_heating=300.0), 250.0),
        (platinum(tolerance="B", wires=3, lead_resistance=5.0, bits=12, noise=0.3), 180.0),
        (platinum(tolerance="AA", wires=2, lead_resistance=1.0, bits=10, noise=0.0), 400.0),
        (ntc(resistance_tolerance=0.009, series_tolerance=0.01, bits=12, noise=1.0), 230.0),
        (ntc(resistance_tolerance=0.01, slope_tolerance=0.02, bits=10, noise=0.5, self_heating=2e3), 350.0),
    ],
)
def test_the_told_variance_is_the_mean_square_of_the_error(params: ResistanceThermometerParams, kelvin: float) -> None:
    """Over many sensors, each at a temperature of its own within a count or two."""
    places = kelvin + np.linspace(-1.0, 1.0, 3000)
    readings = [reading(params, place, seed) for seed, place in enumerate(places.tolist())]
    squares = (np.array([one.temperature for one in readings]) - places) ** 2
    assert squares.mean() == pytest.approx(np.mean([one.variance for one in readings]), rel=0.1)


@pytest.mark.parametrize(
    ("params", "kelvin", "end"), [(platinum(), 40.0, 73.15), (platinum(), 2000.0, 1123.15), (ntc(), 450.0, 423.15)]
)
def test_beyond_the_range_its_end_is_told_and_no_variance(
    params: ResistanceThermometerParams, kelvin: float, end: float
) -> None:
    found = reading(params, kelvin)
    assert found.temperature == pytest.approx(end, abs=0.01) and found.variance == 0.0


def test_the_same_seed_is_the_same_sensor_and_another_name_is_another() -> None:
    params = platinum(tolerance="B", noise=2.0, bits=16)
    state = {name: resistance_thermometer.initial_state(params, 3, name, 290.0) for name in ("a", "b")}
    again = resistance_thermometer.initial_state(params, 3, "a", 290.0)
    one, other = (resistance_thermometer.step(params, each, 290.0, 1.0)[1] for each in (state["a"], again))
    assert one == other and one != resistance_thermometer.step(params, state["b"], 290.0, 1.0)[1]


@pytest.mark.parametrize("bad", [math.nan, math.inf, 0.0, -3.0])
def test_a_temperature_that_is_none_is_refused(bad: float) -> None:
    state = resistance_thermometer.initial_state(platinum(), 1, "here", 290.0)
    with pytest.raises(InvalidValueError, match="temperature"):
        resistance_thermometer.step(platinum(), state, bad, 1.0)
    with pytest.raises(InvalidValueError, match="dt"):
        resistance_thermometer.step(platinum(), state, 290.0, -1.0)


@pytest.mark.parametrize(
    ("given_", "words"),
    [
        ({"steinhart_hart": None}, "either steinhart_hart, or resistance and beta"),
        ({"beta": 3000.0}, "either steinhart_hart, or resistance and beta"),
        ({"steinhart_hart": (1e-3, -1e-4, 0.0)}, "b above 0"),
        ({"warmest": 200.0, "coldest": 300.0}, "allowed is above coldest"),
    ],
)
def test_a_thermistor_that_cannot_be_is_refused(given_: dict[str, object], words: str) -> None:
    with pytest.raises(ValidationError, match=words):
        ntc(**given_)
