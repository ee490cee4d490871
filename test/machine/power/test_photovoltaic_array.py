"""A photovoltaic array against its data sheet, the Lambert W function, and balances of energy."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError
from scipy.optimize import minimize_scalar
from scipy.special import wrightomega

from sojourn_machine.power.photovoltaic_array import (
    STEFAN_BOLTZMANN,
    ArrayState,
    CellParams,
    PhotovoltaicArrayParams,
    ShadowParams,
)
from sojourn_machine.power.photovoltaic_kernels import CellGroup, most_power, string_voltage
from sojourn_machine.power.surroundings import DARK, PowerSurroundings

CELL = CellParams(
    area=30.18e-4,
    short_circuit_current=0.5202,
    open_circuit_voltage=2.700,
    current_at_most_power=0.5044,
    voltage_at_most_power=2.411,
    current_slope=3.6e-4,
    voltage_slope=-6.2e-3,
)
"""Azur Space 3G30C."""
UP = np.array((0.0, 0.0, 1.0))


def array(**more: Any) -> PhotovoltaicArrayParams:
    return PhotovoltaicArrayParams(
        **{"cell": CELL, "cells_series": 12, "strings": 5, "tracking_efficiency": 1.0, **more}
    )


def sun(
    direct: float = 1367.0, elevation_deg: float = 90.0, azimuth_deg: float = 0.0, diffuse: float = 0.0
) -> PowerSurroundings:
    up, along = math.radians(elevation_deg), math.radians(azimuth_deg)
    direction = np.array((math.cos(up) * math.cos(along), math.cos(up) * math.sin(along), math.sin(up)))
    return PowerSurroundings(direction, direct, diffuse, UP)


def at(temperature: float) -> ArrayState:
    return ArrayState(temperature, 1.0, 0.0)


def by_lambert(group: CellGroup, light: float) -> tuple[float, float]:
    """Most power and its current by the explicit current of the single-diode equation."""
    made = group.light_current * light

    def current(voltage: float) -> float:
        full = made + group.saturation
        scale = group.series * group.saturation / group.slope
        inside = math.log(scale) + (voltage + group.series * full) / group.slope
        return float(full - group.slope / group.series * wrightomega(inside))  # W(e^x)

    top = group.slope * math.log1p(made / group.saturation)
    found = minimize_scalar(
        lambda voltage: -voltage * current(voltage), bounds=(0.0, top), options={"xatol": 1e-10}, method="bounded"
    )
    return -float(found.fun), current(float(found.x))


@pytest.mark.published("data sheet of the array's cell, 29.5 % at 28 C")
def test_the_three_points_of_the_data_sheet_are_on_its_curve() -> None:
    group = array(cells_series=1, strings=1).group(301.15)
    assert string_voltage(group, np.ones(1), 0.5044) == pytest.approx(2.411, rel=1e-6)
    assert string_voltage(group, np.ones(1), 0.0) == pytest.approx(2.700, rel=1e-6)
    assert group.light_current == pytest.approx(0.5202)
    power, current = most_power(group, np.ones(1))
    assert (power, current) == (pytest.approx(2.411 * 0.5044, rel=1e-5), pytest.approx(0.5044, rel=2e-3))
    assert power / (1367.0 * CELL.area) == pytest.approx(0.295, abs=0.005), "the data sheet says 29.8 % of its own area"


def test_voltage_at_most_power_falls_with_warmth_as_the_data_sheet_says() -> None:
    """-6.7 mV/K, which the model is not told; 0.24 mA/K of the current."""
    points = []
    for temperature in (301.15, 351.15):
        power, current = most_power(array(cells_series=1, strings=1).group(temperature), np.ones(1))
        points.append((power / current, current))
    (v_cold, i_cold), (v_warm, i_warm) = points
    assert (v_warm - v_cold) / 50.0 == pytest.approx(-6.7e-3, rel=0.1)
    assert (i_warm - i_cold) / 50.0 == pytest.approx(2.4e-4, rel=0.4)


@given(light=st.floats(1e-3, 1.5), temperature=st.floats(150.0, 400.0), number=st.integers(1, 60))
def test_most_power_is_that_of_lamberts_function(light: float, temperature: float, number: int) -> None:
    group = array(cells_series=number).group(temperature)
    power, _ = most_power(group, np.array([light]))
    assert power == pytest.approx(by_lambert(group, light)[0], rel=1e-6)


@given(light=st.lists(st.just(0.0) | st.floats(1e-3, 1.2), min_size=2, max_size=6), temperature=st.floats(200.0, 380.0))
def test_in_part_shade_it_lies_between_its_brightest_and_all_groups(light: list[float], temperature: float) -> None:
    group = array(cells_series=6, groups=6).group(temperature)
    lights = np.array(light)
    power, current = most_power(group, lights)
    alone = [by_lambert(group, each)[0] if each > 0.0 else 0.0 for each in light]
    assert power <= sum(alone) * (1.0 + 1e-9)
    # k brightest groups at the current of the least of them, the others bypassed
    ordered, least = sorted(light, reverse=True), 0.0
    for k, each in enumerate(ordered, start=1):
        if each > 0.0:
            best, amps = by_lambert(group, each)
            least = max(least, k * best - (len(light) - k) * group.bypass * amps)
    assert power >= least * (1.0 - 1e-6) - 1e-9
    grid = np.linspace(0.0, group.light_current * max(lights.max(), 1e-9), 4000)
    assert power >= max(float(amps * string_voltage(group, lights, amps)) for amps in grid) * (1.0 - 1e-6) - 1e-12
    assert 0.0 <= current <= group.light_current * max(lights.max(), 0.0) + 1e-12


def test_a_group_in_the_dark_costs_its_own_part_and_no_more_where_a_diode_goes_round_it() -> None:
    whole = array(groups=3)
    shaded = whole.model_copy(
        update={
            "shadows": (ShadowParams(azimuth_from_deg=80, azimuth_to_deg=100, below_elevation_deg=60, light=(0, 1, 1)),)
        }
    )
    full = whole.point(at(300.0), sun(elevation_deg=30.0, azimuth_deg=90.0)).power
    part = shaded.point(at(300.0), sun(elevation_deg=30.0, azimuth_deg=90.0)).power
    assert 0.6 * full < part < 2.0 / 3.0 * full
    assert shaded.point(at(300.0), sun(elevation_deg=30.0, azimuth_deg=120.0)).power == pytest.approx(full)
    assert shaded.point(at(300.0), sun(elevation_deg=70.0, azimuth_deg=90.0)).power > full


@given(elevation=st.floats(-90.0, 90.0), diffuse=st.floats(0.0, 300.0))
def test_it_gives_what_falls_on_its_plane(elevation: float, diffuse: float) -> None:
    """Almost in proportion to the light; nothing from a Sun behind it, but for the sky."""
    panel = array()
    offered = panel.point(at(300.0), sun(600.0, elevation, diffuse=diffuse)).power
    square = panel.point(at(300.0), sun(600.0 * max(math.sin(math.radians(elevation)), 0.0) + diffuse)).power
    assert offered == pytest.approx(square, rel=1e-9, abs=1e-9)
    assert panel.point(at(300.0), DARK).power == 0.0
    turned = array(normal=(0.0, 0.0, -2.0))
    assert turned.point(at(300.0), sun(600.0, 45.0, diffuse=diffuse)).power == 0.0


def test_dust_age_and_regulator_take_their_parts() -> None:
    new = array().point(at(300.0), sun()).power
    assert array(tracking_efficiency=0.9).point(at(300.0), sun()).power == pytest.approx(0.9 * new)
    state = array(dust_loss_per_day=0.0028).initial_state()
    for _ in range(100):
        state = array(dust_loss_per_day=0.0028).step(state, 0.0, 86400.0)
    assert state.clean == pytest.approx(0.9972**100)
    dusty = array().point(ArrayState(300.0, 0.8, 0.0), sun()).power
    assert 0.77 * new < dusty < 0.8 * new, "less voltage, too"
    old = array(age_years=10.0, degradation_per_year=0.01)
    assert old.point(old.initial_state(), sun()).power < 0.91 * array().point(old.initial_state(), sun()).power


@given(direct=st.floats(0.0, 1400.0), around=st.floats(20.0, 330.0), power=st.floats(0.0, 100.0))
def test_it_settles_where_what_it_takes_is_what_it_radiates(direct: float, around: float, power: float) -> None:
    panel = array(temperature_surroundings=around)
    state, light = panel.initial_state(), sun(direct)
    power = min(power, 0.5 * 0.9 * direct * panel.area)
    for _ in range(60):
        state = panel.step(state, power, 1e6, light)
    radiated = panel.area * (0.85 + 0.8) * STEFAN_BOLTZMANN * (state.temperature**4 - around**4)
    assert radiated == pytest.approx(0.9 * direct * panel.area - power, rel=1e-3, abs=1e-3)


def test_one_long_step_warms_as_many_short_ones() -> None:
    panel, light = array(), sun(590.0)
    once, often = panel.step(at(200.0), 10.0, 60.0, light), at(200.0)
    for _ in range(600):
        often = panel.step(often, 10.0, 0.1, light)
    assert once.temperature == pytest.approx(often.temperature, abs=0.3)
    assert once.energy == often.energy == pytest.approx(600.0)


def test_periods_shorter_than_a_second_come_to_the_same_as_seconds() -> None:
    """Warmth, dust and age wait for the second; what was given does not, and none of it is lost."""
    made, light = array(dust_loss_per_day=0.01), sun(direct=1000.0)
    slow, quick = at(250.0), at(250.0)
    for number in range(60):
        slow = made.step(slow, 20.0 + number, 1.0, light)
        for part in range(50):
            quick = made.step(quick, 20.0 + number + (part - 24.5), 0.02, light)
    assert quick.temperature == pytest.approx(slow.temperature, abs=1e-9) and quick.temperature > 251.0
    assert quick.clean == pytest.approx(slow.clean, rel=1e-12) and quick.clean < 1.0
    assert quick.age == pytest.approx(slow.age) and quick.energy == pytest.approx(slow.energy)
    half = made.step(quick, 30.0, 0.5, light)
    assert half.temperature == quick.temperature and half.energy == pytest.approx(quick.energy + 15.0)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"current_at_most_power": 0.53}, "less than short_circuit_current"),
        ({"voltage_at_most_power": 1.2}, "between half of open_circuit_voltage"),
        ({"voltage_at_most_power": 2.69}, "one diode with a series resistance"),
        ({"current_at_most_power": 0.25}, "more than half of it"),
        ({"area": 8.8e-4}, r"at most all of the light, 1\.2"),
        ({"reference_irradiance": 400.0}, r"at most all of the light, 1\.2"),
        ({"voltage_slope": -1.0}, "leaves an open-circuit voltage from 80 to 420 K"),
        ({"voltage_slope": -0.1}, "leaves an open-circuit voltage"),
        ({"voltage_slope": -0.02}, r"at 0 K a cell has at most 3 times"),
        ({"current_slope": 0.1}, "leaves a short-circuit current from 80 to 420 K"),
        ({"current_slope": -0.1}, "leaves a short-circuit current"),
        ({"area": 12e-4, "voltage_slope": -0.015}, "no more than all of the light from 80 to 420 K"),
        ({"current_at_most_power": 0.52019}, "whose bend a diode has at 80 K too"),
        ({"reference_temperature": 1000.0}, "reference_temperature"),
    ],
)
def test_a_cell_that_cannot_be_is_refused(changes: dict[str, float], words: str) -> None:
    with pytest.raises(ValidationError, match=words):
        CellParams(**{**CELL.model_dump(), **changes})


SILICON = CellParams(
    area=0.0244, short_circuit_current=9.6, open_circuit_voltage=0.6, current_at_most_power=9.0,
    voltage_at_most_power=0.5, current_slope=9.6e-3, voltage_slope=-2e-3, reference_irradiance=1000.0,
    reference_temperature=298.15,
)  # fmt: skip


@pytest.mark.parametrize("cell", [SILICON, CELL.model_copy(update={"voltage_slope": -6.5e-3, "current_slope": 5.2e-4})])
def test_cells_that_are_there_are_allowed(cell: CellParams) -> None:
    """Silicon, 0.1 % more current and 2 mV less a kelvin; three junctions with -6.5 mV/K."""
    again = CellParams(**cell.model_dump())
    assert 0.15 < again.efficiency < again.most_of_light < 0.6


@given(
    cell=st.builds(
        dict,
        area=st.floats(1e-6, 1.0),
        short_circuit_current=st.floats(1e-9, 100.0),
        open_circuit_voltage=st.floats(1e-3, 100.0),
        current=st.floats(0.5, 1.0),
        voltage=st.floats(0.5, 1.0),
        current_slope=st.floats(-0.009, 0.005),
        voltage_slope=st.floats(-0.009, 0.0),
        reference_irradiance=st.floats(1.0, 1e4),
        reference_temperature=st.floats(80.0, 420.0),
    ),
    temperature=st.floats(1.0, 600.0),
    light=st.floats(0.0, 1e4),
)
def test_no_cell_that_is_accepted_fails_or_makes_more_than_all_of_the_light(
    cell: dict[str, float], temperature: float, light: float
) -> None:
    """Part of the light, slopes of currents and voltages: relative to the cell's own."""
    current, voltage = cell["short_circuit_current"], cell["open_circuit_voltage"]
    own = {
        "current_at_most_power": cell.pop("current") * current,
        "voltage_at_most_power": cell.pop("voltage") * voltage,
        "current_slope": cell["current_slope"] * current,
        "voltage_slope": cell["voltage_slope"] * voltage,
    }
    try:
        made = CellParams(**{**cell, **own})
    except ValidationError:
        return
    panel = array(cell=made, cells_series=1, strings=1, absorptance=1.0)
    state = panel.initial_state()
    power = panel.point(at(temperature), sun(light)).power
    assert math.isfinite(panel.step(at(temperature), power, 1.0, sun(light)).temperature)
    assert math.isfinite(panel.point(state, sun(light)).power) and power >= 0.0
    full = panel.point(at(temperature), sun(made.reference_irradiance)).power
    assert full <= made.most_of_light * made.reference_irradiance * made.area * (1.0 + 1e-9)
    assert made.most_of_light <= 1.0


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"absorptance": 0.2}, "at least 0.29"),
        ({"groups": 5}, "a divisor of cells_series"),
        ({"normal": (0.0, 0.0, 0.0)}, "a direction"),
        (
            {"shadows": [{"azimuth_from_deg": 0, "azimuth_to_deg": 9, "below_elevation_deg": 5, "light": [1, 1]}]},
            "one for each group",
        ),
    ],
)
def test_an_array_that_cannot_be_is_refused(changes: dict[str, Any], words: str) -> None:
    with pytest.raises(ValidationError, match=words):
        array(**changes)


@pytest.mark.parametrize(("power", "dt"), [(math.nan, 1.0), (1.0, 0.0), (1.0, math.inf)])
def test_no_numbers_are_refused(power: float, dt: float) -> None:
    with pytest.raises(ValueError, match=r"source|dt"):
        array().step(at(300.0), power, dt)
