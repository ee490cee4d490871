"""Orbits: against numerical integration, sampling, sums over points, and published drifts."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray
from sojourn_physics.environment.orbit.circular import CircularOrbit, Flattening
from sojourn_physics.environment.orbit.relative_motion import transition
from sojourn_physics.environment.orbit.thin_air import deceleration, density, sinking

GM, R = 3.986004418e14, 6.378137e6
EARTH = Flattening(1.08262982e-3, R)
STATION = CircularOrbit(GM, R, R + 408e3)
DAY = 86400.0
ALTITUDES = st.floats(160e3, 2e6)
NUMBERS = st.floats(-1.0, 1.0)


def accelerated(_time: float, state: FloatArray) -> FloatArray:
    place = state[:3]
    return np.concatenate([state[3:], -GM * place / np.linalg.norm(place) ** 3])


@pytest.mark.published("the International Space Station, 408 km, 51.64 degrees")
def test_the_station_goes_round_and_its_node_drifts_as_published() -> None:
    assert STATION.period / 60.0 == pytest.approx(92.7, abs=0.1)
    assert STATION.speed == pytest.approx(7664.0, abs=3.0)
    drift = math.degrees(EARTH.node_rate(STATION, math.radians(51.64))) * DAY
    assert drift == pytest.approx(-5.0, abs=0.05)
    assert math.degrees(EARTH.perigee_rate(STATION, math.radians(51.64))) * DAY == pytest.approx(3.7, abs=0.05)
    assert STATION.shadow_share(0.0) * STATION.period / 60.0 == pytest.approx(36.0, abs=0.5)


@pytest.mark.published("Vallado 2013, Fundamentals of Astrodynamics")
def test_a_sun_synchronous_orbit_turns_with_the_sun_and_a_critical_one_keeps_its_perigee() -> None:
    # 800 km: 98.60 degrees (Vallado 2013); a turn a year
    orbit = CircularOrbit(GM, R, R + 800e3)
    assert math.degrees(EARTH.node_rate(orbit, math.radians(98.60))) * 365.2422 * DAY == pytest.approx(360.0, abs=1.0)
    assert EARTH.perigee_rate(orbit, math.acos(math.sqrt(0.2))) == pytest.approx(0.0, abs=1e-20)


def test_the_node_drifts_as_in_an_orbit_that_is_integrated() -> None:
    inclination, orbits = math.radians(51.64), 10
    little = Flattening(EARTH.j2 / 100.0, R)  # the closed form is of the first order in it

    def rates(_time: float, state: FloatArray) -> FloatArray:
        x, y, z = state[:3]
        r2 = x * x + y * y + z * z
        pull = -GM / r2**1.5
        flat, up = 1.5 * little.j2 * R**2 / r2, 5.0 * z * z / r2
        return np.array([*state[3:], pull * x * (1 + flat * (1 - up)), pull * y * (1 + flat * (1 - up)),
                         pull * z * (1 + flat * (3 - up))])  # fmt: skip

    v = STATION.speed
    start = np.array([STATION.radius, 0.0, 0.0, 0.0, v * math.cos(inclination), v * math.sin(inclination)])
    times = np.linspace(0.0, orbits * STATION.period, 40 * orbits + 1)
    found = solve_ivp(rates, (0.0, times[-1]), start, t_eval=times, rtol=1e-10, atol=1e-6).y
    pole = np.cross(found[:3].T, found[3:].T)
    node = np.unwrap(np.arctan2(pole[:, 0], -pole[:, 1]))
    assert np.polyfit(times, node, 1)[0] == pytest.approx(little.node_rate(STATION, inclination), rel=1e-3)


@given(ALTITUDES, st.floats(-1.5, 1.5))
def test_the_shadow_is_the_share_of_points_behind_the_body(altitude: float, beta: float) -> None:
    orbit = CircularOrbit(GM, R, R + altitude)
    angle = (np.arange(20000) + 0.5) * (2.0 * np.pi / 20000)
    towards_sun = orbit.radius * np.cos(angle) * math.cos(beta)
    behind = (towards_sun < 0.0) & (orbit.radius**2 - towards_sun**2 < R**2)
    assert orbit.shadow_share(beta) == pytest.approx(behind.mean(), abs=2e-4)
    assert (orbit.shadow_share(beta) == 0.0) == (abs(beta) >= orbit.always_sunlit_above)


@given(st.floats(0.0, 2.0), st.floats(-2.0, 2.0))
def test_drift_over_two_times_is_drift_over_their_sum(first: float, second: float) -> None:
    n = STATION.rate
    scale = np.diag([1.0, 1.0, 1.0, 1.0 / n, 1.0 / n, 1.0 / n])  # velocities in metres for each radian

    def over(turns: float) -> FloatArray:
        result: FloatArray = scale @ transition(n, turns * STATION.period) @ np.linalg.inv(scale)
        return result

    np.testing.assert_allclose(over(second) @ over(first), over(first + second), atol=1e-9)
    assert np.linalg.det(over(first)) == pytest.approx(1.0, abs=1e-9)  # Liouville


@pytest.mark.parametrize("axis", range(6))
def test_what_drifts_beside_a_station_drifts_as_two_bodies_that_are_integrated(axis: int) -> None:
    n, r = STATION.rate, STATION.radius
    local = np.zeros(6)
    local[axis] = 1.0 if axis < 3 else n
    station = np.array([r, 0.0, 0.0, 0.0, n * r, 0.0])
    turning = np.array([0.0, 0.0, n])
    beside = station + np.concatenate([local[:3], local[3:] + np.cross(turning, local[:3])])
    time = 0.8 * STATION.period
    ends = [solve_ivp(accelerated, (0.0, time), start, method="DOP853", rtol=1e-13, atol=1e-7).y[:, -1]
            for start in (station, beside)]  # fmt: skip
    x = ends[0][:3] / np.linalg.norm(ends[0][:3])
    z = np.array([0.0, 0.0, 1.0])
    axes = np.array([x, np.cross(z, x), z])
    found = axes @ (ends[1] - ends[0])[:3]
    np.testing.assert_allclose(found, (transition(n, time) @ local)[:3], atol=2e-3)


@given(st.lists(st.tuples(NUMBERS, NUMBERS, NUMBERS, st.floats(0.1, 10.0)), min_size=2, max_size=6), NUMBERS, NUMBERS)
def test_the_torque_is_the_sum_over_points_of_the_tide(
    points: list[tuple[float, float, float, float]], x: float, y: float
) -> None:
    rows = np.array(points)
    mass = rows[:, 3]
    places = rows[:, :3] - mass @ rows[:, :3] / mass.sum()
    inertia = np.einsum("p,pij->ij", mass, np.sum(places**2, axis=1)[:, None, None] * np.eye(3)
                        - np.einsum("pi,pj->pij", places, places))  # fmt: skip
    towards = np.array([x, y, 1.0])
    down = towards / np.linalg.norm(towards)
    tide = STATION.rate**2 * (3.0 * np.outer(places @ down, down) - places)  # of the first order in place / radius
    expected = np.cross(places, mass[:, None] * tide).sum(axis=0)
    found = STATION.gravity_gradient_torque(inertia, towards)
    np.testing.assert_allclose(found, expected, atol=1e-11 * STATION.rate**2 * mass.sum())


@given(st.floats(150e3, 999e3), st.floats(1.0, 20e3))
def test_the_air_thins_upwards(altitude: float, rise: float) -> None:
    assert density(min(altitude + rise, 1000e3)) < density(altitude)


@pytest.mark.parametrize(("altitude", "scale_height"), [(200e3, 37.105e3), (400e3, 58.515e3), (700e3, 88.667e3)])
def test_the_air_thins_by_the_scale_height_that_the_table_has_beside_it(altitude: float, scale_height: float) -> None:
    found = 10e3 / math.log(density(altitude) / density(altitude + 10e3))
    assert found == pytest.approx(scale_height, rel=2e-3)


def test_an_orbit_sinks_by_drag_as_one_that_is_integrated() -> None:
    orbit, ballistic, turns = CircularOrbit(GM, R, R + 250e3), 20.0, 4
    air = density(250e3)

    def rates(time: float, state: FloatArray) -> FloatArray:
        free = accelerated(time, state)
        velocity = state[3:]
        free[3:] -= 0.5 * air * float(np.linalg.norm(velocity)) * velocity / ballistic
        return free

    start = np.array([orbit.radius, 0.0, 0.0, 0.0, orbit.speed, 0.0])
    end = solve_ivp(rates, (0.0, turns * orbit.period), start, method="DOP853", rtol=1e-12, atol=1e-6).y[:, -1]
    energy = 0.5 * end[3:] @ end[3:] - GM / np.linalg.norm(end[:3])
    sunk = -GM / (2.0 * energy) - orbit.radius
    assert sunk < -3e3
    assert sunk == pytest.approx(sinking(orbit, air, ballistic) * turns * orbit.period, rel=1e-3)
    power = deceleration(orbit, air, ballistic) * orbit.speed  # of drag, for each kilogram
    assert sinking(orbit, air, ballistic) == pytest.approx(-2.0 * orbit.radius**2 / GM * power, rel=1e-12)


def test_what_is_no_orbit_is_refused() -> None:
    with pytest.raises(InvalidValueError, match="radius of the orbit"):
        CircularOrbit(GM, R, R)
    with pytest.raises(InvalidValueError, match="altitude"):
        density(1.2e6)
