"""Clearance between the rover and the obstacles of its map, for a pose and for a motion.

The outline, a rectangle, is covered by CIRCLES equal circles along its axis, each over a third of its length:
spacing s = (front + rear) / CIRCLES, radius r = sqrt((s / 2)^2 + half_width^2). With the distance D of each cell to
the nearest obstacle (exact Euclidean distance transform, bilinear between cells) the clearance of a pose is the least
D - r of its circles: one look at the grid for each, whatever the obstacles' number. Outside the map nothing is known
and clearance is infinite.

Sources: Ziegler & Stiller (2010), IEEE Intelligent Vehicles Symp., 518 (circles that cover a vehicle); Maurer, Qi &
Raghavan (2003), IEEE Trans. Pattern Analysis and Machine Intelligence 25(2):265 (the transform of scipy).
"""

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sojourn_flight.hazards.obstacle_map import ObstacleMap
from sojourn_flight.hazards.obstacle_params import OutlineParams
from sojourn_flight.hazards.traversability import FREE
from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray

CIRCLES = 3
AHEAD = (0.05, 0.15, 0.25)
"""Way of a wheel over which a motion is looked at before it is made [m]."""


class Circles(NamedTuple):
    """Equal circles that cover an outline."""

    places: FloatArray
    """Along x in base_link, shape (CIRCLES,) [m]."""
    radius: float
    """[m]"""


class DistanceGrid(NamedTuple):
    """Distances to obstacles on a grid in odom, for the kernels."""

    x0: float
    y0: float
    """Corner of the grid [m]."""
    cell: float
    """[m]"""
    distances: FloatArray
    """See `ClearanceMap`."""


def circles_of(outline: OutlineParams) -> Circles:
    """The circles of an outline."""
    spacing = (outline.front + outline.rear) / CIRCLES
    places = -outline.rear + spacing * (np.arange(CIRCLES, dtype=np.float64) + 0.5)
    return Circles(np.asarray(places, dtype=np.float64), math.hypot(0.5 * spacing, outline.half_width))


@dataclass(frozen=True, slots=True)
class ClearanceMap:
    """Distances to obstacles on the grid of a map."""

    x0: float
    y0: float
    cell: float
    distances: FloatArray
    """From the middle of each cell to the edge of the nearest cell with an obstacle, shape (cells, cells) [m]."""
    nearest: NDArray[np.int64]
    """Row and column of that cell, shape (2, cells, cells)."""

    @property
    def grid(self) -> DistanceGrid:
        """The distances, for the kernels."""
        return DistanceGrid(self.x0, self.y0, self.cell, self.distances)

    def at(self, x: float, y: float) -> float:
        """Distance from a place in odom to the nearest obstacle [m]."""
        return float(distance_at(self.distances, self.x0, self.y0, self.cell, x, y))

    def holds(self, x: float, y: float) -> bool:
        """Whether a place in odom is on the map."""
        row, column = self.cell_of(x, y)
        return 0 <= row < len(self.distances) and 0 <= column < len(self.distances)

    def cell_of(self, x: float, y: float) -> tuple[int, int]:
        """Row and column of a place in odom; may be off the map."""
        return math.floor((y - self.y0) / self.cell), math.floor((x - self.x0) / self.cell)

    def without(self, x: float, y: float, radius: float) -> "ClearanceMap":
        """The same with the cells about a place in odom closed, by themselves."""
        middles = self.cell * (np.arange(len(self.distances)) + 0.5)
        away = np.hypot(self.x0 + middles[np.newaxis, :] - x, self.y0 + middles[:, np.newaxis] - y)
        return replace(self, distances=np.where(away <= radius, 0.0, self.distances))

    def nearest_to(self, x: float, y: float) -> tuple[int, int] | None:
        """Row and column of the obstacle nearest to a place in odom; None where the map has none."""
        last = len(self.distances) - 1
        row, column = (min(max(place, 0), last) for place in self.cell_of(x, y))
        if not math.isfinite(self.distances[row, column]):
            return None
        return int(self.nearest[0, row, column]), int(self.nearest[1, row, column])


def clearance_in(map_: ObstacleMap, kinds: NDArray[np.int64]) -> ClearanceMap:
    """The clearance map of a judged map."""
    free = kinds == FREE
    if free.all():
        endless = np.full(kinds.shape, np.inf)
        return ClearanceMap(map_.x0, map_.y0, map_.cell, endless, np.zeros((2, *kinds.shape), dtype=np.int64))
    from scipy.ndimage import distance_transform_edt  # here: a drive without a camera need not wait for it to load

    distances, nearest = distance_transform_edt(free, return_indices=True)
    edges = np.maximum(distances - 0.5, 0.0) * map_.cell
    return ClearanceMap(map_.x0, map_.y0, map_.cell, edges, nearest.astype(np.int64))


@njit(cache=True)
def distance_at(distances: FloatArray, x0: float, y0: float, cell: float, x: float, y: float) -> float:
    """Distance to the nearest obstacle, bilinear between the middles of cells; infinite off the map."""
    size = distances.shape[0]
    column, row = (x - x0) / cell - 0.5, (y - y0) / cell - 0.5
    if not (0.0 <= column <= size - 1 and 0.0 <= row <= size - 1):
        return math.inf
    j, i = min(int(column), size - 2), min(int(row), size - 2)
    u, v = column - j, row - i
    low = distances[i, j] + u * (distances[i, j + 1] - distances[i, j])
    high = distances[i + 1, j] + u * (distances[i + 1, j + 1] - distances[i + 1, j])
    if not math.isfinite(low + high):  # a map without obstacles
        return math.inf
    found: float = low + v * (high - low)
    return found


@njit(cache=True)
def clearance_at_pose(grid: DistanceGrid, circles: Circles, x: float, y: float, yaw: float) -> float:
    """Clearance of the outline at a pose in odom [m]; below zero where a circle meets an obstacle."""
    least = math.inf
    for place in circles.places:
        east, north = x + place * math.cos(yaw), y + place * math.sin(yaw)
        found = distance_at(grid.distances, grid.x0, grid.y0, grid.cell, east, north)
        least = min(least, found - circles.radius)
    return least


@njit(cache=True)
def clearance_along(grid: DistanceGrid, circles: Circles, poses: FloatArray) -> FloatArray:
    """Clearance at poses x, y, yaw in odom, shape (n, 3): shape (n,) [m]."""
    clearances = np.empty(poses.shape[0])
    for i in range(poses.shape[0]):
        clearances[i] = clearance_at_pose(grid, circles, poses[i, 0], poses[i, 1], poses[i, 2])
    return clearances


@njit(cache=True)
def clearance_of_motion(
    grid: DistanceGrid,
    circles: Circles,
    pose: tuple[float, float, float],
    twist: tuple[float, float, float],
    reach: float,
    steps: FloatArray,
) -> tuple[float, float]:
    """Clearance now, and the least clearance over the next steps of a motion (exact arcs of SE(2)).

    Args:
        pose: x, y, yaw in odom. twist: v_x, v_y, yaw rate in base_link. reach: distance of the farthest wheel [m].
        steps: way of the fastest wheel at which to look [m].
    """
    x, y, yaw = pose
    v_x, v_y, rate = twist
    now = clearance_at_pose(grid, circles, x, y, yaw)
    least = now
    fastest = math.sqrt(v_x * v_x + v_y * v_y) + abs(rate) * reach
    if fastest == 0.0:
        return now, now
    least = math.inf
    for way in steps:
        t = way / fastest
        turn = rate * t
        if abs(turn) < 1e-9:
            sine, cosine = 1.0, 0.5 * turn
        else:
            sine, cosine = math.sin(turn) / turn, (1.0 - math.cos(turn)) / turn
        ahead, left = t * (sine * v_x - cosine * v_y), t * (cosine * v_x + sine * v_y)
        east = x + ahead * math.cos(yaw) - left * math.sin(yaw)
        north = y + ahead * math.sin(yaw) + left * math.cos(yaw)
        least = min(least, clearance_at_pose(grid, circles, east, north, yaw + turn))
    return now, least
