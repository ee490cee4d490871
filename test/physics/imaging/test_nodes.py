"""Nodes below many places, and what grids say there, against each place by itself."""

import numpy as np
import pytest
from camera_scenes import rough
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_physics.imaging.ground import height_at, on_map, seen_ground, slope_at
from sojourn_physics.imaging.nodes import find_nodes, heights_between, nodes_for, slopes_between
from sojourn_physics.imaging.soils import brightness_at, brightness_between, soils_of
from sojourn_physics.terrain.height_field import HeightField

COUNT = 64
SIDE = 4.0
"""Half of the map's [m]."""


def places(seed: int, reach: float) -> np.ndarray:
    """On the map and off it, at its corners and its middle, (2, COUNT) [m]."""
    found = np.random.default_rng(seed).uniform(-reach, reach, (2, COUNT))
    found[:, :5] = [[-SIDE, -SIDE, SIDE, SIDE, 0.0], [-SIDE, SIDE, -SIDE, SIDE, 0.0]]
    return found


@settings(max_examples=50)
@given(st.integers(0, 2**32), st.sampled_from((SIDE, 1.5 * SIDE)))
def test_heights_and_slopes_are_those_of_each_place(seed: int, reach: float) -> None:
    """Within single precision."""
    ground, (x, y), nodes = seen_ground(rough(seed % 7)), places(seed, reach), nodes_for(COUNT)
    found = np.empty((3, COUNT), dtype=np.float32)
    find_nodes(ground, x, y, nodes)
    heights_between(ground, nodes, found[0])
    slopes_between(ground, nodes, found[1], found[2])
    on = np.array([on_map(ground, *place) for place in zip(x, y, strict=True)])
    assert (nodes.on == on).all()
    heights = np.array([height_at(ground, *place) for place in zip(x, y, strict=True)])
    slopes = np.array([slope_at(ground, *place) for place in zip(x, y, strict=True)])
    assert found[0][on] == pytest.approx(heights[on], abs=1e-5)
    assert (np.abs(found[1:].T - slopes).max(axis=1) < 1e-4).all()
    assert (found[1:, ~on] == 0.0).all()


@settings(max_examples=50)
@given(st.integers(0, 2**32), st.sampled_from(("bilinear", "bicubic")))
def test_brightness_is_that_of_each_place(seed: int, interpolation: str) -> None:
    """Of two soils, on the map, and farther off it than half a node."""
    random = np.random.default_rng(seed)
    soils = random.integers(0, 2, (41, 41)).astype(np.uint8)
    field = HeightField(np.zeros((41, 41)), soils, 0.2, -SIDE, -SIDE, ("sand", "rock"), interpolation)  # type: ignore[arg-type]
    ground, bright, nodes = seen_ground(field), soils_of(field, (0.8, 1.25)), nodes_for(COUNT)
    x, y = places(seed, 1.5 * SIDE)
    found = np.empty(COUNT, dtype=np.float32)
    find_nodes(ground, x, y, nodes)
    brightness_between(bright, ground, nodes, found)
    beside = np.maximum(np.abs(x), np.abs(y)) - SIDE
    between = (np.abs(np.array([x, y]) / 0.2 % 1.0 - 0.5) < 1e-5).any(axis=0)
    judged = ~between & ((beside <= 0.0) | (beside > 0.1))
    expected = np.array([brightness_at(bright, *place) for place in zip(x, y, strict=True)])
    assert (found[judged] == expected.astype(np.float32)[judged]).all()
