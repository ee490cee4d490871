"""Measured trials of a wheel on soil, what a soil predicts for them, and how far that is off.

Errors are over the load for forces, over the radius for the sinkage, and over load times radius for the torque; a
summary is the median of their magnitudes. `driving` is what rovers do: slip from 0 and slip angles up to 45 degrees.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from sojourn_analysis.wheels.wheel_bench import RESULT_COLUMNS, check_case, solve
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray

BoolArray: TypeAlias = NDArray[np.bool_]

QUANTITIES: tuple[str, ...] = ("drawbar_pull_n", "side_force_n", "sinkage_m", "torque_nm")
"""Columns of what is measured, predicted and compared."""
DRIVING_SLIP_ANGLE = math.radians(45.5)
DRIVING_LEAST_SLIP = -0.003
"""A test bed holds a slip of zero within this."""
_RESULT = (1, 2, 0, 3)
"""Where the quantities stand in a row of `solve`'s results."""


@dataclass(frozen=True, slots=True)
class Trials:
    """Trials, one a row."""

    shapes: FloatArray
    """(count, SHAPE_COLUMNS) of `wheel_bench`."""
    cases: FloatArray
    """(count, CASE_COLUMNS) of `wheel_bench`."""
    measured: FloatArray
    """(count, len(QUANTITIES)); not-a-number where nothing was measured."""

    def __post_init__(self) -> None:
        if not len(self.cases) == len(self.shapes) == len(self.measured) or not len(self.cases):
            raise InvalidValueError("trials", len(self.cases), "at least one, with a wheel and a measurement each")
        for load, slip, angle, _ in self.cases:
            check_case(float(load), float(slip), round(math.degrees(float(angle)), 9))

    def only(self, rows: BoolArray) -> "Trials":
        """The trials of these rows; a boolean array of shape (count,)."""
        return Trials(self.shapes[rows], self.cases[rows], self.measured[rows])

    def driving(self) -> BoolArray:
        """Which trials are driving, shape (count,)."""
        result: BoolArray = (self.cases[:, 1] >= DRIVING_LEAST_SLIP) & (np.abs(self.cases[:, 2]) <= DRIVING_SLIP_ANGLE)
        return result

    def groups(self) -> NDArray[Any]:
        """Number of the group of each trial for cross-validation, shape (count,): trials of one slip angle belong
        together; with a single slip angle, trials of one slip."""
        for column in (2, 1):
            values = np.round(self.cases[:, column], 2)
            if len(np.unique(values)) > 1:
                return np.unique(values, return_inverse=True)[1]
        return np.arange(len(self.cases))


def predict(trials: Trials, soil: FloatArray) -> FloatArray:
    """Predictions for the trials, (count, len(QUANTITIES)); not-a-number where the soil does not carry the load.

    Args:
        soil: kernel row.
    """
    results = np.empty((len(trials.cases), RESULT_COLUMNS))
    solve(trials.shapes, trials.cases, soil, results)
    return results[:, _RESULT]


def errors(trials: Trials, predicted: FloatArray) -> FloatArray:
    """Relative errors, (count, len(QUANTITIES)); not-a-number where there is nothing to compare."""
    load, radius = trials.cases[:, 0], trials.shapes[:, 0]
    scale = np.stack([load, load, radius, load * radius], axis=1)
    result: FloatArray = (predicted - trials.measured) / scale
    return result


def summary(trials: Trials, predicted: FloatArray) -> dict[str, Mapping[str, float | int | None]]:
    """Median error of each quantity in percent, for all trials and for driving, with the number of trials.

    `not_carried` counts trials whose load the soil does not carry. A quantity that was not measured has None.
    """
    magnitude = 100.0 * np.abs(errors(trials, predicted))
    lost = np.isnan(predicted[:, 0])
    table: dict[str, Mapping[str, float | int | None]] = {}
    for name, rows in (("all", np.full(len(lost), True)), ("driving", trials.driving())):
        row: dict[str, float | int | None] = {"trials": int(rows.sum()), "not_carried": int(lost[rows].sum())}
        for column, quantity in enumerate(QUANTITIES):
            known = magnitude[rows, column]
            # A trial that is not carried is wrong by more than any median.
            known = np.where(lost[rows] & ~np.isnan(trials.measured[rows, column]), np.inf, known)
            known = known[~np.isnan(known)]
            median = float(np.median(known)) if len(known) else None
            row[f"{quantity.rsplit('_', 1)[0]}_error_percent"] = median
        table[name] = row
    return table
