"""Steps and drops of a height map, without the noise of the camera that has made it.

A cell keeps the lowest and the highest of n points, of which each has an error of height of standard deviation sigma.
On smooth ground these extremes are noise alone, and they grow with n. So:

- a cell whose extremes are not farther from its mean than noise makes plausible is smooth:
  its ground is its mean. Plausible: the highest of n standard normal errors is below x with probability Phi(x)^n;
  x is taken where this is PLAUSIBLE;
- where they are, there is an edge, a stone or a wall in the cell, and each extreme is brought in by sigma e_n, the
  expected highest of n errors, e_n = Phi^-1((n - 3/8) / (n + 1/4)) (Blom 1958).

The step between two cells is the highest of the one against the lowest of the other, less what a slope explains. That
is told by the ground beyond on either side, over cells in line that have no part in the step themselves: a slope that
is found on neither side is a step. Where nothing is known on a side, the means of the two cells stand for it. No more
is explained than the slope that the rover can do.

A step is sure as far as it is beyond the noise of the two cells, of n1 and n2 points:

    2 sqrt(sigma1^2 / n1 + sigma2^2 / n2).

Of single points that the explorer's camera sees from three metres that is two centimetres, of the points within a metre
two millimetres, and less with every observation: what is in doubt from afar is decided nearby.

Sources: Blom (1958), Statistical Estimates and Transformed Beta-Variables, sec. 6.9 (e_n, within 0.01 from n = 2 on);
David & Nagaraja (2003), Order Statistics, sec. 2.1 (distribution of the extreme); Goldberg, Maimone & Matthies (2002),
IEEE Aerospace Conf. 5:2025 (steps between cells); JCGM 106:2012, The Role of Measurement Uncertainty in Conformity
Assessment (guarded rejection: refused is what is beyond a limit by the expanded uncertainty, here with coverage
factor 2). The slope from both sides is this module's.

Assumptions: errors of points are independent; those that an observation has in common (tilt, height) fall out of a
difference. Extremes are noisier than means, and slopes have an error, too; both are left out, so that too little is
taken off.
"""

import math
from statistics import NormalDist

import numpy as np

from sojourn_flight.hazards.obstacle_map import COUNT, HIGH, LOW, MEAN, NOISE, SIGMAS, mean_variance
from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray

PLAUSIBLE = 0.99
MOST = 1000
"""Points of a cell beyond which its extremes are taken for those of so many [-]."""
BEYOND = 3
"""Cells in line that tell the slope on a side of a step."""
GENTLE = 0.05
"""A slope against the step counts from here on [-]: below it is mostly noise, or the begin of another slope."""
STRAIGHT = 0.015
"""Root of the sum of squares by which they may miss a line, to be taken for a slope against the step [m]: another edge
among them would make the step seem higher."""


def _tables() -> tuple[FloatArray, FloatArray]:
    normal, counts = NormalDist(), range(1, MOST + 1)
    expected = [normal.inv_cdf((n - 0.375) / (n + 0.25)) for n in counts]
    return np.array([0.0, *expected]), np.array([0.0, *(normal.inv_cdf(PLAUSIBLE ** (1.0 / n)) for n in counts)])


EXPECTED, LARGEST = _tables()
"""Expected and largest plausible of n standard normal errors, by n."""


@njit(cache=True)
def grounds(layers: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Lowest and highest ground of each cell without the noise, each of shape (cells, cells) [m]; 0 where unknown."""
    size = layers.shape[1]
    lows, highs = np.zeros((size, size)), np.zeros((size, size))
    for row in range(size):
        for column in range(size):
            if layers[COUNT, row, column] == 0.0:
                continue
            n = min(int(layers[COUNT, row, column]), MOST)
            mean, sigma = layers[MEAN, row, column], math.sqrt(layers[NOISE, row, column])
            low, high = layers[LOW, row, column], layers[HIGH, row, column]
            if max(high - mean, mean - low) <= LARGEST[n] * sigma:
                lows[row, column] = highs[row, column] = mean
            else:
                lows[row, column] = min(low + EXPECTED[n] * sigma, mean)
                highs[row, column] = max(high - EXPECTED[n] * sigma, mean)
    return lows, highs


@njit(cache=True)
def step_at(
    layers: FloatArray, lows: FloatArray, highs: FloatArray, row: int, column: int, cell: float, max_slope: float
) -> tuple[float, float, float]:
    """Greatest rise from a cell to a neighbour (across one unknown cell if need be), greatest fall, and what of either
    is sure [m]."""
    size = layers.shape[1]
    low, high = lows[row, column], highs[row, column]
    rise = fall = sure = max(high - low - max_slope * cell, 0.0)
    for down in range(-1, 2):
        for right in range(-1, 2):
            if down == 0 and right == 0:
                continue
            for far in range(1, 3):
                i, j = row + far * down, column + far * right
                if not (0 <= i < size and 0 <= j < size):
                    break
                if layers[COUNT, i, j] == 0.0:
                    continue
                up, off = highs[i, j] - low, high - lows[i, j]
                beside = cell * math.sqrt(float(down * down + right * right))
                if max(up, off) + 2.0 * beside * max_slope > max(rise, fall):  # it may be the greatest
                    slope = (layers[MEAN, i, j] - layers[MEAN, row, column]) / (far * beside)
                    before, bent = _slope(layers, row, column, -down, -right, beside)
                    behind, bent_behind = _slope(layers, i, j, down, right, beside)
                    known = not (math.isnan(before) or math.isnan(behind))
                    straight = known and max(bent, bent_behind) < STRAIGHT
                    rough = 0.5 * cell * ((1.0 if high > low else 0.0) + (1.0 if highs[i, j] > lows[i, j] else 0.0))
                    rising = max(-before, behind) if known else slope
                    falling = max(before, -behind) if known else -slope
                    up -= _explained(rising, straight, far * beside, rough, max_slope)
                    off -= _explained(falling, straight, far * beside, rough, max_slope)
                    noise = SIGMAS * math.sqrt(mean_variance(layers, row, column) + mean_variance(layers, i, j))
                    rise, fall, sure = max(rise, up), max(fall, off), max(sure, up - noise, off - noise)
                break
    return rise, fall, sure


@njit(cache=True)
def _explained(slope: float, may_oppose: bool, way: float, rough: float, max_slope: float) -> float:
    """Rise that a slope explains; less than none where it is against the step, if it `may_oppose` [m].

    Args:
        way: from mean to mean. rough: from means to extremes; with a slope against the step they are that much nearer.
    """
    against = min(max(-slope - GENTLE, 0.0), max_slope) if may_oppose else 0.0
    likely = min(max(slope, 0.0), max_slope) - against
    return likely * max(way + (rough if likely > 0.0 else -rough), 0.0)


@njit(cache=True)
def _slope(layers: FloatArray, row: int, column: int, down: int, right: int, beside: float) -> tuple[float, float]:
    """Slope along a direction of the ground beyond a cell [-], and how far its cells are from lying in a line [m].

    The slope is not a number where fewer than two cells are known, the other is infinite with fewer than three.
    """
    size = layers.shape[1]
    n = sx = sz = sxx = sxz = szz = 0.0
    for far in range(1, BEYOND + 1):
        i, j = row + far * down, column + far * right
        if not (0 <= i < size and 0 <= j < size):
            break
        if layers[COUNT, i, j] > 0.0:
            x, z = far * beside, layers[MEAN, i, j] - layers[MEAN, row, column]
            n += 1.0
            sx += x
            sz += z
            sxx += x * x
            sxz += x * z
            szz += z * z
    if n < 2.0:
        return math.nan, math.inf
    slope = (n * sxz - sx * sz) / (n * sxx - sx * sx)
    if n < 3.0:
        return slope, math.inf
    return slope, math.sqrt(max(szz - sz * sz / n - slope * (sxz - sx * sz / n), 0.0))
