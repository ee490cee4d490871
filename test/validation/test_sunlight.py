"""Sunlight against what has been published: Mars under dust, eclipses, clocks on Mars, lunar poles."""

import math
from datetime import UTC, datetime

import numpy as np
import pytest

from sojourn_config.load import load_params
from sojourn_physics.environment.body import BodyParams
from sojourn_physics.environment.site import SiteParams, site_frame
from sojourn_physics.environment.sun.dusty_sky import flux_of_season, light_under_dust
from sojourn_physics.environment.sun.ephemeris import earth_from, sun_from
from sojourn_physics.environment.sun.instant import instant
from sojourn_physics.environment.sun.mars_time import mars_time
from sojourn_physics.environment.sun.over import SunOver
from sojourn_physics.environment.sun.path import SunParams

ZENITHS = (0, 20, 40, 60, 70, 80, 85)
# Net flux over ground of albedo 0.1 and 0.4, NASA TM-103623 (1991), table III, of optical depths that the model leaves
# out
NET_FLUX = {
    (0.25, 0.1): (0.857, 0.852, 0.838, 0.793, 0.739, 0.608, 0.466),
    (0.6, 0.1): (0.796, 0.785, 0.755, 0.668, 0.579, 0.422, 0.325),
    (0.85, 0.1): (0.752, 0.739, 0.701, 0.596, 0.500, 0.356, 0.281),
    (1.25, 0.1): (0.687, 0.670, 0.621, 0.502, 0.405, 0.287, 0.235),
    (1.75, 0.1): (0.612, 0.592, 0.534, 0.413, 0.327, 0.236, 0.197),
    (3.4, 0.1): (0.415, 0.395, 0.338, 0.243, 0.193, 0.146, 0.124),
    (4.5, 0.1): (0.325, 0.307, 0.257, 0.184, 0.148, 0.114, 0.096),
    (0.25, 0.4): (0.583, 0.578, 0.569, 0.539, 0.502, 0.413, 0.316),
    (0.6, 0.4): (0.550, 0.543, 0.522, 0.462, 0.401, 0.292, 0.225),
    (1.75, 0.4): (0.440, 0.425, 0.384, 0.297, 0.236, 0.171, 0.142),
    (4.5, 0.4): (0.244, 0.231, 0.194, 0.140, 0.112, 0.087, 0.074),
}


@pytest.mark.published("NASA TM-103623 (1991), table III")
@pytest.mark.parametrize("depth,albedo", NET_FLUX)
def test_light_under_dust_is_that_of_the_published_table(depth: float, albedo: float) -> None:
    for zenith, net in zip(ZENITHS, NET_FLUX[depth, albedo], strict=True):
        cosine = math.cos(math.radians(zenith))
        beam, diffuse = light_under_dust(1.0, cosine, depth, albedo)
        assert (beam * cosine + diffuse) * (1.0 - albedo) / cosine == pytest.approx(net, rel=0.02, abs=0.003)
        assert beam == pytest.approx(math.exp(-depth / cosine))


@pytest.mark.published("Appelbaum & Flood 1990, Solar Energy 45:353")
@pytest.mark.parametrize("season,flux", [(0.0, 559.2), (69.0, 493.5), (153.0, 590.7), (249.0, 717.8)])
def test_flux_over_mars_is_the_published_one(season: float, flux: float) -> None:
    assert flux_of_season(season) == pytest.approx(flux, rel=0.002)


def test_flux_by_the_date_is_that_of_the_season() -> None:
    """The published formula has the perihelion at Ls 248, where it is at 251 today: 1.1 % between them."""
    start = datetime(2027, 1, 1, tzinfo=UTC).timestamp()
    for day in range(0, 687, 7):
        mars = mars_time(instant(start + 86400.0 * day))
        flux = 1361.0 / mars.distance**2 * 590.0 / 586.2  # their solar constant is the larger
        assert flux == pytest.approx(flux_of_season(mars.solar_longitude), rel=0.013)


@pytest.mark.published
def test_curiosity_landed_in_the_afternoon() -> None:
    """2012 August 6, 05:17:57 UTC at 137.4417 E: 15:03 local mean solar time (JPL), Ls 150.7."""
    mars = mars_time(instant(datetime(2012, 8, 6, 5, 17, 57, tzinfo=UTC).timestamp()))
    assert mars.solar_longitude == pytest.approx(150.7, abs=0.1)
    assert (mars.coordinated_time + 137.4417 / 15.0) % 24.0 == pytest.approx(15.0 + 3.0 / 60.0, abs=0.03)


# Contacts of the umbra, from the catalogue of F. Espenak, NASA GSFC [UTC]: the Moon's first limb in, all of it in,
# the first limb out again, all of it out
ECLIPSES = {
    "2000-07-16": ("11:57:40", "13:02:11", "14:48:35", "15:53:58"),
    "2018-07-27": ("18:24:27", "19:30:15", "21:13:12", "22:19:00"),
    "2025-03-14": ("05:09:40", "06:26:06", "07:31:26", "08:47:52"),
    "2028-12-31": ("15:07:44", "16:16:28", "17:28:20", "18:37:04"),
}


@pytest.mark.parametrize("day", ECLIPSES)
def test_the_moon_is_eclipsed_when_it_was_foretold(day: str) -> None:
    """All that face the Earth are in full shadow between the second and third contact, in full light well before."""
    start = datetime.fromisoformat(f"{day}T00:00:00+00:00")
    moon = load_params("bodies", "moon", BodyParams)
    contacts = [(datetime.fromisoformat(f"{day}T{c}+00:00") - start).total_seconds() for c in ECLIPSES[day]]
    first, second, third, last = contacts
    for latitude, longitude in ((0.0, 0.0), (0.0, 60.0), (0.0, -60.0), (60.0, 0.0), (-60.0, 0.0)):
        sun = SunOver(SunParams(time=start), moon, SiteParams(latitude_deg=latitude, longitude_deg=longitude))
        for time in (second + 300.0, 0.5 * (second + third), third - 300.0):
            assert sun.light(time, 0.0, 0.0).direct == 0.0
        for time in (first - 5400.0, last + 5400.0):
            assert sun.light(time, 0.0, 0.0).visible == 1.0
        seen = np.array([sun.light(t, 0.0, 0.0).visible for t in np.arange(first - 3600.0, last + 3600.0, 60.0)])
        dark = np.flatnonzero(seen == 0.0) * 60.0 + first - 3600.0
        # the place is dark no earlier than the Moon's first limb, and no later than its last
        assert first - 180.0 <= dark[0] <= second + 180.0
        assert third - 180.0 <= dark[-1] <= last + 180.0
        assert (np.diff(np.flatnonzero(seen < 1.0)) == 1).all()


# Sun's altitude and azimuth, Earth's altitude and azimuth [deg] over the landing sites: Apollo Lunar Surface Journal
# (NASA), "Sun and Earth: altitudes and azimuths", after J. Scotti; with another ephemeris they are up to 0.5 deg off
APOLLO_11, APOLLO_12 = (0.6875, 23.4333), (-3.1975, -23.3856)
SKIES = [
    (APOLLO_11, "1969-07-20T20:17:39Z", (10.65, 88.81, 59.43, 272.16)),
    (APOLLO_11, "1969-07-21T05:11:13Z", (15.17, 88.85, 59.27, 273.17)),
    (APOLLO_11, "1969-07-21T17:54:00Z", (21.65, 88.91, 59.09, 274.58)),
    (APOLLO_12, "1969-11-19T06:54:36Z", (5.19, 91.16, 61.56, 86.95)),
    (APOLLO_12, "1969-11-20T03:54:45Z", (15.79, 90.60, 61.48, 89.65)),
    (APOLLO_12, "1969-11-20T14:25:47Z", (21.11, 90.33, 61.48, 90.88)),
]


@pytest.mark.published("Apollo Lunar Surface Journal (NASA), Sun and Earth over Apollo 11 and 12")
@pytest.mark.parametrize("place,time,published", SKIES)
def test_sun_and_earth_stood_over_apollo_where_its_journal_has_them(
    place: tuple[float, float], time: str, published: tuple[float, float, float, float]
) -> None:
    """Its Earth agrees as seen from the Moon's centre; from the ground it stands an eighth of a degree lower."""
    moon = load_params("bodies", "moon", BodyParams)
    at = instant(datetime.fromisoformat(time).timestamp())
    frame = site_frame(SiteParams(latitude_deg=place[0], longitude_deg=place[1]), moon.semi_axes)
    found = []
    for seen in (sun_from("moon", at), earth_from("moon", at)):
        east, north, up = frame.rotation.T @ np.array(seen.direction)
        found += [math.degrees(math.asin(up)), math.degrees(math.atan2(east, north)) % 360.0]
    assert found[:2] == pytest.approx(published[:2], abs=0.03)
    assert found[2:] == pytest.approx(published[2:], abs=0.07)


@pytest.mark.published
def test_io_is_in_jupiters_shadow_at_noon_where_it_faces_jupiter() -> None:
    """Once an orbit of 42.46 h, for as long as Jupiter's shadow is wide: asin(R/a)/pi of it, 2.25 h."""
    io, site = load_params("bodies", "io", BodyParams), SiteParams(latitude_deg=0.0)
    sun = SunOver(SunParams.model_validate({"time": "2028-03-01T00:00:00Z"}), io, site)
    lights = [sun.light(t, 0.0, 0.0) for t in np.arange(0.0, 10.0 * 42.459 * 3600.0, 300.0)]
    hidden = sum(light.visible < 0.5 and light.elevation > 0.5 for light in lights)
    assert hidden / 120.0 == pytest.approx(2.25, abs=0.15)


@pytest.mark.published
def test_the_lunar_pole_sees_the_sun_low_all_round() -> None:
    """The Moon's axis leans on the ecliptic by 1.54 deg: at the pole the Sun stands no higher than that."""
    moon, site = load_params("bodies", "moon", BodyParams), SiteParams(latitude_deg=-90.0)
    sun = SunOver(SunParams.model_validate({"time": "2028-01-01T00:00:00Z"}), moon, site)
    lights = [sun.light(t, 0.0, 0.0) for t in np.arange(0.0, 366.0 * 86400.0, 86400.0)]
    elevations = np.degrees([light.elevation for light in lights])
    assert elevations.max() == pytest.approx(1.54, abs=0.06)
    assert elevations.min() == pytest.approx(-1.54, abs=0.06)
