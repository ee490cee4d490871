"""Dust, dose, upsets and meteoroids, against what has been published of them."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sojourn_config.load import load_params
from sojourn_config.paths import available
from sojourn_machine.errors import InvalidValueError
from sojourn_physics.environment.body import BodyParams
from sojourn_physics.environment.hazards.array_dust import SPIRIT, Cleaning, light_through_dust
from sojourn_physics.environment.hazards.meteoroids import (
    SPEED,
    chance_of_none,
    flux_at,
    focusing,
    interplanetary_flux,
    open_sky,
)
from sojourn_physics.environment.hazards.radiation import DOSE_RATES, INTERPLANETARY, dose_rate, share_behind
from sojourn_physics.environment.hazards.stay import Stay, rows_of_stay
from sojourn_physics.environment.hazards.upsets import MemoryPart, upsets_per_day

MASSES = st.floats(-17.0, 0.0).map(lambda exponent: 10.0**exponent)


@pytest.mark.published
def test_meteoroids_between_the_planets_weigh_what_gruen_found() -> None:
    """9.6e-20 kg/m3 at 1 au (Gruen et al. 1985): the flux on a turning plate is n v / 4."""
    edges = np.logspace(-18.0, 0.0, 1801)
    fluxes = np.array([interplanetary_flux(mass) for mass in edges]) / 3.15576e7
    flow = np.sum(-np.diff(fluxes) * np.sqrt(edges[1:] * edges[:-1])) * 1e-3  # kg/(m2 s)
    assert 4.0 * flow / SPEED == pytest.approx(9.6e-20, rel=0.1, abs=0.0)  # pytest allows 1e-12 by itself


def test_large_meteoroids_thin_out_as_gruen_has_it() -> None:
    """The cumulative flux nears a slope of -1.34 (photographic meteors)."""
    slope = math.log10(interplanetary_flux(1.0) / interplanetary_flux(0.1))
    assert slope == pytest.approx(-1.34, abs=0.02)


@given(MASSES, st.floats(1.0, 3.0))
def test_more_mass_is_rarer(mass: float, factor: float) -> None:
    assert interplanetary_flux(min(mass * factor, 1.0)) <= interplanetary_flux(mass)


@given(MASSES, st.floats(1.0, 50.0), st.floats(0.3, 4.0))
def test_near_a_body_flux_is_drawn_in_and_hidden(mass: float, radii: float, sun: float) -> None:
    gm, radius = 3.986e14, 6.371e6
    far, near = flux_at(mass, gm, radius, 1e12, sun), flux_at(mass, gm, radius, radii * radius, sun)
    assert far == pytest.approx(interplanetary_flux(mass) * sun**-1.8, rel=1e-4)
    assert 0.5 * far <= near <= 1.32 * far


def test_what_the_earth_draws_in_and_hides() -> None:
    """Escape at 11.2 km/s against 20: 1.31 at the surface; at 400 km 0.65 of the sky is open (half on the ground)."""
    assert focusing(3.986e14, 6.371e6) == pytest.approx(1.0 + (11.186 / 20.0) ** 2, rel=1e-3)
    assert open_sky(6371.0, 6771.0) == pytest.approx(0.67, abs=0.005)
    assert open_sky(1.0, 1.0) == 0.5


@pytest.mark.parametrize("mass,sun", [(2.0, 1.0), (1e-19, 1.0), (1e-6, 5.2)])
def test_what_is_not_known_of_meteoroids_is_refused(mass: float, sun: float) -> None:
    with pytest.raises(InvalidValueError, match="allowed is"):
        flux_at(mass, 1e10, 1e5, 1e5, sun)


def test_dose_rates_are_the_published_ones() -> None:
    assert DOSE_RATES["mars"].equivalent == 640.0
    assert INTERPLANETARY.equivalent == 1840.0
    assert DOSE_RATES["moon"].absorbed / 24.0 == pytest.approx(13.2)


def test_shielding_is_that_computed_for_the_ground_of_mars() -> None:
    """232 mSv a year in the open, 295, 81, 15 and 2.9 under 0.1, 1, 2 and 3 m of 2.8 g/cm3 (Hassler et al. 2014)."""
    for depth, left in ((0.0, 232.0), (10.0, 295.0), (100.0, 81.0), (200.0, 15.0), (300.0, 2.9)):
        assert 232.0 * share_behind(2.8 * depth) == pytest.approx(left)


@given(st.floats(28.0, 2000.0), st.floats(0.0, 500.0))
def test_a_thicker_shield_leaves_less(mass: float, more: float) -> None:
    assert 0.0 < share_behind(mass + more) <= share_behind(mass) <= 295.0 / 232.0 + 1e-12


def test_upsets_by_the_figure_of_merit() -> None:
    """Petersen 1998: 200 x figure of merit; a bit of 1e-8 cm2 and 10 MeV cm2/mg has 2e-8 a day between the planets."""
    part = MemoryPart(bits=1.0, cross_section=1e-8, quarter_transfer=10.0)
    assert upsets_per_day(part, INTERPLANETARY.absorbed) == pytest.approx(2e-8)
    assert upsets_per_day(part._replace(bits=1e9), 0.5 * INTERPLANETARY.absorbed) == pytest.approx(10.0)


@pytest.mark.published("Pathfinder 0.28 % a sol, Spirit 0.2 % a sol early on")
def test_dust_takes_what_pathfinder_and_spirit_measured() -> None:
    assert 1.0 - light_through_dust(1.0) == pytest.approx(0.0028)
    assert 1.0 - light_through_dust(30.0, SPIRIT) == pytest.approx(0.06, abs=0.003)


@given(st.floats(0.0, 0.05), st.floats(0.0, 300.0), st.floats(0.0, 1.0), st.floats(0.0, 300.0))
def test_a_gust_gives_light_back_and_dust_goes_on_falling(loss: float, sol: float, share: float, after: float) -> None:
    gusts = [Cleaning(sol, share)]
    before, at_once = light_through_dust(sol, loss), light_through_dust(sol, loss, gusts)
    assert at_once == pytest.approx(before + share * (1.0 - before))
    assert light_through_dust(sol + after, loss, gusts) == pytest.approx(at_once * (1.0 - loss) ** after)
    assert light_through_dust(0.5 * sol, loss, gusts) == light_through_dust(0.5 * sol, loss) or sol == 0.0


@pytest.mark.parametrize(
    "loss,cleanings",
    [(1.0, []), (-0.1, []), (0.01, [Cleaning(3.0, 1.5)]), (0.01, [Cleaning(5.0, 0.5), Cleaning(3.0, 0.5)])],
)
def test_dust_that_cannot_be_is_refused(loss: float, cleanings: list[Cleaning]) -> None:
    with pytest.raises(InvalidValueError, match="allowed is"):
        light_through_dust(10.0, loss, cleanings)


@pytest.mark.parametrize("name", available("bodies"))
def test_every_body_has_a_sheet_of_a_stay(name: str) -> None:
    rows = rows_of_stay(load_params("bodies", name, BodyParams), Stay(days=365.25))
    assert rows[0].what in ("absorbed dose", "dose")
    assert all(row.what and row.value and "nan" not in row.value for row in rows)
    assert any("meteoroids" in row.what for row in rows)


def test_a_year_on_mars_and_on_the_moon() -> None:
    """Mars: 0.64 mSv/day are 234 mSv in a year, no meteoroids. The Moon: hits from half of the sky."""
    mars = {row.what: row.value for row in rows_of_stay(load_params("bodies", "mars", BodyParams), Stay(days=365.25))}
    assert mars["dose equivalent"] == "0.64 mSv/d, 233.8 mSv"
    assert "none" in mars["meteoroids of 1e-06 g or more"]
    assert mars["light through dust on arrays"].startswith("36.9 %")
    moon = load_params("bodies", "moon", BodyParams)
    hits = next(row.value for row in rows_of_stay(moon, Stay(days=365.25)) if "meteoroids" in row.what)
    expected = 0.5 * (1.0 + (2.376 / 20.0) ** 2) * interplanetary_flux(1e-6) * 4.0
    assert float(hits.split()[0]) == pytest.approx(expected, rel=0.01)
    assert f"{chance_of_none(expected):.3f}" in hits
    assert dose_rate("venus", 9.2e6) is None
