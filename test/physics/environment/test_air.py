"""Air over bodies against published tables; wind and its force against their laws."""

import itertools
import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import simpson

from sojourn_config.load import load_params
from sojourn_config.paths import available
from sojourn_machine.errors import InvalidValueError
from sojourn_physics.environment.air.atmosphere import AtmosphereParams
from sojourn_physics.environment.air.tabulated import TabulatedParams
from sojourn_physics.environment.air.wind import MovingAir, WindParams
from sojourn_physics.environment.body import BodyParams
from sojourn_physics.environment.site import SiteParams

AIRY = [name for name in available("bodies") if load_params("bodies", name, BodyParams).atmosphere is not None]


def air(name: str) -> AtmosphereParams:
    found = load_params("bodies", name, BodyParams).atmosphere
    assert found is not None
    return found


@pytest.mark.published("NASA Glenn, Mars atmosphere model")
@pytest.mark.parametrize(
    ("height", "pressure", "density"), [(0.0, 699.0, 0.01503), (5e3, 445.7, 0.009785), (10e3, 284.2, 0.006503)]
)
def test_mars_has_the_published_air(height: float, pressure: float, density: float) -> None:
    found = air("mars").at(height)
    assert found.pressure == pytest.approx(pressure, rel=1e-3)
    assert found.density == pytest.approx(density, rel=1e-3)


@pytest.mark.published
def test_sound_on_mars_is_as_perseverance_heard_it() -> None:
    """240 m/s at 240 K for low frequencies (Maurice et al. 2022, Nature 605:653), within the spread of temperature."""
    assert air("mars").at(0.0).speed_of_sound == pytest.approx(240.0, rel=0.03)


@pytest.mark.published("Venus International Reference Atmosphere (Seiff et al. 1985)")
def test_venus_has_the_reference_atmosphere_and_a_mild_level() -> None:
    """350 K and 1.07 bar at 50 km; densities of the same table, for which pressure and temperature alone were taken."""
    found = air("venus").at(50e3)
    assert found.temperature == pytest.approx(350.5, abs=0.1)
    assert found.pressure == pytest.approx(1.066e5, rel=1e-6)
    published = {0: 64.79, 20: 20.39, 40: 4.404, 50: 1.594, 60: 0.4694, 80: 0.01186, 100: 7.890e-5}
    for height, density in published.items():
        assert air("venus").at(1e3 * height).density == pytest.approx(density, rel=0.025)


@pytest.mark.published
@pytest.mark.parametrize(
    ("height", "temperature", "pressure", "density"),
    [
        (0.0, 288.15, 101325.0, 1.2250), (1e3, 281.651, 89876.0, 1.1117), (5e3, 255.676, 54048.0, 0.73643),
        (10e3, 223.252, 26500.0, 0.41351), (15e3, 216.650, 12111.0, 0.19476), (30e3, 226.509, 1197.0, 0.018410),
        (50e3, 270.650, 79.779, 1.0269e-3), (70e3, 219.585, 5.2209, 8.2829e-5),
    ],
)  # fmt: skip
def test_earth_has_the_standard_atmosphere(height: float, temperature: float, pressure: float, density: float) -> None:
    """U.S. Standard Atmosphere 1976, table I, by geometric altitude."""
    found = air("earth").at(height)
    assert found.temperature == pytest.approx(temperature, abs=0.01)
    assert found.pressure == pytest.approx(pressure, rel=2e-4)
    assert found.density == pytest.approx(density, rel=2e-4)


@pytest.mark.published
def test_titan_has_the_air_that_huygens_met() -> None:
    """93.65 K and 1467 hPa at the surface, 70.43 K and 115 hPa at 44 km (Fulchignoni et al. 2005). By the
    densities of a model from before Huygens it was 3 % and 7 % less."""
    surface, cold = air("titan").at(0.0), air("titan").at(44e3)
    assert surface.temperature == pytest.approx(93.65) and surface.pressure == pytest.approx(146.7e3)
    assert surface.density == pytest.approx(5.3, rel=0.01)
    assert cold.temperature == pytest.approx(70.43, abs=0.5) and cold.pressure == pytest.approx(11.5e3, rel=0.015)


@pytest.mark.published
def test_sound_at_sea_level_and_on_titan() -> None:
    """340.294 m/s (standard atmosphere); 195.6 m/s in the table that Titan's air is from."""
    assert air("earth").at(0.0).speed_of_sound == pytest.approx(340.294, rel=1e-4)
    assert air("titan").at(0.0).speed_of_sound == pytest.approx(195.6, rel=0.01)


@pytest.mark.parametrize("name", AIRY)
def test_the_ground_has_the_pressure_and_density_that_the_body_s_file_says(name: str) -> None:
    """Two sources: Mars within the year's swing, the giants' mean density to their nearest figure."""
    body, found = load_params("bodies", name, BodyParams), air(name).at(0.0)
    assert found.pressure == pytest.approx(body.surface_pressure, rel=0.12 if name == "mars" else 0.04)
    assert found.density == pytest.approx(body.surface_density, rel=0.27 if name == "mars" else 0.16)


@pytest.mark.parametrize("name", [name for name in AIRY if name != "mars"])
def test_a_column_of_air_is_carried_by_the_air_below_it(name: str) -> None:
    """dp = -rho g dh, by sums over thin layers, g by the body's own field: the table's pressures are not used by it."""
    body, atmosphere = load_params("bodies", name, BodyParams), air(name)
    low, high = atmosphere.altitudes
    low, high = max(low, -60e3), min(high, 60e3)
    edges = np.linspace(low, high, 400)
    weight = 0.0
    for bottom, top in itertools.pairwise(edges.tolist()):
        middle = 0.5 * (bottom + top)
        latitude = 7.0 if name == "jupiter" else 45.0
        gravity = body.gravity_over(SiteParams(latitude_deg=latitude, altitude_m=middle)).gravity
        weight += atmosphere.at(middle).density * gravity * (top - bottom)
    lost = atmosphere.at(low).pressure - atmosphere.at(high).pressure
    assert weight == pytest.approx(lost, rel=0.02 if name == "earth" else 0.06)


@pytest.mark.published
def test_the_probe_s_depth_in_jupiter_is_the_measured_one() -> None:
    """22 bar and 428 K, 132 km below 1 bar (Seiff et al. 1998); the file's height is that of a gas at rest."""
    assert air("jupiter").altitudes[0] == pytest.approx(-132e3, rel=0.005)


@pytest.mark.published
def test_the_wind_in_jupiter_grows_to_4_bar_and_no_further() -> None:
    """Some 100 m/s at 1 bar, 170 m/s at 4 bar and down to 21 (Atkinson et al. 1998)."""
    heights = np.linspace(-132e3, 0.0, 331)
    found = [air("jupiter").at(float(height)) for height in heights]
    wind = {4.0: 170.0, 10.0: 170.0, 21.0: 170.0, 1.0: 100.0}
    for bar, expected in wind.items():
        nearest = min(found, key=lambda level: abs(math.log(level.pressure / (1e5 * bar))))
        assert nearest.zonal_wind == pytest.approx(expected, abs=1.0)


# Heights between the rows and the layer that each row bears, so that one wrong figure shows.
@pytest.mark.parametrize(
    ("name", "latitude", "allowed"),
    [("earth", 45.0, 1e-3), ("venus", 0.0, 8e-3), ("titan", 0.0, 1e-3), ("jupiter", 6.5, 1e-3), ("saturn", 45.0, 0.02),
     ("uranus", 32.0, 0.03), ("neptune", 38.0, 0.03)],
)  # fmt: skip
def test_every_layer_of_a_table_bears_the_ones_over_it(name: str, latitude: float, allowed: float) -> None:
    """ln p falls by the integral of g/(R T), T linear between the rows, by Simpson's rule; the giants' rows have one g
    for all heights."""
    body, atmosphere = load_params("bodies", name, BodyParams), air(name)
    assert isinstance(atmosphere, TabulatedParams)
    radius = atmosphere.geopotential_radius or math.inf
    for low, high in itertools.pairwise(atmosphere.rows):
        heights = np.linspace(low.altitude, high.altitude, 41)
        heights = heights / (1.0 - heights / radius)
        gravity = [body.gravity_over(SiteParams(latitude_deg=latitude, altitude_m=float(h))).gravity for h in heights]
        warm = low.temperature + np.linspace(0.0, 1.0, 41) * (high.temperature - low.temperature)
        fall = simpson(np.array(gravity) / (atmosphere.gas_constant * warm), x=heights)
        assert low.pressure * math.exp(-fall) == pytest.approx(high.pressure, rel=allowed)


def standard_atmosphere(height: float) -> tuple[float, float, float]:
    """Temperature, pressure and speed of sound of the U.S. Standard Atmosphere 1976, by its lapse rates from sea level
    upwards [K, Pa, m/s]: no row of the file is used."""
    geopotential = 6356766.0 * height / (6356766.0 + height)
    gas, temperature, pressure = 8314.32 / 28.9644, 288.15, 101325.0
    bases = ((0.0, -6.5e-3), (11e3, 0.0), (20e3, 1e-3), (32e3, 2.8e-3), (47e3, 0.0), (51e3, -2.8e-3), (71e3, -2e-3))
    for (base, lapse), (top, _) in itertools.pairwise((*bases, (84852.0, 0.0))):
        rise = min(geopotential, top) - base
        if rise <= 0.0:
            break
        if lapse == 0.0:
            pressure *= math.exp(-9.80665 * rise / (gas * temperature))
        else:
            pressure *= (1.0 + lapse * rise / temperature) ** (-9.80665 / (gas * lapse))
            temperature += lapse * rise
    return temperature, pressure, math.sqrt(1.4 * gas * temperature)


@given(st.floats(0.0, 85e3))
def test_earth_has_the_standard_atmosphere_at_every_height(height: float) -> None:
    temperature, pressure, sound = standard_atmosphere(height)
    found = air("earth").at(height)
    assert found.temperature == pytest.approx(temperature, rel=1e-5)
    assert found.pressure == pytest.approx(pressure, rel=1e-5)
    assert found.speed_of_sound == pytest.approx(sound, rel=1e-5)


@pytest.mark.parametrize("name", AIRY)
@given(part=st.floats(0.0, 1.0), step=st.floats(1e-4, 0.3))
def test_air_thins_upwards_without_a_jump(name: str, part: float, step: float) -> None:
    atmosphere = air(name)
    low, high = atmosphere.altitudes
    here = low + part * (high - low)
    above = min(here + step * (high - low), high)
    below, over = atmosphere.at(here), atmosphere.at(above)
    assert over.pressure <= below.pressure
    close = atmosphere.at(min(here + 1e-7 * (high - low), high))
    assert close.density == pytest.approx(below.density, rel=1e-5)
    assert close.temperature == pytest.approx(below.temperature, abs=0.3)


@pytest.mark.parametrize("name", AIRY)
def test_beyond_what_is_known_it_is_refused(name: str) -> None:
    low, high = air(name).altitudes
    for altitude in (low - 1.0, high + 1.0):
        with pytest.raises(InvalidValueError, match="altitude"):
            air(name).at(altitude)


def test_rows_that_do_not_go_up_are_refused() -> None:
    row = {"altitude": 0.0, "temperature": 200.0, "pressure": 1e3}
    for other in ({**row, "altitude": -1.0, "pressure": 10.0}, {**row, "altitude": 10.0}):
        with pytest.raises(ValueError, match="rows go upwards"):
            TabulatedParams.model_validate({"gas_constant": 190.0, "heat_ratio": 1.3, "rows": [row, other]})


# --- wind ---


def test_wind_that_no_source_tells_of_is_not_called_calm() -> None:
    """Over 70 km of Venus, where the table ends and the air goes on at some 90 m/s, and Saturn without a place."""
    venus = load_params("bodies", "venus", BodyParams)
    known = [venus.air_at(SiteParams(latitude_deg=0.0, altitude_m=h)).zonal_wind for h in (50e3, 67.5e3, 70e3)]
    assert known == pytest.approx([-60.0, -92.5, -90.0])
    for height in (72e3, 75e3, 99e3):
        assert venus.air_at(SiteParams(latitude_deg=0.0, altitude_m=height)).zonal_wind is None
    assert load_params("bodies", "saturn", BodyParams).air_at(None).zonal_wind is None
    assert (
        load_params("bodies", "titan", BodyParams).air_at(SiteParams(latitude_deg=0.0, altitude_m=5e3)).zonal_wind
        == 1.0
    )


@given(speed=st.floats(0.1, 50.0), roughness=st.floats(1e-4, 0.1), height=st.floats(0.2, 100.0))
def test_the_wind_grows_by_the_same_amount_with_each_doubling(speed: float, roughness: float, height: float) -> None:
    wind = WindParams(speed=speed, towards_deg=0.0, drag_area=1.0, height=2.0, roughness=roughness)
    assert wind.speed_at(2.0) == pytest.approx(speed)
    step = speed * math.log(2.0) / math.log(2.0 / roughness)
    assert wind.speed_at(2.0 * height) - wind.speed_at(height) == pytest.approx(step, rel=1e-6)
    assert wind.speed_at(roughness) == wind.speed_at(0.0) == 0.0


@given(st.tuples(*(st.floats(-30.0, 30.0),) * 3), st.floats(-180.0, 180.0))
def test_drag_acts_along_the_wind_that_the_machine_feels_and_takes_energy_from_it(
    velocity: tuple[float, float, float], heading: float
) -> None:
    moving = np.array(velocity)
    moved = MovingAir(WindParams(speed=10.0, towards_deg=heading, drag_area=2.0), 0.02)
    force = moved.force(1.5, moving)
    felt = 10.0 * np.array((math.sin(math.radians(heading)), math.cos(math.radians(heading)), 0.0)) - moving
    np.testing.assert_allclose(force, 0.5 * 0.02 * 2.0 * np.linalg.norm(felt) * felt, rtol=1e-9, atol=1e-12)
    assert float(force @ -felt) <= 0.0


@pytest.mark.parametrize(
    ("change", "word"), [({"speed": -1.0}, "speed"), ({"roughness": 2.0}, "height"), ({"drag_area": 0.0}, "drag_area")]
)
def test_bad_winds_are_refused(change: dict[str, Any], word: str) -> None:
    with pytest.raises(ValueError, match=word):
        WindParams.model_validate({"speed": 3.0, "towards_deg": 90.0, "drag_area": 1.0, **change})
