"""The horizon of ground and of a far table, against shapes whose horizon is known."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sojourn_machine.params import FloatArray
from sojourn_physics.environment.sun.horizon import HorizonPoint, far_horizon, ground_horizon
from sojourn_physics.terrain.height_field import HeightField

RESOLUTION, HALF = 0.1, 40.0
SIDE = np.arange(-HALF, HALF + 1e-9, RESOLUTION)
X, Y = np.meshgrid(SIDE, SIDE)
AZIMUTHS = np.radians(np.arange(0.0, 360.0, 7.5))


def ground(heights: FloatArray) -> HeightField:
    """Of one soil, 80 m square, its middle in the origin."""
    return HeightField(heights, np.zeros(heights.shape, dtype=np.uint8), RESOLUTION, -HALF, -HALF, ("soil",))


@given(st.floats(-20.0, 20.0), st.floats(-20.0, 20.0), st.floats(0.0, 0.6), st.floats(0.0, 2.0 * math.pi))
def test_a_plane_has_the_horizon_of_its_slope(x: float, y: float, slope: float, fall: float) -> None:
    heights = slope * (math.sin(fall) * X + math.cos(fall) * Y)
    place = (x, y, slope * (math.sin(fall) * x + math.cos(fall) * y))
    expected = np.arctan(slope * np.cos(AZIMUTHS - fall))
    np.testing.assert_allclose(ground_horizon(ground(heights), place, AZIMUTHS), expected, atol=1e-9)


def test_a_round_wall_stands_equally_high_all_round() -> None:
    """A rim of 6 m at 20 m: what counts is its near upper edge."""
    field = ground(np.where(np.hypot(X, Y) >= 20.0, 6.0, 0.0))
    np.testing.assert_allclose(ground_horizon(field, (0.0, 0.0, 1.0), AZIMUTHS), math.atan2(5.0, 20.0), rtol=0.02)


def test_an_eye_over_all_ground_looks_down_on_it() -> None:
    found = ground_horizon(ground(np.zeros(X.shape)), (0.0, 0.0, 3.0), AZIMUTHS)
    assert (found < 0.0).all()
    assert (found > math.atan2(-3.0, 38.0)).all()


def test_off_the_map_there_is_no_ground() -> None:
    found = ground_horizon(ground(np.zeros(X.shape)), (HALF, 0.0, 0.5), np.array([0.5 * math.pi, 1.5 * math.pi]))
    assert found[0] == pytest.approx(-0.5 * math.pi)
    assert found[1] > -0.1


def test_a_wall_is_seen_where_it_is() -> None:
    """North, 10 m away, 4 m high, from x = -2 to 2."""
    field = ground(np.where((Y >= 10.0) & (np.abs(X) <= 2.0), 4.0, 0.0))
    azimuths = np.radians([0.0, 8.0, 20.0, 180.0])
    found = np.degrees(ground_horizon(field, (0.0, 0.0, 0.0), azimuths))
    assert found[:2] == pytest.approx([21.8, 21.6], abs=0.6)
    assert found[2:] == pytest.approx([0.0, 0.0], abs=1e-9)


def test_a_far_horizon_goes_all_the_way_round() -> None:
    points = [HorizonPoint(azimuth_deg=a, elevation_deg=e) for a, e in ((350.0, 2.0), (10.0, 4.0), (180.0, -1.0))]
    for azimuth, elevation in ((350.0, 2.0), (0.0, 3.0), (-5.0, 2.5), (10.0, 4.0), (95.0, 1.5), (540.0, -1.0)):
        assert math.degrees(far_horizon(points, math.radians(azimuth))) == pytest.approx(elevation)
    assert far_horizon((), 1.0) == 0.0
