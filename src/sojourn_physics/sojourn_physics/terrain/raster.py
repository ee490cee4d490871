"""A raster of heights (and soils) as the ground of a map: holes, resampling.

Pixels are points at their centres. Holes (NaN) are refused, or filled where that is asked for: from the nearest
pixel, or linearly between the pixels around the hole (on a Delaunay triangulation of its rim; from the nearest where
a hole is open to the edge). Resampling is the interpolation of the height field itself, bilinear or bicubic; a map
coarser than the raster takes single points of it and does no averaging. Nothing is extrapolated: a map that is larger
than its raster is refused.
"""

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray, IntArray
from sojourn_physics.terrain.height_field import HeightField, Interpolation, sample_ground

STEEPEST_DEG = 60.0
"""RMS slope between pixels beyond which the heights cannot be in the unit that they are said to be in [degree]."""
HIGHEST = 3.0e4
"""Height that no ground exceeds [m]."""


@dataclass(frozen=True, slots=True)
class Raster:
    """Part of a file that covers a map.

    Args:
        heights: shape (ny, nx), row along +y, column along +x [m]; NaN is a hole.
        resolution: side of a pixel [m]. x, y: centre of pixel (0, 0) in map [m].
        soils: numbers of soils, shape (ny, nx), or None.
    """

    heights: FloatArray
    resolution: float
    x: float
    y: float
    soils: IntArray | None = None


def filled(heights: FloatArray, how: Literal["no", "nearest", "linear"]) -> FloatArray:
    """The heights without holes.

    Raises:
        InvalidValueError: holes that are not to be filled, or nothing but holes.
    """
    holes = ~np.isfinite(heights)
    count = int(holes.sum())
    if not count:
        return heights
    if how == "no":
        share = 100.0 * count / holes.size
        raise InvalidValueError("fill", how, f"nearest or linear: {count} of the pixels ({share:.2g} %) have no height")
    if count == holes.size:
        raise InvalidValueError("heights", "holes only", "some pixels with a height")
    from scipy import ndimage  # here: most runs have no raster, or one without holes

    nearest = ndimage.distance_transform_edt(holes, return_distances=False, return_indices=True)
    whole = heights[tuple(nearest)]
    if how == "linear":
        from scipy.interpolate import LinearNDInterpolator  # here: most runs have no raster, and it loads half of scipy

        rim = ndimage.binary_dilation(holes, structure=np.ones((3, 3))) & ~holes
        if rim.sum() >= 4 and np.ptp(np.argwhere(rim), axis=0).min() > 0:
            linear = LinearNDInterpolator(np.argwhere(rim), heights[rim])(np.argwhere(holes))
            whole[holes] = np.where(np.isfinite(linear), linear, whole[holes])
    return np.asarray(whole)


def check_scale(heights: FloatArray, resolution: float) -> None:
    """Refuse heights that are not in metres, as far as one can tell.

    Raises:
        InvalidValueError: higher than any mountain, or steeper than any ground.
    """
    highest = float(np.abs(heights).max())
    if highest > HIGHEST:
        raise InvalidValueError("height_scale", f"gives heights of {highest:.3g} m", f"at most {HIGHEST:g} m")
    rises = np.concatenate([np.diff(heights, axis=0).ravel(), np.diff(heights, axis=1).ravel()])
    slope = math.degrees(math.atan(math.sqrt(float(np.mean(rises * rises))) / resolution))
    if slope > STEEPEST_DEG:
        found = f"gives an RMS slope of {slope:.3g} degrees"
        raise InvalidValueError("height_scale", found, f"at most {STEEPEST_DEG:g}: are the heights in metres?")


def resample(
    raster: Raster, shape: tuple[int, int], origin: tuple[float, float], resolution: float, how: Interpolation
) -> FloatArray:
    """Heights of a map's nodes, of shape (ny, nx), from a raster without holes that covers it [m].

    Raises:
        InvalidValueError: the raster does not cover the map.
    """
    source = HeightField(
        heights=raster.heights,
        soil_index=np.zeros(raster.heights.shape, dtype=np.uint8),
        resolution=raster.resolution,
        origin_x=raster.x,
        origin_y=raster.y,
        soil_names=("any",),
        interpolation=how,
    )
    heights = np.empty(shape)
    outside = _resample(source.heights, source.grid, heights, origin[0], origin[1], resolution)
    if outside:
        x_min, x_max, y_min, y_max = source.bounds
        allowed = f"a map inside x {x_min:g} to {x_max:g} m, y {y_min:g} to {y_max:g} m, which the file covers"
        raise InvalidValueError("size", f"{outside} nodes are outside", allowed)
    return heights


@njit(cache=True)
def _resample(
    source: FloatArray, grid: FloatArray, heights: FloatArray, x0: float, y0: float, resolution: float
) -> int:
    """Fill heights, (ny, nx); returns how many of its nodes are off the source."""
    outside = 0
    # A node on the very edge may be a rounding error beyond it.
    x_max = grid[0] + (source.shape[1] - 1) * grid[2]
    y_max = grid[1] + (source.shape[0] - 1) * grid[2]
    slack = 1e-6 * grid[2]
    for row in range(heights.shape[0]):
        y = y0 + row * resolution
        if abs(y - grid[1]) < slack:
            y = grid[1]
        elif abs(y - y_max) < slack:
            y = y_max
        for column in range(heights.shape[1]):
            x = x0 + column * resolution
            if abs(x - grid[0]) < slack:
                x = grid[0]
            elif abs(x - x_max) < slack:
                x = x_max
            found = sample_ground(source, grid, x, y)
            heights[row, column] = found[0]
            outside += not found[3]
    return outside


def soils_at(raster: Raster, shape: tuple[int, int], origin: tuple[float, float], resolution: float) -> IntArray:
    """Numbers of the soils of the pixels nearest to a map's nodes: shape (ny, nx).

    Raises:
        InvalidValueError: a raster without soils.
    """
    if raster.soils is None:
        raise InvalidValueError("soils", None, "a raster with soils")
    indices = []
    for start, first, count, pixels in (
        (origin[1], raster.y, shape[0], raster.soils.shape[0]),
        (origin[0], raster.x, shape[1], raster.soils.shape[1]),
    ):
        nearest = np.rint((start + resolution * np.arange(count) - first) / raster.resolution)
        indices.append(np.clip(nearest, 0, pixels - 1).astype(np.int64))
    return np.asarray(raster.soils[np.ix_(indices[0], indices[1])])
