"""The Sun of a scenario: by its place at the start, or by the date; what does not go together is said."""

import math

import numpy as np
import pytest

from sojourn_config.errors import ConfigError
from sojourn_config.scenario import load_scenario

MARCH = "sun.time=2028-03-01T12:00:00Z"


def test_a_date_takes_the_sun_from_the_ephemeris() -> None:
    """In half a day of the Earth the Moon turns by 6.1 deg under the Sun."""
    site = ["site={latitude_deg: 0.0, longitude_deg: 20.0}"]
    now, later = (
        load_scenario("flat_drive", [f"sun.time=2028-03-01T{hour:02d}:00:00Z", *site]).sun_over().direction(0.0)
        for hour in (0, 12)
    )
    assert math.degrees(math.acos(float(now @ later))) == pytest.approx(6.1, abs=0.1)
    same = load_scenario("flat_drive", ["sun.time=2028-03-01T02:00:00+02:00", *site]).sun_over().direction(0.0)
    np.testing.assert_allclose(same, now, atol=1e-12)


@pytest.mark.parametrize(
    "overrides,said",
    [
        ([MARCH], r"sun.time = .*allowed is with a site"),
        (["sun.time=2028-03-01T12:00:00", "site.latitude_deg=0"], r"sun.time = .*zone"),
        (["sun.time=soon", "site.latitude_deg=0"], r"sun.time = .*soon"),
        (["sun.time=2100-03-01T12:00:00Z", "site.latitude_deg=0"], "years 1958 to 2099"),
        ([MARCH, "site.latitude_deg=0", "sun.elevation_deg=10"], "Leave out elevation_deg"),
        (["site.latitude_deg=0", "sun.latitude_deg=10"], "sun.latitude_deg = .*the site has its latitude"),
        ([MARCH, "site.latitude_deg=0", "sun.horizon=[{azimuth_deg: 400.0, elevation_deg: 1.0}]"], "azimuth_deg = 400"),
        ([MARCH, "site.latitude_deg=0", "sun.optical_depth=-1"], "optical_depth = -1"),
    ],
)
def test_what_does_not_go_together_is_said(overrides: list[str], said: str) -> None:
    with pytest.raises(ConfigError, match=said):
        load_scenario("flat_drive", overrides)
