"""CastShadows of the ground: their length, their edge, and a march towards the Sun for each point."""

import math

import numpy as np
import pytest
from camera_scenes import flat, ground, rough, sun
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.ndimage import map_coordinates

from sojourn_physics.imaging.ground import seen_ground, with_changes
from sojourn_physics.imaging.shadows import shadows, sunlit, sunlit_nearby
from sojourn_physics.terrain.height_field import HeightField
from sojourn_physics.terrain.memory import GroundMemory
from sojourn_physics.terrain.memory_tiles import CHANNELS, DUG, TILE


def lit(field: HeightField, towards: np.ndarray, points: np.ndarray) -> np.ndarray:
    seen = seen_ground(field)
    cast = shadows(seen, towards)
    return np.array([sunlit(seen, cast, *point) for point in points])


@settings(max_examples=30)
@given(st.floats(8.0, 60.0), st.floats(0.2, 0.8), st.sampled_from((0.0, 90.0, 180.0, 270.0)))
def test_a_shadow_is_as_long_as_height_over_tangent(elevation: float, height: float, azimuth: float) -> None:
    """Of a wall: half of the Sun's disc is hidden at the very end of the shadow of its top."""
    size, resolution = 401, 0.05
    nodes = (np.arange(size) - 200) * resolution
    heights = np.zeros((size, size))
    heights[np.ix_(np.abs(nodes) < 3.0, np.abs(nodes) < 0.12)] = height  # thick as five nodes, along y
    turned = heights if azimuth in (0.0, 180.0) else heights.T
    long = height / math.tan(math.radians(elevation))
    away = -np.array([math.cos(math.radians(azimuth)), math.sin(math.radians(azimuth))])
    edge = 0.1  # of the wall's top, on the far side
    distances = edge + long * np.array([0.8, 1.2])
    inside, outside = lit(ground(turned), sun(elevation, azimuth, 1e-4), [[*(away * d), 0.0] for d in distances])
    if 0.2 * long > 0.06 and distances[1] < 8.0:
        assert inside == 0.0 and outside == 1.0
        near, far = distances
        for _ in range(40):
            middle = 0.5 * (near + far)
            (part,) = lit(ground(turned), sun(elevation, azimuth, 1e-4), [[*(away * middle), 0.0]])
            near, far = (middle, far) if part < 0.5 else (near, middle)
        # a wall's back is one node wide, and the light of a node that stands on it is bilinear
        assert near - edge == pytest.approx(long, abs=0.06)


def test_the_penumbra_is_as_wide_as_the_disc_is_high() -> None:
    """At the end of a shadow: where the upper limb comes over the edge, to where the lower one does."""
    size, disc, elevation = 801, 0.00465, 10.0
    heights = np.zeros((size, size))
    heights[300:500, 395:405] = 1.0
    x = -0.2 - np.linspace(5.3, 6.1, 401)
    parts = lit(ground(heights), sun(elevation, 0.0, disc), np.column_stack([x, np.zeros_like(x), np.zeros_like(x)]))
    wide = np.ptp(x[(parts > 0.02) & (parts < 0.98)]) / 0.96
    e = math.radians(elevation)
    assert wide == pytest.approx(1.0 / math.tan(e - disc) - 1.0 / math.tan(e + disc), rel=0.03)


@settings(max_examples=15)
@example(seed=232, elevation=30.0, azimuth=246.0)  # several points beside the shadows of towers
@given(seed=st.integers(0, 10_000), elevation=st.floats(10.0, 70.0), azimuth=st.floats(0.0, 360.0))
def test_points_on_rough_ground_are_lit_where_a_march_to_the_sun_is_free(
    seed: int, elevation: float, azimuth: float
) -> None:
    """But within a node of the edge of a shadow, for shadows are bilinear between nodes."""
    field, towards = rough(seed), sun(elevation, azimuth, 1e-4)
    places = np.random.default_rng(seed).uniform(-3.5, 3.5, (150, 2))
    parts = lit(field, towards, [[x, y, field.height(x, y)] for x, y in places])
    around = field.resolution * np.array([[0.0, 0.0], [1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]])
    free = np.array([_free(field, towards, places + offset) for offset in around])
    clear = (np.abs(free) > 0.03).all(axis=0) & (np.ptp(np.sign(free), axis=0) == 0.0)
    assert clear.mean() > 0.3
    assert ((parts > 0.5) == (free[0] > 0.0))[clear].mean() > 0.985


def _free(field: HeightField, towards: np.ndarray, places: np.ndarray) -> np.ndarray:
    """By what angle the ways from the ground to the Sun are free of it, at their closest [rad], small ones alone."""
    ways = np.arange(0.05, 12.0, 0.01)[:, np.newaxis]
    x, y = (places[:, k] + ways * towards[k] for k in range(2))
    over = (_height(field, *places.T) + ways * towards[2] - _height(field, x, y)) / ways
    on_map = (np.abs(x) < 3.99) & (np.abs(y) < 3.99)
    return np.min(np.where(on_map, over, 1.0), axis=0)


def _height(field: HeightField, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    nodes = [(y - field.origin_y) / field.resolution, (x - field.origin_x) / field.resolution]
    return map_coordinates(field.heights, nodes, order=1, mode="nearest")


def test_nothing_is_lit_by_night_and_flat_ground_all_day() -> None:
    points = [[x, 0.3 * x, 0.0] for x in np.linspace(-8.0, 8.0, 30)]
    assert (lit(flat(), sun(-5.0), points) == 0.0).all()
    for elevation in (2.0, 30.0, 90.0):
        assert (lit(flat(), sun(elevation), points) == 1.0).all()


def test_a_hole_has_a_shadow_on_the_side_of_the_sun() -> None:
    tile = np.zeros((TILE, TILE, CHANNELS), dtype=np.float32)
    tile[8:24, 8:24, DUG] = 0.1
    seen = with_changes(seen_ground(flat(4.0)), GroundMemory(0.02, 0.0, 0.0, {(1, 1): tile}))
    low, high = ((TILE + k) * 0.02 for k in (9.5, 22.5))
    middle = (TILE + 16) * 0.02
    towards = sun(30.0)
    assert sunlit_nearby(seen, towards, high, middle, -0.1) == 0.0
    assert sunlit_nearby(seen, towards, low, middle, -0.1) == 1.0
