"""The Sun over a site, against the formulas of spherical astronomy."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sojourn_machine.params import FloatArray
from sojourn_physics.environment.sun.path import SunParams, sun_direction

DAY = 88775.244  # of Mars [s]


def by_hour_angle(latitude: float, declination: float, hour_angle: float) -> FloatArray:
    """East, north and up of the Sun (Meeus 1998, eq. 13.5 and 13.6; hour angle positive westward)."""
    up = math.sin(latitude) * math.sin(declination) + math.cos(latitude) * math.cos(declination) * math.cos(hour_angle)
    east = -math.cos(declination) * math.sin(hour_angle)
    north = math.cos(latitude) * math.sin(declination) - math.sin(latitude) * math.cos(declination) * math.cos(
        hour_angle
    )
    return np.array((east, north, up))


@given(st.floats(-1.5, 1.5), st.floats(-0.43, 0.43), st.floats(-3.1, 3.1), st.floats(0.0, 3.0))
def test_it_follows_the_hour_angle(latitude: float, declination: float, hour_angle: float, days: float) -> None:
    start = by_hour_angle(latitude, declination, hour_angle)
    sun = SunParams(
        azimuth_deg=math.degrees(math.atan2(start[0], start[1])),
        elevation_deg=math.degrees(math.asin(min(max(start[2], -1.0), 1.0))),
        latitude_deg=math.degrees(latitude),
    )
    later = by_hour_angle(latitude, declination, hour_angle + 2.0 * math.pi * days)
    np.testing.assert_allclose(sun_direction(sun, DAY, days * DAY), later, atol=1e-6)


@pytest.mark.parametrize(
    "azimuth,elevation,direction", [(0.0, 0.0, (0, 1, 0)), (90.0, 0.0, (1, 0, 0)), (45.0, 90.0, (0, 0, 1))]
)
def test_azimuth_is_from_north_towards_east(azimuth: float, elevation: float, direction: tuple[float, ...]) -> None:
    sun = SunParams(azimuth_deg=azimuth, elevation_deg=elevation)
    np.testing.assert_allclose(sun_direction(sun, DAY, 0.0), direction, atol=1e-15)


def test_it_sets_in_the_west_at_the_equator() -> None:
    noon = SunParams(azimuth_deg=0.0, elevation_deg=90.0)
    np.testing.assert_allclose(sun_direction(noon, DAY, DAY / 4.0), (-1.0, 0.0, 0.0), atol=1e-12)
