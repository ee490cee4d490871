"""Map of the ground round the rover, from the points of its hazard camera: a square grid in odom that rolls along.

Each cell keeps the lowest, highest and mean height of its points (odom), their number, from how far they were
seen, and at which distance driven. Rules:

- a look from much nearer (NEARER) replaces what was known, since the error of stereo grows with the square of the
  distance; one from about as far is merged; one from much farther is dropped;
- a cell that has not been seen for `memory` metres of driving is unknown again. Odometry drifts with the distance
  driven, so the map is good as far as it reaches back, and a rover that stands still forgets nothing;
- the grid moves by whole cells when the rover is RECENTRE from its middle.

Ground that the camera should have seen and has not is kept apart, see `hidden_ground`.

Sources: Goldberg, Maimone & Matthies (2002), IEEE Aerospace Conf. 5:2025 (grid of height statistics from hazard
cameras, a cell of about a wheel); Fankhauser et al. (2018), IEEE Robotics and Automation Letters 3(4):3019 (map
centred on the robot, drift of its pose).
"""

from dataclasses import dataclass

import numpy as np
from numba import njit

from sojourn_mechanics.params import FloatArray
from sojourn_mechanics.steering.hidden_ground import hidden_strips, is_hidden
from sojourn_mechanics.steering.obstacle_params import ObstacleParams

COUNT, LOW, HIGH, MEAN, SIGHT, SEEN_AT, HIDDEN, LAYERS = 0, 1, 2, 3, 4, 5, 6, 7
"""Layers: points [-], heights in odom [m], distance from the camera [m], odometer [m], 1 where hidden."""
RECENTRE = 1.0
"""[m]"""
NEARER, FARTHER = 0.7, 1.5
"""Ratios of distances of two looks: below, the new one replaces the old; above, it is dropped."""
MOST_POINTS = 50.0
"""Weight of what is known when new points are merged [-]."""


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

    @property
    def known(self) -> "np.ndarray[tuple[int, int], np.dtype[np.bool_]]":
        """Cells of which points are kept."""
        known: np.ndarray[tuple[int, int], np.dtype[np.bool_]] = self.layers[COUNT] > 0.0
        return known

    def centre(self, row: int, column: int) -> tuple[float, float]:
        """Middle of a cell in odom [m]."""
        return self.x0 + (column + 0.5) * self.cell, self.y0 + (row + 0.5) * self.cell


def empty_map(params: ObstacleParams, x: float, y: float) -> ObstacleMap:
    """Nothing known round a place in odom [m]."""
    count, cell = params.map.cells, params.map.cell
    corner = [(round(value / cell) - count // 2) * cell for value in (x, y)]
    return ObstacleMap(corner[0], corner[1], cell, np.zeros((LAYERS, count, count)))


def recentred(map_: ObstacleMap, x: float, y: float) -> ObstacleMap:
    """The map with (x, y) near its middle; what leaves it is forgotten."""
    count = map_.layers.shape[1]
    middle = (map_.x0 + 0.5 * count * map_.cell, map_.y0 + 0.5 * count * map_.cell)
    if abs(x - middle[0]) <= RECENTRE and abs(y - middle[1]) <= RECENTRE:
        return map_
    right, up = round((x - middle[0]) / map_.cell), round((y - middle[1]) / map_.cell)
    layers = np.zeros_like(map_.layers)
    if abs(right) < count and abs(up) < count:
        old = map_.layers[:, max(up, 0) : count + min(up, 0), max(right, 0) : count + min(right, 0)]
        layers[:, max(-up, 0) : count - max(up, 0), max(-right, 0) : count - max(right, 0)] = old
    return ObstacleMap(map_.x0 + right * map_.cell, map_.y0 + up * map_.cell, map_.cell, layers)


def with_cloud(
    params: ObstacleParams,
    map_: ObstacleMap,
    points: FloatArray,
    eye: FloatArray,
    position: FloatArray,
    rotation: FloatArray,
    driven: float,
) -> ObstacleMap:
    """The map after one look.

    Args:
        points: in base_link, shape (n, 3) [m]. eye: the camera in base_link, shape (3,) [m].
        position, rotation: of base_link in odom, shapes (3,) [m] and (3, 3).
        driven: odometer [m].
    """
    rolled = recentred(map_, float(position[0]), float(position[1]))
    layers = rolled.layers.copy()
    layers[:, layers[SEEN_AT] < driven - params.map.memory] = 0.0
    in_odom = points @ rotation.T + position
    distances = np.sqrt(((points - eye) ** 2).sum(axis=1))
    add_points(layers, rolled.x0, rolled.y0, rolled.cell, in_odom, distances, driven)
    outline, limits = params.outline, params.passable
    edges, ends = hidden_strips(points, eye, outline.ride_height, params.map.view_deg, params.map.near, limits.max_step)
    mark_hidden(layers, rolled.x0, rolled.y0, rolled.cell, position, rotation, eye, edges, ends, params.map.view_deg)
    return ObstacleMap(rolled.x0, rolled.y0, rolled.cell, layers)


@njit(cache=True)
def add_points(
    layers: FloatArray, x0: float, y0: float, cell: float, points: FloatArray, distances: FloatArray, driven: float
) -> None:
    """Merge the points of one look, shape (n, 3) in odom, seen from `distances`, into the layers."""
    size = layers.shape[1]
    look = np.zeros((5, size, size))  # number, lowest, highest, sum, sum of distances
    for i in range(points.shape[0]):
        column = int(np.floor((points[i, 0] - x0) / cell))
        row = int(np.floor((points[i, 1] - y0) / cell))
        if not (0 <= row < size and 0 <= column < size):
            continue
        z = points[i, 2]
        if look[0, row, column] == 0.0 or z < look[1, row, column]:
            look[1, row, column] = z
        if look[0, row, column] == 0.0 or z > look[2, row, column]:
            look[2, row, column] = z
        look[0, row, column] += 1.0
        look[3, row, column] += z
        look[4, row, column] += distances[i]
    for row in range(size):
        for column in range(size):
            count = look[0, row, column]
            if count == 0.0:
                continue
            mean, distance = look[3, row, column] / count, look[4, row, column] / count
            known = layers[COUNT, row, column]
            before = layers[SIGHT, row, column]
            if known > 0.0 and distance > FARTHER * before:
                continue
            if known == 0.0 or distance < NEARER * before:
                layers[COUNT, row, column] = count
                layers[LOW, row, column] = look[1, row, column]
                layers[HIGH, row, column] = look[2, row, column]
                layers[MEAN, row, column] = mean
                layers[SIGHT, row, column] = distance
            else:
                weight = min(known, MOST_POINTS)
                layers[MEAN, row, column] = (weight * layers[MEAN, row, column] + count * mean) / (weight + count)
                layers[COUNT, row, column] = known + count
                layers[LOW, row, column] = min(layers[LOW, row, column], look[1, row, column])
                layers[HIGH, row, column] = max(layers[HIGH, row, column], look[2, row, column])
                layers[SIGHT, row, column] = min(before, distance)
            layers[SEEN_AT, row, column] = driven
            layers[HIDDEN, row, column] = 0.0


@njit(cache=True)
def mark_hidden(
    layers: FloatArray,
    x0: float,
    y0: float,
    cell: float,
    position: FloatArray,
    rotation: FloatArray,
    eye: FloatArray,
    edges: FloatArray,
    ends: FloatArray,
    view_deg: float,
) -> None:
    """Set the layer HIDDEN of the unknown cells in the camera's sector, from the strips of `hidden_strips`."""
    size = layers.shape[1]
    for row in range(size):
        for column in range(size):
            if layers[COUNT, row, column] > 0.0:
                continue
            east = x0 + (column + 0.5) * cell - position[0]
            north = y0 + (row + 0.5) * cell - position[1]
            # in the plane of the body; the height of a cell that nobody has seen is not known
            ahead = rotation[0, 0] * east + rotation[1, 0] * north - eye[0]
            left = rotation[0, 1] * east + rotation[1, 1] * north - eye[1]
            found = is_hidden(ahead, left, edges, ends, view_deg)
            if found >= 0:
                layers[HIDDEN, row, column] = float(found)
