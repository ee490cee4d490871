"""Map of the ground round the rover, from the points of its hazard camera: a square grid in odom that rolls along.

Each cell keeps the lowest, highest and mean height of its points (odom), their number, how noisy they are (see
`stereo_camera`), from how far they were seen, and at which distance driven. Rules:

- an observation from much nearer (NEARER) than the first that is kept replaces what was known, since the error of
  stereo grows with the square of the distance; one from about as far is merged; one from farther is dropped;
- a cell that has not been seen for `memory` metres of driving is unknown again. Odometry drifts with the distance
  driven, so the map is good as far as it reaches back, and a rover that stands still forgets nothing;
- odometry's height is off where wheels slip on a climb, for all points of one observation by the same. So an
  observation is first lifted to fit what is known: by the median of its points against the means of the cells that they
  fall into;
- the grid moves by whole cells of the wide map (`wide_map`) when the rover is RECENTRE from its middle.

Ground that the camera should have seen and has not is kept apart, see `hidden_ground`.

Sources: Goldberg, Maimone & Matthies (2002), IEEE Aerospace Conf. 5:2025 (grid of height statistics from hazard
cameras, a cell of about a wheel); Fankhauser et al. (2018), IEEE Robotics and Automation Letters 3(4):3019 (map
centred on the robot, drift of its pose).
"""

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from sojourn_flight.hazards.hidden_ground import HiddenStrips, hidden_strips, is_hidden
from sojourn_flight.hazards.obstacle_params import ObstacleParams
from sojourn_flight.hazards.stereo_camera import StereoCamera, height_variances
from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray

COUNT, LOW, HIGH, MEAN, NOISE, SIGHT, SEEN_AT, HIDDEN, SLIP, LAYERS = 0, 1, 2, 3, 4, 5, 6, 7, 8, 9
"""Layers: points [-], heights in odom [m], variance of the error of a point's height [m^2], distance from the camera at
the first of the observations that are kept [m], odometer [m], 1 where hidden, slip that was found there or 0 [-].
"""
RECENTRE = 1.0
"""[m]"""
NEARER, FARTHER = 0.7, 1.2
"""Ratios of distances of two observations: below, the new one replaces the old; above, it is dropped."""
LEAST_FIT = 50
"""Points on known ground that an observation needs to be fitted to it; with fewer the last fit holds [-]."""
MOST_POINTS = 50.0
"""Weight of what is known when new points are merged [-]."""
SIGMAS = 2.0
"""So much of a difference of heights is taken for noise of the map, in standard deviations [-]."""


class CellGrid(NamedTuple):
    """Where the cells of a map are."""

    x0: float
    y0: float
    """Corner of the first cell in odom [m]."""
    cell: float
    """Side of a cell [m]."""


@dataclass(frozen=True, slots=True)
class ObstacleMap:
    """The grid; nobody writes to it after it was made."""

    x0: float
    """Corner in odom [m], a whole number of cells."""
    y0: float
    cell: float
    """Side of a cell [m]."""
    layers: FloatArray
    """Shape (LAYERS, cells, cells); row along y, column along x."""
    lift: float = 0.0
    """By so much the heights of the map are above those of odometry, as of the last observation [m]."""

    @property
    def known(self) -> "np.ndarray[tuple[int, int], np.dtype[np.bool_]]":
        """Cells of which points are kept."""
        known: np.ndarray[tuple[int, int], np.dtype[np.bool_]] = self.layers[COUNT] > 0.0
        return known

    @property
    def grid(self) -> CellGrid:
        """Where its cells are."""
        return CellGrid(self.x0, self.y0, self.cell)

    def centre(self, row: int, column: int) -> tuple[float, float]:
        """Middle of a cell in odom [m]."""
        return self.x0 + (column + 0.5) * self.cell, self.y0 + (row + 0.5) * self.cell


def empty_map(params: ObstacleParams, x: float, y: float) -> ObstacleMap:
    """Nothing known round a place in odom [m]."""
    count, cell, step = params.map.cells, params.map.cell, params.map.wide_cells
    corner = [(round(value / (step * cell)) * step - count // 2) * cell for value in (x, y)]
    return ObstacleMap(corner[0], corner[1], cell, np.zeros((LAYERS, count, count)))


def recentred(map_: ObstacleMap, x: float, y: float, step: int = 1) -> ObstacleMap:
    """The map with (x, y) near its middle, moved by a multiple of `step` cells; what leaves it is forgotten."""
    count = map_.layers.shape[1]
    middle = (map_.x0 + 0.5 * count * map_.cell, map_.y0 + 0.5 * count * map_.cell)
    if abs(x - middle[0]) <= RECENTRE and abs(y - middle[1]) <= RECENTRE:
        return map_
    right, up = (round((value - old) / (step * map_.cell)) * step for value, old in ((x, middle[0]), (y, middle[1])))
    layers = np.zeros_like(map_.layers)
    if abs(right) < count and abs(up) < count:
        old = map_.layers[:, max(up, 0) : count + min(up, 0), max(right, 0) : count + min(right, 0)]
        layers[:, max(-up, 0) : count - max(up, 0), max(-right, 0) : count - max(right, 0)] = old
    return replace(map_, x0=map_.x0 + right * map_.cell, y0=map_.y0 + up * map_.cell, layers=layers)


def with_cloud(
    params: ObstacleParams,
    map_: ObstacleMap,
    points: FloatArray,
    camera: StereoCamera,
    position: FloatArray,
    rotation: FloatArray,
    driven: float,
) -> ObstacleMap:
    """The map after one observation.

    Args:
        points: in base_link, shape (n, 3) [m]. camera: that saw them.
        position, rotation: of base_link in odom, shapes (3,) [m] and (3, 3).
        driven: odometer [m].
    """
    rolled = recentred(map_, float(position[0]), float(position[1]), params.map.wide_cells)
    layers = rolled.layers.copy()
    layers[:, layers[SEEN_AT] < driven - params.map.memory] = 0.0
    in_odom = points @ rotation.T + position
    lift = _lift(rolled, layers, in_odom)
    in_odom[:, 2] += lift
    seat, view = camera.position, params.map.view_deg
    distances = np.sqrt(((points - seat) ** 2).sum(axis=1))
    noise = height_variances(camera, points, rotation[2])
    add_points(layers, rolled.grid, in_odom, distances, noise, driven)
    outline, limits = params.outline, params.passable
    strips = hidden_strips(points, seat, outline.ride_height, view, params.map.near, limits.max_step)
    mark_hidden(layers, rolled.grid, position, np.ascontiguousarray(rotation), strips)
    return replace(rolled, layers=layers, lift=lift)


def with_slip(map_: ObstacleMap, place: tuple[float, float], radius: float, slip: float, driven: float) -> ObstacleMap:
    """The map with ground on which the wheels have slipped, round a place in odom [m]; driven: odometer [m]."""
    layers = map_.layers.copy()
    middles = map_.cell * (np.arange(layers.shape[1]) + 0.5)
    away = np.hypot(map_.x0 + middles[np.newaxis, :] - place[0], map_.y0 + middles[:, np.newaxis] - place[1])
    layers[SLIP][away <= radius] = slip
    layers[SEEN_AT][away <= radius] = driven
    return replace(map_, layers=layers)


@njit(cache=True)
def mean_variance(layers: FloatArray, row: int, column: int) -> float:
    """Variance of the mean height of a known cell [m^2]: that of a point, over the number of points."""
    return float(layers[NOISE, row, column] / layers[COUNT, row, column])


def _lift(map_: ObstacleMap, layers: FloatArray, points: FloatArray) -> float:
    """What the points, shape (n, 3) in odom, have to be lifted by to lie on the known ground [m]."""
    count = layers.shape[1]
    columns = np.floor((points[:, 0] - map_.x0) / map_.cell).astype(np.int64)
    rows = np.floor((points[:, 1] - map_.y0) / map_.cell).astype(np.int64)
    on_map = (rows >= 0) & (rows < count) & (columns >= 0) & (columns < count)
    rows, columns, heights = rows[on_map], columns[on_map], points[on_map, 2]
    known = layers[COUNT, rows, columns] > 0.0
    if np.count_nonzero(known) < LEAST_FIT:
        return map_.lift
    return float(np.median(layers[MEAN, rows[known], columns[known]] - heights[known]))


@njit(cache=True)
def add_points(
    layers: FloatArray,
    grid: CellGrid,
    points: FloatArray,
    distances: FloatArray,
    noise: FloatArray,
    driven: float,
) -> None:
    """Merge points of one observation, shape (n, 3) in odom, into the layers; `noise`: variances of their heights."""
    size = layers.shape[1]
    observation = np.zeros((6, size, size))  # number, lowest, highest, and sums: of heights, distances, variances
    for i in range(points.shape[0]):
        column = int(np.floor((points[i, 0] - grid.x0) / grid.cell))
        row = int(np.floor((points[i, 1] - grid.y0) / grid.cell))
        if not (0 <= row < size and 0 <= column < size):
            continue
        z = points[i, 2]
        if observation[0, row, column] == 0.0 or z < observation[1, row, column]:
            observation[1, row, column] = z
        if observation[0, row, column] == 0.0 or z > observation[2, row, column]:
            observation[2, row, column] = z
        observation[0, row, column] += 1.0
        observation[3, row, column] += z
        observation[4, row, column] += distances[i]
        observation[5, row, column] += noise[i]
    for row in range(size):
        for column in range(size):
            count = observation[0, row, column]
            if count == 0.0:
                continue
            mean, distance = observation[3, row, column] / count, observation[4, row, column] / count
            spread = observation[5, row, column] / count
            known = layers[COUNT, row, column]
            before = layers[SIGHT, row, column]
            if known > 0.0 and distance > FARTHER * before:
                continue
            if known == 0.0 or distance < NEARER * before:
                layers[COUNT, row, column] = count
                layers[LOW, row, column] = observation[1, row, column]
                layers[HIGH, row, column] = observation[2, row, column]
                layers[MEAN, row, column] = mean
                layers[NOISE, row, column] = spread
                layers[SIGHT, row, column] = distance
            else:
                weight = min(known, MOST_POINTS)
                layers[MEAN, row, column] = (weight * layers[MEAN, row, column] + count * mean) / (weight + count)
                layers[NOISE, row, column] = (weight * layers[NOISE, row, column] + count * spread) / (weight + count)
                layers[COUNT, row, column] = known + count
                layers[LOW, row, column] = min(layers[LOW, row, column], observation[1, row, column])
                layers[HIGH, row, column] = max(layers[HIGH, row, column], observation[2, row, column])
            layers[SEEN_AT, row, column] = driven
            layers[HIDDEN, row, column] = 0.0


@njit(cache=True)
def mark_hidden(
    layers: FloatArray, grid: CellGrid, position: FloatArray, rotation: FloatArray, strips: HiddenStrips
) -> None:
    """Set the layer HIDDEN of the unknown cells in the camera's sector."""
    size, camera = layers.shape[1], strips.camera
    for row in range(size):
        for column in range(size):
            if layers[COUNT, row, column] > 0.0:
                continue
            east = grid.x0 + (column + 0.5) * grid.cell - position[0]
            north = grid.y0 + (row + 0.5) * grid.cell - position[1]
            # in the plane of the body; the height of a cell that nobody has seen is not known
            ahead = rotation[0, 0] * east + rotation[1, 0] * north - camera[0]
            left = rotation[0, 1] * east + rotation[1, 1] * north - camera[1]
            found = is_hidden(ahead, left, strips)
            if found >= 0:
                layers[HIDDEN, row, column] = float(found)
