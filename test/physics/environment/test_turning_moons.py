"""Sun and Earth over moons, Mercury and Venus, by another ephemeris, and of the Moon by another rotation too."""

import math
from datetime import UTC, datetime

import numpy as np
import pytest

from sojourn_config.load import load_params
from sojourn_physics.environment.body import BodyParams
from sojourn_physics.environment.site import SiteParams
from sojourn_physics.environment.sun.ephemeris import FromCentre, earth_from, sun_from
from sojourn_physics.environment.sun.instant import Instant, instant
from sojourn_physics.environment.sun.moons import MOONS
from sojourn_physics.environment.sun.over import SunOver, sun_path
from sojourn_physics.environment.sun.path import SunParams

DATES = ((2003, 8, 27, 7), (2019, 1, 11, 21), (2031, 11, 5, 3), (2047, 6, 19, 14))
# Direction in the body's axes at the dates, UTC, computed with the ephemeris DE421 (Folkner, Williams and Boggs 2009,
# IPN Progress Report 42-178) with light time and aberration. The Moon is turned by the librations that DE421 has
# integrated, in its mean Earth and pole axes; the others by all terms of Archinal et al. (2018) with its erratum.
SUN = {
    "moon": (
        (-0.99956, -0.01308, 0.02645), (-0.37434, 0.92729, 0.00311),
        (0.41634, -0.90921, -0.00267), (-0.73239, -0.68083, 0.00887),
    ),
    "phobos": (
        (0.61329, -0.67963, -0.40246), (-0.15064, 0.95315, -0.26231),
        (-0.12703, 0.91931, -0.37247), (0.74191, 0.67008, 0.02377),
    ),
    "io": (
        (-0.93091, 0.36508, -0.01072), (0.96010, -0.27491, -0.05142),
        (-0.97452, -0.22145, -0.03555), (0.72295, -0.68886, 0.05299),
    ),
    "titan": (
        (0.01837, 0.89770, -0.44023), (-0.88889, -0.16631, 0.42686),
        (-0.83008, 0.33269, -0.44753), (0.44039, 0.77917, 0.44604),
    ),
    "mercury": (
        (-0.67602, -0.73688, -0.00059), (0.02981, -0.99956, -0.00044),
        (0.82596, 0.56373, -0.00058), (-0.28038, -0.95989, -0.00053),
    ),
    "venus": (
        (0.99015, -0.13253, -0.04511), (0.85551, 0.51580, -0.04534),
        (0.47239, 0.88094, -0.02809), (0.96217, 0.27245, -0.00021),
    ),
}  # fmt: skip
EARTH_FROM_MOON = (
    (0.98993, -0.08397, -0.11399), (0.99118, -0.08594, 0.10088),
    (0.99453, 0.01402, 0.10347), (0.99452, -0.00646, -0.10437),
)  # fmt: skip
ALLOWED = {"moon": 0.01, "mercury": 0.01, "venus": 0.01, "phobos": 0.08, "io": 0.15, "titan": 0.16}
"""What the header of `ephemeris` says of each [deg]."""


def at(date: tuple[int, int, int, int]) -> Instant:
    year, month, day, hour = date
    return instant(datetime(year, month, day, hour, tzinfo=UTC).timestamp())


def off(seen: FromCentre, direction: tuple[float, float, float]) -> float:
    """[deg]"""
    return math.degrees(2.0 * math.asin(0.5 * math.dist(seen.direction, direction)))


@pytest.mark.parametrize("body", SUN)
def test_the_sun_stands_where_another_ephemeris_has_it(body: str) -> None:
    for date, direction in zip(DATES, SUN[body], strict=True):
        assert off(sun_from(body, at(date)), direction) < ALLOWED[body]


def test_the_earth_stands_over_the_moon_where_another_ephemeris_has_it() -> None:
    for date, direction in zip(DATES, EARTH_FROM_MOON, strict=True):
        assert off(earth_from("moon", at(date)), direction) < 0.04


def test_phobos_gains_on_its_mean_motion_as_its_orbit_sinks() -> None:
    """By 4 cm a year (Bills et al. 2005, J. Geophys. Res. 110:E07004): n is as a^(-3/2), and the longitude gains half
    of its change times the time."""
    phobos = MOONS["phobos"]
    meridian = phobos.orientation.meridian
    sinking = 0.04 / 365.25  # [m/d]
    gain = 0.5 * 1.5 * sinking / phobos.distance * meridian.per_day
    assert meridian.per_day_squared == pytest.approx(gain, rel=0.1)


def test_mercurys_sun_turns_back_where_it_rises_at_perihelion() -> None:
    """A day of Mercury takes two of its years, and over longitude 90 the Sun rises, sets and rises again (Soter and
    Ulrichs 1967, Nature 214:1315)."""
    body, site = load_params("bodies", "mercury", BodyParams), SiteParams(latitude_deg=0.0, longitude_deg=90.0)
    path = sun_path(SunParams.model_validate({"time": "2030-01-01T00:00:00Z"}), body, site)
    times = np.arange(0.0, 352.0 * 86400.0, 0.25 * 86400.0)
    up = np.array([path.direction(float(time))[2] for time in times])
    rises = times[1:][(up[:-1] < 0.0) & (up[1:] >= 0.0)] / 86400.0
    assert rises[3:] - rises[:-3] == pytest.approx(2.0 * 87.969, abs=0.3)  # and at sunset it comes back once
    assert rises[1] - rises[0] == pytest.approx(14.25, abs=0.5)


# Hidden by a planet of radius R a distance a away, where the Sun stands d over the moon's equator and orbit:
# cos H = sqrt(1 - (R/a)^2) / cos d of the half turn, if that is below one.
@pytest.mark.parametrize(
    "body,radius,distance,days,date",
    [
        ("phobos", 3389.5, 9376.0, 0.31891, "2028-02-20T00:00:00Z"),
        ("phobos", 3389.5, 9376.0, 0.31891, "2028-05-15T00:00:00Z"),
        ("phobos", 3389.5, 9376.0, 0.31891, "2028-10-20T00:00:00Z"),
        ("europa", 69911.0, 671100.0, 3.551181, "2031-06-01T00:00:00Z"),
        ("titan", 58232.0, 1221900.0, 15.945421, "2025-05-10T00:00:00Z"),
        ("titan", 58232.0, 1221900.0, 15.945421, "2032-05-10T00:00:00Z"),
    ],
)
def test_a_planet_hides_the_sun_for_as_long_as_its_shadow_is_wide(
    body: str, radius: float, distance: float, days: float, date: str
) -> None:
    site = SiteParams(latitude_deg=0.0)
    sun = SunOver(SunParams.model_validate({"time": date}), load_params("bodies", body, BodyParams), site)
    step = 2e-3 * days * 86400.0
    lights = [sun.light(step * index, 0.0, 0.0) for index in range(500)]
    middle = instant(datetime.fromisoformat(date).timestamp()).after(250.0 * step)
    cosine = math.sqrt(1.0 - (radius / distance) ** 2) / math.cos(sun_from(body, middle).latitude)
    expected = 0.0 if cosine >= 1.0 else math.acos(cosine) / math.pi
    hidden = np.mean([1.0 - light.visible for light in lights if light.elevation > 0.3])
    share = np.mean([light.elevation > 0.3 for light in lights])
    assert hidden * share == pytest.approx(expected, abs=0.003)
