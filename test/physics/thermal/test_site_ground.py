"""The ground of a site under the Sun of its scenario, against what was measured on the Moon and on Mars."""

import math

import numpy as np
import pytest

from sojourn_config.expected_light import light_at_start
from sojourn_config.load import load_params
from sojourn_config.scenario import load_scenario
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray
from sojourn_machine.sunlight import Sunlight
from sojourn_physics.environment.body import BodyParams
from sojourn_physics.environment.site import SiteParams
from sojourn_physics.environment.sun.over import SunOver
from sojourn_physics.environment.sun.path import SunParams
from sojourn_physics.thermal.site_ground import SiteGround

MOON = load_params("bodies", "moon", BodyParams)
UP = np.array([0.0, 0.0, 1.0])


def over_a_day(ground: SiteGround, day: float) -> FloatArray:
    return np.array([ground.temperature(share * day) for share in np.linspace(0.0, 1.0, 2001)])


def site(scenario: str, *changes: str) -> FloatArray:
    loaded = load_scenario(scenario, list(changes))
    return over_a_day(SiteGround(loaded.body, light_at_start(loaded, loaded.height_field)), loaded.body.solar_day)


def test_the_equator_of_the_moon_is_as_warm_as_it_was_measured() -> None:
    """Hayne et al. 2017: 385 to 395 K at noon, 95 to 100 K at midnight; by its distance from the Sun a little more."""
    there = site("lunar_night", "site.latitude_deg=0.0")
    assert 383.0 < there.max() < 398.0 and 90.0 < there.min() < 97.0


def test_dust_takes_the_heat_from_the_day_of_mars() -> None:
    """Clear, the ground goes over most of what the planet's fact sheet has (130 to 308 K); a storm flattens its day."""
    clear, storm = site("mars_sol"), site("mars_sol", "sun.optical_depth=5.0")
    assert 130.0 < clear.min() < 200.0 and 270.0 < clear.max() < 308.0
    assert 130.0 < storm.min() < clear.min() and np.ptp(storm) < 0.6 * np.ptp(clear)


def test_a_cold_and_a_warm_half_follow_the_light() -> None:
    """A light of a known course: warm after noon, cold before dawn, the same a day later."""

    def light(time: float) -> Sunlight:
        height = math.sin(2.0 * math.pi * time / MOON.solar_day)
        return Sunlight(UP, 1361.0 if height > 0.0 else 0.0, 0.0, math.asin(height), float(height > 0.0))

    ground = SiteGround(MOON, light)
    there = over_a_day(ground, MOON.solar_day)
    assert 500 <= there.argmax() < 540 and there.argmin() in (*range(1980, 2001), *range(20))
    assert ground.temperature(3.25 * MOON.solar_day) == pytest.approx(ground.temperature(0.25 * MOON.solar_day))


def test_a_total_eclipse_of_the_moon_takes_the_heat_of_noon_in_an_hour() -> None:
    """14 March 2025, seen from the middle of the near side: nothing yet at 3:50, total from 6:26 to 7:31. By a finer
    model of its own, 0.3 mm at the surface and 10 s, with this light 271 K at 5:30 and 174 K at 7:25.
    """

    def ground(start: str) -> SiteGround:
        sun = SunOver(SunParams.model_validate({"time": start}), MOON, SiteParams(latitude_deg=0.0, longitude_deg=0.0))
        return SiteGround(MOON, lambda time: sun.light(time, 0.0, 0.0))

    assert ground("2025-03-14T07:25:00Z").temperature(0.0) == pytest.approx(174.3, abs=2.0)
    begun = ground("2025-03-14T03:50:00Z")
    assert begun.temperature(0.0) > 384.0
    assert begun.temperature(100.0 * 60.0) == pytest.approx(270.0, abs=3.0)
    assert begun.temperature(215.0 * 60.0) == pytest.approx(174.3, abs=2.0)
    assert begun.temperature(MOON.solar_day) > 383.0, "a month later there is none"
    assert ground("2025-03-16T07:25:00Z").temperature(0.0) == pytest.approx(377.0, abs=2.0)


def test_a_body_without_the_table_is_refused() -> None:
    with pytest.raises(InvalidValueError, match="regolith"):
        SiteGround(MOON.model_copy(update={"regolith": None}), lambda time: Sunlight(UP, 0.0, 0.0, 0.0, 0.0))
