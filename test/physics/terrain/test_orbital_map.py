"""The map from orbit: means of a plane, and the statistics of its error."""

import numpy as np
import pytest

from sojourn_physics.terrain.height_field import HeightField
from sojourn_physics.terrain.orbital import orbital_map
from sojourn_physics.terrain.orbital_params import OrbitalMapParams


def plane(count: int, resolution: float) -> HeightField:
    y, x = np.mgrid[0:count, 0:count] * resolution
    return HeightField(0.3 * x - 0.1 * y, np.zeros((count, count), dtype=np.uint8), resolution, 0.0, 0.0, ("one",))


def test_without_error_it_is_the_mean_over_each_cell() -> None:
    found = orbital_map(plane(53, 0.1), OrbitalMapParams(cell=1.0, height_error=0.0), 1)
    assert (found.cell, found.heights.shape) == (pytest.approx(1.0), (5, 5))
    rows, columns = np.indices(found.heights.shape)
    middles = 0.3 * (found.x0 + found.cell * columns) - 0.1 * (found.y0 + found.cell * rows)
    assert found.heights == pytest.approx(middles, abs=1e-9)  # of a plane the mean is the height at the middle


def test_its_error_has_the_stated_size_and_length() -> None:
    params = OrbitalMapParams(cell=1.0, height_error=0.2, error_length=4.0)
    flat = HeightField(np.zeros((400, 400)), np.zeros((400, 400), dtype=np.uint8), 1.0, 0.0, 0.0, ("one",))
    errors = np.stack([orbital_map(flat, params, seed).heights for seed in range(6)])
    assert errors.std() == pytest.approx(0.2, rel=0.05)
    for lag in (2, 4, 8):  # exp(-d^2 / (2 l^2))
        correlation = (errors[:, :, lag:] * errors[:, :, :-lag]).mean() / errors.var()
        assert correlation == pytest.approx(np.exp(-0.5 * (lag / 4.0) ** 2), abs=0.06)
    assert (errors[0] != errors[1]).all()
    assert (orbital_map(flat, params, 3).heights == errors[3]).all()


def test_a_small_ground_has_two_cells_at_least() -> None:
    found = orbital_map(plane(4, 0.1), OrbitalMapParams(cell=50.0), 1)
    assert found.heights.shape == (2, 2) and found.cell == pytest.approx(0.2)
