"""The height field against planes, finite differences and its own nodes."""

import copy
import math
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from sojourn_machine.errors import InvalidValueError
from sojourn_physics.terrain.height_field import (
    HeightField,
    OutsideTerrainError,
    sample_height,
    sample_soil,
)

RESOLUTION = 0.25
SHAPE = (9, 13)
X_MIN, Y_MIN = -1.0, 2.0
X_MAX, Y_MAX = X_MIN + 12 * RESOLUTION, Y_MIN + 8 * RESOLUTION
in_x = st.floats(X_MIN, X_MAX)
in_y = st.floats(Y_MIN, Y_MAX)


def field(**changes: Any) -> HeightField:
    generator = np.random.default_rng(7)
    soil_index = np.zeros(SHAPE, dtype=np.uint8)
    soil_index[4, 6] = 1
    values: dict[str, Any] = dict(
        heights=generator.normal(size=SHAPE),
        soil_index=soil_index,
        resolution=RESOLUTION,
        origin_x=X_MIN,
        origin_y=Y_MIN,
        soil_names=("sand", "rock"),
    )
    return HeightField(**{**values, **changes})


FIELD = field()


def test_nodes_have_their_heights_and_rows_run_along_y() -> None:
    for row in range(SHAPE[0]):
        for column in range(SHAPE[1]):
            height = FIELD.height(X_MIN + column * RESOLUTION, Y_MIN + row * RESOLUTION)
            assert height == pytest.approx(FIELD.heights[row, column], abs=1e-12)
    assert FIELD.bounds == (X_MIN, X_MAX, Y_MIN, Y_MAX)


@settings(max_examples=60, deadline=None)
@given(st.floats(-2, 2), st.floats(-2, 2), st.floats(-5, 5), in_x, in_y)
def test_plane_is_exact(slope_x: float, slope_y: float, level: float, x: float, y: float) -> None:
    node_x = X_MIN + RESOLUTION * np.arange(SHAPE[1])
    node_y = Y_MIN + RESOLUTION * np.arange(SHAPE[0])
    plane = field(heights=level + slope_x * node_x[np.newaxis, :] + slope_y * node_y[:, np.newaxis])
    assert plane.height(x, y) == pytest.approx(level + slope_x * x + slope_y * y, abs=1e-12)
    assert plane.gradient(x, y) == pytest.approx((slope_x, slope_y), abs=1e-11)
    length = math.sqrt(1 + slope_x**2 + slope_y**2)
    assert plane.normal(x, y) == pytest.approx(np.array([-slope_x, -slope_y, 1.0]) / length, abs=1e-11)


@settings(max_examples=150, deadline=None)
@given(in_x, in_y)
def test_gradient_is_the_derivative_of_the_height(x: float, y: float) -> None:
    step = 1e-5
    for value, start in ((x, X_MIN), (y, Y_MIN)):
        in_cell = math.fmod(value - start, RESOLUTION)
        assume(2 * step < in_cell < RESOLUTION - 2 * step)
    dh_dx = (FIELD.height(x + step, y) - FIELD.height(x - step, y)) / (2 * step)
    dh_dy = (FIELD.height(x, y + step) - FIELD.height(x, y - step)) / (2 * step)
    assert FIELD.gradient(x, y) == pytest.approx((dh_dx, dh_dy), abs=1e-8)
    normal = FIELD.normal(x, y)
    assert float(normal @ normal) == pytest.approx(1.0)
    assert float(normal @ np.array([1.0, 0.0, dh_dx])) == pytest.approx(0.0, abs=1e-8)
    assert float(normal @ np.array([0.0, 1.0, dh_dy])) == pytest.approx(0.0, abs=1e-8)


@settings(max_examples=150, deadline=None)
@given(st.integers(1, 11), in_y, st.floats(1e-12, 1e-6))
def test_height_is_continuous_across_cell_edges(column: int, y: float, step: float) -> None:
    edge = X_MIN + column * RESOLUTION
    steepest = 2 * float(np.ptp(FIELD.heights)) / RESOLUTION
    change = FIELD.height(edge + step, y) - FIELD.height(edge - step, y)
    assert abs(change) <= steepest * 2 * step + 1e-12


@settings(max_examples=100, deadline=None)
@given(st.floats(-1e6, 1e6), st.floats(-1e6, 1e6))
def test_outside_gives_the_value_of_the_edge_and_says_so(x: float, y: float) -> None:
    height, dh_dx, dh_dy, inside = sample_height(FIELD.heights, X_MIN, Y_MIN, RESOLUTION, x, y)
    is_on_map = X_MIN <= x <= X_MAX and Y_MIN <= y <= Y_MAX
    assert inside == is_on_map
    edge_x, edge_y = min(max(x, X_MIN), X_MAX), min(max(y, Y_MIN), Y_MAX)
    assert height == pytest.approx(FIELD.height(edge_x, edge_y), abs=1e-9)
    assert math.isfinite(dh_dx) and math.isfinite(dh_dy)


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_points_that_are_not_numbers_are_outside_and_stay_finite(bad: float) -> None:
    for x, y in ((bad, 2.5), (0.0, bad), (bad, bad)):
        *values, inside = sample_height(FIELD.heights, X_MIN, Y_MIN, RESOLUTION, x, y)
        assert not inside and all(math.isfinite(value) for value in values)
        assert sample_soil(FIELD.soil_index, X_MIN, Y_MIN, RESOLUTION, x, y) == 0
        with pytest.raises(OutsideTerrainError):
            FIELD.height(x, y)


def test_methods_refuse_points_off_the_map() -> None:
    for method in (FIELD.height, FIELD.gradient, FIELD.normal, FIELD.soil_name):
        with pytest.raises(OutsideTerrainError, match="x from -1 to 2 m") as error:
            method(3.0, 2.5)
        assert (error.value.x, error.value.y) == (3.0, 2.5)


@settings(max_examples=100, deadline=None)
@given(in_x, in_y)
def test_soil_is_that_of_the_nearest_node(x: float, y: float) -> None:
    off_x, off_y = abs(x - (X_MIN + 6 * RESOLUTION)), abs(y - (Y_MIN + 4 * RESOLUTION))
    assume(abs(off_x - RESOLUTION / 2) > 1e-9 and abs(off_y - RESOLUTION / 2) > 1e-9)
    expected = "rock" if max(off_x, off_y) < RESOLUTION / 2 else "sand"
    assert FIELD.soil_name(x, y) == expected


def test_soil_off_the_map_is_that_of_the_edge() -> None:
    soil_index = np.arange(SHAPE[0] * SHAPE[1], dtype=np.int64).reshape(SHAPE)
    corners = [sample_soil(soil_index, X_MIN, Y_MIN, RESOLUTION, x, y) for x in (-9.0, 9.0) for y in (-9.0, 9.0)]
    assert corners == [0, 8 * 13, 12, 8 * 13 + 12]


def test_field_keeps_its_own_arrays() -> None:
    heights = np.zeros(SHAPE)
    ground = field(heights=heights)
    heights += 1.0
    assert ground.height(0.0, 3.0) == 0.0
    other = copy.deepcopy(ground)
    assert np.array_equal(other.heights, ground.heights) and other.heights is not ground.heights


def test_other_layouts_are_made_contiguous() -> None:
    heights = np.asfortranarray(np.random.default_rng(0).normal(size=SHAPE).astype(np.float32))
    ground = field(heights=heights, soil_index=np.zeros(SHAPE, dtype=np.uint8))
    assert ground.heights.flags.c_contiguous and ground.heights.dtype == np.float64
    assert ground.soil_index.flags.c_contiguous and ground.soil_index.dtype == np.uint8
    assert np.array_equal(ground.heights, heights)


BAD_HEIGHTS = np.zeros(SHAPE)
BAD_HEIGHTS[3, 5] = np.nan


@pytest.mark.parametrize(
    ("changes", "word"),
    [
        ({"heights": BAD_HEIGHTS}, r"heights\[3, 5\]"),
        ({"heights": np.zeros((1, 13))}, "heights.shape"),
        ({"heights": np.zeros(13)}, "heights.shape"),
        ({"soil_index": np.zeros((9, 12), dtype=np.int64)}, "soil_index"),
        ({"soil_index": np.zeros(SHAPE)}, "soil_index"),
        ({"soil_index": np.full(SHAPE, 2, dtype=np.int64)}, "soil_index = 2"),
        ({"soil_index": np.full(SHAPE, -1, dtype=np.int64)}, "soil_index = -1"),
        ({"resolution": 0.0}, "resolution"),
        ({"resolution": math.nan}, "resolution"),
        ({"origin_x": math.inf}, "origin_x"),
        ({"soil_names": ()}, "soil_names"),
        ({"soil_names": ("sand", "sand")}, "soil_names"),
    ],
)
def test_bad_fields_are_refused_by_name(changes: dict[str, Any], word: str) -> None:
    with pytest.raises(InvalidValueError, match=word):
        field(**changes)
