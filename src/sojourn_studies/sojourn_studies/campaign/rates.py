"""Rates of success with what is certain of them."""

from collections.abc import Sequence
from typing import NamedTuple

from scipy.stats import binomtest

CONFIDENCE = 0.95


class Rate(NamedTuple):
    """Of `runs` so many `met` their goals: their share, and the limits between which the true rate lies [1]."""

    met: int
    runs: int
    share: float
    low: float
    high: float


def rate(results: Sequence[bool], confidence: float = CONFIDENCE) -> Rate:
    """Share of successes with its exact interval by Clopper and Pearson (1934, Biometrika 26, 404; scipy's): it holds
    the true rate in at least `confidence` of all campaigns, also near 0 and 1, where a normal approximation does not.
    """
    runs, met = len(results), sum(results)
    if runs == 0:
        return Rate(0, 0, float("nan"), 0.0, 1.0)
    interval = binomtest(met, runs).proportion_ci(confidence, method="exact")
    return Rate(met, runs, met / runs, float(interval.low), float(interval.high))
