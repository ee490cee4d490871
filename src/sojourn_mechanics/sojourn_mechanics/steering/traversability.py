"""What of the ground the rover cannot pass: steps, drops, slopes, bumps, hidden ground, cell by cell.

- Step: the height of a cell against its eight neighbours (across one unknown cell if need be), and within it, without
  what noise and slope explain, see `steps`. A cell at the foot is a `step`, one at the top a `drop`.
- Slope: gradient of the plane of least squares through the mean heights within `reach` of a cell, without those of
  steps, so that a rock is no slope.
- Bump: highest point within `reach` above that plane, which would touch the belly.
- Hidden: see `hidden_ground`.

Sources: Goldberg, Maimone & Matthies (2002), IEEE Aerospace Conf. 5:2025 (step, tilt and roughness of planes fitted
to patches of the rover's size); Biesiadecki & Maimone (2006), IEEE Aerospace Conf. (their use on Mars).

Assumptions: the rover's limits hold for any heading; friction and sinkage are in these limits. Lengths [m].
"""

import math
from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from sojourn_mechanics.params import FloatArray
from sojourn_mechanics.steering.obstacle_map import COUNT, HIDDEN, HIGH, LOW, MEAN, ObstacleMap
from sojourn_mechanics.steering.obstacle_params import ObstacleParams
from sojourn_mechanics.steering.steps import grounds, step_at

FREE, STEP, DROP, SLOPE, BUMP, HIDDEN_GROUND = 0, 1, 2, 3, 4, 5
NAMES = ("free ground", "step", "drop", "slope", "bump", "hidden ground")
NEARBY = 3
"""Cells round one for whose worst it is reported."""
LEAST_PATCH = 6
"""Fewer cells make no plane."""


@dataclass(frozen=True, slots=True)
class Obstacle:
    """One cell that the rover cannot pass."""

    kind: str
    x: float
    """In odom [m]."""
    y: float
    measured: float
    """Height [m] or slope [degree]; not a number for hidden ground."""
    limit: float

    def __str__(self) -> str:
        place = f"at ({self.x:.2f}, {self.y:.2f})"
        if self.kind == "hidden ground":
            return f"hidden ground (a drop?) {place}"
        unit, digits = ("°", 0) if self.kind == "slope" else (" m", 2)
        return f"{self.kind} of {self.measured:.{digits}f}{unit} {place}, limit {self.limit:.{digits}f}{unit}"


@dataclass(frozen=True, slots=True)
class Passability:
    """The judged map."""

    kinds: NDArray[np.int64]
    """FREE or what is there, shape (cells, cells)."""
    measures: FloatArray
    """Height [m] or slope [degree], of the same shape."""


def judged(params: ObstacleParams, map_: ObstacleMap) -> Passability:
    """What each cell is. `reach` is half the outline's width: a patch as wide as the rover."""
    limits = params.passable
    kinds, measures = judge_cells(
        map_.layers,
        map_.cell,
        limits.max_step,
        math.tan(math.radians(limits.max_slope_deg)),
        limits.clearance,
        params.outline.half_width,
    )
    return Passability(kinds, measures)


def obstacle_at(
    params: ObstacleParams, map_: ObstacleMap, ground: Passability, row: int, column: int, level: float
) -> Obstacle:
    """What is in a cell that is not free, by its worst cell nearby.

    Args:
        level: height of the ground under the rover [m]; what rises above it is a step, what does not a drop.
    """
    kind, limits = int(ground.kinds[row, column]), params.passable
    if kind in (STEP, DROP):
        rows, columns = (slice(max(place - NEARBY, 0), place + NEARBY + 1) for place in (row, column))
        part = np.where(ground.kinds[rows, columns] <= DROP, ground.measures[rows, columns], 0.0)
        worst = np.unravel_index(int(np.argmax(part)), part.shape)
        row, column = rows.start + int(worst[0]), columns.start + int(worst[1])
        low, high = map_.layers[LOW, row, column], map_.layers[HIGH, row, column]
        top = low + ground.measures[row, column] if ground.kinds[row, column] == STEP else high
        kind = STEP if top > level + 0.5 * limits.max_step else DROP
    limit = {SLOPE: limits.max_slope_deg, BUMP: limits.clearance}.get(kind, limits.max_step)
    x, y = map_.centre(row, column)
    return Obstacle(NAMES[kind], x, y, float(ground.measures[row, column]), limit)


@njit(cache=True)
def judge_cells(
    layers: FloatArray, cell: float, max_step: float, max_slope: float, clearance: float, reach: float
) -> tuple[NDArray[np.int64], FloatArray]:
    """Kinds and measures of all cells, see the module; max_slope as a tangent."""
    size = layers.shape[1]
    kinds = np.zeros((size, size), np.int64)
    measures = np.zeros((size, size))
    lows, highs = grounds(layers)
    for row in range(size):
        for column in range(size):
            if layers[COUNT, row, column] > 0.0:
                rise, fall = step_at(layers, lows, highs, row, column, cell, max_slope)
                measures[row, column] = max(rise, fall)
                if measures[row, column] > max_step:
                    kinds[row, column] = STEP if rise >= fall else DROP
            elif layers[HIDDEN, row, column] > 0.0:
                kinds[row, column] = HIDDEN_GROUND
                measures[row, column] = math.nan
    stepped = kinds.copy()
    wide = math.ceil(reach / cell)
    for row in range(size):
        for column in range(size):
            if layers[COUNT, row, column] == 0.0 or stepped[row, column] != FREE:
                continue
            slope, bump = _plane(layers, stepped, row, column, cell, wide, reach)
            if slope > max_slope:
                kinds[row, column] = SLOPE
                measures[row, column] = math.degrees(math.atan(slope))
            elif bump > clearance:
                kinds[row, column] = BUMP
                measures[row, column] = bump
    return kinds, measures


@njit(cache=True)
def _plane(
    layers: FloatArray, stepped: NDArray[np.int64], row: int, column: int, cell: float, wide: int, reach: float
) -> tuple[float, float]:
    """Gradient of the plane through a patch [-], and the highest point above it [m]; zeros where it is too small."""
    size = layers.shape[1]
    n = sx = sy = sz = sxx = sxy = syy = sxz = syz = 0.0
    for i in range(max(row - wide, 0), min(row + wide + 1, size)):
        for j in range(max(column - wide, 0), min(column + wide + 1, size)):
            x, y = (j - column) * cell, (i - row) * cell
            if layers[COUNT, i, j] == 0.0 or stepped[i, j] != FREE or x * x + y * y > reach * reach:
                continue
            z = layers[MEAN, i, j]
            n += 1.0
            sx += x
            sy += y
            sz += z
            sxx += x * x
            sxy += x * y
            syy += y * y
            sxz += x * z
            syz += y * z
    if n < LEAST_PATCH:
        return 0.0, 0.0
    sxx -= sx * sx / n
    sxy -= sx * sy / n
    syy -= sy * sy / n
    sxz -= sx * sz / n
    syz -= sy * sz / n
    determinant = sxx * syy - sxy * sxy
    if determinant < 0.05 * (sxx + syy) ** 2:  # cells in a row: no plane
        return 0.0, 0.0
    a = (syy * sxz - sxy * syz) / determinant
    b = (sxx * syz - sxy * sxz) / determinant
    c = (sz - a * sx - b * sy) / n
    bump = 0.0
    for i in range(max(row - wide, 0), min(row + wide + 1, size)):
        for j in range(max(column - wide, 0), min(column + wide + 1, size)):
            x, y = (j - column) * cell, (i - row) * cell
            if layers[COUNT, i, j] == 0.0 or stepped[i, j] != FREE or x * x + y * y > reach * reach:
                continue
            bump = max(bump, layers[HIGH, i, j] - a * x - b * y - c)
    return math.sqrt(a * a + b * b), bump
