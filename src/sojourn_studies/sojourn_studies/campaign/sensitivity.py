"""How much each input of a campaign has to do with an outcome, from the runs as they are, whatever their design.

- Rank correlation (Spearman 1904): +1 where the outcome always rises with the input, -1 where it always falls. Its
  interval is Fisher's with the variance of Bonett and Wright (2000, Psychometrika 65, 23): (1 + r^2 / 2) / (n - 3).
- First-order index S = Var(E[Y | X]) / Var(Y) (Sobol 1993): the share of the outcome's variance that is gone once the
  input is known; it sees what rises and falls again, and names as well as numbers. Estimated from given data by the
  correlation ratio over classes of X (McKay 1995; Plischke, Borgonovo and Smith 2013, Eur. J. Oper. Res. 226, 536),
  less what chance alone would give (Kelley 1935, Proc. Natl. Acad. Sci. 21, 554). Classes: the names, or sqrt(n)
  equally filled ranges: what varies within a range is not seen.
- How often chance alone gives as much: the runs are dealt to the classes at random (permutation test: Fisher 1935, The
  Design of Experiments), which holds for few runs, many classes and outcomes of any distribution, until it is sure that
  nothing is told (Besag and Clifford 1991, Biometrika 78, 301).

Inputs are taken to be independent of each other, as a campaign draws them; grids or lists that do not end evenly are
not.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.stats import norm, rankdata

from sojourn_studies.campaign.rates import CONFIDENCE

FloatArray = NDArray[np.float64]
LEAST_RUNS = 8
"""With fewer nothing is said."""
CHANCE = 0.01
"""An index that chance alone gives as often as this, or more often, is not told from nothing [1]."""
DEALS = 999
"""Of the runs to the classes at random, at most."""
_ENOUGH = round(CHANCE * (DEALS + 1))
"""Deals that give as much, after which nothing is told, however the others would be."""


class Correlation(NamedTuple):
    """Rank correlation and the limits of its interval [1]."""

    value: float
    low: float
    high: float


class FirstOrder(NamedTuple):
    """First-order index [1], and how often chance alone gives as much [1]."""

    value: float
    chance: float

    @property
    def is_told(self) -> bool:
        """Whether it is more than chance."""
        return self.chance < CHANCE


def rank_correlation(inputs: FloatArray, outcome: FloatArray, confidence: float = CONFIDENCE) -> Correlation | None:
    """Spearman's of an input with an outcome, shape (n,) each, ties at middle rank; None where either is constant."""
    count = len(inputs)
    if count < LEAST_RUNS or np.ptp(inputs) == 0.0 or np.ptp(outcome) == 0.0:
        return None
    value = float(np.corrcoef(rankdata(inputs), rankdata(outcome))[0, 1])
    bounded = float(np.clip(value, -1.0 + 1e-12, 1.0 - 1e-12))
    half = float(norm.ppf(0.5 + 0.5 * confidence)) * np.sqrt((1.0 + 0.5 * bounded**2) / (count - 3))
    low, high = np.tanh(np.arctanh(bounded) - half), np.tanh(np.arctanh(bounded) + half)
    return Correlation(value, float(low), float(high))


def first_order(classes: NDArray[np.int64], outcome: FloatArray) -> FirstOrder | None:
    """Of an input by the class of each run, shape (n,), and an outcome, shape (n,); None where nothing can be said."""
    count = len(outcome)
    if count < LEAST_RUNS or np.ptp(outcome) == 0.0:
        return None
    _, places, sizes = np.unique(classes, return_inverse=True, return_counts=True)
    groups = len(sizes)
    if groups < 2 or count <= groups:
        return None
    deviations = outcome - outcome.mean()
    total = float(deviations @ deviations)
    between = _between(np.bincount(places, deviations).astype(np.float64), sizes)
    index = 1.0 - (1.0 - between / total) * (count - 1) / (count - groups)
    return FirstOrder(min(max(index, 0.0), 1.0), _chance(deviations, sizes, between - 1e-9 * total))


def _between(sums: FloatArray, sizes: NDArray[np.int64]) -> float:
    """Sum of squares between classes, of the sum of deviations in each and its size, shape (m,) each."""
    return float(np.sum(sums**2 / sizes))


def _chance(deviations: FloatArray, sizes: NDArray[np.int64], between: float) -> float:
    """How often as much is between classes of these sizes, shape (m,), to which runs, shape (n,), are dealt at random
    [1]: the same for the same runs.
    """
    dealer, starts = np.random.default_rng(0), np.cumsum(sizes) - sizes
    as_much = 0
    for dealt in range(1, DEALS + 1):
        sums = np.add.reduceat(dealer.permutation(deviations), starts)
        as_much += _between(sums, sizes) >= between
        if as_much == _ENOUGH:
            return as_much / dealt
    return (as_much + 1) / (DEALS + 1)


def classes_of(values: Sequence[Any]) -> NDArray[np.int64]:
    """The class of each run by its input: one for each value where there are few, else equally filled ranges."""
    few = max(round(len(values) ** 0.5), 2)
    if not is_numeric(values):
        known = {value: number for number, value in enumerate(dict.fromkeys(map(str, values)))}
        return np.array([known[str(value)] for value in values], dtype=np.int64)
    numbers = np.array(values, dtype=np.float64)
    different, places = np.unique(numbers, return_inverse=True)
    if len(different) <= few:
        return np.asarray(places, dtype=np.int64)
    ranks = rankdata(numbers, method="min") - 1.0
    return np.asarray(np.minimum(ranks * few / len(values), few - 1), dtype=np.int64)


def is_numeric(values: Sequence[Any]) -> bool:
    """Whether all are numbers."""
    return all(isinstance(value, int | float) and not isinstance(value, bool) for value in values)
