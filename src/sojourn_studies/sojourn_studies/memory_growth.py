"""What processes hold in memory over a long run: samples of it, and by how much they have grown."""

import math
from collections.abc import Iterator, Sequence

import numpy as np

Sample = dict[str, float]
"""Resident memory by process [MB]."""


def growth(series: Sequence[float]) -> float:
    """By which part the last fifth of a series is above its second fifth, by their medians [-].

    In the first fifth caches and buffers fill up. NaN for fewer than five.
    """
    fifth = len(series) // 5
    if fifth == 0:
        return math.nan
    return float(np.median(series[-fifth:]) / np.median(series[fifth : 2 * fifth])) - 1.0


def told(samples: Sequence[Sample]) -> Iterator[str]:
    """A line about each process that was there at first."""
    for name in samples[0] if samples else ():
        series = [sample[name] for sample in samples if name in sample]
        part = growth(series)
        over = "" if math.isnan(part) else f", {100.0 * part:+.1f} % from the second fifth to the last"
        yield f"{name}: {series[0]:.0f} MB at first, {series[-1]:.0f} MB at last{over}"
