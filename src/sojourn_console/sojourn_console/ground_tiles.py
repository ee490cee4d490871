"""The ground as tiles of triangles with a picture of its soils on each, in which ruts show as they form.

A tile has small triangles where it is curved, and a pixel for each node of the ground, or finer. The light of the Sun
is in the picture, and so are ruts, the darker the deeper: they are a few centimetres deep and would hardly be seen as
relief.
"""

import io
import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import trimesh
from numpy.typing import NDArray
from PIL import Image

from sojourn_console.ground_light import GroundLight
from sojourn_console.ground_mesh import GroundMesh
from sojourn_machine.params import FloatArray
from sojourn_physics.terrain.ground_samples import heights_of
from sojourn_physics.terrain.height_field import HeightField

MOST_VERTICES = 6_000
"""Of the whole ground, about: what a browser draws without a graphics card."""
MOST_NODES = 1_000_000
"""Of those vertices are chosen."""
FLAT = 0.002
"""What lies no farther away from its triangles is not drawn finer [m]."""
TILE = 8.0
"""Side of a tile [m]; larger on larger grounds, so that there are not too many."""
MOST_TILES = 64
PIXEL = 0.04
"""Side of a pixel [m], or what makes MOST_PIXELS of a tile."""
MOST_PIXELS = 512
DARKEST = 0.06
"""Sinkage that is drawn darkest [m]."""
GAMMA = 2.2
"""Of the picture's colours: light goes with this power of them."""
PALETTE = ((158, 150, 138), (116, 108, 100), (176, 152, 118), (134, 140, 128), (190, 176, 150), (104, 92, 84))
"""Of the soils, in the order of the ground; then again."""


@dataclass(frozen=True)
class TileKey:
    """Row and column of a tile."""

    row: int
    column: int


class GroundTiles:
    """Of one ground.

    Args:
        ground: as it was at the start.
    """

    def __init__(self, ground: HeightField) -> None:
        self.ground = ground
        x_min, x_max, y_min, y_max = ground.bounds
        width, height = x_max - x_min, y_max - y_min
        side = max(TILE, math.sqrt(width * height / MOST_TILES))
        rows, columns = self._counts = max(1, math.ceil(height / side)), max(1, math.ceil(width / side))
        self._sides = width / columns, height / rows
        side = max(self._sides)
        spacing = max(ground.resolution, math.sqrt(width * height / MOST_NODES))
        spaces = 2 ** max(0, math.floor(math.log2(side / spacing)))
        x, y = np.meshgrid(
            np.linspace(x_min, x_max, columns * spaces + 1), np.linspace(y_min, y_max, rows * spaces + 1)
        )
        z = heights_of(ground, x, y)
        self._nodes = np.stack([x, y, z], axis=2).reshape(-1, 3)
        self._mesh = GroundMesh(z, spaces, MOST_VERTICES, FLAT)
        self.light = GroundLight(ground)
        self._pixels = min(MOST_PIXELS, max(2, round(side / PIXEL)))
        self._lowered: dict[TileKey, NDArray[np.float32]] = {}

    def keys(self) -> Iterator[TileKey]:
        """Of all tiles."""
        rows, columns = self._counts
        yield from (TileKey(row, column) for row in range(rows) for column in range(columns))

    def clear(self) -> set[TileKey]:
        """Forget all ruts. Returns the tiles that had some."""
        changed = set(self._lowered)
        self._lowered.clear()
        return changed

    def lower(self, places: FloatArray, depths: FloatArray, radius: float) -> set[TileKey]:
        """Press the ground down round some places.

        Args:
            places: x, y in map, shape (n, 2) [m]. depths: by how much, (n,) [m]. radius: how far round each [m].

        Returns:
            Tiles that look otherwise now.
        """
        deep = depths > 1e-3
        places, depths = places[deep], depths[deep]
        if not len(places):
            return set()
        return {key for key in self._keys_near(places, radius) if self._press(key, places, depths, radius)}

    def glb(self, key: TileKey) -> bytes:
        """A tile as a binary glTF file."""
        x0, x1, y0, y1 = self._bounds(key)
        vertices, faces = self._triangles([key])
        uv = (vertices[:, :2] - (x0, y0)) / (x1 - x0, y1 - y0)
        image = Image.fromarray(self.picture(key))
        image.format = "JPEG"  # in which it is kept: a hundredth of the time that PNG takes, and a tenth of its size
        material = trimesh.visual.material.PBRMaterial(baseColorTexture=image, metallicFactor=0.0, roughnessFactor=1.0)
        return _glb(vertices, faces, trimesh.visual.TextureVisuals(uv=uv, material=material))

    def unseen(self) -> bytes:
        """The whole ground as a binary glTF file that shows nothing: for what falls on it."""
        material = trimesh.visual.material.PBRMaterial(
            baseColorFactor=(0, 0, 0, 0), alphaMode="MASK", alphaCutoff=0.5, metallicFactor=0.0, roughnessFactor=1.0
        )
        vertices, faces = self._triangles(self.keys())
        return _glb(vertices, faces, trimesh.visual.TextureVisuals(material=material))

    def picture(self, key: TileKey) -> NDArray[np.uint8]:
        """Colours of a tile, north up: shape (pixels, pixels, 3)."""
        x, y = self._centres(key)
        ground = self.ground
        columns, rows = (
            np.clip(np.rint((values - origin) / ground.resolution).astype(int), 0, count - 1)
            for values, origin, count in (
                (x, ground.origin_x, ground.heights.shape[1]),
                (y, ground.origin_y, ground.heights.shape[0]),
            )
        )
        palette = np.array([PALETTE[index % len(PALETTE)] for index in range(len(ground.soil_names))], dtype=float)
        colors = palette[ground.soil_index[np.ix_(rows, columns)]]
        grain = np.random.default_rng((key.row, key.column)).normal(0.0, 5.0, colors.shape[:2])
        colors = colors + grain[:, :, None]
        lowered = self._lowered.get(key)
        if lowered is not None:
            colors = colors * (1.0 - 0.62 * np.clip(lowered / DARKEST, 0.0, 1.0) ** 0.6)[:, :, None]
        lit = np.clip(colors / 255.0, 0.0, 1.0) * self.light.on(x, y) ** (1.0 / GAMMA)
        return np.clip(255.0 * lit[::-1], 0.0, 255.0).astype(np.uint8)

    def _triangles(self, keys: Iterable[TileKey]) -> tuple[FloatArray, NDArray[np.int64]]:
        """Of some tiles: vertices (n, 3) in map [m], and the three of each triangle, (m, 3)."""
        faces = np.concatenate([self._mesh.triangles(key.row, key.column) for key in keys])
        nodes, corners = np.unique(faces, return_inverse=True)
        return self._nodes[nodes], corners.reshape(-1, 3)

    def _bounds(self, key: TileKey) -> tuple[float, float, float, float]:
        x_min, _, y_min, _ = self.ground.bounds
        across, up = self._sides
        x0, y0 = x_min + key.column * across, y_min + key.row * up
        return x0, x0 + across, y0, y0 + up

    def _centres(self, key: TileKey) -> tuple[FloatArray, FloatArray]:
        x0, x1, y0, y1 = self._bounds(key)
        part = (np.arange(self._pixels) + 0.5) / self._pixels
        return x0 + part * (x1 - x0), y0 + part * (y1 - y0)

    def _keys_near(self, places: FloatArray, radius: float) -> Iterator[TileKey]:
        """Of the tiles in the rectangle round some places."""
        x_min, _, y_min, _ = self.ground.bounds
        low, high = ((edge - (x_min, y_min)) / self._sides for edge in (places.min(0) - radius, places.max(0) + radius))
        rows, columns = self._counts
        for row in range(max(0, math.floor(low[1])), min(rows - 1, math.floor(high[1])) + 1):
            for column in range(max(0, math.floor(low[0])), min(columns - 1, math.floor(high[0])) + 1):
                yield TileKey(row, column)

    def _press(self, key: TileKey, places: FloatArray, depths: FloatArray, radius: float) -> bool:
        """Press a tile down; whether it looks otherwise now. All places at once, in turn each of the pixels round them:
        a look at a run in lock-step has hundreds.
        """
        across, up = self._centres(key)
        sides = np.array([across[1] - across[0], up[1] - up[0]])
        nearest = np.rint((places - (across[0], up[0])) / sides).astype(int)
        reach = np.ceil(radius / sides).astype(int)
        is_new = False
        for offset in np.ndindex(*(2 * reach + 1)):
            column, row = (nearest + offset - reach).T
            inside = (column >= 0) & (column < self._pixels) & (row >= 0) & (row < self._pixels)
            column, row, depth, (x, y) = column[inside], row[inside], depths[inside], places[inside].T
            within = np.hypot(across[column] - x, up[row] - y) <= radius
            if not within.any():
                continue
            pixels, depth = (row[within], column[within]), depth[within].astype(np.float32)
            lowered = self._lowered.setdefault(key, np.zeros((self._pixels, self._pixels), dtype=np.float32))
            is_new |= bool((depth > lowered[pixels] + 2e-3).any())
            np.maximum.at(lowered, pixels, depth)
        return is_new


def _glb(vertices: FloatArray, faces: NDArray[np.int64], visual: trimesh.visual.TextureVisuals) -> bytes:
    """A binary glTF file of triangles that are shown as they are painted."""
    mesh = trimesh.Trimesh(vertices, faces, visual=visual, process=False)
    data = io.BytesIO()
    mesh.export(data, file_type="glb", include_normals=False, tree_postprocessor=_as_painted)
    return data.getvalue()


def _as_painted(tree: dict[str, Any]) -> None:
    """Without light of the browser's, and with no colours from the far side of a picture at its edge."""
    unlit, clamp = "KHR_materials_unlit", 33071
    tree["extensionsUsed"] = [*tree.get("extensionsUsed", ()), unlit]
    for material in tree["materials"]:
        material.setdefault("extensions", {})[unlit] = {}
    tree["samplers"] = [{"wrapS": clamp, "wrapT": clamp}]
    for texture in tree.get("textures", ()):
        texture["sampler"] = 0
