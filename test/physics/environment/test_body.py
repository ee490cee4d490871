"""Bodies against the published gravity, sunlight and days."""

import math
from pathlib import Path
from typing import Any

import pytest
import yaml
from pydantic import ValidationError

from sojourn_physics.environment.body import BodyParams

BODIES = Path(__file__).parents[3] / "config" / "bodies"

PUBLISHED_GRAVITY = {
    "moon": 1.624, "mars": 3.728, "mercury": 3.70, "venus": 8.87, "titan": 1.354, "ceres": 0.284, "io": 1.796,
    "europa": 1.315, "ganymede": 1.428, "callisto": 1.236,
    "enceladus": 0.1133, "triton": 0.779, "pluto": 0.616, "earth": 9.82,
}  # fmt: skip
LOOSE_GRAVITY = {"phobos": 0.0058, "eros": 0.006, "itokawa": 8.7e-5}
PUBLISHED_FLUX = {
    "moon": 1361.0,
    "mars": 586.2,
    "mercury": 9083.0,
    "venus": 2601.0,
    "titan": 14.8,
    "ceres": 178.0,
}
PUBLISHED_DAY = {"moon": 708.7, "mercury": 4222.6, "ceres": 9.07, "eros": 5.27, "itokawa": 12.13}
PUBLISHED_TEMPERATURES = {
    "moon": (95, 390), "mars": (130, 308), "mercury": (90, 700), "venus": (737, 737), "titan": (94, 94),
    "ceres": (110, 235), "europa": (50, 125), "triton": (38, 38),
}  # fmt: skip


def read(name: str) -> dict[str, Any]:
    values: dict[str, Any] = yaml.safe_load((BODIES / f"{name}.yaml").read_text(encoding="utf-8"))
    return values


def load(name: str) -> BodyParams:
    return BodyParams(**read(name))


def test_every_file_loads_and_has_the_name_of_its_file() -> None:
    names = sorted(path.stem for path in BODIES.glob("*.yaml"))
    assert set(names) >= set(PUBLISHED_GRAVITY) | set(LOOSE_GRAVITY)
    for name in names:
        assert load(name).name == name


@pytest.mark.published("GM/R2 of each body (JPL Solar System Dynamics)")
@pytest.mark.parametrize(("name", "gravity"), PUBLISHED_GRAVITY.items())
def test_gravity_is_the_published_one(name: str, gravity: float) -> None:
    assert load(name).surface_gravity == pytest.approx(gravity, rel=0.005)


def test_in_orbit_nothing_has_weight_and_the_day_is_a_turn_round_the_earth() -> None:
    orbit = load("low_earth_orbit")
    assert orbit.surface_gravity == 0.0
    turn = 2.0 * math.pi * math.sqrt(orbit.radius**3 / orbit.gravitational_parameter)  # Kepler's third law
    assert orbit.solar_day == pytest.approx(turn, rel=1e-3)
    with_weight = orbit.model_copy(update={"free_fall": False})
    assert with_weight.surface_gravity == pytest.approx(8.67, rel=1e-3)  # it is not far from the Earth: it falls


@pytest.mark.parametrize(("name", "gravity"), LOOSE_GRAVITY.items())
def test_gravity_of_irregular_bodies(name: str, gravity: float) -> None:
    assert load(name).surface_gravity == pytest.approx(gravity, rel=0.1)


@pytest.mark.published("1361 W/m2 at 1 au")
@pytest.mark.parametrize(("name", "flux"), PUBLISHED_FLUX.items())
def test_sunlight_is_the_published_one(name: str, flux: float) -> None:
    assert load(name).solar_flux == pytest.approx(flux, rel=0.005)


@pytest.mark.published("NASA NSSDCA Planetary Fact Sheets")
@pytest.mark.parametrize(("name", "hours"), PUBLISHED_DAY.items())
def test_solar_day_is_the_published_one(name: str, hours: float) -> None:
    assert load(name).solar_day_hours == pytest.approx(hours, rel=1e-3)


@pytest.mark.parametrize(("name", "limits"), PUBLISHED_TEMPERATURES.items())
def test_temperatures_are_the_published_ones(name: str, limits: tuple[float, float]) -> None:
    body = load(name)
    assert (body.temperature_min, body.temperature_max) == limits


def test_mars_day_orbit_and_air() -> None:
    mars = load("mars")
    assert mars.solar_day == pytest.approx(88775.244, abs=0.01)
    assert mars.solar_flux / (1 + mars.orbital_eccentricity) ** 2 == pytest.approx(490.0, rel=0.005)
    assert mars.solar_flux / (1 - mars.orbital_eccentricity) ** 2 == pytest.approx(713.0, rel=0.005)
    assert (mars.surface_pressure, mars.surface_density) == (636.0, 0.020)
    venus, titan = load("venus"), load("titan")
    assert (venus.surface_pressure, venus.surface_density) == (9.2e6, 65.0)
    assert (titan.surface_pressure, titan.surface_density) == (146.7e3, 5.3)


@pytest.mark.parametrize(
    ("changes", "word"),
    [
        ({"radius": 0.0}, "radius"),
        ({"radius": float("nan")}, "radius"),
        ({"gravitational_parameter": -1.0}, "gravitational_parameter"),
        ({"orbital_eccentricity": 1.0}, "orbital_eccentricity"),
        ({"temperature_max": 50.0}, "temperature_min = 95"),
        ({"surface_pressure": 600.0}, "surface_density"),
        ({"estimates": ["weather"]}, "weather"),
        ({"gravity": 1.62}, "gravity"),
        ({"name": "The Moon"}, "name"),
    ],
)
def test_bad_input_is_refused_by_name(changes: dict[str, Any], word: str) -> None:
    with pytest.raises(ValidationError, match=word):
        BodyParams(**{**read("moon"), **changes})
