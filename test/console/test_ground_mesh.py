"""Triangles of the ground: without gaps, on the ground as near as is told, and few where there is nothing to see."""

import math
from collections import Counter

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_console.ground_mesh import GroundMesh

ROUGH = st.tuples(st.integers(1, 3), st.integers(1, 3), st.sampled_from((1, 2, 4, 8)), st.integers(0, 2**32 - 1))
"""Rows and columns of tiles, spaces along one, and a seed."""


def heights(rows: int, columns: int, tile: int, seed: int) -> np.ndarray:
    """Smooth in part, with peaks of single nodes."""
    rng = np.random.default_rng(seed)
    y, x = np.mgrid[0 : rows * tile + 1, 0 : columns * tile + 1].astype(float)
    peaks = np.where(rng.random(x.shape) < 0.1, rng.normal(0.0, 0.5, x.shape), 0.0)
    return 0.3 * np.sin(0.4 * x) * np.cos(0.3 * y) + peaks


def all_triangles(mesh: GroundMesh, rows: int, columns: int) -> np.ndarray:
    return np.concatenate([mesh.triangles(row, column) for row in range(rows) for column in range(columns)])


@settings(max_examples=60)
@given(ROUGH, st.integers(0, 80))
def test_tiles_leave_no_gap_and_lie_over_nothing_twice(shape: tuple[int, int, int, int], most: int) -> None:
    """Each side of a triangle is that of one other, the other way round, or lies on the border of the ground."""
    rows, columns, tile, _ = shape
    ground = heights(*shape)
    triangles = all_triangles(GroundMesh(ground, tile, most, 0.0), rows, columns)
    sides = Counter((int(a), int(b)) for one in triangles for a, b in zip(one, np.roll(one, -1), strict=True))
    assert set(sides.values()) == {1}
    up, across = ground.shape
    for a, b in sides:
        if (b, a) not in sides:
            (row, column), (other_row, other_column) = divmod(a, across), divmod(b, across)
            assert row == other_row in (0, up - 1) or column == other_column in (0, across - 1)
    y, x = (of[triangles] for of in np.divmod(np.arange(ground.size), across))
    areas = 0.5 * ((x[:, 1] - x[:, 0]) * (y[:, 2] - y[:, 0]) - (x[:, 2] - x[:, 0]) * (y[:, 1] - y[:, 0]))
    assert (areas > 0.0).all() and areas.sum() == rows * columns * tile * tile


@settings(max_examples=40)
@given(ROUGH, st.integers(0, 80))
def test_the_ground_is_as_near_as_told(shape: tuple[int, int, int, int], most: int) -> None:
    """At each node: a halving that is left out adds what is borne at most, and two of them halve a side."""
    rows, columns, tile, _ = shape
    ground = heights(*shape)
    mesh = GroundMesh(ground, tile, most, 0.0)
    nodes = np.unique(all_triangles(mesh, rows, columns))
    assert len(nodes) <= most + (rows + 1) * (columns + 1)
    for face in all_triangles(mesh, rows, columns):
        away = over(face, ground)
        assert np.abs(away).max() <= 2.0 * math.log2(2.0 * tile) * mesh.borne + 1e-12


def over(face: np.ndarray, ground: np.ndarray) -> np.ndarray:
    """How far the plane through a triangle's corners is over the nodes inside it."""
    y, x = np.divmod(np.arange(ground.size), ground.shape[1])
    sides = zip(face, np.roll(face, -1), strict=True)
    inside = np.logical_and.reduce([(x[b] - x[a]) * (y - y[a]) >= (y[b] - y[a]) * (x - x[a]) for a, b in sides])
    corners = np.column_stack([x, y, np.ones(ground.size)])
    plane = np.linalg.solve(corners[face], ground.ravel()[face])
    found: np.ndarray = corners[inside] @ plane - ground.ravel()[inside]
    return found


def test_a_plane_is_two_triangles_a_tile_and_a_bump_is_finer_only_about_it() -> None:
    y, x = np.mgrid[0:65, 0:65].astype(float)
    plane = 0.1 * x - 0.2 * y
    assert len(all_triangles(GroundMesh(plane, 32, 10_000, 1e-6), 2, 2)) == 8
    bump = plane + np.exp(-((x - 16.0) ** 2 + (y - 16.0) ** 2) / 8.0)
    mesh = GroundMesh(bump, 32, 10_000, 1e-3)
    assert len(mesh.triangles(0, 0)) > 100 and len(mesh.triangles(1, 1)) < 10  # what is fine next door
