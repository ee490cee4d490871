"""The ground as tiles of triangles with a picture of its soils on each, in which ruts show as they form.

A tile has triangles fine enough for its relief and a pixel for each node of the ground, or finer: a rut is drawn in the
picture, the darker the deeper, for it is a few centimetres deep and would hardly be seen as relief.
"""

import io
import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import trimesh
from numpy.typing import NDArray
from PIL import Image
from scipy.ndimage import map_coordinates

from sojourn_machine.params import FloatArray
from sojourn_physics.terrain.height_field import HeightField

MOST_VERTICES = 60_000
"""Of the whole ground: what a laptop draws with ease."""
TILE = 8.0
"""Side of a tile [m]; larger on larger grounds, so that there are not too many."""
MOST_TILES = 64
PIXEL = 0.04
"""Side of a pixel [m], or what makes MOST_PIXELS of a tile."""
MOST_PIXELS = 512
DARKEST = 0.06
"""Sinkage that is drawn darkest [m]."""
PALETTE = ((158, 150, 138), (116, 108, 100), (176, 152, 118), (134, 140, 128), (190, 176, 150), (104, 92, 84))
"""Of the soils, in the order of the ground; then again."""


def heights_of(ground: HeightField, x: FloatArray, y: FloatArray) -> FloatArray:
    """Heights of a ground at points of any shape [m], bilinear; beyond its edge those of the edge."""
    places = np.stack([(y - ground.origin_y) / ground.resolution, (x - ground.origin_x) / ground.resolution])
    found: FloatArray = map_coordinates(ground.heights, places, order=1, mode="nearest", output=np.float64)
    return found


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
        self.side = max(TILE, math.sqrt(width * height / MOST_TILES))
        self._counts = max(1, math.ceil(height / self.side)), max(1, math.ceil(width / self.side))
        self._spacing = max(ground.resolution, math.sqrt(width * height / MOST_VERTICES))
        self._pixels = min(MOST_PIXELS, max(2, round(self.side / PIXEL)))
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
        changed: set[TileKey] = set()
        for (x, y), depth in zip(places.tolist(), depths.tolist(), strict=True):
            if depth <= 1e-3:
                continue
            for key in self._keys_near(x, y, radius):
                if self._press(key, x, y, depth, radius):
                    changed.add(key)
        return changed

    def glb(self, key: TileKey) -> bytes:
        """A tile as a binary glTF file."""
        x0, x1, y0, y1 = self._bounds(key)
        columns, rows = (max(2, math.ceil((b - a) / self._spacing) + 1) for a, b in ((x0, x1), (y0, y1)))
        x, y = np.meshgrid(np.linspace(x0, x1, columns), np.linspace(y0, y1, rows))
        z = self.heights(x, y)
        vertices = np.stack([x, y, z], axis=2).reshape(-1, 3)
        step = 0.5 * self._spacing
        slopes = [
            (self.heights(x + a, y + b) - self.heights(x - a, y - b)) / (2.0 * step)
            for a, b in ((step, 0.0), (0.0, step))
        ]
        normals = np.stack([-slopes[0], -slopes[1], np.ones_like(x)], axis=2).reshape(-1, 3)
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        first = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).ravel()
        low = np.stack([first, first + 1, first + columns], axis=1)
        high = np.stack([first + 1, first + columns + 1, first + columns], axis=1)
        uv = np.stack([(x - x0) / (x1 - x0), (y - y0) / (y1 - y0)], axis=2).reshape(-1, 2)
        material = trimesh.visual.material.PBRMaterial(
            baseColorTexture=Image.fromarray(self.picture(key)), metallicFactor=0.0, roughnessFactor=1.0
        )
        mesh = trimesh.Trimesh(
            vertices,
            np.concatenate([low, high]),
            vertex_normals=normals,
            visual=trimesh.visual.TextureVisuals(uv=uv, material=material),
            process=False,
        )
        data = io.BytesIO()
        mesh.export(data, file_type="glb")
        return data.getvalue()

    def heights(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Heights of the ground at the start at points of any shape [m]; beyond its edge those of the edge."""
        return heights_of(self.ground, x, y)

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
        return np.clip(colors[::-1], 0, 255).astype(np.uint8)

    def _bounds(self, key: TileKey) -> tuple[float, float, float, float]:
        x_min, x_max, y_min, y_max = self.ground.bounds
        x0, y0 = x_min + key.column * self.side, y_min + key.row * self.side
        return x0, min(x0 + self.side, x_max), y0, min(y0 + self.side, y_max)

    def _centres(self, key: TileKey) -> tuple[FloatArray, FloatArray]:
        x0, x1, y0, y1 = self._bounds(key)
        part = (np.arange(self._pixels) + 0.5) / self._pixels
        return x0 + part * (x1 - x0), y0 + part * (y1 - y0)

    def _keys_near(self, x: float, y: float, radius: float) -> list[TileKey]:
        x_min, _, y_min, _ = self.ground.bounds
        rows, columns = self._counts
        spans = [
            range(max(0, math.floor((at - low - radius) / self.side)),
                  min(count - 1, math.floor((at - low + radius) / self.side)) + 1)
            for at, low, count in ((y, y_min, rows), (x, x_min, columns))
        ]  # fmt: skip
        return [TileKey(row, column) for row in spans[0] for column in spans[1]]

    def _press(self, key: TileKey, x: float, y: float, depth: float, radius: float) -> bool:
        across, up = self._centres(key)
        near_x, near_y = (np.flatnonzero(np.abs(at - here) <= radius) for at, here in ((across, x), (up, y)))
        if not near_x.size or not near_y.size:
            return False
        lowered = self._lowered.setdefault(key, np.zeros((self._pixels, self._pixels), dtype=np.float32))
        part = np.ix_(near_y, near_x)
        away = np.hypot(across[near_x][None, :] - x, up[near_y][:, None] - y)
        deeper = np.where(away <= radius, np.float32(depth), np.float32(0.0))
        is_new = bool((deeper > lowered[part] + 2e-3).any())
        lowered[part] = np.maximum(lowered[part], deeper)
        return is_new
