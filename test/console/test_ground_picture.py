"""Tiles of the ground, ruts on them, and where a click meets it."""

import io
import math

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st

from sojourn_console.ground_tiles import GroundTiles
from sojourn_console.picking import met_by
from sojourn_physics.terrain.ground_samples import heights_of
from sojourn_physics.terrain.height_field import HeightField


def slope(rise: float = 0.1, across: float = -0.05) -> HeightField:
    """A plane z = 1 + rise x + across y, 20 m by 12 m; of another soil where y is over -3 m."""
    y, x = np.mgrid[-6.0:6.01:0.1, -10.0:10.01:0.1]
    return HeightField(1.0 + rise * x + across * y, (y > -3.0).astype(np.uint8), 0.1, -10.0, -6.0, ("one", "other"))


def sunlit(field: HeightField) -> GroundTiles:
    tiles = GroundTiles(field)
    tiles.light.shine(np.array([0.0, 0.0, 1.0]), 0.005)
    return tiles


def test_tiles_cover_the_ground_and_lie_on_it() -> None:
    tiles = GroundTiles(slope())
    corners = []
    for key in tiles.keys():  # noqa: SIM118 - it is no mapping
        mesh = trimesh.load(io.BytesIO(tiles.glb(key)), file_type="glb", force="mesh")
        x, y, z = mesh.vertices.T
        assert z == pytest.approx(1.0 + 0.1 * x - 0.05 * y, abs=1e-5)
        assert (mesh.face_normals[:, 2] > 0.9).all()
        corners += [mesh.bounds]
    low, high = np.min([one[0] for one in corners], axis=0), np.max([one[1] for one in corners], axis=0)
    assert low[:2] == pytest.approx([-10.0, -6.0], abs=1e-5) and high[:2] == pytest.approx([10.0, 6.0], abs=1e-5)
    assert sum((one[1] - one[0])[:2].prod() for one in corners) == pytest.approx(240.0, rel=1e-5)


def test_a_tile_s_picture_is_small_and_looks_the_same() -> None:
    """As PNG its grain took 16 ms of each drawing, and 60 kB of what a browser reads."""
    tiles = sunlit(slope())
    key = next(iter(tiles.keys()))
    drawn = tiles.picture(key).astype(float)
    data = tiles.glb(key)
    texture = trimesh.load(io.BytesIO(data), file_type="glb", force="mesh").visual.material.baseColorTexture
    assert len(data) < 0.2 * drawn.size
    assert np.abs(np.asarray(texture, dtype=float) - drawn).mean() < 5.0


def test_what_shadows_fall_on_is_the_same_ground() -> None:
    tiles = GroundTiles(slope())
    mesh = trimesh.load(io.BytesIO(tiles.unseen()), file_type="glb", force="mesh")
    x, y, z = mesh.vertices.T
    assert z == pytest.approx(1.0 + 0.1 * x - 0.05 * y, abs=1e-5)
    assert mesh.area_faces @ mesh.face_normals[:, 2] == pytest.approx(240.0, rel=1e-5)


def test_soils_have_their_colours_with_north_up() -> None:
    tiles = sunlit(slope())
    picture = tiles.picture(next(iter(tiles.keys()))).astype(float)  # the tile from y = -6 to 0 m
    upper, lower = picture[:20].mean(axis=(0, 1)), picture[-20:].mean(axis=(0, 1))
    assert np.abs(upper - lower).max() > 30.0


def test_a_rut_darkens_the_ground_where_it_is_and_nowhere_else() -> None:
    tiles = sunlit(slope())
    before = {key: tiles.picture(key).astype(int) for key in tiles.keys()}  # noqa: SIM118
    changed = tiles.lower(np.array([[1.0, -3.0], [1.0, -3.0]]), np.array([0.03, 0.0]), 0.1)
    (key,) = changed
    for other, picture in before.items():
        darker = picture - tiles.picture(other).astype(int) > 10
        if other != key:
            assert not darker.any()
            continue
        rows, columns, _ = np.nonzero(darker)
        x0, x1, y0, y1 = tiles._bounds(key)
        x = x0 + (columns + 0.5) / picture.shape[1] * (x1 - x0)
        y = y1 - (rows + 0.5) / picture.shape[0] * (y1 - y0)
        assert len(x) and np.hypot(x - 1.0, y + 3.0).max() < 0.12
    assert not tiles.lower(np.array([[1.0, -3.0]]), np.array([0.02]), 0.1)  # no deeper than it is
    assert tiles.clear() == changed
    assert (tiles.picture(key) == before[key]).all()


@given(st.integers(0, 2**32 - 1), st.floats(0.005, 0.3))
def test_each_pixel_is_as_low_as_the_deepest_place_within_the_radius(seed: int, radius: float) -> None:
    """By going through all pixels and places; some of the places lie beyond the ground."""
    rng = np.random.default_rng(seed)
    places, depths = rng.uniform((-10.2, -6.2), (10.2, 6.2), (40, 2)), rng.uniform(-0.01, 0.06, 40)
    tiles = GroundTiles(slope())
    changed = tiles.lower(places, depths, radius)
    for key in tiles.keys():  # noqa: SIM118
        x, y = tiles._centres(key)
        away = np.hypot(x[None, :, None] - places[:, 0], y[:, None, None] - places[:, 1])
        expected = np.where((away <= radius) & (depths > 1e-3), depths, 0.0).max(axis=2).astype(np.float32)
        assert np.array_equal(tiles._lowered.get(key, np.zeros_like(expected)), expected)
        assert (key in changed) == bool((expected > 2e-3).any())
    assert not tiles.lower(places, depths, radius)


@given(st.floats(-9.9, 9.9), st.floats(-5.9, 5.9))
def test_heights_are_those_of_the_ground(x: float, y: float) -> None:
    ground = slope(0.3, 0.2)
    assert float(heights_of(ground, np.array([x]), np.array([y]))[0]) == pytest.approx(ground.height(x, y), abs=1e-9)


@given(
    st.floats(-9.0, 9.0), st.floats(-5.0, 5.0), st.floats(0.0, 2.0 * math.pi), 
    st.floats(math.radians(20), math.radians(80)), st.floats(3.0, 30.0),
)  # fmt: skip
def test_a_ray_meets_a_plane_where_geometry_says(
    x: float, y: float, azimuth: float, elevation: float, away: float
) -> None:
    """From a point over the plane back to it, along whatever line."""
    place = np.array([x, y, 1.0 + 0.1 * x - 0.05 * y])
    back = np.array(
        [math.cos(elevation) * math.cos(azimuth), math.cos(elevation) * math.sin(azimuth), math.sin(elevation)]
    )
    found = met_by(slope(), place + away * back, -2.0 * back)
    assert found is not None and found == pytest.approx(place, abs=2e-6)


def test_a_ray_beside_the_ground_or_up_meets_none() -> None:
    assert met_by(slope(), np.array([0.0, 0.0, 5.0]), np.array([0.0, 0.3, 1.0])) is None
    assert met_by(slope(), np.array([50.0, 0.0, 5.0]), np.array([0.1, 0.0, -1.0])) is None
