"""scripts/site as a user types it."""

import json
from pathlib import Path
from typing import Any

import pytest

from sojourn_config.command_errors import UsageError
from sojourn_config.errors import ConfigError
from sojourn_config.paths import available
from sojourn_studies import site_sheet


def sheet(capsys: pytest.CaptureFixture[str], *arguments: str) -> Any:
    assert site_sheet.main([*arguments, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def test_a_summer_noon_in_greenwich(capsys: pytest.CaptureFixture[str]) -> None:
    """Elevation 90 - 51.48 + 23.44 at noon of the solstice; normal gravity of the latitude; the standard atmosphere."""
    found = sheet(capsys, "earth", "--lat", "51.48", "--time", "2026-06-21T12:02:00Z")
    assert found["gravity"]["gravity"] == pytest.approx(9.81191, abs=2e-4)
    assert found["gravity"]["speed of escape"] == pytest.approx(11180.0, rel=2e-3)
    assert found["sun"]["at the date: elevation of the Sun"] == pytest.approx(61.96, abs=0.05)
    assert found["sun"]["at the date: azimuth, from north by east"] == pytest.approx(180.0, abs=0.3)
    assert found["sun"]["over a day: the Sun is up for"] == pytest.approx(16.6, abs=0.3)
    assert found["air"]["density"] == pytest.approx(1.225, rel=1e-3)
    assert 5.0 < found["sun"]["over a day: energy on the level"] < 9.5


def test_the_lunar_pole_and_a_level_of_venus(capsys: pytest.CaptureFixture[str]) -> None:
    pole = sheet(capsys, "moon", "--lat", "-90", "--time", "2028-03-01T00:00:00Z")
    assert abs(pole["sun"]["over a day: greatest elevation"]) < 1.6  # the Moon's axis is 1.5 degrees off its orbit's
    assert "none" in pole["air"]["air"]
    mild = sheet(capsys, "venus", "--altitude", "50000")
    assert mild["air"]["temperature"] == pytest.approx(350.5, abs=0.1)
    assert mild["gravity"]["gravity"] < mild["gravity"]["mean of the body, GM/R2"]


def test_the_winds_of_a_planet_go_by_the_latitude_of_the_place(capsys: pytest.CaptureFixture[str]) -> None:
    for latitude, expected in (("0", 400.0), ("50", "not known")):
        assert sheet(capsys, "saturn", "--lat", latitude)["air"]["mean wind towards the east"] == expected


@pytest.mark.parametrize(
    ("body", "altitude", "said"),
    [
        ("venus", "80000", "of this height"),
        ("mars", "40000", "of this height"),
        ("jupiter", "-130000", "of this depth"),
        ("mars", "21000", ""),
        ("moon", "30000", ""),
    ],
)
def test_of_a_place_within_the_air_it_says_what_is_not_known(
    body: str, altitude: str, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """The beam over Venus' clouds was said to be nothing, and 21 bar over Jupiter's to change nothing."""
    found = sheet(capsys, body, "--altitude", altitude, "--time", "2026-05-01T00:00:00Z")
    for group in (rows for rows in found.values() if isinstance(rows, dict)):
        lit = any("sunlight" in name or "dose" in name or "meteoroids" in name for name in group)
        assert {name for name in group if name.startswith("of this ")} == ({said} if said and lit else set())


def test_the_ground_of_a_place_over_a_day(capsys: pytest.CaptureFixture[str]) -> None:
    """The Moon's equator: 385 to 395 K and 90 to 100 K (Hayne et al. 2017), coldest at sunrise. At 60 deg
    of latitude colder at noon by the fourth root of the cosine and of the part of slant light that it takes in."""
    found = {
        latitude: sheet(capsys, "moon", "--lat", latitude, "--time", "2028-03-01T00:00:00Z")["temperature"]
        for latitude in ("0", "60")
    }
    warmest, coldest = "over a day: warmest ground here", "over a day: coldest ground here"
    assert 380.0 < found["0"][warmest] < 397.0 and 90.0 < found["0"][coldest] < 100.0
    absorbed = (1.0 - 0.12 - 0.06 * (60.0 / 45.0) ** 3 - 0.25 * (60.0 / 90.0) ** 8) / (1.0 - 0.12)
    assert found["60"][warmest] / found["0"][warmest] == pytest.approx((0.5 * absorbed) ** 0.25, rel=0.02)
    assert found["0"][coldest] <= found["0"]["at the date: ground here"] <= found["0"][warmest]
    undated = sheet(capsys, "moon")["temperature"]
    assert undated["over a day: ground here"] == "with a date"
    assert (
        "not known"
        in sheet(capsys, "europa", "--time", "2028-03-01T00:00:00Z")["temperature"]["over a day: ground here"]
    )


def test_soils_of_a_body_are_those_that_were_found_there(capsys: pytest.CaptureFixture[str]) -> None:
    soil = "soil: density, cohesion and angle of friction"
    assert sheet(capsys, "moon")[soil]["lunar_nominal"].startswith("1521 kg/m3, 170 Pa, 35 deg")
    assert set(sheet(capsys, "mars")[soil]) == {"mars", "viking_drift", "viking_blocky"}
    assert sheet(capsys, "io")[soil] == {"soil": "no figure"}
    assert "no ground" in sheet(capsys, "saturn")[soil]["soil"]


def test_what_has_no_source_has_no_empty_brackets(capsys: pytest.CaptureFixture[str]) -> None:
    for body in ("venus", "mars", "pluto"):
        assert not any("()" in str(value) for value in sheet(capsys, body)["stay"].values())


@pytest.mark.parametrize("name", [name for name in available("bodies") if name != "low_earth_orbit"])
def test_every_body_has_a_sheet(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    found = sheet(capsys, name, "--lat", "30", "--lon", "40", "--time", "2027-01-01T00:00:00Z")
    assert found["gravity"]["gravity"] > 0.0
    assert found["stay"]
    assert 0.0 <= found["sun"]["over a day: the Sun is up for"] <= found["day"]["solar day"] * (1.0 + 1e-9)


def test_it_prints_and_draws(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    picture = tmp_path / "mars.png"
    given = ["mars", "--lat", "-1.95", "--lon", "354.5", "--time", "2004-01-25T05:05:00Z", "--plot", str(picture)]
    assert site_sheet.main(given) == 0
    said = capsys.readouterr().out
    assert "mars, latitude -1.95" in said and "m/s2" in said and "Sources: JPL" in said
    assert picture.stat().st_size > 20_000


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        (["moon", "--lat", "91"], "--lat 91"),
        (["moon", "--lon", "-400"], "--lon -400"),
        (["moon", "--time", "noon"], "--time noon"),
        (["moon", "--time", "2028-03-01T00:00:00"], "--time"),
        (["mars", "--time", "9999-12-31T23:59:59Z"], "--time 9999-12-31T23:59:59Z: time = "),
        (["moon", "--altitude", "-1.5e6"], "--altitude -1500000"),
        (["moon", "--days", "0"], "--days 0"),
        (["low_earth_orbit"], "orbit"),
        (["itokawa", "--altitude", "-200"], "altitude_m"),
        (["moon", "--plot", "/no/such/folder/x.png"], "--plot"),
    ],
)
def test_bad_places_are_refused_in_one_sentence(arguments: list[str], word: str) -> None:
    with pytest.raises(UsageError, match=word):
        site_sheet.main(arguments)


def test_a_picture_that_cannot_be_written_is_told_before_the_sheet(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(UsageError, match="--plot"):
        site_sheet.main(["moon", "--plot", "/no/such/folder/x.png"])
    assert capsys.readouterr().out == ""


def test_a_turn_westwards_is_the_same_place(capsys: pytest.CaptureFixture[str]) -> None:
    west, east = (sheet(capsys, "mars", "--lat", "20", "--lon", degrees)["gravity"] for degrees in ("-350", "10"))
    assert west == pytest.approx(east, rel=1e-9)


@pytest.mark.parametrize("depth", ["-1e5", "-1.0E+5", "-100000", "-.1e6"])
def test_a_number_below_zero_may_have_an_exponent(depth: str, capsys: pytest.CaptureFixture[str]) -> None:
    found = sheet(capsys, "jupiter", "--altitude", depth)
    assert found["gravity"]["gravity"] > sheet(capsys, "jupiter")["gravity"]["gravity"]


def test_beyond_the_synchronous_orbit_nothing_stays(capsys: pytest.CaptureFixture[str]) -> None:
    """Of Mars 20428 km, 17032 km over the equator; over its pole everything falls."""
    assert sheet(capsys, "mars", "--altitude", "1.70e7")["gravity"]["gravity"] < 0.01
    far = sheet(capsys, "mars", "--altitude", "1.71e7")["gravity"]
    assert "flies off" in far["gravity"] and "time to fall 1 m" not in far
    assert sheet(capsys, "mars", "--altitude", "1e8", "--lat", "90")["gravity"]["gravity"] < 0.01


def test_of_an_orbit_in_dense_air_it_is_said(capsys: pytest.CaptureFixture[str]) -> None:
    low = sheet(capsys, "earth", "--orbit", "--altitude", "100")["orbit"]
    assert "150 km" in low["air"] and "air, mean activity of the Sun" not in low
    assert site_sheet.main(["earth", "--orbit", "--altitude", "100"]) == 0
    assert "too dense" in capsys.readouterr().out
    assert "air" not in sheet(capsys, "moon", "--orbit", "--altitude", "100")["orbit"]


@pytest.mark.parametrize(
    ("body", "altitude"),
    [("titan", "1000"), ("mars", "5000"), ("venus", "90000"), ("earth", "80000"), ("earth", "155000")],
)
def test_of_no_body_does_an_orbit_last_in_dense_air(
    body: str, altitude: str, capsys: pytest.CaptureFixture[str]
) -> None:
    low = (body, "--orbit", "--altitude", altitude)
    assert "too dense for an orbit to last" in sheet(capsys, *low)["orbit"]["air"]
    assert "too dense for an orbit to last" in sheet(capsys, *low, "--eccentricity", "0.1")["orbit"]["air"]


def test_where_air_is_not_known_it_is_said(capsys: pytest.CaptureFixture[str]) -> None:
    """Of Titan it is to 100 km; the Earth's is thin from 170 km on and nothing to speak of above 1000 km."""
    assert "only up to 100 km" in sheet(capsys, "titan", "--orbit", "--altitude", "200000")["orbit"]["air"]
    for altitude in ("170000", "408000", "36e6"):
        assert "air" not in sheet(capsys, "earth", "--orbit", "--altitude", altitude)["orbit"]


def test_hill_spheres_are_as_published(capsys: pytest.CaptureFixture[str]) -> None:
    """Of the Earth 1.5 million km, of the Moon 61 500 km, of Phobos 16.6 km from its middle."""
    for body, beside, largest, radius in (
        ("earth", "the Sun", 6378.1, 1.497e6),
        ("moon", "earth", 1737.4, 61_500.0),
        ("phobos", "mars", 13.03, 16.6),
    ):
        found = sheet(capsys, body, "--orbit", "--altitude", "3000")["orbit"]
        highest = found[f"highest orbit, by the Hill sphere beside {beside}"]
        assert highest + largest == pytest.approx(radius, rel=2e-3)


@pytest.mark.parametrize(
    ("arguments", "beside"),
    [
        (("phobos", "--altitude", "5000"), "mars"),
        (("moon", "--altitude", "1e9"), "earth"),
        (("earth", "--altitude", "1e10"), "the Sun"),
        (("itokawa", "--altitude", "1e6"), "the Sun"),
        (("earth", "--altitude", "6e5", "--eccentricity", "0.995"), "the Sun"),
    ],
)
def test_an_orbit_that_another_body_pulls_away_is_refused(arguments: tuple[str, ...], beside: str) -> None:
    with pytest.raises(UsageError, match=f"allowed is .* Hill sphere {beside} pulls it away"):
        site_sheet.main([*arguments, "--orbit"])


def test_an_unknown_body_is_answered_with_the_nearest() -> None:
    with pytest.raises(ConfigError, match=r"did you mean titania\?"):
        site_sheet.main(["titaniaa"])


def test_the_orbit_of_a_station(capsys: pytest.CaptureFixture[str]) -> None:
    found = sheet(capsys, "earth", "--orbit", "--altitude", "408000", "--inclination", "51.64")["orbit"]
    assert found["drift of the node, eastward"] == pytest.approx(-5.0, abs=0.05)
    assert found["in the body's shadow"] == pytest.approx(36.0, abs=0.5)
    beside = found["what rests 1 m above a spacecraft is along its flight a turn later"]
    assert beside == pytest.approx(-37.70, abs=0.01)  # 12 pi
    assert found["debris of 1 mm or more, of 2010"] > found["meteoroids of 1 mm or more"] > 1e-4
    moon = sheet(capsys, "moon", "--orbit", "--altitude", "1e5")["orbit"]
    assert "air, mean activity of the Sun" not in moon and not any("debris" in name for name in moon)
    assert moon["meteoroids of 1 mm or more"] > 0.0


def test_an_orbit_on_an_ellipse(capsys: pytest.CaptureFixture[str]) -> None:
    ellipse = ("--eccentricity", "0.737", "--inclination", "63.4")
    found = sheet(capsys, "earth", "--orbit", "--altitude", "600000", *ellipse)["orbit"]
    assert found["highest"] == pytest.approx(39_700.0, rel=0.01)
    assert found["period"] / 60.0 == pytest.approx(11.97, abs=0.1)
    assert abs(found["drift of the perigee"]) < 0.002


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (["earth", "--orbit"], "--altitude 0"),
        (["low_earth_orbit", "--orbit", "--altitude", "1e5"], "an orbit itself"),
        (["earth", "--orbit", "--altitude", "4e5", "--beta", "91"], "--beta 91"),
        (["earth", "--orbit", "--altitude", "4e5", "--eccentricity", "1.0"], "--eccentricity 1"),
        (["earth", "--orbit", "--altitude", "4e5", "--lat", "3"], "a place or an orbit"),
    ],
)
def test_what_is_no_orbit_is_refused(arguments: list[str], named: str) -> None:
    with pytest.raises(UsageError, match=named):
        site_sheet.main(arguments)
