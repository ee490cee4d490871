"""Long curves made short for drawing, and the colours and names that pictures of bags share."""

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#333333", "#56b4e9", "#999933")
"""Distinct to colour-blind eyes too (Okabe and Ito, 2008, and two more)."""
MOST_POINTS = 3000
"""Of a curve; a longer one is drawn as the band between its least and greatest values."""
MEANS = 400
"""Stretches of time over which a long curve is averaged."""


def means(times: FloatArray, values: FloatArray, stretches: int = MEANS) -> tuple[FloatArray, FloatArray]:
    """Mean over each of so many stretches of time, at their middle; or the values where there are few."""
    if len(values) <= 2 * stretches:
        return times, values
    edges = np.linspace(times.min(), times.max(), stretches + 1)
    stretch = np.clip(np.searchsorted(edges, times, side="right") - 1, 0, stretches - 1)
    good = np.isfinite(values)
    counts = np.bincount(stretch[good], minlength=stretches)
    sums = np.bincount(stretch[good], weights=values[good], minlength=stretches)
    filled = counts > 0
    return 0.5 * (edges[:-1] + edges[1:])[filled], sums[filled] / counts[filled]


def thinned(times: FloatArray, values: FloatArray, most: int = MOST_POINTS) -> tuple[FloatArray, FloatArray]:
    """Least and greatest value of each of `most` / 2 stretches, in the order of time; every peak is kept."""
    if len(values) <= most:
        return times, values
    width = -(-len(values) // (most // 2))
    bins = -(-len(values) // width)
    padded = np.full(bins * width, np.nan)
    padded[: len(values)] = values
    blocks = padded.reshape(bins, width)
    filled_low, filled_high = np.nan_to_num(blocks, nan=np.inf), np.nan_to_num(blocks, nan=-np.inf)
    picks = np.stack([filled_low.argmin(axis=1), filled_high.argmax(axis=1)], axis=1)
    picks.sort(axis=1)
    rows = (picks + np.arange(bins)[:, np.newaxis] * width).ravel()
    rows = rows[rows < len(values)]
    return times[rows], values[rows]


def short_name(joint: str) -> str:
    """Name of a joint without what all of them share."""
    name = joint.removesuffix("_joint")
    for prefix in ("arm_", "wheel_", "steer_"):
        name = name.removeprefix(prefix)
    return name.replace("_", " ")
