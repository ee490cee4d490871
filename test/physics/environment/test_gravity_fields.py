"""Gravity over a site: against closed forms of geodesy, finite differences, and kinds of attraction by each other."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sojourn_config.load import load_params
from sojourn_config.paths import available
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray
from sojourn_physics.environment.body import BodyParams
from sojourn_physics.environment.gravity.attraction import Attraction
from sojourn_physics.environment.gravity.ellipsoid import EllipsoidAttraction
from sojourn_physics.environment.gravity.field import BodyField, GravityField, UniformField
from sojourn_physics.environment.gravity.oblate import OblateAttraction
from sojourn_physics.environment.site import SiteParams, site_frame

ORIGIN = np.zeros(3)
LATITUDES = st.floats(-90.0, 90.0)
LONGITUDES = st.floats(-180.0, 180.0)
ATTRACTIONS: dict[str, tuple[Attraction, float]] = {  # with the length of the body
    "sphere": (OblateAttraction(4.9e12, 1.7e6), 1.7e6),
    "oblate": (OblateAttraction(3.986e14, 6.378e6, 1.0826e-3, -2.4e-6), 6.4e6),
    "very oblate": (OblateAttraction(6.3e10, 4.7e5, 0.03, -0.005), 4.8e5),
    "ellipsoid": (EllipsoidAttraction(2.36, (267.5, 147.0, 104.5)), 267.5),
    "cigar": (EllipsoidAttraction(4.5e5, (17200.0, 5600.0, 5600.0)), 17200.0),
}


def body(name: str) -> BodyParams:
    return load_params("bodies", name, BodyParams)


def site(latitude: float, longitude: float = 0.0, altitude: float = 0.0) -> SiteParams:
    return SiteParams(latitude_deg=latitude, longitude_deg=longitude, altitude_m=altitude)


def slope(attraction: Attraction | GravityField, place: FloatArray, step: float) -> FloatArray:
    """Fall of the potential by central differences of fourth order."""
    shifts = step * np.eye(3)
    near = [attraction.potential(place + s) - attraction.potential(place - s) for s in shifts]
    far = [attraction.potential(place + 2.0 * s) - attraction.potential(place - 2.0 * s) for s in shifts]
    return -(8.0 * np.array(near) - np.array(far)) / (12.0 * step)


def directions(latitude: float, longitude: float) -> FloatArray:
    f, l = math.radians(latitude), math.radians(longitude)  # noqa: E741
    return np.array((math.cos(f) * math.cos(l), math.cos(f) * math.sin(l), math.sin(f)))


@pytest.mark.parametrize("latitude", [-90.0, -60.0, -30.0, 0.0, 15.0, 45.0, 75.0, 90.0])
def test_earth_has_the_normal_gravity_of_somigliana(latitude: float) -> None:
    """WGS 84, closed form of Somigliana (NGA.STND.0036, eq. 4-1)."""
    square = math.sin(math.radians(latitude)) ** 2
    normal = 9.7803253359 * (1.0 + 0.00193185265241 * square) / math.sqrt(1.0 - 0.00669437999014 * square)
    field = body("earth").gravity_over(site(latitude))
    assert field.gravity == pytest.approx(normal, rel=1e-6)
    east, north, up = field.acceleration(ORIGIN)
    assert abs(east) < 1e-12 and abs(north) < 2e-5 and up < 0.0  # the level ellipsoid is level


@pytest.mark.published
def test_earth_s_gravity_falls_with_height_as_geodesy_has_it() -> None:
    """Free-air gradient at 45 degrees, 3.086e-6 per second squared (Heiskanen & Moritz 1967, eq. 2-122)."""
    low, high = (body("earth").gravity_over(site(45.0, 0.0, h)).gravity for h in (0.0, 1000.0))
    assert (low - high) / 1000.0 == pytest.approx(3.086e-6, rel=2e-3)


@pytest.mark.parametrize(("name", "mean"), [("moon", 1.6242), ("mars", 3.728), ("venus", 8.87), ("mercury", 3.70)])
def test_the_mean_over_a_body_is_gm_over_r_squared(name: str, mean: float) -> None:
    """Mean over the sphere, latitude by latitude with weight cos; less two thirds of what the turning takes."""
    sines = (np.arange(60) + 0.5) / 60.0
    found = body(name)
    values = [found.gravity_over(site(math.degrees(math.asin(s)))).gravity for s in sines]
    turning = 0.0 if found.rotation is None else 2.0 / 3.0 * found.rotation.rate**2 * found.radius
    assert float(np.mean(values)) + turning == pytest.approx(mean, rel=1e-3)


def test_mars_is_heavier_at_its_poles() -> None:
    """3.711 at the equator and 3.758 at the pole (JPL Horizons, physical data of Mars), both within 0.7 per cent."""
    equator, pole = (body("mars").gravity_over(site(latitude)).gravity for latitude in (0.0, 90.0))
    assert equator == pytest.approx(3.71, rel=2e-3)
    assert pole == pytest.approx(3.758, rel=7e-3)


@pytest.mark.parametrize("kind", ATTRACTIONS)
@given(latitude=LATITUDES, longitude=LONGITUDES, ratio=st.floats(1.05, 20.0))
def test_attraction_is_the_fall_of_its_potential(kind: str, latitude: float, longitude: float, ratio: float) -> None:
    attraction, length = ATTRACTIONS[kind]
    place = ratio * length * directions(latitude, longitude)
    found = attraction.acceleration(place)
    scale = float(np.linalg.norm(found))
    assert np.abs(slope(attraction, place, 1e-3 * length * ratio) - found).max() < 1e-7 * scale


@pytest.mark.parametrize("kind", ATTRACTIONS)
@given(latitude=LATITUDES, longitude=LONGITUDES)
def test_from_afar_every_body_is_a_point(kind: str, latitude: float, longitude: float) -> None:
    attraction, length = ATTRACTIONS[kind]
    place = 3e3 * length * directions(latitude, longitude)
    strength = attraction.gravitational_parameter / float(place @ place)  # type: ignore[attr-defined]
    np.testing.assert_allclose(
        attraction.acceleration(place), -strength * directions(latitude, longitude), atol=1e-6 * strength
    )
    assert attraction.potential(place) == pytest.approx(-strength * float(np.linalg.norm(place)), rel=1e-6)


@given(latitude=LATITUDES, longitude=LONGITUDES, ratio=st.floats(0.0, 5.0))
def test_an_ellipsoid_with_equal_axes_is_a_ball(latitude: float, longitude: float, ratio: float) -> None:
    ball = EllipsoidAttraction(7.0, (3.0, 3.0, 3.0))
    place = 3.0 * ratio * directions(latitude, longitude)
    inside = ratio <= 1.0
    expected = -7.0 / 27.0 * place if inside else -7.0 / float(np.linalg.norm(place)) ** 3 * place
    np.testing.assert_allclose(ball.acceleration(place), expected, rtol=1e-9, atol=1e-12)
    depth = 7.0 * (3.0 - ratio**2) / 6.0 if inside else 7.0 / (3.0 * ratio)
    assert ball.potential(place) == pytest.approx(-depth, rel=1e-9)


@given(
    axes=st.tuples(st.floats(1.0, 5.0), st.floats(1.0, 5.0), st.floats(1.0, 5.0)),
    latitude=LATITUDES,
    longitude=LONGITUDES,
    ratio=st.floats(0.0, 0.9),
)
def test_inside_an_ellipsoid_poisson_s_equation_holds(
    axes: tuple[float, float, float], latitude: float, longitude: float, ratio: float
) -> None:
    """Three GM over abc, 4 pi G times the density; the attraction grows in proportion to the distance on each axis."""
    a, b, c = sorted(axes, reverse=True)
    attraction = EllipsoidAttraction(1.0, (a, b, c))
    rates = -attraction.acceleration(np.ones(3) * 0.1) / 0.1
    assert float(rates.sum()) == pytest.approx(3.0 / (a * b * c), rel=1e-9)
    place = ratio * np.array((a, b, c)) * directions(latitude, longitude)
    np.testing.assert_allclose(attraction.acceleration(place), -rates * place, rtol=1e-9, atol=1e-15)


def test_a_spheroid_s_attraction_is_the_published_closed_form() -> None:
    """Oblate spheroid, inside: A3 = 2/e2 (1 - sqrt(1 - e2) asin(e)/e) (Chandrasekhar 1969, sec. 17, eq. 36)."""
    a, c = 2.0, 1.0
    e2 = 1.0 - (c / a) ** 2
    e = math.sqrt(e2)
    polar = 2.0 / e2 * (1.0 - math.sqrt(1.0 - e2) * math.asin(e) / e)
    attraction = EllipsoidAttraction(4.0 / 3.0 * math.pi * a * a * c, (a, a, c))  # density and G of 1
    assert -attraction.acceleration(np.array((0.0, 0.0, 0.3)))[2] == pytest.approx(
        2.0 * math.pi * polar * 0.3, rel=1e-12
    )


@given(latitude=LATITUDES, longitude=LONGITUDES)
def test_a_spheroid_is_oblate_with_its_own_harmonics(latitude: float, longitude: float) -> None:
    """J2 = 3 e2/15, J4 = -3 e4/35 of an even spheroid (Heiskanen & Moritz 1967, sec. 2-9, with m = 0, even density)."""
    a, c = 1.0, 0.98
    e2 = 1.0 - c * c
    harmonics = OblateAttraction(1.0, a, e2 / 5.0, -3.0 * e2**2 / 35.0)
    place = 1.1 * directions(latitude, longitude)
    np.testing.assert_allclose(
        EllipsoidAttraction(1.0, (a, a, c)).acceleration(place), harmonics.acceleration(place), atol=2e-5
    )


@given(latitude=LATITUDES, longitude=LONGITUDES, altitude=st.floats(0.0, 1e5))
def test_a_site_stands_on_the_ellipsoid_along_its_normal(latitude: float, longitude: float, altitude: float) -> None:
    axes = (5.0e5, 4.0e5, 3.0e5)
    ground, raised = (site_frame(site(latitude, longitude, h), axes) for h in (0.0, altitude))
    assert float((ground.origin**2 / np.square(axes)).sum()) == pytest.approx(1.0, rel=1e-12)
    normal = ground.origin / np.square(axes)
    np.testing.assert_allclose(ground.rotation[:, 2], normal / np.linalg.norm(normal), atol=1e-12)
    np.testing.assert_allclose(raised.origin - ground.origin, altitude * ground.rotation[:, 2], atol=1e-6)
    np.testing.assert_allclose(ground.rotation.T @ ground.rotation, np.eye(3), atol=1e-12)
    assert float(np.linalg.det(ground.rotation)) == pytest.approx(1.0)
    assert float(ground.rotation[2, 0]) == 0.0  # east is level with the equator
    assert float(ground.rotation[2, 1]) >= 0.0  # north goes towards the pole


@pytest.mark.parametrize("name", ["itokawa", "phobos"])
@given(latitude=LATITUDES, longitude=LONGITUDES, altitude=st.floats(0.0, 1e3))
def test_weight_over_a_site_is_the_fall_of_its_potential(
    name: str, latitude: float, longitude: float, altitude: float
) -> None:
    field = body(name).gravity_over(site(latitude, longitude, altitude))
    place = np.array((0.3, -0.2, 0.5))
    found = field.acceleration(place)
    np.testing.assert_allclose(slope(field, place, 0.05), found, atol=1e-6 * float(np.linalg.norm(found)) + 1e-12)


@pytest.mark.parametrize(("latitude", "longitude"), [(0.0, 0.0), (0.0, 180.0), (0.0, 90.0), (90.0, 0.0)])
def test_phobos_weighs_less_under_mars(latitude: float, longitude: float) -> None:
    """Beside its own turn, what Mars (GM 4.282837e13 m3/s2) draws more or less there than at its middle, 9376 km away,
    worked out from the distances themselves: a third of the weight under Mars.
    """
    phobos, turn = body("phobos"), 2.0 * math.pi / (7.65385 * 3600.0)
    place = site_frame(site(latitude, longitude), phobos.semi_axes).origin
    alone = EllipsoidAttraction(phobos.gravitational_parameter, phobos.semi_axes).acceleration(place)
    mars = np.array((9.376e6, 0.0, 0.0))
    way = mars - place
    drawn = 4.282837e13 * (way / float(np.linalg.norm(way)) ** 3 - mars / 9.376e6**3)
    weight = alone + turn**2 * place * (1.0, 1.0, 0.0) + drawn
    found = phobos.field_over(site(latitude, longitude)).gravity
    assert found == pytest.approx(float(np.linalg.norm(weight)), rel=5e-3)


def test_the_moons_that_are_locked_are_those_of_planets() -> None:
    locked = {name for name in available("bodies") if (turn := body(name).rotation) is not None and turn.locked}
    assert len(locked) == 17 and "moon" not in locked and locked >= {"phobos", "io", "titan", "triton", "miranda"}


def test_a_site_below_all_ground_is_refused() -> None:
    with pytest.raises(InvalidValueError, match="altitude_m = -60"):
        body("itokawa").gravity_over(site(10.0, 0.0, -60.0))


def test_without_a_site_gravity_is_today_s_mean_to_the_last_bit() -> None:
    moon = body("moon")
    field = moon.gravity_over(None)
    assert isinstance(field, UniformField)
    assert field.gravity == moon.surface_gravity == moon.gravitational_parameter / moon.radius**2
    assert field.acceleration(np.array((3.0, 2.0, 1.0))).tolist() == [0.0, 0.0, -moon.surface_gravity]


def test_on_itokawa_a_walk_leaves_it() -> None:
    """Some 0.1 to 0.2 m/s (Fujiwara et al. 2006, Science 312:1330)."""
    field = body("itokawa").gravity_over(site(0.0))
    assert isinstance(field, BodyField)
    assert 0.1 < field.escape_speed(ORIGIN) < 0.2
    assert isinstance(body("moon").gravity_over(site(0.0)), BodyField)


@pytest.mark.parametrize("name", available("bodies"))
def test_shape_and_radius_of_a_file_agree(name: str) -> None:
    found = body(name)
    a, b, c = found.semi_axes
    loose = {"phobos": 0.01, "eros": 0.05, "itokawa": 0.02}.get(name, 2e-3)
    assert (a * b * c) ** (1.0 / 3.0) == pytest.approx(found.radius, rel=loose)


@pytest.mark.parametrize("name", [name for name in available("bodies") if not body(name).free_fall])
def test_the_two_days_of_a_file_agree(name: str) -> None:
    """1/solar = 1/sidereal - 1/year, the year by Kepler's third law of the distance in the file. Itokawa's pole, about
    which it turns eastward, points to the south of its orbit: there the signs agree.
    """
    found = body(name)
    assert found.rotation is not None
    year = 365.25636 * 24.0 * found.semi_major_axis_au**1.5 * (-1.0 if name == "itokawa" else 1.0)
    solar = 1.0 / (1.0 / found.rotation.sidereal_hours - 1.0 / year)
    assert abs(solar) == pytest.approx(found.solar_day_hours, rel=1e-3)


def test_gravity_is_felt_whole_at_any_latitude_of_any_body() -> None:
    for name in available("bodies"):
        found = body(name)
        for latitude in (-90.0, -30.0, 0.0, 60.0):
            if found.free_fall:
                with pytest.raises(InvalidValueError, match="free fall"):
                    found.gravity_over(site(latitude))
            else:
                field: GravityField = found.gravity_over(site(latitude, 77.0))
                assert 0.35 < field.gravity / found.surface_gravity < 1.5


@pytest.mark.parametrize(
    ("table", "word"),
    [
        ({"shape": {"semi_axes": [1.0, 2.0, 1.0]}}, "longest first"),
        ({"shape": {"semi_axes": [1.0, 1.0, 0.0]}}, "above 0"),
        ({"rotation": {"sidereal_hours": 0.0}}, "does not turn"),
        ({"attraction": {"kind": "elipsoid"}}, "did you mean ellipsoid"),
        ({"attraction": {"kind": "oblate", "j2": 3.0}}, "j2"),
        ({"attraction": {"j2": 0.01}}, "kind"),
    ],
)
def test_bad_tables_are_refused_in_words(table: dict[str, Any], word: str) -> None:
    known = body("moon").model_dump(exclude_none=True)
    with pytest.raises(ValueError, match=word):
        BodyParams.model_validate({**known, **table})
