"""What of the ground no part of the rover may meet: steps, drops, bumps, hidden ground, cell by cell; and its slope.

- Step: the height of a cell against its eight neighbours (across one unknown cell if need be), and within it, without
  what noise and slope explain, see `steps`. A cell at the foot is a `step`, one at the top a `drop`. It is closed where
  it or one beside it is surely beyond the limit: noise of two cells alone closes nothing, and of a stone that is seen
  for sure nothing is left out.
- Bump: highest point within `reach` of a cell above its plane, which would touch the belly.
- Hidden: see `hidden_ground`.
- Loose: ground on which the wheels have slipped too much, see `slip_policy`.
- Slope: gradient of the plane of least squares through the mean heights within `reach` of a cell, without those of
  steps, so that a rock is no slope; with its standard deviation, from what the cells are off the plane. A slope closes
  no cell: what it means depends on the direction driven, see `detour_search` (plans) and `settling` (poses).

What was closed by a step or a bump stays so until it is below its limit by the part `hysteresis`: noise about a limit
does not open and close the way with every observation.

Sources: Goldberg, Maimone & Matthies (2002), IEEE Aerospace Conf. 5:2025 (step, tilt and roughness of planes fitted
to patches of the rover's size); Biesiadecki & Maimone (2006), IEEE Aerospace Conf. (their use on Mars); Canny (1986),
IEEE Trans. Pattern Analysis and Machine Intelligence 8(6):679 (two thresholds: what is beyond the lower one counts
beside what is beyond the higher one).

Assumption: steps and bumps are the same from any side. Lengths [m].
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sojourn_flight.hazards.obstacle_map import COUNT, HIDDEN, HIGH, LOW, MEAN, SLIP, ObstacleMap
from sojourn_flight.hazards.obstacle_params import ObstacleParams
from sojourn_flight.hazards.settling import SettlingGround
from sojourn_flight.hazards.steps import grounds, step_at
from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray

FREE, STEP, DROP, BUMP, HIDDEN_GROUND, LOOSE = 0, 1, 2, 3, 4, 5
NAMES = ("free ground", "step", "drop", "bump", "hidden ground", "loose ground")
SLOPES = ("climb", "descent", "side slope")
"""Names of tilts beyond their limits, in the order of TiltLimits."""
NEARBY = 3
"""Cells round one for whose worst it is reported."""
ALMOST = 0.8
"""A slope that is so near to the least limit may be more than it at another pose [-]."""
LEAST_PATCH = 6
"""Fewer cells make no plane."""
NO_HEIGHT = 1e-9
"""By so much the rounding of a sum may raise a cell [m]."""


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
        if self.kind == "loose ground":
            return f"{self.kind} {place}, slip {self.measured:.2f}"
        unit, digits = ("°", 0) if self.kind in SLOPES else (" m", 2)
        return f"{self.kind} of {self.measured:.{digits}f}{unit} {place}, limit {self.limit:.{digits}f}{unit}"


@dataclass(frozen=True, slots=True)
class Passability:
    """The judged map."""

    x0: float
    y0: float
    """Corner of its map in odom [m]."""
    kinds: NDArray[np.int64]
    """FREE or what is there, shape (cells, cells)."""
    measures: FloatArray
    """Height [m] or slip [-], of the same shape."""
    slopes: FloatArray
    """Gradient of the ground in odom, along x and y, and its standard deviation, shape (3, cells, cells) [-]; zeros
    where it is not known."""
    steep: NDArray[np.bool_]
    """Cells with a slope within NEARBY cells that is beyond the least of the limits, or not far below it."""

    def steep_near(self, row: int, column: int) -> bool:
        """Whether a slope about a cell may be beyond a limit."""
        size = len(self.kinds)
        return 0 <= row < size and 0 <= column < size and bool(self.steep[row, column])

    def under(self, map_: ObstacleMap) -> SettlingGround:
        """What the chassis settles on; the map is that which was judged."""
        return SettlingGround(map_.layers, self.kinds, self.slopes, map_.x0, map_.y0, map_.cell)


def judged(params: ObstacleParams, map_: ObstacleMap, before: Passability | None = None) -> Passability:
    """What each cell is. `reach` is half the outline's width: a patch as wide as the rover.

    Args:
        before: what was thought of the map before its last observation, None at first.
    """
    from scipy.ndimage import maximum_filter  # here: a drive without a camera need not wait for it to load

    limits = params.passable
    tilts = limits.tilts
    kinds, measures, slopes = judge_cells(
        map_.layers,
        map_.cell,
        _eased(map_, before, limits.hysteresis),
        limits.max_step,
        max(tilts),
        limits.clearance,
        params.outline.half_width,
    )
    steep = np.square(slopes[0]) + np.square(slopes[1]) > (ALMOST * min(tilts)) ** 2
    steep = maximum_filter(steep, 2 * NEARBY + 1, mode="wrap")
    return Passability(map_.x0, map_.y0, kinds, measures, slopes, steep)


def _eased(map_: ObstacleMap, before: Passability | None, hysteresis: float) -> FloatArray:
    """Factor on the limits of each cell: less than one where a step or a bump was, shape (cells, cells) [-]."""
    size = map_.layers.shape[1]
    factors = np.ones((size, size))
    if before is not None:
        right, up = (round((new - old) / map_.cell) for new, old in ((map_.x0, before.x0), (map_.y0, before.y0)))
        if abs(right) < size and abs(up) < size:
            old = before.kinds[max(up, 0) : size + min(up, 0), max(right, 0) : size + min(right, 0)]
            part = factors[max(-up, 0) : size - max(up, 0), max(-right, 0) : size - max(right, 0)]
            part[(old == STEP) | (old == DROP) | (old == BUMP)] = 1.0 - hysteresis
    return factors


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
        steps = (ground.kinds[rows, columns] == STEP) | (ground.kinds[rows, columns] == DROP)
        part = np.where(steps, ground.measures[rows, columns], 0.0)
        worst = np.unravel_index(int(np.argmax(part)), part.shape)
        row, column = rows.start + int(worst[0]), columns.start + int(worst[1])
        low, high = map_.layers[LOW, row, column], map_.layers[HIGH, row, column]
        top = low + ground.measures[row, column] if ground.kinds[row, column] == STEP else high
        kind = STEP if top > level + 0.5 * limits.max_step else DROP
    limit = limits.clearance if kind == BUMP else limits.max_step
    x, y = map_.centre(row, column)
    return Obstacle(NAMES[kind], x, y, float(ground.measures[row, column]), limit)


@njit(cache=True)
def judge_cells(
    layers: FloatArray,
    cell: float,
    eased: FloatArray,
    max_step: float,
    max_slope: float,
    clearance: float,
    reach: float,
) -> tuple[NDArray[np.int64], FloatArray, FloatArray]:
    """Kinds, measures and slopes of all cells, see the module.

    Args:
        eased: factor on the limits of each cell, shape (cells, cells) [-].
        max_slope: steepest that explains a difference of height, as a tangent [-].
    """
    size = layers.shape[1]
    kinds = np.zeros((size, size), np.int64)
    measures = np.zeros((size, size))
    slopes = np.zeros((3, size, size))
    lows, highs = grounds(layers)
    sure = np.zeros((size + 2, size + 2), np.bool_)
    for row in range(size):
        for column in range(size):
            if layers[COUNT, row, column] > 0.0:
                rise, fall, at_least = step_at(layers, lows, highs, row, column, cell, max_slope)
                measures[row, column] = max(rise, fall)
                if measures[row, column] > eased[row, column] * max_step:
                    kinds[row, column] = STEP if rise >= fall else DROP
                    sure[row + 1, column + 1] = at_least > eased[row, column] * max_step
    for row in range(size):
        for column in range(size):
            if layers[COUNT, row, column] > 0.0:
                if kinds[row, column] != FREE and not sure[row : row + 3, column : column + 3].any():
                    kinds[row, column] = FREE
            elif layers[HIDDEN, row, column] > 0.0:
                kinds[row, column] = HIDDEN_GROUND
                measures[row, column] = math.nan
            if layers[SLIP, row, column] > 0.0:
                kinds[row, column] = LOOSE
                measures[row, column] = layers[SLIP, row, column]
    usable = (layers[COUNT] != 0.0) & (kinds == FREE)
    disc = _disc(reach, cell)
    for row in range(size):
        for column in range(size):
            if not usable[row, column]:
                continue
            limit = eased[row, column] * clearance
            a, b, sigma, bump = _plane(layers, usable, disc, (row, column), cell, limit)
            slopes[0, row, column], slopes[1, row, column], slopes[2, row, column] = a, b, sigma
            if bump > limit:
                kinds[row, column] = BUMP
                measures[row, column] = bump
    return kinds, measures, slopes


@njit(cache=True)
def _disc(reach: float, cell: float) -> NDArray[np.int64]:
    """Half the width of a disc in each row of cells, from its middle on [cells]."""
    wide = math.ceil(reach / cell)
    disc = np.full(wide + 1, -1)
    for off in range(wide + 1):
        for across in range(wide + 1):
            x, y = across * cell, off * cell
            if x * x + y * y <= reach * reach:
                disc[off] = across
    return disc


@njit(cache=True)
def _plane(
    layers: FloatArray,
    usable: NDArray[np.bool_],
    disc: NDArray[np.int64],
    middle: tuple[int, int],
    cell: float,
    limit: float,
) -> tuple[float, float, float, float]:
    """Gradient of the plane through a patch along x and y, its standard deviation [-], and the highest point above the
    plane [m], 0 where none can be above `limit`; zeros where the patch is too small.

    Args:
        usable: cells that the plane is of. disc: the patch, see `_disc`. middle: of the patch, row and column.
    """
    size, wide, (row, column) = layers.shape[1], disc.shape[0] - 1, middle
    n = sx = sy = sz = sxx = sxy = syy = sxz = syz = szz = 0.0
    highest = -math.inf
    for i in range(max(row - wide, 0), min(row + wide + 1, size)):
        half, y = disc[abs(i - row)], (i - row) * cell
        for j in range(max(column - half, 0), min(column + half + 1, size)):
            if not usable[i, j]:
                continue
            x, z = (j - column) * cell, layers[MEAN, i, j]
            highest = max(highest, layers[HIGH, i, j])
            n += 1.0
            sx += x
            sy += y
            sz += z
            sxx += x * x
            sxy += x * y
            syy += y * y
            sxz += x * z
            syz += y * z
            szz += z * z
    if n < LEAST_PATCH:
        return 0.0, 0.0, 0.0, 0.0
    sxx -= sx * sx / n
    sxy -= sx * sy / n
    syy -= sy * sy / n
    sxz -= sx * sz / n
    syz -= sy * sz / n
    szz -= sz * sz / n
    determinant = sxx * syy - sxy * sxy
    if determinant < 0.05 * (sxx + syy) ** 2:  # cells in a row: no plane
        return 0.0, 0.0, 0.0, 0.0
    a = (syy * sxz - sxy * syz) / determinant
    b = (sxx * syz - sxy * sxz) / determinant
    c = (sz - a * sx - b * sy) / n
    off = max(szz - a * sxz - b * syz, 0.0) / (n - 3.0)
    sigma = math.sqrt(off * max(sxx, syy) / determinant)
    if highest - c + wide * cell * (abs(a) + abs(b)) < limit - NO_HEIGHT:
        return a, b, sigma, 0.0
    bump = 0.0
    for i in range(max(row - wide, 0), min(row + wide + 1, size)):
        half, y = disc[abs(i - row)], (i - row) * cell
        for j in range(max(column - half, 0), min(column + half + 1, size)):
            if usable[i, j]:
                x = (j - column) * cell
                bump = max(bump, layers[HIGH, i, j] - a * x - b * y - c)
    return a, b, sigma, bump
