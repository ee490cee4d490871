"""The ground round an arm as a camera has seen it: heights on a grid in base_link, a plane where nothing was seen.

    h(x, y): bilinear between the middles of cells, z of base_link over x, y of base_link

The arm is held against it by points on the surfaces of its shapes (surface_points.py), each of which has to keep its
link's clearance over the ground straight below it; so a point that has come under the surface is found however deep it
is. An edge is smeared over a cell, and what is narrower than a cell, or was hidden from the camera, is not in it.

It is made from a map in odom (`steering/obstacle_map`): at the middle of each cell the mean height of that cell of the
map which lies there.
"""

from dataclasses import dataclass
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from sojourn_flight.arm.chain import Chain, joint_frames
from sojourn_flight.arm.ground_plane import GroundPlane
from sojourn_flight.arm.surface_points import SurfacePoints
from sojourn_flight.hazards.obstacle_map import COUNT, MEAN, ObstacleMap
from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray

_ITERATIONS = 3
"""Times that the place of a cell in odom is looked up by its height, which moves it where base_link is tilted."""


class ReliefGrid(NamedTuple):
    """A relief (see `GroundRelief`), for the kernels."""

    heights: FloatArray
    seen: NDArray[np.bool_]
    x0: float
    y0: float
    """Middle of the first cell [m]."""
    cell: float
    plane: FloatArray
    """See `plane_row`."""


@dataclass(frozen=True, slots=True, eq=False)
class GroundRelief:
    """See the module header. Where nothing was seen `heights` are those of the plane."""

    plane: GroundPlane
    corner: tuple[float, float]  # middle of the first cell, x and y in base_link [m]
    cell: float  # [m]
    heights: FloatArray  # (nx, ny) z in base_link [m]
    seen: NDArray[np.bool_]  # (nx, ny)

    @property
    def grid(self) -> ReliefGrid:
        """For the kernels."""
        return ReliefGrid(self.heights, self.seen, self.corner[0], self.corner[1], self.cell, plane_row(self.plane))

    def height(self, x: float, y: float) -> tuple[float, bool]:
        """z of the ground at a place in base_link [m], and whether it was seen."""
        out = np.empty(2)
        ground_at(self.grid, x, y, out)
        return float(out[0]), bool(out[1] > 0.5)


Ground: TypeAlias = GroundPlane | GroundRelief


def depth_below(ground: Ground, place: FloatArray) -> float:
    """How far a place in base_link (3,) is below the ground [m]; negative above it."""
    if isinstance(ground, GroundRelief):
        return ground.height(float(place[0]), float(place[1]))[0] - float(place[2])
    return ground.height - float(np.array(ground.normal) @ place)


def plane_row(plane: GroundPlane) -> FloatArray:
    """Height over the origin of base_link, and slopes along x and y, of a plane."""
    x, y, z = plane.normal
    return np.array([plane.height / z, -x / z, -y / z])


def flat_relief(plane: GroundPlane) -> GroundRelief:
    """A plane of which nothing was seen, as a relief."""
    return GroundRelief(plane, (0.0, 0.0), 1.0, np.full((2, 2), plane.height), np.zeros((2, 2), dtype=np.bool_))


def relief_of(
    map_: ObstacleMap, position: FloatArray, rotation: FloatArray, plane: GroundPlane, reach: float
) -> GroundRelief:
    """The ground within `reach` [m] of a rover that stands at a place.

    Args:
        map_: in odom. position, rotation: of base_link in odom, (3,) [m] and (3, 3).
        plane: under the wheels, for what was not seen.
    """
    cell, count = map_.cell, int(np.ceil(reach / map_.cell))
    line = cell * np.arange(-count, count + 1)
    x, y = np.meshgrid(line, line, indexing="ij")
    height, slope_x, slope_y = plane_row(plane)
    heights = height + slope_x * x + slope_y * y
    seen = np.zeros(x.shape, dtype=np.bool_)
    size = map_.layers.shape[1]
    for _ in range(_ITERATIONS):
        places = np.stack([x, y, heights], axis=-1) @ rotation.T + position
        columns = np.floor((places[..., 0] - map_.x0) / cell).astype(np.int64)
        rows = np.floor((places[..., 1] - map_.y0) / cell).astype(np.int64)
        on_map = (rows >= 0) & (rows < size) & (columns >= 0) & (columns < size)
        rows, columns = np.clip(rows, 0, size - 1), np.clip(columns, 0, size - 1)
        seen = on_map & (map_.layers[COUNT, rows, columns] > 0.0)
        # along z of base_link to the height that the map has there
        up = (map_.layers[MEAN, rows, columns] - map_.lift - places[..., 2]) / rotation[2, 2]
        heights = np.where(seen, heights + up, heights)
    return GroundRelief(plane, (float(line[0]), float(line[0])), cell, np.ascontiguousarray(heights), seen)


@njit(cache=True)
def ground_at(grid: ReliefGrid, x: float, y: float, out: FloatArray) -> None:
    """Write the height of the ground [m] and 1 where it was seen."""
    heights, seen, plane = grid.heights, grid.seen, grid.plane
    u, v = (x - grid.x0) / grid.cell, (y - grid.y0) / grid.cell
    i, j = int(np.floor(u)), int(np.floor(v))
    if i < 0 or j < 0 or i + 1 >= heights.shape[0] or j + 1 >= heights.shape[1]:
        out[0], out[1] = plane[0] + plane[1] * x + plane[2] * y, 0.0
        return
    a, b = u - i, v - j
    below = (1.0 - b) * heights[i, j] + b * heights[i, j + 1]
    above = (1.0 - b) * heights[i + 1, j] + b * heights[i + 1, j + 1]
    out[0] = (1.0 - a) * below + a * above
    out[1] = 1.0 if seen[i, j] and seen[i + 1, j] and seen[i, j + 1] and seen[i + 1, j + 1] else 0.0


@njit(cache=True)
def go_on_over(
    chain: Chain,
    samples: FloatArray,
    surface: SurfacePoints,
    clearance: FloatArray,
    room: FloatArray,
    grid: ReliefGrid,
    allow_start: bool,
) -> tuple[int, int, float]:
    """The first sample (of m) at which a point comes too near to the ground, its shape and height over it [m]; -1.

    Args:
        surface: of the shapes.
        clearance: (shapes, 2): over ground that was not seen, and that was [m].
        room: (shapes,) written: how much nearer each shape may come than its clearance, by where it starts.
    """
    n = samples.shape[1]
    points, shapes, parents = surface.points, surface.shapes, surface.parents
    turns, places = np.empty((n, 3, 3)), np.empty((n, 3))
    ground = np.empty(2)
    least = np.empty(room.shape[0])
    room[:] = 0.0
    for k in range(samples.shape[0]):
        joint_frames(chain, samples[k], turns, places)
        least[:] = np.inf
        worst, worst_height, worst_shape = 0.0, 0.0, -1
        for p in range(points.shape[0]):
            r, t, joint = turns[parents[p] - 1], places[parents[p] - 1], points[p]
            x = t[0] + r[0, 0] * joint[0] + r[0, 1] * joint[1] + r[0, 2] * joint[2]
            y = t[1] + r[1, 0] * joint[0] + r[1, 1] * joint[1] + r[1, 2] * joint[2]
            z = t[2] + r[2, 0] * joint[0] + r[2, 1] * joint[1] + r[2, 2] * joint[2]
            ground_at(grid, x, y, ground)
            over = z - ground[0]
            margin = over - clearance[shapes[p], 1 if ground[1] > 0.5 else 0]
            least[shapes[p]] = min(least[shapes[p]], margin)
            if margin - room[shapes[p]] < worst:
                worst, worst_height, worst_shape = margin - room[shapes[p]], over, shapes[p]
        if k == 0 and allow_start:
            for shape in range(room.shape[0]):
                room[shape] = min(0.0, least[shape] - 1e-4)
        elif worst_shape >= 0:
            return k, worst_shape, worst_height
    return -1, 0, 0.0
