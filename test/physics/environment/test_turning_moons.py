"""Sun and Earth over moons, Mercury and Venus, by another ephemeris, and of the Moon by another rotation too."""

import math
from datetime import UTC, datetime, timedelta

import numpy as np
import pytest

from sojourn_config.load import load_params
from sojourn_machine.params import FloatArray
from sojourn_physics.environment.body import BodyParams
from sojourn_physics.environment.site import SiteParams
from sojourn_physics.environment.sun.ephemeris import FromCentre, body_axes, earth_from, sun_from
from sojourn_physics.environment.sun.instant import Instant, instant
from sojourn_physics.environment.sun.moons import MOONS
from sojourn_physics.environment.sun.orbits import eccentric_anomaly
from sojourn_physics.environment.sun.orientation import angle_at
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


@pytest.mark.published
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


# Middle of eclipses [UTC] and how long the moon's centre is behind Jupiter's mean disc [min], by the theory of Lainey,
# Duriez and Vienne and VSOP87 in Astronomy Engine 2.1.19 (D. Cross).
ECLIPSES = [
    ("io", "2003-04-01T09:51:30", 135.0), ("io", "2009-08-02T08:11:50", 134.3), ("io", "2021-04-01T09:30:00", 135.3),
    ("io", "2032-04-02T17:52:20", 132.7), ("io", "2050-04-02T01:24:00", 134.0),
    ("europa", "2003-04-04T09:31:15", 169.5), ("europa", "2014-04-02T12:48:00", 163.0),
    ("europa", "2026-04-01T17:33:00", 170.0), ("europa", "2041-04-03T02:14:45", 150.5),
    ("ganymede", "2003-04-08T16:30:00", 214.0), ("ganymede", "2014-04-03T21:04:00", 198.0),
    ("ganymede", "2032-04-07T09:46:00", 192.0), ("ganymede", "2041-04-02T16:39:30", 127.0),
    ("callisto", "2003-04-03T02:42:00", 284.0), ("callisto", "2014-04-05T23:47:00", 242.0),
    ("callisto", "2032-04-14T16:39:00", 230.0), ("callisto", "2050-04-08T12:11:00", 278.0),
]  # fmt: skip


@pytest.mark.parametrize(("body", "middle", "minutes"), ECLIPSES)
def test_a_moon_of_jupiter_is_eclipsed_when_its_theory_has_it(body: str, middle: str, minutes: float) -> None:
    """With Jupiter over longitude 0 they were 7 minutes off on Io, 33 on Europa, 70 on Ganymede, 110 on Callisto."""
    start = datetime.fromisoformat(f"{middle}+00:00") - timedelta(hours=6)
    sun = SunOver(SunParams(time=start), load_params("bodies", body, BodyParams), SiteParams(latitude_deg=0.0))
    times = np.arange(0.0, 12.0 * 3600.0, 60.0)
    dark = times[[sun.light(float(time), 0.0, 0.0).visible < 0.5 for time in times]] / 60.0
    late = {"io": 1.5, "europa": 3.0, "ganymede": 4.0, "callisto": 8.0}[body]
    assert 0.5 * (dark[0] + dark[-1]) == pytest.approx(360.0, abs=late)
    assert dark[-1] - dark[0] == pytest.approx(minutes, abs=3.5)


# Orbits [km, days] of NASA's planetary fact sheets; equinoxes of Saturn and Uranus, solstices.
IN_SEASON = [
    ("tethys", 294_660.0, 1.887802, 58_232.0, "2025-05-06"), ("dione", 377_400.0, 2.736915, 58_232.0, "2025-05-06"),
    ("rhea", 527_040.0, 4.518212, 58_232.0, "2025-05-06"), ("miranda", 129_390.0, 1.413479, 25_362.0, "2007-12-07"),
    ("ariel", 191_020.0, 2.520379, 25_362.0, "2007-12-07"), ("umbriel", 266_300.0, 4.144177, 25_362.0, "2007-12-07"),
]  # fmt: skip
OUT_OF_SEASON = {"saturn": "2017-05-24", "uranus": "2030-04-19"}


@pytest.mark.parametrize(("body", "distance", "days", "radius", "equinox"), IN_SEASON)
def test_moons_of_saturn_and_uranus_are_eclipsed_each_turn_at_equinox_and_never_at_solstice(
    body: str, distance: float, days: float, radius: float, equinox: str
) -> None:
    """Through the middle of the shadow for asin(R/a)/pi of the orbit; Miranda's own tilt takes some off."""
    times = np.arange(0.0, days * 86400.0, 240.0)

    def dark_seconds(day: str) -> float:
        start = datetime.fromisoformat(f"{day}T00:00:00+00:00")
        sun = SunOver(SunParams(time=start), load_params("bodies", body, BodyParams), SiteParams(latitude_deg=0.0))
        return 240.0 * sum(
            sun.light(float(time), 0.0, 0.0).visible < 0.5 for time in times if sun.direction(float(time))[2] > 0.0
        )

    expected = math.asin(radius / distance) / math.pi * days * 86400.0
    assert 0.9 * expected - 480.0 < dark_seconds(equinox) < expected + 480.0
    assert dark_seconds(OUT_OF_SEASON["saturn" if radius > 5e4 else "uranus"]) == 0.0


# JPL Solar System Dynamics, planetary satellite mean elements for 2000 January 1.5: pole of the Laplace plane [deg],
# eccentricity, inclination, node, argument of the pericentre, mean anomaly [deg], motion [deg/d].
OF_SATURN = {
    "enceladus": ((40.66, 83.52), 0.0047, 0.003, 342.507, 0.076, 199.686, 262.7318996),
    "dione": ((40.66, 83.52), 0.0022, 0.028, 290.415, 284.315, 322.232, 131.5349316),
    "rhea": ((40.38, 83.55), 0.0010, 0.333, 351.042, 241.619, 179.781, 79.6900478),
    "titan": ((36.214, 83.949), 0.0288, 0.306, 28.060, 180.532, 163.310, 22.5769768),
}


def turning(plane: float, tilt: float, angle: float) -> FloatArray:
    """Axes (3, 3) of a plane from its node and tilt, turned by an angle in it [rad]."""

    def about_z(a: float) -> FloatArray:
        return np.array(((math.cos(a), -math.sin(a), 0.0), (math.sin(a), math.cos(a), 0.0), (0.0, 0.0, 1.0)))

    c, s = math.cos(tilt), math.sin(tilt)
    found: FloatArray = about_z(plane) @ np.array(((1.0, 0.0, 0.0), (0.0, c, -s), (0.0, s, c))) @ about_z(angle)
    return found


@pytest.mark.parametrize(
    ("moon", "days"),
    [("enceladus", 0.0), ("enceladus", 0.7), ("dione", 0.0), ("dione", 2.0), ("rhea", 0.0), ("rhea", 4.0)]
    + [("titan", days) for days in (0.0, 4.0, 8.0, 12.0, 4000.0, 9006.0, 9014.0)],
)
def test_saturn_stands_over_its_moons_where_their_orbits_have_it(moon: str, days: float) -> None:
    """Swings of less than a degree are left out of all but Titan. Its node and pericentre have periods of 687.37 and
    351.77 years, the others' are not needed for some days."""
    (ascension, declination), eccentricity, inclination, node, argument, anomaly, motion = OF_SATURN[moon]
    if moon == "titan":
        node -= 360.0 / 687.37 * days / 365.25
        argument += 360.0 / 351.77 * days / 365.25
        motion -= (360.0 / 351.77 - 360.0 / 687.37) / 365.25
    eccentric = eccentric_anomaly(math.radians(anomaly + motion * days), eccentricity)
    across = math.sqrt(1.0 - eccentricity**2) * math.sin(eccentric)
    along = math.radians(argument) + math.atan2(across, math.cos(eccentric) - eccentricity)
    laplace = turning(math.radians(90.0 + ascension), math.radians(90.0 - declination), 0.0)
    x, y, z = laplace @ turning(math.radians(node), math.radians(inclination), along) @ np.array((-1.0, 0.0, 0.0))
    x, y, z = body_axes(moon, (float(x), float(y), float(z)), Instant(days, days))
    found = angle_at(MOONS[moon].planet_longitude, days)
    allowed = 0.3 if moon == "titan" else 0.1 + math.degrees(2.0 * eccentricity)
    assert math.degrees(math.remainder(math.atan2(y, x) - found, math.tau)) == pytest.approx(0.0, abs=allowed)
    assert math.degrees(math.asin(z)) == pytest.approx(0.0, abs=0.5)


def test_phobos_swings_against_its_orbit() -> None:
    """A body on a round of e turns by A = 2 e w^2/(w^2 - n^2) of the forced swing, w^2 = 3 n^2 (B - A)/C (Murray and
    Dermott 1999, Solar System Dynamics, ch. 5): of an even ellipsoid (B - A)/C = (a^2 - b^2)/(a^2 + b^2)."""
    a, b, _ = load_params("bodies", "phobos", BodyParams).semi_axes
    square = 3.0 * (a * a - b * b) / (a * a + b * b)
    twice = math.degrees(2.0 * 0.0151)
    forced = twice * square / (square - 1.0)
    ((swing, _),) = MOONS["phobos"].planet_longitude.harmonics
    assert forced < 0.0
    assert swing == pytest.approx(twice - forced, rel=0.1)
