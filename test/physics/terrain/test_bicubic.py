"""The bicubic ground: through its nodes, smooth, exact for quadratics; and large maps in single precision."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_machine.errors import InvalidValueError
from sojourn_physics.terrain import height_field
from sojourn_physics.terrain.height_field import HeightField, OutsideTerrainError

CELL = 0.25
X = -1.0 + CELL * np.arange(13)
Y = 2.0 + CELL * np.arange(9)
in_x = st.floats(float(X[0]), float(X[-1]))
in_y = st.floats(float(Y[0]), float(Y[-1]))
coefficient = st.floats(-2.0, 2.0)


def bicubic(heights: np.ndarray) -> HeightField:
    index = np.zeros(heights.shape, dtype=np.uint8)
    return HeightField(heights, index, CELL, float(X[0]), float(Y[0]), ("sand",), "bicubic")


ROUGH = bicubic(np.random.default_rng(5).normal(size=(9, 13)))


def test_goes_through_its_nodes() -> None:
    for i, y in enumerate(Y):
        for j, x in enumerate(X):
            assert ROUGH.height(x, y) == pytest.approx(ROUGH.heights[i, j], abs=1e-12)


@settings(max_examples=150, deadline=None)
@given(st.tuples(*[coefficient] * 9), in_x, in_y)
def test_quadratics_are_exact_up_to_the_edge(c: tuple[float, ...], x: float, y: float) -> None:
    def value(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        return sum(c[3 * i + j] * x**i * y**j for i in range(3) for j in range(3))

    ground = bicubic(value(X[np.newaxis, :], Y[:, np.newaxis]) + np.zeros((9, 13)))
    assert ground.height(x, y) == pytest.approx(value(x, y), abs=1e-9)
    by_x = sum(i * c[3 * i + j] * x ** max(i - 1, 0) * y**j for i in (1, 2) for j in range(3))
    by_y = sum(j * c[3 * i + j] * x**i * y ** max(j - 1, 0) for i in range(3) for j in (1, 2))
    assert ground.gradient(x, y) == pytest.approx((by_x, by_y), abs=1e-8)


@settings(max_examples=100, deadline=None)
@given(st.floats(-0.99, 1.99), st.floats(2.01, 3.99))
def test_gradient_is_the_derivative_of_the_height(x: float, y: float) -> None:
    step = 1e-6
    by_x = (ROUGH.height(x + step, y) - ROUGH.height(x - step, y)) / (2 * step)
    by_y = (ROUGH.height(x, y + step) - ROUGH.height(x, y - step)) / (2 * step)
    assert ROUGH.gradient(x, y) == pytest.approx((by_x, by_y), abs=1e-4)


@settings(max_examples=100, deadline=None)
@given(st.integers(1, 11), st.integers(1, 7), st.floats(0.0, 1.0))
def test_height_and_gradient_are_continuous_across_cell_edges(column: int, row: int, along: float) -> None:
    y = 2.0 + 2.0 * along
    left, right = ROUGH.gradient(X[column] - 1e-9, y), ROUGH.gradient(X[column] + 1e-9, y)
    assert left == pytest.approx(right, abs=1e-5)
    x = -1.0 + 3.0 * along
    below, above = ROUGH.gradient(x, Y[row] - 1e-9), ROUGH.gradient(x, Y[row] + 1e-9)
    assert below == pytest.approx(above, abs=1e-5)


def test_bilinear_gradient_does_jump() -> None:
    """So that the test above can fail."""
    flat = HeightField(ROUGH.heights, ROUGH.soil_index, CELL, float(X[0]), float(Y[0]), ("sand",))
    jumps = [abs(flat.gradient(x - 1e-9, 3.1)[0] - flat.gradient(x + 1e-9, 3.1)[0]) for x in X[1:-1]]
    assert max(jumps) > 0.5


def test_off_the_map_is_told() -> None:
    for x in (-1.01, float("nan"), 5.0):
        with pytest.raises(OutsideTerrainError):
            ROUGH.height(x, 3.0)


def test_too_small_or_unknown_is_refused() -> None:
    with pytest.raises(InvalidValueError, match="4 nodes each way"):
        bicubic(np.zeros((3, 9)))
    with pytest.raises(InvalidValueError, match="bilinear or bicubic"):
        HeightField(np.zeros((5, 5)), np.zeros((5, 5), dtype=np.uint8), 1.0, 0.0, 0.0, ("sand",), "cubic")  # type: ignore[arg-type]


@pytest.mark.parametrize("interpolation", ["bilinear", "bicubic"])
def test_large_maps_are_kept_in_single_precision(monkeypatch: pytest.MonkeyPatch, interpolation: str) -> None:
    monkeypatch.setattr(height_field, "DOUBLE_NODES", 50)
    heights = 20.0 + 0.3 * X[np.newaxis, :] - 0.2 * Y[:, np.newaxis]
    index = np.zeros(heights.shape, dtype=np.uint8)
    ground = HeightField(heights, index, CELL, float(X[0]), float(Y[0]), ("sand",), interpolation)  # type: ignore[arg-type]
    assert ground.heights.dtype == np.float32
    assert ground.height(0.4, 2.9) == pytest.approx(20.0 + 0.12 - 0.58, abs=4e-6)
    assert ground.gradient(0.4, 2.9) == pytest.approx((0.3, -0.2), abs=2e-5)
