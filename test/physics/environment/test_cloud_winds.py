"""Winds of the giant planets by latitude, against figures that are not those in their tables."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from sojourn_config.load import load_params
from sojourn_machine.errors import InvalidValueError
from sojourn_physics.environment.air.cloud_winds import CloudWinds
from sojourn_physics.environment.air.tabulated import TabulatedParams
from sojourn_physics.environment.body import BodyParams
from sojourn_physics.environment.site import SiteParams, site_frame

SATURN, URANUS, NEPTUNE = (load_params("bodies", name, BodyParams) for name in ("saturn", "uranus", "neptune"))


def wind(body: BodyParams, latitude: float, altitude: float = 0.0) -> float | None:
    return body.air_at(SiteParams(latitude_deg=latitude, altitude_m=altitude)).zonal_wind


def before_its_rotation(body: BodyParams, latitude: float) -> float:
    """Wind in the sense in which the body turns [m/s]."""
    found, rotation = wind(body, latitude), body.rotation
    assert found is not None and rotation is not None
    return math.copysign(1.0, rotation.rate) * found


def test_the_jet_of_saturn_is_between_those_of_its_slow_and_its_fast_years() -> None:
    """990 and 1700 km/h (Sanchez-Lavega et al. 2003); it runs before the planet, alike on both sides."""
    assert 990.0 / 3.6 < before_its_rotation(SATURN, 0.0) < 1700.0 / 3.6
    assert wind(SATURN, -20.0) == wind(SATURN, 20.0) == pytest.approx(400.0 * 15.0 / 35.0)
    assert wind(SATURN, 36.0) is None and wind(SATURN, -36.0) is None


def test_neptune_has_the_extremes_of_voyager() -> None:
    """400 m/s against its rotation at the equator, 250 m/s with it at 70 degrees south, as reviews round them."""
    assert before_its_rotation(NEPTUNE, 0.0) == pytest.approx(-400.0, abs=10.0)
    assert before_its_rotation(NEPTUNE, -70.0) == pytest.approx(250.0, abs=20.0)
    assert wind(NEPTUNE, -75.0) is None


@given(st.floats(-70.0, 70.0))
def test_the_rows_of_neptune_follow_the_fit(latitude: float) -> None:
    """A line between two rows of a curve bent by 0.38 m/s a square degree strays by 4.7 m/s."""
    assert wind(NEPTUNE, latitude) == pytest.approx(-398.0 + 0.188 * latitude**2 - 1.2e-5 * latitude**4, abs=4.8)


@pytest.mark.published
def test_uranus_is_fastest_where_keck_saw_it_and_turns_back_at_the_equator() -> None:
    """Jet near 58 to 60 degrees north, with 218 m/s as the fastest cloud of 2003 (Hammel et al. 2005)."""
    found = {latitude: before_its_rotation(URANUS, float(latitude)) for latitude in range(-42, 84)}
    fastest = max(found, key=lambda latitude: found[latitude])
    assert 55 <= fastest <= 63 and found[58] == pytest.approx(218.0, rel=0.05)
    assert found[0] == min(found.values()) == pytest.approx(-50.0, abs=1.0)
    assert [found[latitude] < 0.0 for latitude in (-10, 10, 25, -25)] == [True, True, False, False]
    assert wind(URANUS, -50.0) is None and wind(URANUS, 85.0) is None


@given(st.floats(62.0, 83.0))
def test_the_north_of_uranus_turns_like_a_solid_body(latitude: float) -> None:
    """4.08 degrees/h before the planet, with the distance from the axis by the body's ellipsoid."""
    origin = site_frame(SiteParams(latitude_deg=latitude), URANUS.semi_axes).origin
    speed = math.radians(4.08) / 3600.0 * math.hypot(origin[0], origin[1])
    assert before_its_rotation(URANUS, latitude) == pytest.approx(speed, abs=2.5)


@pytest.mark.parametrize(
    ("body", "known", "unknown"),
    [(SATURN, [0.0, 30e3], [-1.0, 31e3]), (URANUS, [-30e3, 0.0], [1.0]), (NEPTUNE, [0.0, 44e3], [-1.0])],
)
def test_beyond_the_clouds_no_wind_is_told(body: BodyParams, known: list[float], unknown: list[float]) -> None:
    assert all(wind(body, 10.0, altitude) == wind(body, 10.0) is not None for altitude in known)
    assert [wind(body, 10.0, altitude) for altitude in unknown] == [None] * len(unknown)


def test_without_a_latitude_there_is_air_and_no_wind() -> None:
    for body in (SATURN, URANUS, NEPTUNE):
        found = body.air_at(None)
        assert found.zonal_wind is None and found[:4] == body.air_at(SiteParams(latitude_deg=5.0))[:4]
        assert body.atmosphere is not None
        for none in (math.nan, 91.0):
            with pytest.raises(InvalidValueError, match="latitude"):
                body.atmosphere.over(none, 0.0)


def test_bodies_without_such_winds_are_written_as_before() -> None:
    """Bags and resolved files of them have no further key, and their wind goes by altitude as it did."""
    titan = load_params("bodies", "titan", BodyParams)
    assert "cloud_winds" not in titan.model_dump()["atmosphere"]
    assert wind(titan, 60.0, 5e3) == 1.0
    again = BodyParams.model_validate(URANUS.model_dump())
    assert again == URANUS and wind(again, 62.0) == -242.0


ROWS = [{"latitude_deg": 0.0, "zonal_wind": 1.0}, {"latitude_deg": 9.0, "zonal_wind": 0.0}]
GOOD = {"lowest": 0.0, "highest": 1.0, "rows": ROWS}


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"highest": 0.0}, "above lowest"),
        ({"rows": ROWS[::-1]}, "they go north"),
        ({"both_sides": True, "rows": [{"latitude_deg": 1.0, "zonal_wind": 1.0}, ROWS[1]]}, "equator"),
        ({"rows": [{"latitude_deg": 91.0, "zonal_wind": 1.0}]}, "90"),
    ],
)  # fmt: skip
def test_winds_that_make_no_table_are_refused(changes: dict[str, object], words: str) -> None:
    with pytest.raises(ValidationError, match=words):
        CloudWinds.model_validate(GOOD | changes)


def test_two_tables_of_winds_are_one_too_many() -> None:
    low = {"altitude": 0.0, "temperature": 90.0, "pressure": 1e5, "zonal_wind": 3.0}
    rows = [low, {"altitude": 1.0, "temperature": 90.0, "pressure": 1.0}]
    with pytest.raises(ValidationError, match="none beside rows"):
        TabulatedParams.model_validate({"gas_constant": 190.0, "heat_ratio": 1.3, "rows": rows, "cloud_winds": GOOD})
