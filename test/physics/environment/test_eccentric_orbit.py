"""Orbits on ellipses against the circle, against integrated motion and published figures; debris against hand."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from sojourn_machine.errors import InvalidValueError
from sojourn_physics.environment.hazards.orbital_debris import debris_flux
from sojourn_physics.environment.orbit.circular import CircularOrbit, Flattening
from sojourn_physics.environment.orbit.eccentric import EccentricOrbit

GM, RADIUS = 3.986004418e14, 6378137.0
EARTH = Flattening(1.08263e-3, RADIUS)


@given(st.floats(1.02, 8.0), st.floats(-1.5, 1.5))
@settings(max_examples=25, deadline=None)
def test_without_eccentricity_it_is_the_circle(size: float, beta: float) -> None:
    circle = CircularOrbit(GM, RADIUS, size * RADIUS)
    found = EccentricOrbit(GM, RADIUS, size * RADIUS, 0.0)
    assert found.period == pytest.approx(circle.period) and found.speed(found.apocentre) == pytest.approx(circle.speed)
    assert found.shadow(beta, 1.0) == pytest.approx(circle.shadow_share(beta) * circle.period, abs=0.02 * circle.period)
    assert EARTH.perigee_rate(found, 0.4) == pytest.approx(EARTH.perigee_rate(circle, 0.4))


@given(st.floats(0.0, 0.85), st.floats(0.0, 1.0))
@settings(max_examples=15, deadline=None)
def test_its_place_is_that_of_integrated_motion(eccentricity: float, share: float) -> None:
    orbit = EccentricOrbit(GM, RADIUS, 1.1 * RADIUS, eccentricity)
    start = [orbit.pericentre, 0.0, 0.0, orbit.speed(orbit.pericentre)]

    def falls(_: float, s: list[float]) -> list[float]:
        pull = -GM / math.hypot(s[0], s[1]) ** 3
        return [s[2], s[3], pull * s[0], pull * s[1]]

    time = share * orbit.period
    end = solve_ivp(falls, (0.0, time), start, rtol=1e-11, atol=1e-6, method="DOP853").y[:, -1]
    np.testing.assert_allclose(orbit.place(time), end[:2], atol=1e-6 * orbit.apocentre)


def test_a_molniya_orbit_keeps_its_perigee_and_is_half_a_day_long() -> None:
    orbit = EccentricOrbit(GM, RADIUS, RADIUS + 600e3, 0.737)
    assert orbit.period / 3600.0 == pytest.approx(11.97, abs=0.1)
    assert abs(math.degrees(EARTH.perigee_rate(orbit, math.radians(63.4349))) * 86400.0) < 1e-5
    assert math.degrees(EARTH.node_rate(orbit, math.radians(63.4))) * 86400.0 == pytest.approx(-0.13, abs=0.02)


def test_its_shadow_is_long_where_it_is_slow() -> None:
    orbit = EccentricOrbit(GM, RADIUS, RADIUS + 600e3, 0.737)
    slow, quick = orbit.longest_shadow(0.0), orbit.shadow(0.0, math.pi)
    assert slow > 1.5 * quick > 0.0
    # behind the body, within its radius of the axis, it goes almost square to that: 2 R over its speed there
    assert slow == pytest.approx(2.0 * RADIUS / orbit.speed(orbit.apocentre), rel=0.05)
    assert orbit.shadow(math.radians(80.0), 0.0) == 0.0
    dark = [orbit.in_shadow(time, 0.1, 0.7) for time in np.arange(0.0, orbit.period, 5.0)]
    assert orbit.shadow(0.1, 0.7) == pytest.approx(5.0 * sum(dark), abs=20.0)


@pytest.mark.parametrize(
    ("numbers", "words"),
    [((GM, RADIUS, RADIUS, 0.1), "pericentre"), ((GM, RADIUS, 2 * RADIUS, 1.0), "leaves for good"),
     ((0.0, RADIUS, 2 * RADIUS, 0.1), "gravitational"), ((GM, RADIUS, math.nan, 0.1), "pericentre")],
)  # fmt: skip
def test_what_is_no_ellipse_is_refused(numbers: tuple[float, float, float, float], words: str) -> None:
    with pytest.raises(InvalidValueError, match=words):
        EccentricOrbit(*numbers)


@pytest.mark.published("Kessler et al. 1989, NASA TM-100471, by hand")
def test_debris_of_a_centimetre_in_1988_by_hand() -> None:
    # H = 10^(0.2233 / 2) = 1.2932, f = 10^0.0714 = 1.1788, phi = 0.54104, 1.22e-5 + 6.826e-7, psi 0.96
    assert debris_flux(0.01, 500e3, 40.0, 1988.0) == pytest.approx(8.653e-6, rel=2e-3)


@given(st.floats(1e-4, 2.0), st.floats(200e3, 1900e3), st.floats(28.5, 51.0))
@settings(max_examples=30, deadline=None)
def test_more_debris_is_smaller_higher_steeper_and_later(size: float, height: float, inclination: float) -> None:
    here = debris_flux(size, height, inclination, 2000.0)
    assert 0.0 < debris_flux(1.3 * size, height, inclination, 2000.0) < here
    assert debris_flux(size, height + 100e3, inclination, 2000.0) > here
    assert debris_flux(size, height, inclination + 1.0, 2000.0) > here
    assert debris_flux(size, height, inclination, 2001.0) > here


@pytest.mark.parametrize(
    ("numbers", "words"),
    [((1e-5, 4e5, 40.0), "diameter"), ((0.01, 3e6, 40.0), "altitude"), ((0.01, 4e5, 90.0), "inclination"),
     ((0.01, 4e5, 40.0, 2020.0), "1988 to 2010")],
)  # fmt: skip
def test_debris_that_nobody_has_told_of_is_refused(numbers: tuple[float, ...], words: str) -> None:
    with pytest.raises(InvalidValueError, match=words):
        debris_flux(*numbers)
