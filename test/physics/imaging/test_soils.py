"""Brightness of soils, on the map and off it."""

import numpy as np
import pytest

from sojourn_physics.imaging.soils import brightness_at, soils_of
from sojourn_physics.terrain.height_field import HeightField

EDGE_OF_ROCK = np.zeros((21, 21), dtype=np.uint8)
EDGE_OF_ROCK[:, 15:] = 1


def field(soils: np.ndarray) -> HeightField:
    return HeightField(np.zeros((21, 21)), soils, 0.1, 0.0, 0.0, ("sand", "rock"), "bilinear")


@pytest.mark.parametrize(("x", "expected"), [(0.3, 1.0), (1.4, 1.0), (1.6, 1.25), (2.0, 1.25), (2.2, 1.0), (-3.0, 1.0)])
def test_rock_at_the_edge_does_not_go_on_off_the_map(x: float, expected: float) -> None:
    assert brightness_at(soils_of(field(EDGE_OF_ROCK), (1.0, 1.25)), x, 1.0) == expected


@pytest.mark.parametrize(
    ("soils", "brightness"), [(np.zeros_like(EDGE_OF_ROCK), (0.8, 1.25)), (EDGE_OF_ROCK, (0.8, 0.8))]
)
def test_ground_that_is_all_as_bright_is_kept_as_one_node(soils: np.ndarray, brightness: tuple[float, float]) -> None:
    kept = soils_of(field(soils), brightness)
    assert kept.of_node.size == 1 and brightness_at(kept, 1.9, 0.2) == 0.8
