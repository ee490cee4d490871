"""Adds up what is not equal in one topic, field by field."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sojourn_bags.comparison_result import FieldDifference, UnequalValues

_Spot = tuple[int, int, Any, Any, float]
"""Pair, element (-1 for none), the two values, their difference."""


@dataclass
class _Sum:
    kind: str
    tolerance: float
    pairs: int
    beyond: int
    first: _Spot
    largest: _Spot
    first_beyond: _Spot | None


class Tally:
    """Differences of one topic. Pairs are numbered in the order of time, and may come in any order."""

    def __init__(self) -> None:
        self._sums: dict[str, _Sum] = {}

    def add(
        self,
        path: str,
        kind: str,
        pairs: NDArray[np.int64],
        unequal: NDArray[np.bool_],
        differences: NDArray[np.float64],
        tolerance: float,
        values: Callable[[int, int], tuple[Any, Any]],
    ) -> None:
        """Add the comparison of one field in many pairs.

        Args:
            path: the field. pairs: numbers of the pairs, shape (n,).
            unequal, differences: shape (n,), or (n, k) for arrays. tolerance: or shape (n,), for each pair.
            values: the two values at (row, element).
        """
        if not unequal.any():
            return
        if unequal.ndim == 1:
            unequal, differences = unequal[:, np.newaxis], differences[:, np.newaxis]
            single = True
        else:
            single = False
        beyond = unequal & (differences > tolerance)

        def spot(chosen: NDArray[np.bool_]) -> _Spot:
            rows = np.flatnonzero(chosen.any(axis=1))
            row = int(rows[np.argmin(pairs[rows])])
            element = int(np.argmax(chosen[row]))
            return self._spot(row, element, single, pairs, differences, values)

        masked = np.where(unequal, differences, -1.0)
        top = masked.max()
        found = _Sum(
            kind,
            tolerance,
            int(unequal.any(axis=1).sum()),
            int(beyond.any(axis=1).sum()),
            spot(unequal),
            spot(masked == top),
            spot(beyond) if beyond.any() else None,
        )
        known = self._sums.get(path)
        self._sums[path] = found if known is None else _joined(known, found)

    def add_single(
        self, path: str, kind: str, pair: int, one: Any, other: Any, difference: float, tolerance: float
    ) -> None:
        """Add one pair of values that are not equal."""
        self.add(
            path,
            kind,
            np.array([pair]),
            np.array([True]),
            np.array([difference]),
            tolerance,
            lambda _row, _element: (one, other),
        )

    def fields(
        self, topic: str, stamps: NDArray[np.int64], label: Callable[[str, int, int], str]
    ) -> tuple[FieldDifference, ...]:
        """The fields that differ, in order of the first stamp.

        Args:
            stamps: of each pair [ns]. label: name of an element, of (field, pair, element).
        """

        def place(path: str, spot: _Spot) -> UnequalValues:
            pair, element, one, other, difference = spot
            return UnequalValues(
                int(stamps[pair]), "" if element < 0 else label(path, pair, element), one, other, difference
            )

        found = [
            FieldDifference(
                topic,
                path,
                each.kind,
                each.pairs,
                each.beyond,
                len(stamps),
                each.tolerance,
                place(path, each.first),
                place(path, each.largest),
                None if each.first_beyond is None else place(path, each.first_beyond),
            )
            for path, each in self._sums.items()
        ]
        return tuple(sorted(found, key=lambda each: each.first.stamp))

    @staticmethod
    def _spot(
        row: int,
        element: int,
        single: bool,
        pairs: NDArray[np.int64],
        differences: NDArray[np.float64],
        values: Callable[[int, int], tuple[Any, Any]],
    ) -> _Spot:
        one, other = values(row, element)
        return int(pairs[row]), -1 if single else element, one, other, float(differences[row, element])


def _joined(one: _Sum, other: _Sum) -> _Sum:
    beyond = [spot for spot in (one.first_beyond, other.first_beyond) if spot is not None]
    worse = one if one.largest[4] > other.largest[4] else other
    if one.largest[4] == other.largest[4]:
        worse = one if one.largest[0] <= other.largest[0] else other
    return _Sum(
        worse.kind,
        max(one.tolerance, other.tolerance),
        one.pairs + other.pairs,
        one.beyond + other.beyond,
        min(one.first, other.first, key=lambda spot: spot[0]),
        worse.largest,
        min(beyond, key=lambda spot: spot[0], default=None),
    )
