"""Ground as a height field: heights and soils at the nodes of a square grid, bilinear or bicubic between them.

Node (row i, column j) is at x = origin_x + j resolution, y = origin_y + i resolution in frame `map` (x east,
y north, z up). In a cell with u, v in 0..1 along x and y:

    h = h00 (1-u)(1-v) + h01 u (1-v) + h10 (1-u) v + h11 u v
    dh/dx = [(h01 - h00)(1-v) + (h11 - h10) v] / resolution
    dh/dy = [(h10 - h00)(1-u) + (h11 - h01) u] / resolution

(bilinear patch; Press et al., Numerical Recipes, 3rd ed., sec. 3.6). The height is continuous (C0), and the
gradient is the exact derivative of that surface: it jumps at cell edges by the second difference of the
heights. Bicubic is cubic convolution with a = -1/2, the Catmull-Rom spline, along x and y (Keys 1981, IEEE Trans.
Acoust. Speech Signal Process. 29:1153; Catmull & Rom 1974): it goes through the nodes, has a continuous gradient (C1)
and is exact for quadratics in x and y, also in the cells at the edge, where the node that is missing is extrapolated
from the last three as Keys does. It overshoots at a sharp step by up to 7 % of its height: a bilinear ground is the
better one for ledges and rocks, a bicubic one for smooth relief on a coarse grid.

Heights are kept in double precision up to DOUBLE_NODES nodes, and in single precision on larger maps (0.03 mm at 500 m
of relief); the soil index takes a byte. No sampling looks at more than 16 nodes: its cost does not depend on the size.

There is ground only from the first to the last node. Outside, the kernels return the values of the nearest
point of the edge with `inside = False`, so that a step stays finite and the caller can say that the machine
has left the map; the methods raise OutsideTerrainError.
"""

import math
from dataclasses import dataclass
from typing import Literal, TypeAlias, get_args

import numpy as np
from numpy.typing import NDArray

from sojourn_machine.errors import InvalidValueError, MachineError
from sojourn_machine.kernels import kernel, small_kernel
from sojourn_machine.params import FloatArray

MAX_NODES = 500_000_000
"""Largest grid [nodes], 2.5 GB: 1 km square at 5 cm is 400 million."""
DOUBLE_NODES = 16_000_000
"""Largest grid in double precision [nodes]: 200 m square at 5 cm, 128 MB."""
MAX_SOILS = 256

HeightArray: TypeAlias = NDArray[np.float64] | NDArray[np.float32]
SoilArray: TypeAlias = NDArray[np.uint8]
Weights: TypeAlias = tuple[float, float, float, float]
Interpolation: TypeAlias = Literal["bilinear", "bicubic"]

BICUBIC_NODES = 4
"""Least number of nodes along each side of a bicubic ground."""


class OutsideTerrainError(MachineError):
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


@small_kernel
def sample_height(
    heights: HeightArray, x0: float, y0: float, resolution: float, x: float, y: float
) -> tuple[float, float, float, bool]:
    """Height and slope at one point, bilinear. No allocation.

    Args:
        heights: shape (ny, nx), contiguous [m].
        x0, y0: position of node (0, 0) in `map` [m].
        resolution: distance of nodes [m].
        x, y: the point in `map` [m].

    Returns:
        height [m], dh/dx, dh/dy [-], inside. Off the map (or for NaN) these are of the nearest edge point.
    """
    rows, columns = heights.shape
    column, u, inside_x = _locate((x - x0) / resolution, columns)
    row, v, inside_y = _locate((y - y0) / resolution, rows)
    # float(): the rest is in double precision also where the heights are kept in single
    h00 = float(heights[row, column])
    h01 = float(heights[row, column + 1])
    h10 = float(heights[row + 1, column])
    h11 = float(heights[row + 1, column + 1])
    rise_low = h01 - h00
    rise_high = h11 - h10
    height_low = h00 + u * rise_low
    height_high = h10 + u * rise_high
    height = height_low + v * (height_high - height_low)
    dh_dx = (rise_low + v * (rise_high - rise_low)) / resolution
    dh_dy = (height_high - height_low) / resolution
    return height, dh_dx, dh_dy, inside_x and inside_y


@small_kernel
def _locate(position: float, nodes: int) -> tuple[int, float, bool]:
    """Cell of a position in nodes, place in it from 0 to 1, and whether it is on the map; else that of the edge."""
    inside = True
    # Written as "not (in range)" so that NaN counts as outside and never becomes an index.
    if not (0.0 <= position <= nodes - 1):
        inside = False
        position = nodes - 1.0 if position > 0.0 else 0.0
    cell = min(int(position), nodes - 2)
    return cell, position - cell, inside


@kernel
def _fold(cell: int, nodes: int, a: float, b: float, c: float, d: float) -> Weights:
    """Weights of the four nodes from cell - 1 on, where the first or the last of them is not on the map: its weight
    goes to the three that it is extrapolated from, h(-1) = 3 h0 - 3 h1 + h2.
    """
    if cell == 0:
        return b + 3.0 * a, c - 3.0 * a, d + a, 0.0
    if cell == nodes - 2:
        return 0.0, a + d, b - 3.0 * d, c + 3.0 * d
    return a, b, c, d


@kernel
def _cubic_weights(cell: int, nodes: int, t: float) -> tuple[int, Weights, Weights]:
    """First of four nodes in a row, their weights for the value at t in 0..1 of a cell, and for its derivative by t."""
    value = _fold(
        cell, nodes,
        t * (-0.5 + t * (1.0 - 0.5 * t)),
        1.0 + t * t * (-2.5 + 1.5 * t),
        t * (0.5 + t * (2.0 - 1.5 * t)),
        t * t * (-0.5 + 0.5 * t),
    )  # fmt: skip
    slope = _fold(
        cell, nodes,
        -0.5 + t * (2.0 - 1.5 * t),
        t * (-5.0 + 4.5 * t),
        0.5 + t * (4.0 - 4.5 * t),
        t * (-1.0 + 1.5 * t),
    )  # fmt: skip
    return min(max(cell - 1, 0), nodes - 4), value, slope


@kernel
def sample_bicubic(
    heights: HeightArray, x0: float, y0: float, resolution: float, x: float, y: float
) -> tuple[float, float, float, bool]:
    """As `sample_height`, bicubic; heights has at least BICUBIC_NODES rows and columns."""
    rows, columns = heights.shape
    column, u, inside_x = _locate((x - x0) / resolution, columns)
    row, v, inside_y = _locate((y - y0) / resolution, rows)
    first_column, along_x, slope_x = _cubic_weights(column, columns, u)
    first_row, along_y, slope_y = _cubic_weights(row, rows, v)
    height = 0.0
    dh_dx = 0.0
    dh_dy = 0.0
    for i in range(4):
        value = 0.0
        slope = 0.0
        for j in range(4):
            node = float(heights[first_row + i, first_column + j])
            value += along_x[j] * node
            slope += slope_x[j] * node
        height += along_y[i] * value
        dh_dx += along_y[i] * slope
        dh_dy += slope_y[i] * value
    return height, dh_dx / resolution, dh_dy / resolution, inside_x and inside_y


@small_kernel
def sample_ground(heights: HeightArray, grid: FloatArray, x: float, y: float) -> tuple[float, float, float, bool]:
    """Height, gradients and whether (x, y) is on the map, by the ground's own interpolation: see `HeightField.grid`."""
    found: tuple[float, float, float, bool]
    if grid[3] > 0.0:
        found = sample_bicubic(heights, grid[0], grid[1], grid[2], x, y)
    else:
        found = sample_height(heights, grid[0], grid[1], grid[2], x, y)
    return found


@small_kernel
def sample_soil(soil_index: SoilArray, x0: float, y0: float, resolution: float, x: float, y: float) -> int:
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
        soil_index: shape (ny, nx), uint8, index into soil_names.
        resolution: distance of nodes [m].
        origin_x, origin_y: position of node (0, 0) in `map` [m].
        soil_names: names of the soils, in the order of the index.
        interpolation: between the nodes.

    Raises:
        InvalidValueError: shapes that differ, a height that is not finite, an index without a name, a
            resolution that is not positive.
    """

    heights: HeightArray
    soil_index: SoilArray
    resolution: float
    origin_x: float
    origin_y: float
    soil_names: tuple[str, ...]
    interpolation: Interpolation = "bilinear"

    def __post_init__(self) -> None:
        # Own copies: nobody changes the ground from outside. Not flagged read-only, because numba takes that
        # for another type, compiles its kernels twice, and a deep copy loses the flag.
        given = np.asarray(self.heights)
        heights: HeightArray = (
            np.array(given, dtype=np.float64, order="C")
            if given.size <= DOUBLE_NODES
            else np.array(given, dtype=np.float32, order="C")
        )
        if heights.ndim != 2 or min(heights.shape) < 2 or heights.size > MAX_NODES:
            allowed = f"(ny, nx), each at least 2, {MAX_NODES} nodes at most"
            raise InvalidValueError("heights.shape", heights.shape, allowed)
        if self.interpolation not in get_args(Interpolation):
            raise InvalidValueError("interpolation", self.interpolation, " or ".join(get_args(Interpolation)))
        if self.interpolation == "bicubic" and min(heights.shape) < BICUBIC_NODES:
            raise InvalidValueError("heights.shape", heights.shape, f"{BICUBIC_NODES} nodes each way for bicubic")
        if not bool(np.isfinite(heights).all()):
            row, column = (int(position) for position in np.argwhere(~np.isfinite(heights))[0])
            value = float(heights[row, column])
            raise InvalidValueError(f"heights[{row}, {column}]", value, "a finite height [m]")
        if not (math.isfinite(self.resolution) and self.resolution > 0.0):
            raise InvalidValueError("resolution", self.resolution, "a finite number more than 0 m")
        for name in ("origin_x", "origin_y"):
            if not math.isfinite(getattr(self, name)):
                raise InvalidValueError(name, getattr(self, name), "a finite number [m]")
        count = len(self.soil_names)
        if not 1 <= count <= MAX_SOILS or len(set(self.soil_names)) != count:
            raise InvalidValueError("soil_names", self.soil_names, f"1 to {MAX_SOILS} names, each once")
        given_index = np.asarray(self.soil_index)
        if given_index.dtype.kind not in "iu" or given_index.shape != heights.shape:
            raise InvalidValueError(
                "soil_index", f"{given_index.dtype} {given_index.shape}", f"integers of shape {heights.shape}"
            )
        lowest, highest = int(given_index.min()), int(given_index.max())
        if lowest < 0 or highest >= len(self.soil_names):
            wrong = lowest if lowest < 0 else highest
            allowed = f"0 to {len(self.soil_names) - 1}, one of soil_names"
            raise InvalidValueError("soil_index", wrong, allowed)
        object.__setattr__(self, "heights", heights)
        object.__setattr__(self, "soil_index", np.array(given_index, dtype=np.uint8, order="C"))

    @property
    def grid(self) -> FloatArray:
        """For the kernels: origin_x, origin_y, resolution [m], and 1 for bicubic."""
        return np.array([self.origin_x, self.origin_y, self.resolution, float(self.interpolation == "bicubic")])

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
        height, dh_dx, dh_dy, inside = sample_ground(self.heights, self.grid, float(x), float(y))
        return float(height), float(dh_dx), float(dh_dy), bool(inside)
