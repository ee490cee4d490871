"""What came of a campaign, as values: rates of success, spread of the outcomes, what they depend on, the worst runs."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sojourn_studies.campaign.rates import Rate, rate
from sojourn_studies.campaign.row import FIGURES, LOST, MET, RAISED
from sojourn_studies.campaign.sensitivity import (
    Correlation,
    FirstOrder,
    classes_of,
    first_order,
    is_numeric,
    rank_correlation,
)

FloatArray = NDArray[np.float64]
GOALS_MET = "goals met"
"""Outcome that is 1 of a run that met its goals, and 0 of one that did not."""
OUTCOMES = (GOALS_MET, *(name for name in FIGURES if name != "soc_start"))
SHARES = (0.0, 0.05, 0.5, 0.95, 1.0)
"""Of runs, for the spread of an outcome [1]."""
MOST_GROUPS = 12
MOST_WORST = 20
Row = Mapping[str, Any]


class RunGroup(NamedTuple):
    """Runs that have an input in common: its key, the value or range in words, their rate."""

    key: str
    value: str
    rate: Rate


class Influence(NamedTuple):
    """Of an input on an outcome; `correlation` is None for names."""

    key: str
    outcome: str
    first_order: FirstOrder
    correlation: Correlation | None


@dataclass(frozen=True)
class CampaignFindings:
    """Of the rows of a campaign.

    Args:
        rows: as they are in its table, in any order. keys: columns of what varies; total: runs of the whole campaign.
    """

    rows: Sequence[Row]
    keys: Sequence[str]
    total: int

    @cached_property
    def judged(self) -> list[Row]:
        """Runs that count: all but those that were lost; one that could not be run has not met its goals."""
        return sorted((row for row in self.rows if row["result"] != LOST), key=lambda row: row["run"])

    @property
    def rate(self) -> Rate:
        """Of all runs that count."""
        return _rate(self.judged)

    @property
    def results(self) -> Counter[str]:
        """How many runs ended in which way."""
        return Counter(row["result"] for row in self.rows)

    @cached_property
    def inputs(self) -> list[str]:
        """Keys that do vary, the scenario among them."""
        return [key for key in ("scenario", *self.keys) if len({str(row[key]) for row in self.judged}) > 1]

    def groups(self) -> list[RunGroup]:
        """Rates by the values of each input, by thirds of one that has many."""
        found = []
        for key in self.inputs:
            values = [row[key] for row in self.judged]
            different = list(dict.fromkeys(values))
            if len(different) <= MOST_GROUPS:
                ordered = sorted(different) if is_numeric(different) else sorted(different, key=str)
                for value in ordered:
                    found.append(RunGroup(key, str(value), _rate([row for row in self.judged if row[key] == value])))
            elif is_numeric(values):
                edges = np.quantile(np.array(values, dtype=np.float64), [0.0, 1 / 3, 2 / 3, 1.0])
                third = np.clip(np.searchsorted(edges[1:-1], values, side="right"), 0, 2)
                for number in range(3):
                    rows = [row for row, place in zip(self.judged, third, strict=True) if place == number]
                    found.append(RunGroup(key, f"{edges[number]:.4g} to {edges[number + 1]:.4g}", _rate(rows)))
        return found

    def spreads(self) -> dict[str, FloatArray]:
        """Quantiles of each figure at SHARES, over the runs that have it."""
        found = {}
        for name in FIGURES:
            values = np.array([row[name] for row in self.judged if row[name] is not None], dtype=np.float64)
            if values.size:
                found[name] = np.quantile(values, SHARES)
        return found

    @cached_property
    def influences(self) -> list[Influence]:
        """Of every input on every outcome that varies, the strongest first."""
        found = []
        for outcome in OUTCOMES:
            told = [row for row in self.judged if _outcome(row, outcome) is not None]
            y = np.array([_outcome(row, outcome) for row in told], dtype=np.float64)
            for key in self.inputs:
                values = [row[key] for row in told]
                index = first_order(classes_of(values), y) if told else None
                if index is not None:
                    x = np.array(values, dtype=np.float64) if is_numeric(values) else None
                    found.append(Influence(key, outcome, index, None if x is None else rank_correlation(x, y)))
        return sorted(found, key=lambda one: -one.first_order.value)

    def worst(self) -> list[Row]:
        """Those that could not be run, then those that did not meet their goals, each by how far off they were."""

        def badness(row: Row) -> tuple[int, float, float, int]:
            order = {RAISED: 0, MET: 2}.get(row["result"], 1)
            share = 0.0 if not row["goals"] else row["goals_met"] / row["goals"]
            return order, share, -max(row["goal_error_m"] or 0.0, row["arm_error_m"] or 0.0), row["run"]

        return sorted(self.judged, key=badness)[:MOST_WORST]

    def reasons(self) -> list[tuple[str, int]]:
        """Why runs were lost or could not be run, the most frequent first."""
        return Counter(row["reason"] for row in self.rows if row["result"] in (RAISED, LOST)).most_common(MOST_WORST)


def _rate(rows: Sequence[Row]) -> Rate:
    return rate([row["result"] == MET for row in rows])


def _outcome(row: Row, name: str) -> float | None:
    return float(row["result"] == MET) if name == GOALS_MET else row[name]
