"""Heat in the ground against closed forms, another integrator, the balance of every step, and the Moon as measured."""

import itertools
import math
from collections.abc import Callable
from typing import cast

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError
from scipy.integrate import solve_ivp

from sojourn_config.load import load_params
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray
from sojourn_physics.environment.body import BodyParams
from sojourn_physics.thermal.regolith import Irradiation, advance, cut_ground, step
from sojourn_physics.thermal.regolith_day import DayOfGround, SolarDay, irradiation_of_day, settled_day
from sojourn_physics.thermal.regolith_params import RegolithParams, uniform_regolith

MOON = load_params("bodies", "moon", BodyParams)
LUNAR_REGOLITH = cast(RegolithParams, MOON.regolith)
LUNAR_DAY = 29.530589 * 86400.0
SOL = 88775.244
SIGMA = 5.670374419e-8


def lunar(latitude_deg: float, steps: int = 1000) -> DayOfGround:
    day = SolarDay(LUNAR_DAY, 1361.0, math.radians(latitude_deg))
    return settled_day(cut_ground(LUNAR_REGOLITH, LUNAR_DAY), irradiation_of_day(LUNAR_REGOLITH, day, steps), LUNAR_DAY)


def martian(inertia: float, infrared: float) -> DayOfGround:
    params = uniform_regolith(inertia, albedo=0.25)
    light = irradiation_of_day(params, SolarDay(SOL, 500.0, 0.0), sky=Irradiation(0.0, infrared))
    return settled_day(cut_ground(params, SOL), light, SOL)


@pytest.mark.published
def test_the_equator_of_the_moon_is_as_warm_as_it_was_measured() -> None:
    """Hayne et al. 2017: 385 to 395 K at noon, 95 to 100 K at midnight, coldest before dawn."""
    surface = lunar(0.0).surface
    assert surface.max() == pytest.approx(390.0, abs=5.0)
    assert surface[-1] == pytest.approx(97.5, abs=2.5)
    before_dawn = surface[: surface.size // 4].argmin()
    assert before_dawn > 0.9 * surface.size / 4.0
    assert 90.0 < surface.min() < surface[-1]


@pytest.mark.parametrize("latitude_deg", [0.0, 30.0, 60.0, 75.0])
def test_noon_is_near_the_balance_of_sunlight_and_radiation(latitude_deg: float) -> None:
    """Little goes into dry ground beside what is radiated, which is why the Moon's noon tells little of its soil."""
    day = lunar(latitude_deg)
    angle = math.radians(latitude_deg)
    absorbed = 1361.0 * math.cos(angle) * (1.0 - LUNAR_REGOLITH.albedo(angle))
    alone = (absorbed / (LUNAR_REGOLITH.emissivity * SIGMA)) ** 0.25
    assert alone - 8.0 < day.surface.max() < alone


def test_nearer_the_pole_it_is_colder_by_day_and_by_night() -> None:
    days = [lunar(latitude).surface for latitude in (0.0, 40.0, 70.0, 85.0)]
    for nearer, farther in itertools.pairwise(days):
        assert nearer.max() > farther.max() and nearer.min() > farther.min()


def test_a_settled_day_repeats_and_passes_the_heat_of_the_interior_at_every_depth() -> None:
    ground = cut_ground(LUNAR_REGOLITH, LUNAR_DAY)
    light = irradiation_of_day(LUNAR_REGOLITH, SolarDay(LUNAR_DAY, 1361.0, 0.0))
    day = settled_day(ground, light, LUNAR_DAY)
    mean = day.fluxes.mean(axis=0)
    assert mean == pytest.approx(np.full(mean.size, -LUNAR_REGOLITH.heat_flow), abs=2e-3)
    later = day.temperatures[-1]
    for _ in range(10):
        later = advance(ground, later, light, LUNAR_DAY / light.shape[0])[0][-1]
    assert np.abs(later - day.temperatures[-1]).max() < 0.05


def test_shorter_steps_change_little() -> None:
    coarse, fine = lunar(20.0, 1000).surface, lunar(20.0, 8000).surface[7::8]
    night = slice(0, 240)
    assert coarse.max() == pytest.approx(fine.max(), abs=0.1)
    assert np.abs(coarse[night] - fine[night]).max() < 0.3


@settings(max_examples=25, deadline=None)
@given(inertia=st.floats(40.0, 2000.0), transfer=st.floats(1.0, 20.0))
def test_a_wave_of_warmth_is_that_of_a_half_space(inertia: float, transfer: float) -> None:
    """Carslaw and Jaeger 1959, ch. 2: a surface with heat transfer h given q e^(i w t) answers with
    q / (h + I sqrt(i w)), and at a depth z that times e^(-z sqrt(i w / kappa))."""
    params = uniform_regolith(inertia, albedo=0.0, emissivity=1e-9)
    ground = cut_ground(params, SOL)
    steps, omega = 4000, 2.0 * math.pi / SOL
    ends = (np.arange(steps) + 1.0) * SOL / steps
    light = np.tile([100.0, 0.0, transfer, 200.0], (steps, 1))
    light[:, 0] += 60.0 * np.cos(omega * ends)
    day = settled_day(ground, light, SOL)
    diffusivity = (inertia / 1.0e6) ** 2
    for node in (0, 5, 12):
        waves = 60.0 / (transfer + inertia * np.sqrt(1j * omega))
        waves *= np.exp(-ground.depths[node] * np.sqrt(1j * omega / diffusivity))
        found = 2.0 * np.mean(day.temperatures[:, node] * np.exp(-1j * omega * ends))
        assert abs(found - waves) < 0.015 * abs(waves)
        assert day.temperatures[:, node].mean() == pytest.approx(200.0 + 100.0 / transfer, abs=0.1)


def test_the_skin_depth_is_where_the_wave_has_fallen_to_its_e_th_part() -> None:
    params = uniform_regolith(220.0, albedo=0.25)
    assert params.skin_depth(SOL, 250.0) == pytest.approx(220.0 / 1.0e6 * math.sqrt(SOL / math.pi), rel=1e-12)


@settings(max_examples=60, deadline=None)
@given(
    surface=st.floats(60.0, 400.0),
    deep=st.floats(60.0, 400.0),
    absorbed=st.floats(0.0, 1300.0),
    infrared=st.floats(0.0, 300.0),
    convection=st.floats(0.0, 20.0),
    dt=st.floats(1.0, 3.0e4),
)
def test_a_step_stores_what_comes_in(
    surface: float, deep: float, absorbed: float, infrared: float, convection: float, dt: float
) -> None:
    ground = cut_ground(LUNAR_REGOLITH, LUNAR_DAY)
    start = deep + (surface - deep) * np.exp(-ground.depths / 0.1)
    after, fluxes = advance(ground, start, np.array([[absorbed, infrared, convection, 250.0]]), dt)
    gained = ground.heat(after[0]) - ground.heat(start)
    came = dt * (fluxes[0, 0] - fluxes[0, -1])
    scale = dt * (abs(fluxes[0, 0]) + absorbed + SIGMA * surface**4)
    assert gained == pytest.approx(came, abs=1e-6 * scale + 1e-4)
    expected = absorbed + 0.95 * (infrared - SIGMA * after[0, 0] ** 4) + convection * (250.0 - after[0, 0])
    assert fluxes[0, 0] == pytest.approx(expected, abs=1e-9 * (1.0 + absorbed))


class MethodOfLines:
    """Another integrator: a grid of its own, heat capacity at the nodes, an implicit method of order 5."""

    def __init__(self, params: RegolithParams, deepest: float, nodes: int) -> None:
        self.params = params
        self.z = deepest * np.linspace(0.0, 1.0, nodes) ** 2
        middles = 0.5 * (self.z[1:] + self.z[:-1])
        density = np.array([params.density(depth) for depth in self.z])
        self.mass = density * np.diff(np.concatenate(([0.0], middles, [self.z[-1]])))
        self.contact = np.array([params.contact_conductivity(depth) for depth in middles]) / np.diff(self.z)
        self.c = np.polynomial.Polynomial(params.heat_capacity)

    def run(self, start: FloatArray, span: float, absorbed: Callable[[float], float], times: FloatArray) -> FloatArray:
        """Temperatures at times, shape (N, M) [K]. absorbed: sunlight and infrared light at a time [W/m2]."""

        def rate(time: float, temperature: FloatArray) -> FloatArray:
            middle = 0.5 * (temperature[1:] + temperature[:-1])
            radiative = 1.0 + self.params.radiative_conductivity * (middle / 350.0) ** 3
            down = -self.contact * radiative * np.diff(temperature)
            top = absorbed(time) - self.params.emissivity * SIGMA * temperature[0] ** 4
            fluxes = np.concatenate(([top], down, [-self.params.heat_flow]))
            return -np.diff(fluxes) / (self.mass * self.c(temperature))

        largest = 0.02 * span
        lines = solve_ivp(rate, (0.0, span), start, "Radau", times, rtol=1e-5, atol=1e-4, max_step=largest)
        return np.asarray(lines.y)


def test_ground_cools_after_sunset_as_another_integrator_has_it() -> None:
    span, steps = 5.0 * 86400.0, 2000
    lines = MethodOfLines(LUNAR_REGOLITH, 0.6, 121)
    others = lines.run(np.full(121, 280.0), span, lambda _: 0.0, np.array([span]))[:, -1]
    ground = cut_ground(LUNAR_REGOLITH, LUNAR_DAY)
    found, _ = advance(ground, np.full(ground.depths.size, 280.0), np.zeros((steps, 4)), span / steps)
    assert found[-1, 0] == pytest.approx(others[0], abs=0.5)
    for depth in (0.02, 0.1, 0.3):
        assert np.interp(depth, ground.depths, found[-1]) == pytest.approx(np.interp(depth, lines.z, others), abs=0.8)


@pytest.mark.parametrize(
    ("params", "day", "infrared"),
    [
        (LUNAR_REGOLITH, SolarDay(LUNAR_DAY, 1361.0, math.radians(45.0)), 0.0),
        (LUNAR_REGOLITH, SolarDay(LUNAR_DAY, 1361.0, math.radians(75.0)), 0.0),
        (LUNAR_REGOLITH, SolarDay(LUNAR_DAY, 1361.0, math.radians(-85.0), math.radians(-1.5)), 0.0),
        (uniform_regolith(220.0, 0.15), SolarDay(SOL, 490.0, math.radians(70.0), math.radians(24.0)), 25.0),
        (uniform_regolith(220.0, 0.15), SolarDay(SOL, 717.0, math.radians(-30.0), math.radians(-24.0)), 39.0),
    ],
)
def test_a_day_at_other_latitudes_is_that_of_another_integrator_and_repeats_in_it(
    params: RegolithParams, day: SolarDay, infrared: float
) -> None:
    ground = cut_ground(params, day.length)
    found = settled_day(ground, irradiation_of_day(params, day, 4000, Irradiation(0.0, infrared)), day.length)

    def absorbed(time: float) -> float:
        turned = math.cos(2.0 * math.pi * (time / day.length - 0.5))
        sine = math.sin(day.latitude) * math.sin(day.declination)
        sine += math.cos(day.latitude) * math.cos(day.declination) * turned
        light = day.flux * sine * (1.0 - params.albedo(math.acos(sine))) if sine > 0.0 else 0.0
        return light + params.emissivity * infrared

    lines = MethodOfLines(params, float(ground.depths[-1]), 81)
    start = np.interp(lines.z, ground.depths, found.temperatures[-1])
    times = np.linspace(0.05, 1.0, 20) * day.length
    surface = lines.run(start, day.length, absorbed, times)[0]
    ours = np.interp(times / day.length, found.fractions, found.surface)
    assert np.abs(ours - surface).max() < 0.35
    assert surface[-1] == pytest.approx(start[0], abs=0.2)


def test_one_step_is_the_first_of_many() -> None:
    ground = cut_ground(LUNAR_REGOLITH, LUNAR_DAY)
    start = np.full(ground.depths.size, 200.0)
    given_light = Irradiation(300.0, 20.0, 0.5, 210.0)
    many, _ = advance(ground, start, np.array([given_light, given_light]), 600.0)
    one = step(ground, start, given_light, 600.0)
    assert one == pytest.approx(many[0], abs=1e-9)
    assert step(ground, one, given_light, 600.0) == pytest.approx(many[1], abs=1e-6)


def test_mars_swings_less_where_the_inertia_is_higher_and_under_a_warmer_sky() -> None:
    """A sol at the equator with inertia 220 and albedo 0.25: 180 to 190 K before dawn, 255 to 290 K after noon."""
    usual = martian(220.0, 35.0).surface
    assert 175.0 < usual.min() < 195.0 and 255.0 < usual.max() < 290.0
    assert 0.5 < (usual.argmax() + 1) / usual.size < 0.6
    rock, sand = martian(1200.0, 35.0).surface, martian(60.0, 35.0).surface
    assert np.ptp(rock) < np.ptp(usual) < np.ptp(sand)
    assert martian(220.0, 80.0).surface.min() > usual.min() + 5.0


def test_values_that_make_no_sense_are_refused() -> None:
    ground = cut_ground(LUNAR_REGOLITH, LUNAR_DAY)
    start = np.full(ground.depths.size, 200.0)
    with pytest.raises(InvalidValueError, match="dt"):
        step(ground, start, Irradiation(0.0), 0.0)
    with pytest.raises(InvalidValueError, match="absorbed"):
        step(ground, start, Irradiation(math.nan), 1.0)
    with pytest.raises(InvalidValueError, match="temperatures"):
        step(ground, start[:-1], Irradiation(0.0), 1.0)
    with pytest.raises(InvalidValueError, match="day"):
        cut_ground(LUNAR_REGOLITH, -1.0)
    with pytest.raises(InvalidValueError, match="irradiation"):
        settled_day(ground, np.zeros((10, 3)), LUNAR_DAY)
    with pytest.raises(ValidationError, match="albedo_slant"):
        RegolithParams(**(LUNAR_REGOLITH.model_dump() | {"albedo_slant": (0.5, 0.9)}))
    with pytest.raises(ValidationError, match="heat_capacity"):
        RegolithParams(**(LUNAR_REGOLITH.model_dump() | {"heat_capacity": (-900.0, 1.0, 0.0, 0.0, 0.0)}))
