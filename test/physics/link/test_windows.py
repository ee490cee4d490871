"""When a link is open: by a table, by the Earth over the horizon, by an orbiter, each known in another way too."""

import math
from datetime import UTC, datetime

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from sojourn_config.load import load_params
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.timing import NANOSECONDS
from sojourn_physics.environment.body import BodyParams
from sojourn_physics.environment.orbit.circular import CircularOrbit
from sojourn_physics.environment.site import SiteParams, site_frame
from sojourn_physics.environment.sun.ephemeris import earth_from
from sojourn_physics.environment.sun.instant import instant
from sojourn_physics.environment.sun.path import SunParams
from sojourn_physics.link.orbiter import OrbiterParams, OrbiterPath
from sojourn_physics.link.params import LinkParams
from sojourn_physics.link.window import AnyOf, Window

LIGHT_S_PER_AU = 499.004784  # IAU 2009


def body(name: str) -> BodyParams:
    return load_params("bodies", name, BodyParams)


def windows(link: dict[str, object], name: str = "mars", site: SiteParams | None = None, **sun: object) -> Window:
    params = LinkParams.model_validate({"light_time_s": 1.0, **link})
    sky = params.sky(body(name), site, SunParams.model_validate(sun))
    params.check(sky)
    return AnyOf([window.build(sky) for window in params.windows])


def light_time(name: str, *date: int) -> float:
    return LIGHT_S_PER_AU * earth_from(name, instant(datetime(*date, tzinfo=UTC).timestamp())).distance  # type: ignore[arg-type,misc]


@pytest.mark.published("press kits of the landings, and distances of the oppositions")
@pytest.mark.parametrize(
    ("date", "minutes"),
    [
        ((2012, 8, 6, 5, 17), 13.8),  # the landing of Curiosity, by the mission's press kit
        ((2021, 2, 18, 20, 55), 11.37),  # of Perseverance: 11 min 22 s
        ((2003, 8, 27, 9, 51), 0.37272 * LIGHT_S_PER_AU / 60.0),  # nearest for 60 000 years
        ((2020, 10, 6, 14, 18), 0.41492 * LIGHT_S_PER_AU / 60.0),
    ],
)
def test_light_from_mars_takes_as_long_as_missions_tell(date: tuple[int, ...], minutes: float) -> None:
    assert light_time("mars", *date) / 60.0 == pytest.approx(minutes, abs=0.05)


@given(st.integers(0, 7000))
def test_the_earth_stands_still_over_the_moon_but_for_libration(days: int) -> None:
    """Within 7.9 and 6.9 deg, at 356 400 to 406 700 km (Meeus 1998, ch. 50 and 53), from surface to centre."""
    seen = earth_from("moon", instant(1577836800.0 + 86400.0 * days))
    assert abs(math.degrees(seen.longitude)) < 8.2 and abs(math.degrees(seen.latitude)) < 6.95
    assert 356.3e6 < seen.distance * 149597870700.0 < 406.9e6


def test_at_the_pole_of_the_moon_the_earth_rises_and_sets_with_its_libration() -> None:
    """Shackleton, 89.9 S: seen for about half of each month, when the libration in latitude is south."""
    site = SiteParams(latitude_deg=-89.9, longitude_deg=0.0)
    window = windows({"windows": [{"kind": "earth"}]}, "moon", site, time="2028-03-01T00:00:00Z")
    hours = [window.at(h * 3600 * NANOSECONDS, 0.0, 0.0)[0] for h in range(0, 655, 5)]
    assert 0.4 < np.mean(hours) < 0.6
    start = instant(datetime(2028, 3, 1, tzinfo=UTC).timestamp())
    south = [math.degrees(earth_from("moon", start.after(3600.0 * h)).latitude) < 0.17 for h in range(0, 655, 5)]
    # the altitude of the Earth's centre is -(latitude) - parallax 0.26 deg + 0.1 deg, near enough
    assert np.mean(np.array(hours) == np.array([s for s in south])) > 0.9


def test_a_rover_on_mars_sees_the_earth_as_the_sun_of_the_same_place_would_be() -> None:
    """Half of a sol on the equator, and as a rotation by the sidereal day has it."""
    site = SiteParams(latitude_deg=0.0, longitude_deg=30.0)
    window = windows({"windows": [{"kind": "earth"}]}, "mars", site, time="2028-03-01T00:00:00Z")
    every = 60
    opens = [window.at(k * every * NANOSECONDS, 0.0, 0.0)[0] for k in range(2 * 88643 // every)]
    rises = [k * every for k in range(1, len(opens)) if opens[k] and not opens[k - 1]]
    assert np.mean(opens) == pytest.approx(0.5, abs=0.01)
    assert rises[1] - rises[0] == pytest.approx(88642.663, abs=300.0)  # it moves by less than 1.2 deg a sol


def test_a_far_horizon_hides_the_earth() -> None:
    site = SiteParams(latitude_deg=0.0, longitude_deg=0.0)
    sun = {"time": "2028-03-01T00:00:00Z"}
    free = windows({"windows": [{"kind": "earth"}]}, "moon", site, **sun)
    steep = windows({"windows": [{"kind": "earth", "least_elevation_deg": 89.0}]}, "moon", site, **sun)
    assert free.at(0, 0.0, 0.0)[0] and not steep.at(0, 0.0, 0.0)[0]


def test_passes_of_an_orbiter_last_as_geometry_has_it() -> None:
    """Overhead from horizon to horizon: 2 acos(R/a) of the orbit, seen from a body that does not turn."""
    still = body("mars").model_copy(update={"rotation": None, "shape": None, "attraction": None})
    choice = OrbiterParams(altitude_km=300.0, inclination_deg=90.0, node_longitude_deg=0.0, least_elevation_deg=0.0)
    sky = LinkParams(light_time_s=1.0).sky(still, SiteParams(latitude_deg=0.0, longitude_deg=0.0), SunParams())
    window = choice.build(sky)
    orbit = CircularOrbit(still.gravitational_parameter, still.radius, still.radius + 300e3)
    opens = [window.at(t * NANOSECONDS, 0.0, 0.0)[0] for t in range(int(orbit.period))]
    expected = math.acos(still.radius / orbit.radius) / math.pi * orbit.period
    assert sum(opens) == pytest.approx(expected, abs=2.0)


@given(st.floats(0.0, 1e6), st.floats(0.0, math.pi), st.floats(-3.0, 3.0), st.floats(-3.0, 3.0))
def test_an_orbit_is_a_circle_in_its_plane(time: float, inclination: float, node: float, angle: float) -> None:
    orbit = CircularOrbit(4.282837e13, 3.3895e6, 3.7895e6)
    path = OrbiterPath(orbit, inclination, (node, 0.0), angle)
    place, step = path.place(time), 0.5
    assert np.linalg.norm(place) == pytest.approx(orbit.radius, rel=1e-9)
    pole = np.array(
        (math.sin(node) * math.sin(inclination), -math.cos(node) * math.sin(inclination), math.cos(inclination))
    )
    assert place @ pole == pytest.approx(0.0, abs=1e-6 * orbit.radius)
    velocity = (path.place(time + step) - path.place(time - step)) / (2.0 * step)
    assert np.linalg.norm(velocity) == pytest.approx(orbit.speed, rel=1e-6)
    assert np.cross(place, velocity) @ pole > 0.0


@given(st.integers(0, 10**12), st.integers(0, 10**10), st.integers(10**6, 10**10), st.integers(0, 10**10))
def test_a_row_of_windows_is_open_from_each_opening_to_its_closing(
    time: int, begin: int, length: int, gap: int
) -> None:
    table = {"kind": "times", "from_s": begin / 1e9, "to_s": (begin + length) / 1e9, "every_s": (length + gap) / 1e9}
    window = windows({"windows": [table]})
    is_open, until = window.at(time, 0.0, 0.0)
    assert is_open == (time >= begin and (time - begin) % (length + gap) < length)
    assert until > time
    assert window.at(until - 1, 0.0, 0.0)[0] == is_open
    assert gap == 0 or window.at(until, 0.0, 0.0)[0] != is_open


@pytest.mark.parametrize(
    ("link", "words"),
    [
        ({"light_time_s": -1.0}, "light_time_s"),
        ({"up": {"bit_s": 0.0}}, "up.bit_s"),
        ({"down": {"loss": 1.5}}, "down.loss"),
        ({"windows": [{"kind": "times", "from_s": 5.0, "to_s": 5.0}]}, "later than from_s"),
        ({"windows": [{"kind": "times", "from_s": 0.0, "to_s": 5.0, "every_s": 4.0}]}, "the length of a window"),
        ({"windows": [{"kind": "orbitr"}]}, "did you mean orbiter"),
        ({"telemetry": [{"topic": "/odom"}, {"topic": "/odom"}]}, "each topic once"),
    ],
)
def test_what_no_link_can_be(link: dict[str, object], words: str) -> None:
    with pytest.raises(ValidationError, match=words):
        LinkParams.model_validate(link)


@pytest.mark.parametrize(
    ("link", "name", "words"),
    [
        ({"light_time_s": None}, "light_time_s", "a site with a date"),
        ({"windows": [{"kind": "earth"}]}, "windows.0.kind", "a site and a date"),
        (
            {"windows": [{"kind": "orbiter", "altitude_km": 300, "inclination_deg": 90, "node_longitude_deg": 0}]},
            "windows.0.kind",
            "with a site",
        ),
    ],
)
def test_what_does_not_fit_a_site(link: dict[str, object], name: str, words: str) -> None:
    with pytest.raises(InvalidValueError, match=words) as refused:
        windows(link)
    assert refused.value.name == name


def test_the_site_of_a_link_by_date_is_on_another_body_than_the_earth() -> None:
    site = SiteParams(latitude_deg=0.0)
    with pytest.raises(InvalidValueError, match="not the Earth"):
        windows({"light_time_s": None}, "earth", site, time="2028-03-01T00:00:00Z")


def test_the_light_time_is_that_from_the_site() -> None:
    """On the near side of the Moon, less than from its centre by its radius."""
    site, sun = SiteParams(latitude_deg=0.0), SunParams.model_validate({"time": "2028-03-18T00:00:00Z"})
    sky = LinkParams().sky(body("moon"), site, sun)
    assert sky.earth is not None
    centre = light_time("moon", 2028, 3, 18)
    seen = earth_from("moon", instant(datetime(2028, 3, 18, tzinfo=UTC).timestamp()))
    nearer = 1.7374e6 * seen.direction[0] / 299792458.0
    assert sky.earth.light_time(0.0) == pytest.approx(centre - nearer, abs=1e-4)
    frame = site_frame(site, body("moon").semi_axes)
    assert frame.origin[0] == pytest.approx(1.7374e6)
