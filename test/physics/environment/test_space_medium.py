"""Space between planets and stars: against figures of books, other ways to them, and the sheet as a user types it."""

import json
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sojourn_config.command_errors import UsageError
from sojourn_machine.errors import InvalidValueError
from sojourn_physics.environment.orbit.circular import CircularOrbit
from sojourn_physics.environment.orbit.thin_air import KAPTON_YIELD, atomic_oxygen, density
from sojourn_physics.environment.space_medium import medium_at, spiral_at
from sojourn_studies import site_sheet


def test_at_the_distance_of_the_earth() -> None:
    """1361 W/m2, 9.1 uPa on a mirror, 278 K, a wind of some 2 nPa, a spiral of 45 degrees."""
    here = medium_at(1.0)
    assert here.light == pytest.approx(1361.0) and here.light_pressure == pytest.approx(9.08e-6, rel=2e-3)
    assert here.grey_temperature == pytest.approx(278.3, abs=0.2)
    assert here.wind_pressure == pytest.approx(1.87e-9, rel=0.02)
    assert math.degrees(here.spiral) == pytest.approx(47.0, abs=2.0)
    assert here.magnetic_field == pytest.approx(5e-9)


@pytest.mark.published
def test_at_jupiter_the_field_lies_across_and_has_thinned_as_was_found() -> None:
    """About 1 nT and 80 degrees (Kivelson and Russell, table 4.2)."""
    there = medium_at(5.2)
    assert math.degrees(there.spiral) == pytest.approx(80.0, abs=2.0)
    assert there.magnetic_field == pytest.approx(0.7e-9, rel=0.3)


@given(st.floats(0.1, 120.0), st.floats(1.01, 1.2))
def test_everything_thins_outwards(distance: float, farther: float) -> None:
    """Light and wind as the square; the field between the square and the first power."""
    near, far = medium_at(distance), medium_at(min(distance * farther, 121.0))
    ratio = min(distance * farther, 121.0) / distance
    assert near.light / far.light == pytest.approx(ratio**2, rel=1e-9)
    assert near.particles / far.particles == pytest.approx(ratio**2, rel=1e-9)
    assert ratio * (1 - 1e-9) <= near.magnetic_field / far.magnetic_field <= ratio**2 * (1 + 1e-9)
    assert spiral_at(distance) <= far.spiral < 0.5 * math.pi


def test_beyond_the_heliopause_it_is_another_medium() -> None:
    inside, outside = medium_at(121.0), medium_at(200.0)
    assert outside.particles > 100.0 * inside.particles and outside.speed < inside.speed
    assert outside.light == pytest.approx(1361.0 / 4e4)


@given(st.floats(0.1, 1e9))
def test_nothing_is_colder_than_what_shines_from_everywhere(distance: float) -> None:
    """Of sunlight alone a ball between the stars came to 0.9 K."""
    medium = medium_at(distance)
    assert medium.grey_temperature >= 2.7254
    radiated = 4.0 * 5.670374419e-8 * (medium.grey_temperature**4 - 2.72548**4)
    assert radiated == pytest.approx(medium.light, rel=1e-6, abs=1e-15)


def test_atomic_oxygen_of_the_station_eats_kapton() -> None:
    """Fluxes of some 1e14 atoms/(cm2 s) at 400 km, so some tens of micrometres of Kapton a year."""
    orbit = CircularOrbit(3.986004e14, 6.378137e6, 6.378137e6 + 400e3)
    atoms = atomic_oxygen(orbit, density(400e3))
    assert 0.3e18 < atoms < 3e18
    assert 30e-6 < atoms * KAPTON_YIELD * 3.156e7 < 200e-6


def test_the_sheet(capsys: pytest.CaptureFixture[str]) -> None:
    assert site_sheet.main(["space", "--distance", "1.5", "--days", "180", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)["space"]
    assert found["sunlight"] == pytest.approx(1361.0 / 2.25)
    assert found["in 180 days"] == pytest.approx(331.2)
    assert site_sheet.main(["space", "--distance", "300"]) == 0
    assert "between the stars" in capsys.readouterr().out
    assert site_sheet.main(["earth", "--orbit", "--altitude", "400000", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["orbit"]["polyimide that it takes away"] == pytest.approx(92.0, rel=0.1)


@pytest.mark.parametrize("given", [["--distance", "0"], ["--lat", "3"], ["--orbit"], ["--distance", "nan"]])
def test_what_space_has_not_is_refused(given: list[str]) -> None:
    with pytest.raises((UsageError, SystemExit)):
        site_sheet.main(["space", *given])
    with pytest.raises(InvalidValueError):
        medium_at(0.0)
