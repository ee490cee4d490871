"""Elevation models and soil rasters from files: GeoTIFF and 16-bit PNG (with rasterio), and .npy.

The part that a map needs is read, with a margin for its interpolation. Nothing is guessed: a file that does not say its
scale, that is in degrees, in feet, turned, or has pixels that are not square, is refused with what to do about it.
"""

import hashlib
import math
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sojourn_config.errors import ConfigError
from sojourn_config.paths import named_file
from sojourn_config.yaml_file import YamlDocument, asking_folders
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray, IntArray
from sojourn_physics.terrain.params import TerrainParams
from sojourn_physics.terrain.raster import Raster, check_scale, filled
from sojourn_physics.terrain.raster_params import RasterParams

if TYPE_CHECKING:
    import rasterio

MARGIN = 3
"""Pixels around the map that are read with it, for the interpolation."""
FINEST, COARSEST = 0.001, 1000.0
"""Sides that a pixel may have [m]."""
SQUARE = 1e-3
"""Difference of the sides of a pixel, as a part of them, that still counts as square."""


@dataclass(frozen=True, slots=True)
class Placement:
    """Where the pixels of a file are.

    Args:
        rows, columns: pixels of the file. cell: side of a pixel [m].
        west, north: of the file's outer edge in its projection [m].
    """

    rows: int
    columns: int
    cell: float
    west: float
    north: float


class RasterReader:
    """Reads the files of one terrain.

    Args:
        document: the scenario, for messages. folder: its folder. terrain: with `file`.
    """

    def __init__(self, document: YamlDocument, folder: Path, terrain: TerrainParams, params: RasterParams) -> None:
        self._document = document
        self._folder = folder
        self._terrain = terrain
        self._params = params
        self.digests: dict[str, str] = {}
        """SHA-256 of each file that was read, by the name in the scenario."""

    def read(self) -> Raster:
        """Heights and soils of the map, without holes.

        Raises:
            ConfigError: a file that is missing or cannot be used, in one sentence.
        """
        path = self._find(self._params.path, "path")
        placement, values, no_data = self._open(path, "path")
        east, north = self._origin(placement)
        window = self._window(placement, east, north)
        heights = self._metres(self._cut(values, window, "path"), no_data)
        try:
            heights = filled(heights, self._params.fill)
            check_scale(heights, placement.cell)
        except InvalidValueError as error:
            raise self._refuse(error.name, error.value, f"allowed is {error.allowed}") from error
        rows, columns = window
        soils = None
        if self._params.soil_path is not None:
            soils = self._soils(self._find(self._params.soil_path, "soil_path"), placement, window)
        return Raster(
            heights=np.ascontiguousarray(heights[::-1]),  # files begin in the north, maps in the south
            resolution=placement.cell,
            x=placement.west + (columns.start + 0.5) * placement.cell - east,
            y=placement.north - (rows.stop - 0.5) * placement.cell - north,
            soils=soils,
        )

    def _refuse(self, key: str, value: object, allowed: str) -> ConfigError:
        return ConfigError([self._document.problem(("terrain", "file", key), value, allowed)])

    def _find(self, name: str, key: str) -> Path:
        folders = asking_folders(self._document, ("terrain", "file", key), self._folder)
        found = named_file(name, (self._document.file, f"terrain.file.{key}"), *folders)
        if found is None:
            raise self._refuse(
                key, name, "there is no such file, from the folder of the scenario or the working folder"
            )
        digest = hashlib.sha256()
        with found.open("rb") as file:
            while block := file.read(1 << 20):
                digest.update(block)
        self.digests[name] = digest.hexdigest()
        return found

    def _open(self, path: Path, key: str) -> tuple[Placement, Any, float | None]:
        """Placement of a file, something to cut windows from, and its mark of a hole."""
        if path.suffix.lower() == ".npy":
            try:
                values = np.load(path, mmap_mode="r", allow_pickle=False)
            except (ValueError, OSError) as error:
                raise self._refuse(key, path.name, f"cannot be read as .npy: {error}") from error
            if values.ndim != 2 or values.dtype.kind not in "iuf":
                found = f"{path.name}: {values.dtype} of shape {values.shape}"
                raise self._refuse(key, found, "allowed are numbers of shape (rows, columns), north first")
            return self._own_placement(values.shape, path.name), values, None
        import rasterio  # loads GDAL, 0.2 s: only for a scenario that has a file for it

        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", rasterio.errors.NotGeoreferencedWarning)
                dataset = rasterio.open(path)
        except rasterio.errors.RasterioError as error:
            raise self._refuse(key, path.name, f"cannot be read as GeoTIFF or PNG: {error}") from error
        if dataset.count != 1:
            raise self._refuse(key, path.name, f"has {dataset.count} bands: allowed is 1, of heights or soils")
        if np.dtype(dataset.dtypes[0]).kind not in "iuf":
            raise self._refuse(key, path.name, f"has values of type {dataset.dtypes[0]}: allowed are real numbers")
        if dataset.driver == "PNG" and key == "path" and dataset.dtypes[0] != "uint16":
            raise self._refuse(key, path.name, f"has {dataset.dtypes[0]} pixels: allowed is a PNG of 16 bits")
        return self._placement(dataset, path.name, key), dataset, dataset.nodata

    def _own_placement(self, shape: tuple[int, int], name: str) -> Placement:
        """Of a file that says nothing of it: what the scenario says, with the south-west corner at 0, 0."""
        if self._params.cell is None:
            raise self._refuse("cell", None, f"{name} has no georeference: give the side of its pixels in metres")
        return Placement(shape[0], shape[1], self._params.cell, 0.0, shape[0] * self._params.cell)

    def _placement(self, dataset: "rasterio.DatasetReader", name: str, key: str) -> Placement:
        transform, projection = dataset.transform, dataset.crs
        if transform.is_identity:
            return self._own_placement(dataset.shape, name)
        if projection is not None and projection.is_geographic:
            advice = "reproject it to a map in metres, for example with gdalwarp -t_srs"
            raise self._refuse(key, name, f"is in degrees ({projection.to_string()}): {advice}")
        width, height = abs(transform.a), abs(transform.e)
        if transform.b or transform.d or transform.a < 0.0 or transform.e > 0.0:
            raise self._refuse(key, name, "is turned against north: allowed is a map with north up, east to the right")
        if abs(width - height) > SQUARE * width:
            raise self._refuse(key, name, f"has pixels of {width:g} x {height:g} m: allowed are square ones")
        if projection is None and (self._params.cell is None or abs(self._params.cell - width) > SQUARE * width):
            found = self._params.cell
            allowed = f"{name} does not say its projection: if its unit is the metre, give its pixel, {width:g}"
            raise self._refuse("cell", found, allowed)
        if projection is not None and not projection.is_projected:
            allowed = "has a local projection: allowed is a map projection, or none and the key cell"
            raise self._refuse(key, name, allowed)
        if projection is not None:
            unit, factor = projection.linear_units_factor
            if abs(factor - 1.0) > 1e-9:
                raise self._refuse(key, name, f"is in the unit {unit}: reproject it to a map in metres")
        if not FINEST <= width <= COARSEST:
            raise self._refuse(key, name, f"has pixels of {width:g} m: allowed is {FINEST:g} to {COARSEST:g} m")
        return Placement(dataset.height, dataset.width, width, transform.c, transform.f)

    def _origin(self, placement: Placement) -> tuple[float, float]:
        """Map (0, 0) in the file's projection [m]."""
        if self._params.east is not None and self._params.north is not None:
            return self._params.east, self._params.north
        half_width, half_height = 0.5 * placement.columns * placement.cell, 0.5 * placement.rows * placement.cell
        return placement.west + half_width, placement.north - half_height

    def _window(self, placement: Placement, east: float, north: float) -> tuple[slice, slice]:
        """Rows and columns of the file that the map needs."""
        cell, terrain = placement.cell, self._terrain
        nodes_y, nodes_x = terrain.node_counts
        x, y = terrain.origin
        west_pixel = (x + east - placement.west) / cell - 0.5
        east_pixel = west_pixel + (nodes_x - 1) * terrain.resolution / cell
        south_pixel = (placement.north - y - north) / cell - 0.5
        north_pixel = south_pixel - (nodes_y - 1) * terrain.resolution / cell
        slack = 1e-6
        if not (
            west_pixel >= -slack
            and east_pixel <= placement.columns - 1 + slack
            and north_pixel >= -slack
            and south_pixel <= placement.rows - 1 + slack
        ):
            x_min, y_max = placement.west + 0.5 * cell - east, placement.north - 0.5 * cell - north
            x_max, y_min = x_min + (placement.columns - 1) * cell, y_max - (placement.rows - 1) * cell
            allowed = (
                f"covers x {x_min:g} to {x_max:g} m and y {y_min:g} to {y_max:g} m of the map, which is larger: "
                "make size_x and size_y smaller, or move center_x and center_y"
            )
            raise self._refuse("path", self._params.path, allowed)
        return (
            _clipped(north_pixel, south_pixel, placement.rows),
            _clipped(west_pixel, east_pixel, placement.columns),
        )

    def _cut(self, values: Any, window: tuple[slice, slice], key: str) -> Any:
        """A part of a file, as it is stored."""
        if isinstance(values, np.ndarray):
            return np.array(values[window])
        import rasterio

        try:
            with values:
                return values.read(1, window=rasterio.windows.Window.from_slices(*window))
        except rasterio.errors.RasterioError as error:
            raise self._refuse(key, Path(values.name).name, f"is damaged: {error}") from error

    def _metres(self, values: Any, no_data: float | None) -> FloatArray:
        heights = np.array(values, dtype=np.float64)
        for mark in (no_data, self._params.no_data):
            if mark is not None:
                heights[values == mark] = math.nan
        heights[~np.isfinite(heights)] = math.nan
        offset = self._params.height_offset or 0.0
        return np.asarray(self._params.height_scale * heights + offset)

    def _soils(self, path: Path, placement: Placement, window: tuple[slice, slice]) -> IntArray:
        own, values, _ = self._open(path, "soil_path")
        if own != placement:
            allowed = f"its pixels are not those of {self._params.path}: allowed is the same area and resolution"
            raise self._refuse("soil_path", self._params.soil_path, allowed)
        numbers = self._cut(values, window, "soil_path")
        if numbers.dtype.kind not in "iu":
            raise self._refuse(
                "soil_path", self._params.soil_path, f"has {numbers.dtype} values: allowed are whole numbers"
            )
        known = [item.value for item in self._params.soil_classes]
        foreign = sorted(set(np.unique(numbers).tolist()) - set(known))
        if foreign:
            raise self._refuse("soil_classes", known, f"the raster also has {foreign[0]}: give its soil")
        return np.ascontiguousarray(numbers[::-1].astype(np.int64))


def _clipped(first: float, last: float, count: int) -> slice:
    """Pixels from one position to another, with the margin, as far as there are any."""
    return slice(max(0, math.floor(first) - MARGIN), min(count, math.ceil(last) + MARGIN + 1))
