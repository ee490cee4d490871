"""The Sun in the sky of a body, against worked examples, and against formulas that share nothing with ours."""

import math
from datetime import UTC, datetime

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sojourn_machine.errors import InvalidValueError
from sojourn_physics.environment.sun.ephemeris import BODIES, sun_from
from sojourn_physics.environment.sun.instant import Instant, instant
from sojourn_physics.environment.sun.lunar_orbit import ecliptic_of_date
from sojourn_physics.environment.sun.mars_time import mars_time
from sojourn_physics.environment.sun.moons import MOONS
from sojourn_physics.environment.sun.orbits import ORBITS, eccentric_anomaly, heliocentric

J2000_DATE = 2451545.0
MOMENTS = st.floats(157766400.0, 2524608000.0).map(instant)  # 1975 to 2050


def date(year: int, month: int, day: int, hour: int = 12) -> Instant:
    """A date, in UTC."""
    return instant(datetime(year, month, day, hour, tzinfo=UTC).timestamp())


def dynamical(julian_date: float) -> Instant:
    """A moment given in TT; what only turns the Earth is not used."""
    return Instant(julian_date - J2000_DATE, math.nan)


def apart(left: tuple[float, ...], right: tuple[float, ...]) -> float:
    """Angle between two unit vectors [deg]."""
    return math.degrees(2.0 * math.asin(min(0.5 * math.dist(left, right), 1.0)))


def test_the_moon_of_meeus_example_47a() -> None:
    longitude, latitude, distance = ecliptic_of_date(2448724.5 - J2000_DATE)
    assert longitude == pytest.approx(133.162655, abs=0.01)
    assert latitude == pytest.approx(-3.229126, abs=0.01)
    assert distance == pytest.approx(368409.7e3, abs=200e3)


def test_the_suns_selenographic_place_of_meeus_example_53a() -> None:
    seen = sun_from("moon", dynamical(2448724.5))
    assert math.degrees(seen.longitude) == pytest.approx(67.89, abs=0.02)
    assert math.degrees(seen.latitude) == pytest.approx(1.46, abs=0.02)


@pytest.mark.published("Meeus 1998, Astronomical Algorithms, example 25.a")
def test_the_suns_apparent_place_of_meeus_example_25a() -> None:
    # 1992 October 13, 0 h TD: declination -7.78507 deg, distance 0.99766 au
    at = dynamical(2448908.5)
    seen = sun_from("earth", Instant(at.terrestrial, at.terrestrial))
    assert math.degrees(seen.latitude) == pytest.approx(-7.78507, abs=0.006)
    assert seen.distance == pytest.approx(0.99766, abs=5e-5)


@pytest.mark.published("Allison & McEwen 2000, Planet. Space Sci. 48:215")
def test_mars_at_the_example_of_allison_and_mcewen() -> None:
    mars = mars_time(date(2000, 1, 6, 0))
    assert mars.solar_longitude == pytest.approx(277.18758, abs=2e-5)
    assert mars.coordinated_time == pytest.approx(23.99425, abs=1e-5)
    assert mars.equation_of_time == pytest.approx(-5.18774, abs=2e-5)


@given(MOMENTS)
def test_mars_by_its_orbit_and_pole_is_where_allison_and_mcewen_have_it(at: Instant) -> None:
    mars, seen = mars_time(at), sun_from("mars", at)
    flattening = 0.00589
    planetographic = math.degrees(math.atan(math.tan(seen.latitude) / (1.0 - flattening) ** 2))
    assert planetographic == pytest.approx(mars.declination, abs=0.04)
    hour_angle = math.remainder(mars.true_solar_time(math.degrees(seen.longitude)) - 12.0, 24.0)
    assert 15.0 * hour_angle == pytest.approx(0.0, abs=0.05)
    assert seen.distance == pytest.approx(mars.distance, abs=2e-4)


def sun_over_the_earth(at: Instant) -> tuple[float, float, float]:
    """Right ascension and declination by the low-precision series of the Astronomical Almanac (0.01 deg, 1950 to 2050),
    turned by the Earth rotation angle of the IAU (2000)."""
    days = at.terrestrial
    mean = math.radians(357.528 + 0.9856003 * days)
    longitude = math.radians(280.460 + 0.9856474 * days + 1.915 * math.sin(mean) + 0.020 * math.sin(2.0 * mean))
    obliquity = math.radians(23.439 - 4e-7 * days)
    x = math.cos(longitude)
    y, z = math.cos(obliquity) * math.sin(longitude), math.sin(obliquity) * math.sin(longitude)
    turned = math.tau * (0.7790572732640 + 1.00273781191135448 * at.universal)
    turned += math.radians(4612.157 / 3600.0 * days / 36525.0)  # accumulated precession in right ascension
    cosine, sine = math.cos(turned), math.sin(turned)
    return x * cosine + y * sine, y * cosine - x * sine, z


@given(MOMENTS)
def test_the_earths_sun_is_that_of_the_almanac(at: Instant) -> None:
    assert apart(sun_from("earth", at).direction, sun_over_the_earth(at)) < 0.03


# Direction of the Sun in the body's axes, distance [au]. Computed with Astronomy Engine 2.1.19 (D. Cross; VSOP87 and
# its own series of the Moon, within 1 arc minute of JPL Horizons; axes of the IAU's working group of 2015), at days of
# TT since J2000.
REFERENCE = {
    ("mercury", -2900.25): ((-0.08397, -0.99647, -0.00049), 0.4664),
    ("mercury", 3000.5): ((0.46236, 0.88669, -0.00055), 0.4572),
    ("mercury", 10287.0): ((0.38331, -0.92362, -0.00030), 0.4605),
    ("mercury", 16000.75): ((-0.59264, 0.80546, -0.00020), 0.4502),
    ("venus", -2900.25): ((-0.22269, -0.97474, -0.01700), 0.7228),
    ("venus", 3000.5): ((-0.02296, 0.99878, 0.04363), 0.7282),
    ("venus", 10287.0): ((-0.51745, -0.85509, -0.03257), 0.7191),
    ("venus", 16000.75): ((-0.78615, -0.61784, 0.01593), 0.7262),
    ("mars", -2900.25): ((-0.99953, -0.03017, -0.00520), 1.4642),
    ("mars", 3000.5): ((-0.47904, -0.82006, 0.31310), 1.6515),
    ("mars", 10287.0): ((0.65924, 0.62184, -0.42276), 1.3838),
    ("mars", 16000.75): ((-0.05725, 0.98361, 0.17100), 1.6118),
    ("moon", -2900.25): ((0.75569, -0.65484, 0.01119), 0.9859),
    ("moon", 3000.5): ((0.90188, 0.43171, 0.01541), 0.9983),
    ("moon", 10287.0): ((-0.45950, 0.88801, 0.01723), 0.9895),
    ("moon", 16000.75): ((0.48974, -0.87175, -0.01439), 0.9961),
    ("jupiter", -2900.25): ((-0.82651, 0.56262, -0.01836), 5.3942),
    ("jupiter", 3000.5): ((0.36894, -0.92882, -0.03432), 5.2188),
    ("jupiter", 10287.0): ((-0.71575, -0.69769, -0.03050), 5.4324),
    ("jupiter", 16000.75): ((0.40238, 0.91483, -0.03421), 5.2225),
    ("saturn", -2900.25): ((0.60303, -0.73293, 0.31492), 9.9322),
    ("saturn", 3000.5): ((-0.12642, -0.98255, -0.13640), 9.2870),
    ("saturn", 10287.0): ((-0.46871, -0.84449, -0.25915), 9.2833),
    ("saturn", 16000.75): ((-0.34174, -0.86209, 0.37418), 9.9086),
    ("uranus", -2900.25): ((-0.38455, 0.26190, -0.88517), 19.5133),
    ("uranus", 3000.5): ((0.94739, -0.31952, 0.01916), 20.0965),
    ("uranus", 10287.0): ((-0.08703, -0.18565, 0.97875), 19.3458),
    ("uranus", 16000.75): ((0.10123, 0.86758, 0.48689), 18.4107),
    ("neptune", -2900.25): ((0.79515, 0.44157, -0.41564), 30.1940),
    ("neptune", 3000.5): ((-0.65219, 0.59336, -0.47177), 30.0410),
    ("neptune", 10287.0): ((-0.33553, -0.89126, -0.30508), 29.8673),
    ("neptune", 16000.75): ((0.91436, 0.40241, -0.04482), 29.8075),
    ("pluto", -2900.25): ((-0.20437, -0.96659, 0.15470), 29.6884),
    ("pluto", 3000.5): ((0.29117, -0.69863, 0.65356), 31.4338),
    ("pluto", 10287.0): ((0.32564, -0.37320, 0.86872), 35.9725),
    ("pluto", 16000.75): ((0.23470, 0.53951, 0.80861), 39.9552),
}


@pytest.mark.parametrize("body,days", REFERENCE)
def test_bodies_are_where_another_ephemeris_has_them(body: str, days: float) -> None:
    direction, distance = REFERENCE[body, days]
    allowed = {"jupiter": 0.2, "saturn": 0.2}.get(body, 0.05)
    seen = sun_from(body, Instant(days, days))
    assert apart(seen.direction, direction) < allowed
    assert seen.distance == pytest.approx(distance, rel=0.002)


@given(st.sampled_from(BODIES), MOMENTS)
def test_direction_is_a_unit_vector_and_moves_steadily(body: str, at: Instant) -> None:
    now, soon = sun_from(body, at), sun_from(body, at.after(1.0))
    assert math.hypot(*now.direction) == pytest.approx(1.0, abs=1e-12)
    assert apart(now.direction, soon.direction) < 0.02  # Eros, the quickest, turns 0.019 deg/s
    assert abs(soon.distance - now.distance) < 1e-6


@given(st.floats(-100.0, 100.0), st.floats(0.0, 0.97))
def test_keplers_equation_is_solved(mean: float, eccentricity: float) -> None:
    anomaly = eccentric_anomaly(mean, eccentricity)
    wrapped = math.remainder(anomaly - eccentricity * math.sin(anomaly) - mean, math.tau)
    assert wrapped == pytest.approx(0.0, abs=1e-11)


@pytest.mark.parametrize("moon", MOONS)
def test_a_moon_turns_once_in_an_orbit(moon: str) -> None:
    """Kepler's third law with the planet's GM (JPL SSD), against the IAU's rotation: nothing of the two is shared."""
    gm = {"mars": 4.28284e13, "jupiter": 1.26687e17, "saturn": 3.79312e16, "uranus": 5.79395e15, "neptune": 6.8365e15}
    orbit = MOONS[moon]
    rate = math.degrees(math.sqrt(gm[orbit.planet] / orbit.distance**3)) * 86400.0
    assert abs(orbit.orientation.meridian.per_day) == pytest.approx(rate, rel=0.004)


def test_a_moons_day_is_near_its_orbit() -> None:
    """Titan's noon comes again after 15.97 d: its orbit of 15.945 d, and Saturn's year."""
    start = date(2028, 3, 1)
    day = 1.0 / (1.0 / 15.945421 - 1.0 / 10759.2)
    first, second = sun_from("titan", start), sun_from("titan", start.after(86400.0 * day))
    assert math.degrees(math.remainder(second.longitude - first.longitude, math.tau)) == pytest.approx(0.0, abs=0.5)


@pytest.mark.parametrize(
    "body,position",
    [
        ("ceres", (2.727955368904768, -0.7824235389148068, -0.9244287343918847)),
        ("vesta", (-1.70317472297052, -1.333843040283118, -0.3086709149679688)),
    ],
)
def test_small_bodies_are_where_horizons_has_them(body: str, position: tuple[float, float, float]) -> None:
    """JPL Horizons, from the Sun, axes of the equator of J2000, 2025 April 21, 12 h TDB: a year off the epoch."""
    np.testing.assert_allclose(heliocentric(ORBITS[body], 2460787.0 - J2000_DATE), position, atol=0.005)


def test_leap_seconds_are_those_of_the_iers() -> None:
    ahead = {1972: 42.184, 1980: 51.184, 1992: 58.184, 2000: 64.184, 2010: 66.184, 2016: 68.184, 2028: 69.184}
    for year, seconds in ahead.items():
        at = date(year, 3, 1)
        assert 86400.0 * (at.terrestrial - at.universal) == pytest.approx(seconds, abs=1e-4)


def test_a_leap_second_begins_with_its_day() -> None:
    day = datetime(2017, 1, 1, tzinfo=UTC).timestamp()
    before, after = instant(day - 1.0), instant(day)
    assert 86400.0 * (after.terrestrial - before.terrestrial) == pytest.approx(2.0, abs=1e-4)


def test_before_leap_seconds_the_earth_lags_as_it_did() -> None:
    """TT - UT1 of The Astronomical Almanac, p. K9; it goes over into that of 1972 without a step."""
    for year, seconds in ((1958, 32.18), (1960, 33.15), (1962, 34.00), (1967, 37.43), (1969, 39.20), (1971, 41.17)):
        at = date(year, 1, 1, 0)
        assert 86400.0 * (at.terrestrial - at.universal) == pytest.approx(seconds, abs=0.2)
    day = datetime(1972, 1, 1, tzinfo=UTC).timestamp()
    before, after = instant(day - 1.0), instant(day)
    assert 86400.0 * (after.terrestrial - before.terrestrial) == pytest.approx(1.0, abs=1e-4)


@pytest.mark.parametrize("year", [1957, 2100])
def test_other_years_are_refused(year: int) -> None:
    with pytest.raises(InvalidValueError, match="1958 to 2099"):
        date(year, 12, 31)


def test_a_body_without_ephemeris_is_refused_with_the_others() -> None:
    with pytest.raises(InvalidValueError, match="titan"):
        sun_from("vulcan", Instant(0.0, 0.0))


def test_seasons_of_mars_have_their_lengths() -> None:
    """Northern spring 193.3, summer 178.64, autumn 142.7, winter 153.95 sols (Allison and McEwen 2000)."""
    start = date(2024, 1, 1)
    sols = np.arange(0.0, 1400.0)
    seasons = np.unwrap([mars_time(start.after(sol * 88775.244)).solar_longitude for sol in sols], period=360.0)
    first = 360.0 * math.ceil(seasons[0] / 360.0)
    turns = np.interp(first + 90.0 * np.arange(5), seasons, sols)
    np.testing.assert_allclose(np.diff(turns), (193.30, 178.64, 142.70, 153.95), atol=0.3)
