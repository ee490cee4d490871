"""Fractal roughness: what was asked for is what the field shows."""

import math

import numpy as np
import pytest

from sojourn_machine.params import FloatArray
from sojourn_physics.terrain.params import RoughnessParams
from sojourn_physics.terrain.roughness import rms_slope, rough_surface

RESOLUTION = 0.05
LAGS = np.array([4, 8, 16, 32, 64])


def surface(hurst: float, seed: int, side: int = 401) -> FloatArray:
    params = RoughnessParams(hurst=hurst, rms_slope_deg=3.0, baseline=0.5)
    return rough_surface(params, (side, side), RESOLUTION, np.random.default_rng(seed))


def measured_hurst(heights: FloatArray) -> float:
    """Slope of log structure function over log lag, with no code of the generator."""
    structure = [
        np.mean((heights[:, lag:] - heights[:, :-lag]) ** 2) + np.mean((heights[lag:] - heights[:-lag]) ** 2)
        for lag in LAGS
    ]
    return float(np.polyfit(np.log(LAGS), 0.5 * np.log(structure), 1)[0])


@pytest.mark.parametrize("hurst", [0.3, 0.6, 0.8, 0.9])
def test_hurst_exponent_is_the_stated_one(hurst: float) -> None:
    values = [measured_hurst(surface(hurst, seed)) for seed in range(6)]
    assert float(np.mean(values)) == pytest.approx(hurst, abs=0.05)


def test_rms_slope_at_the_baseline_is_the_stated_one() -> None:
    heights = surface(0.8, 1)
    rise = np.concatenate([(heights[:, 10:] - heights[:, :-10]).ravel(), (heights[10:] - heights[:-10]).ravel()])
    assert math.degrees(math.atan(float(np.sqrt(np.mean(rise**2))) / 0.5)) == pytest.approx(3.0, rel=1e-6)
    assert float(heights.mean()) == pytest.approx(0.0, abs=1e-12)


def test_slope_grows_as_the_baseline_shrinks() -> None:
    heights = surface(0.7, 2)
    ratio = math.tan(rms_slope(heights, RESOLUTION, 0.2)) / math.tan(rms_slope(heights, RESOLUTION, 1.6))
    assert ratio == pytest.approx(8.0**0.3, rel=0.12)


def test_both_directions_are_equally_rough() -> None:
    ratios = []
    for seed in range(6):
        heights = surface(0.6, seed)
        ratios.append(np.mean((heights[:, 10:] - heights[:, :-10]) ** 2) / np.mean((heights[10:] - heights[:-10]) ** 2))
    assert float(np.exp(np.mean(np.log(ratios)))) == pytest.approx(1.0, abs=0.1)


def test_opposite_edges_do_not_match() -> None:
    heights = surface(0.8, 3)
    across = float(np.sqrt(np.mean((heights[:, 0] - heights[:, -1]) ** 2)))
    one_cell = float(np.sqrt(np.mean((heights[:, 1:] - heights[:, :-1]) ** 2)))
    assert across > 10.0 * one_cell


def test_no_slope_is_a_flat_surface() -> None:
    params = RoughnessParams(rms_slope_deg=0.0)
    heights = rough_surface(params, (50, 60), RESOLUTION, np.random.default_rng(0))
    assert heights.shape == (50, 60) and not heights.any()


def test_long_narrow_and_tiny_maps_work() -> None:
    for shape in ((2, 2), (2, 500), (301, 3)):
        heights = rough_surface(RoughnessParams(rms_slope_deg=3.0), shape, RESOLUTION, np.random.default_rng(0))
        assert heights.shape == shape and bool(np.isfinite(heights).all())
