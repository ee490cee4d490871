"""The surface through points: exact on planes, honest about its errors, unknown where it was not seen."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_flight.odometry.ground_surface import (
    HEIGHT,
    HEIGHT_VARIANCE,
    KNOWN,
    SLOPE_X,
    SLOPE_X_VARIANCE,
    GroundSurface,
    surface_at,
    surface_through,
)
from sojourn_machine.params import FloatArray

CELL, RADIUS = 0.08, 0.14


def scattered(seed: int, count: int = 8000) -> FloatArray:
    """Places in a square of 2 m, shape (count, 2)."""
    return np.random.default_rng(seed).uniform(-1.0, 1.0, (count, 2))


def through(places: FloatArray, heights: FloatArray, sigma: float = 0.003) -> GroundSurface:
    points = np.column_stack([places, heights])
    return surface_through(points, np.full(len(points), sigma**2), CELL, RADIUS, 1.2)


@settings(max_examples=25, deadline=None)
@given(st.floats(-0.5, 0.5), st.floats(-0.5, 0.5), st.floats(-2.0, 2.0), st.floats(-0.8, 0.8), st.floats(-0.8, 0.8))
def test_a_plane_is_met_exactly(slope_x: float, slope_y: float, height: float, x: float, y: float) -> None:
    places = scattered(1)
    surface = through(places, height + places @ (slope_x, slope_y))
    known, *found = surface_at(surface, x, y)
    assert known
    np.testing.assert_allclose(found[:3], (height + slope_x * x + slope_y * y, slope_x, slope_y), atol=1e-9)


def test_the_variances_are_those_of_many_draws() -> None:
    """On a plane, where nothing but noise is off: squared errors over the stated variance are one on average."""
    places, random, sigma = scattered(2), np.random.default_rng(3), 0.003
    heights, slopes = [], []
    for _ in range(20):
        surface = through(places, 0.1 * places[:, 0] + sigma * random.standard_normal(len(places)), sigma)
        inner = surface.planes[5:-5, 5:-5]
        assert (inner[..., KNOWN] == 1.0).all()
        x = surface.x0 + CELL * np.arange(5, surface.planes.shape[0] - 5)
        heights.append((inner[..., HEIGHT] - 0.1 * x) ** 2 / inner[..., HEIGHT_VARIANCE])
        slopes.append((inner[..., SLOPE_X] - 0.1) ** 2 / inner[..., SLOPE_X_VARIANCE])
    assert 0.75 < np.mean(heights) < 1.1
    assert 0.75 < np.mean(slopes) < 1.1


def test_relief_that_a_plane_cannot_follow_is_in_the_variance() -> None:
    places = scattered(4)
    even = through(places, np.zeros(len(places)))
    ridged = through(places, 0.007 * np.sin(40.0 * places[:, 0]))
    middle = even.planes.shape[0] // 2
    assert ridged.planes[middle, middle, HEIGHT_VARIANCE] > 2.0 * even.planes[middle, middle, HEIGHT_VARIANCE]


def test_what_was_not_seen_is_unknown() -> None:
    places = scattered(5)
    surface = through(places[places[:, 0] < 0.0], np.zeros(int((places[:, 0] < 0.0).sum())))
    assert surface_at(surface, -0.5, 0.0)[0]
    assert not surface_at(surface, 0.3, 0.0)[0]
    assert not surface_at(surface, 5.0, 0.0)[0] and not surface_at(surface, -5.0, 0.0)[0]
    line = np.column_stack([np.linspace(-1.0, 1.0, 500), np.zeros(500)])
    on_a_line = through(line, np.zeros(500))
    assert not on_a_line.planes[..., KNOWN].any()


def test_the_edge_of_a_step_is_no_ground_and_what_is_beside_it_is() -> None:
    places = scattered(6)
    surface = through(places, np.where(places[:, 0] > 0.0, 0.1, 0.0))
    for x, known in ((-0.4, True), (0.0, False), (0.4, True)):
        found = surface_at(surface, x, 0.0)
        assert found[0] == known
    assert abs(surface_at(surface, 0.4, 0.0)[1] - 0.1) < 1e-9
