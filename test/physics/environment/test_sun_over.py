"""Sunlight over a site: what is hidden is dark, what falls is what the distance and the air leave."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_config.load import load_params
from sojourn_machine.errors import InvalidValueError
from sojourn_physics.environment.body import BodyParams
from sojourn_physics.environment.site import SiteParams
from sojourn_physics.environment.sun.over import EYE, SunOver
from sojourn_physics.environment.sun.path import SunParams, sun_direction
from sojourn_physics.terrain.height_field import HeightField


def body(name: str) -> BodyParams:
    """One of the files."""
    return load_params("bodies", name, BodyParams)


MOON, MARS = body("moon"), body("mars")


def dated(time: str, **others: object) -> SunParams:
    """A Sun by its date."""
    return SunParams.model_validate({"time": time, **others})


def crater(depth: float, radius: float) -> HeightField:
    """A bowl with a level floor of half its radius, in a level plain of 60 m."""
    side = np.arange(-30.0, 30.01, 0.1)
    x, y = np.meshgrid(side, side)
    fall = np.clip((np.hypot(x, y) - 0.5 * radius) / (0.5 * radius), 0.0, 1.0)
    return HeightField(depth * (fall - 1.0), np.zeros(x.shape, dtype=np.uint8), 0.1, -30.0, -30.0, ("soil",))


@given(st.floats(0.0, 1e6), st.floats(-360.0, 360.0), st.floats(-90.0, 90.0), st.floats(-90.0, 90.0))
def test_a_sun_by_its_place_moves_as_ever(time: float, azimuth: float, elevation: float, latitude: float) -> None:
    sun = SunParams(azimuth_deg=azimuth, elevation_deg=elevation, latitude_deg=latitude)
    found = SunOver(sun, MARS).direction(time)
    assert found.tobytes() == sun_direction(sun, MARS.solar_day, time).tobytes()


def test_a_site_gives_its_latitude_to_a_sun_by_its_place() -> None:
    sun, site = SunParams(azimuth_deg=90.0, elevation_deg=0.0), SiteParams(latitude_deg=40.0)
    noon = SunOver(sun, MARS, site).direction(0.25 * MARS.solar_day)
    assert math.degrees(math.asin(noon[2])) == pytest.approx(50.0)
    with pytest.raises(InvalidValueError, match="the site has its latitude"):
        SunOver(SunParams(latitude_deg=30.0), MARS, site)


@given(st.floats(-80.0, 80.0), st.floats(-180.0, 180.0), st.floats(0.0, 5e7))
def test_light_without_air_is_all_or_nothing_but_on_the_limb(latitude: float, longitude: float, time: float) -> None:
    over = SunOver(dated("2028-01-01T00:00:00Z"), MOON, SiteParams(latitude_deg=latitude, longitude_deg=longitude))
    light = over.light(time, 0.0, 0.0)
    assert np.linalg.norm(light.direction) == pytest.approx(1.0)
    assert light.elevation == pytest.approx(math.asin(light.direction[2]))
    assert light.diffuse == 0.0
    distance = over.path.distance(time)
    assert 0.98 < distance < 1.02
    assert light.direct == pytest.approx(light.visible * 1361.0 / distance**2)
    if light.elevation < -math.radians(0.3):
        assert light.visible == 0.0 and light.direct == 0.0


def test_a_lunar_day_has_its_length() -> None:
    """Noons come 29.2 to 29.9 d apart: the month, as the Moon's and the Earth's unround orbits have it."""
    over = SunOver(dated("2028-01-01T00:00:00Z"), MOON, SiteParams(latitude_deg=0.0))
    times = np.arange(0.0, 65.0 * 86400.0, 7200.0)
    east = np.array([over.direction(time)[0] for time in times])
    up = np.array([over.direction(time)[2] for time in times])
    noons = [t for t, a, b, z in zip(times, east, east[1:], up, strict=False) if a > 0.0 >= b and z > 0.0]
    assert len(noons) == 2
    assert 29.2 < (noons[1] - noons[0]) / 86400.0 < 29.9


def test_a_rover_in_a_craters_shadow_is_dark_and_one_on_the_plain_is_not() -> None:
    sun = SunParams(azimuth_deg=90.0, elevation_deg=10.0, ground_hides=True)
    over = SunOver(sun, MOON, None, lambda: crater(depth=6.0, radius=12.0))
    assert over.light(0.0, 0.0, 0.0).direct == 0.0
    assert over.light(0.0, 0.0, 0.0).visible == 0.0
    assert over.light(0.0, -20.0, 0.0).direct == pytest.approx(1361.0)
    higher = SunParams(azimuth_deg=90.0, elevation_deg=60.0, ground_hides=True)
    assert SunOver(higher, MOON, None, lambda: crater(6.0, 12.0)).light(0.0, 0.0, 0.0).direct == pytest.approx(1361.0)


def test_the_edge_of_a_shadow_lies_where_the_rim_throws_it() -> None:
    """Sun in the east at 20 deg; the rim is 12 m east of the middle and 6 m up, the eye 0.5 m over the floor."""
    sun = SunParams(azimuth_deg=90.0, elevation_deg=20.0, ground_hides=True)
    over = SunOver(sun, MOON, None, lambda: crater(depth=4.0, radius=12.0))
    edge = 12.0 - (4.0 - EYE) / math.tan(math.radians(20.0))
    seen = [over.light(0.0, x, 0.25).visible for x in (edge - 1.0, edge + 1.0)]
    assert seen == [1.0, 0.0]


def test_today_s_sun_has_a_flat_horizon() -> None:
    """Ground hides a Sun that is given by its place only where the scenario says so."""

    def deep() -> HeightField:
        raise AssertionError("the ground is not asked for")

    assert SunOver(SunParams(elevation_deg=10.0), MOON, None, deep).light(0.0, 0.0, 0.0).visible == 1.0


def test_the_horizon_is_that_of_the_square_and_of_every_ten_seconds() -> None:
    sun = dated("2028-03-01T12:00:00Z")
    over = SunOver(sun, MOON, SiteParams(latitude_deg=-60.0), lambda: crater(6.0, 12.0))
    again = SunOver(sun, MOON, SiteParams(latitude_deg=-60.0), lambda: crater(6.0, 12.0))
    for x in (0.01, 3.0, 3.49, 6.1):
        first = over.light(12.0, x, 0.1)
        assert first.visible == again.light(12.0, x, 0.1).visible  # whatever was asked before
        assert first.visible == over.light(12.0, math.floor(2.0 * x) / 2.0, 0.4).visible


def test_a_far_horizon_hides_a_low_sun() -> None:
    site, time = SiteParams(latitude_deg=-89.5, longitude_deg=0.0), "2028-03-01T12:00:00Z"
    clear = SunOver(dated(time), MOON, site)
    mountains = [{"azimuth_deg": float(a), "elevation_deg": 5.0} for a in range(0, 360, 30)]
    hidden = SunOver(dated(time, horizon=mountains), MOON, site)
    year = np.arange(0.0, 366.0 * 86400.0, 2.1 * 86400.0)
    assert max(clear.light(t, 0.0, 0.0).visible for t in year) == 1.0
    assert max(abs(clear.light(t, 0.0, 0.0).elevation) for t in year) < math.radians(2.3)
    assert all(hidden.light(t, 0.0, 0.0).direct == 0.0 for t in year)


@given(st.floats(0.0, 1.5e7), st.floats(0.0, 12.0))
def test_dust_takes_from_the_beam_and_leaves_light_of_the_sky(time: float, depth: float) -> None:
    site, start = SiteParams(latitude_deg=-2.0, longitude_deg=354.5), "2028-01-01T00:00:00Z"
    clear = SunOver(dated(start, optical_depth=0.0), MARS, site).light(time, 0.0, 0.0)
    dusty = SunOver(dated(start, optical_depth=depth), MARS, site).light(time, 0.0, 0.0)
    level = max(math.sin(clear.elevation), 0.0)
    assert 0.0 <= dusty.direct <= clear.direct
    assert dusty.diffuse >= 0.0
    if clear.visible == 1.0:
        assert dusty.direct * level + dusty.diffuse <= clear.direct * level * (1.0 + 1e-9) + 1e-9


def test_a_low_orbit_is_dark_behind_the_earth() -> None:
    """Of an orbit in the plane of the Sun: asin(R/r)/pi, 0.389 of it at 408 km."""
    over = SunOver(SunParams(elevation_deg=90.0), body("low_earth_orbit"))
    period = body("low_earth_orbit").solar_day
    seen = np.array([over.light(t, 0.0, 0.0).visible for t in np.linspace(0.0, period, 4001)])
    assert np.mean(1.0 - seen) == pytest.approx(math.asin(6371.01 / 6779.0) / math.pi, abs=0.001)
    assert 0.0 < np.mean((seen > 0.0) & (seen < 1.0)) < 0.01


@pytest.mark.parametrize("name,share", [("titan", 0.10), ("venus", 0.026)])
def test_under_clouds_there_is_no_beam(name: str, share: float) -> None:
    over = SunOver(SunParams(elevation_deg=90.0), body(name))
    light = over.light(0.0, 0.0, 0.0)
    assert light.direct == 0.0
    assert light.diffuse == pytest.approx(share * body(name).solar_flux)


def test_a_date_needs_a_site_and_a_body_with_ephemeris() -> None:
    with pytest.raises(InvalidValueError, match="with a site"):
        SunOver(dated("2028-03-01T12:00:00Z"), MOON)
    with pytest.raises(InvalidValueError, match="one with an ephemeris"):
        SunOver(dated("2028-03-01T12:00:00Z"), MOON.model_copy(update={"name": "vulcan"}), SiteParams(latitude_deg=0.0))


def test_a_date_and_a_place_are_one_too_many() -> None:
    with pytest.raises(ValueError, match="Leave out elevation_deg"):
        SunParams.model_validate({"time": "2028-03-01T12:00:00Z", "elevation_deg": 20.0})
    with pytest.raises(ValueError, match="timezone"):
        SunParams.model_validate({"time": "2028-03-01T12:00:00"})
    with pytest.raises(ValueError, match="1958 to 2099"):
        SunParams.model_validate({"time": "2128-03-01T12:00:00Z"})


@settings(max_examples=20)
@given(time=st.floats(0.0, 80_000.0), x=st.floats(-5.0, 5.0))
def test_the_held_light_is_that_of_its_second(time: float, x: float) -> None:
    site = SiteParams(latitude_deg=-1.95, longitude_deg=354.47)
    over = SunOver(dated("2004-01-26T00:10:00Z"), MARS, site)
    now, held = over.light(time, x, 0.0), over.held_light(time, x, 0.0)
    assert held is over.held_light(math.floor(time) + 0.25, x, 0.0), "made once"
    assert np.linalg.norm(held.direction - now.direction) < 4e-5
    assert held.direct == pytest.approx(now.direct, abs=0.5) and held.diffuse == pytest.approx(now.diffuse, abs=0.5)
