"""Ground as a height field: heights and soils at the nodes of a square grid, bilinear between them.

Node (row i, column j) is at x = origin_x + j resolution, y = origin_y + i resolution in frame `map` (x east,
y north, z up). In a cell with u, v in 0..1 along x and y:

    h = h00 (1-u)(1-v) + h01 u (1-v) + h10 (1-u) v + h11 u v
    dh/dx = [(h01 - h00)(1-v) + (h11 - h10) v] / resolution
    dh/dy = [(h10 - h00)(1-u) + (h11 - h01) u] / resolution

(bilinear patch; Press et al., Numerical Recipes, 3rd ed., sec. 3.6). The height is continuous (C0), and the
gradient is the exact derivative of that surface: it jumps at cell edges by the second difference of the
heights.

There is ground only from the first to the last node. Outside, the kernels return the values of the nearest
point of the edge with `inside = False`, so that a step stays finite and the caller can say that the machine
has left the map; the methods raise OutsideTerrainError.
"""

import math
from dataclasses import dataclass

import numpy as np
from numba import njit

from sojourn_mechanics.errors import InvalidValueError, MechanicsError
from sojourn_mechanics.params import FloatArray, IntArray

MAX_NODES = 500_000_000
"""Largest grid [nodes], 8 GB: 1 km square at 5 cm is 400 million."""


class OutsideTerrainError(MechanicsError):
    """A point where the terrain has no ground.

    Args:
        x, y: the point in `map` [m].
        bounds: x_min, x_max, y_min, y_max of the terrain [m].
    """

    def __init__(self, x: float, y: float, bounds: tuple[float, float, float, float]) -> None:
        self.x = x
        self.y = y
        self.bounds = bounds
        x_min, x_max, y_min, y_max = bounds
        super().__init__(
            f"point x = {x!r}, y = {y!r} m is off the terrain: "
            f"allowed is x from {x_min:g} to {x_max:g} m and y from {y_min:g} to {y_max:g} m"
        )


@njit(cache=True)
def sample_height(
    heights: FloatArray, x0: float, y0: float, resolution: float, x: float, y: float
) -> tuple[float, float, float, bool]:
    """Height and slope at one point. No allocation.

    Args:
        heights: shape (ny, nx), contiguous [m].
        x0, y0: position of node (0, 0) in `map` [m].
        resolution: distance of nodes [m].
        x, y: the point in `map` [m].

    Returns:
        height [m], dh/dx, dh/dy [-], inside. Off the map (or for NaN) these are of the nearest edge point.
    """
    rows, columns = heights.shape
    column_position = (x - x0) / resolution
    row_position = (y - y0) / resolution
    inside = True
    # Written as "not (in range)" so that NaN counts as outside and never becomes an index.
    if not (0.0 <= column_position <= columns - 1):
        inside = False
        column_position = columns - 1.0 if column_position > 0.0 else 0.0
    if not (0.0 <= row_position <= rows - 1):
        inside = False
        row_position = rows - 1.0 if row_position > 0.0 else 0.0
    column = min(int(column_position), columns - 2)
    row = min(int(row_position), rows - 2)
    u = column_position - column
    v = row_position - row
    h00 = heights[row, column]
    h01 = heights[row, column + 1]
    h10 = heights[row + 1, column]
    h11 = heights[row + 1, column + 1]
    rise_low = h01 - h00
    rise_high = h11 - h10
    height_low = h00 + u * rise_low
    height_high = h10 + u * rise_high
    height = height_low + v * (height_high - height_low)
    dh_dx = (rise_low + v * (rise_high - rise_low)) / resolution
    dh_dy = (height_high - height_low) / resolution
    return height, dh_dx, dh_dy, inside


@njit(cache=True)
def sample_soil(soil_index: IntArray, x0: float, y0: float, resolution: float, x: float, y: float) -> int:
    """Soil of the node nearest to a point (clamped to the map). Arguments as `sample_height`; no allocation.

    Args:
        soil_index: shape (ny, nx), index into the height field's `soil_names`.
    """
    rows, columns = soil_index.shape
    column_position = (x - x0) / resolution + 0.5
    row_position = (y - y0) / resolution + 0.5
    column = 0
    if column_position >= columns:
        column = columns - 1
    elif column_position > 0.0:
        column = int(column_position)
    row = 0
    if row_position >= rows:
        row = rows - 1
    elif row_position > 0.0:
        row = int(row_position)
    return int(soil_index[row, column])


@dataclass(frozen=True, slots=True)
class HeightField:
    """Ground of a scenario. Checked when made; keeps contiguous copies of the arrays, which nobody writes to.

    Attributes:
        heights: shape (ny, nx), ny and nx at least 2 [m]; row along +y, column along +x.
        soil_index: shape (ny, nx), int64, index into soil_names.
        resolution: distance of nodes [m].
        origin_x, origin_y: position of node (0, 0) in `map` [m].
        soil_names: names of the soils, in the order of the index.

    Raises:
        InvalidValueError: shapes that differ, a height that is not finite, an index without a name, a
            resolution that is not positive.
    """

    heights: FloatArray
    soil_index: IntArray
    resolution: float
    origin_x: float
    origin_y: float
    soil_names: tuple[str, ...]

    def __post_init__(self) -> None:
        # Own copies: nobody changes the ground from outside. Not flagged read-only, because numba takes that
        # for another type, compiles its kernels twice, and a deep copy loses the flag.
        heights = np.array(self.heights, dtype=np.float64, order="C")
        if heights.ndim != 2 or min(heights.shape) < 2 or heights.size > MAX_NODES:
            allowed = f"(ny, nx), each at least 2, {MAX_NODES} nodes at most"
            raise InvalidValueError("heights.shape", heights.shape, allowed)
        if not bool(np.isfinite(heights).all()):
            row, column = (int(position) for position in np.argwhere(~np.isfinite(heights))[0])
            value = float(heights[row, column])
            raise InvalidValueError(f"heights[{row}, {column}]", value, "a finite height [m]")
        if not (math.isfinite(self.resolution) and self.resolution > 0.0):
            raise InvalidValueError("resolution", self.resolution, "a finite number more than 0 m")
        for name in ("origin_x", "origin_y"):
            if not math.isfinite(getattr(self, name)):
                raise InvalidValueError(name, getattr(self, name), "a finite number [m]")
        if not self.soil_names or len(set(self.soil_names)) != len(self.soil_names):
            raise InvalidValueError("soil_names", self.soil_names, "at least one name, each once")
        given_index = np.asarray(self.soil_index)
        if given_index.dtype.kind not in "iu" or given_index.shape != heights.shape:
            raise InvalidValueError(
                "soil_index", f"{given_index.dtype} {given_index.shape}", f"integers of shape {heights.shape}"
            )
        soil_index = np.array(given_index, dtype=np.int64, order="C")
        lowest, highest = int(soil_index.min()), int(soil_index.max())
        if lowest < 0 or highest >= len(self.soil_names):
            wrong = lowest if lowest < 0 else highest
            allowed = f"0 to {len(self.soil_names) - 1}, one of soil_names"
            raise InvalidValueError("soil_index", wrong, allowed)
        object.__setattr__(self, "heights", heights)
        object.__setattr__(self, "soil_index", soil_index)

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """x_min, x_max, y_min, y_max of the ground in `map` [m]."""
        rows, columns = self.heights.shape
        return (
            self.origin_x,
            self.origin_x + (columns - 1) * self.resolution,
            self.origin_y,
            self.origin_y + (rows - 1) * self.resolution,
        )

    def contains(self, x: float, y: float) -> bool:
        """Whether there is ground at (x, y) in `map` [m]."""
        return self._call_kernel(x, y)[3]

    def height(self, x: float, y: float) -> float:
        """Height of the ground at (x, y) [m].

        Raises:
            OutsideTerrainError: no ground there.
        """
        return self._sample(x, y)[0]

    def gradient(self, x: float, y: float) -> tuple[float, float]:
        """dh/dx and dh/dy at (x, y) [-].

        Raises:
            OutsideTerrainError: no ground there.
        """
        _, dh_dx, dh_dy = self._sample(x, y)
        return dh_dx, dh_dy

    def normal(self, x: float, y: float) -> FloatArray:
        """Unit normal of the ground at (x, y), in `map`, pointing up: shape (3,).

        Raises:
            OutsideTerrainError: no ground there.
        """
        _, dh_dx, dh_dy = self._sample(x, y)
        normal = np.array([-dh_dx, -dh_dy, 1.0], dtype=np.float64)
        normal /= math.sqrt(dh_dx * dh_dx + dh_dy * dh_dy + 1.0)
        return normal

    def soil_name(self, x: float, y: float) -> str:
        """Name of the soil of the node nearest to (x, y).

        Raises:
            OutsideTerrainError: no ground there.
        """
        self._sample(x, y)
        origin = (self.origin_x, self.origin_y)
        index = int(sample_soil(self.soil_index, *origin, self.resolution, float(x), float(y)))
        return self.soil_names[index]

    def _sample(self, x: float, y: float) -> tuple[float, float, float]:
        height, dh_dx, dh_dy, inside = self._call_kernel(x, y)
        if not inside:
            raise OutsideTerrainError(x, y, self.bounds)
        return height, dh_dx, dh_dy

    def _call_kernel(self, x: float, y: float) -> tuple[float, float, float, bool]:
        origin = (self.origin_x, self.origin_y)
        height, dh_dx, dh_dy, inside = sample_height(self.heights, *origin, self.resolution, float(x), float(y))
        return float(height), float(dh_dx), float(dh_dy), bool(inside)
