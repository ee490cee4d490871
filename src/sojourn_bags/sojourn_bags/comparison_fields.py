"""Compares pairs of messages number by number, with one numpy operation a field and layout.

- Values are equal if they are the same number, NaN equals NaN; zero and minus zero are not equal, and their
  difference is zero.
- A difference of angles (the rule's unit is rad) is taken the short way round.
- An attitude is compared as one field: q and -q are the same attitude, so they are within any tolerance, though
  not equal. Its difference is the largest of the four.
- NaN against a number is an infinite difference.
"""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sojourn_bags.comparison_tally import Tally
from sojourn_bags.messages import LayoutGroup, Messages, points_of
from sojourn_contract.tolerance import is_angle, rule_of, tolerance_of

_CLOUD = "sensor_msgs/msg/PointCloud2"
_ATTITUDES = ("orientation", "rotation")
_AXES = ("x", "y", "z", "w")
_TURN = 2.0 * np.pi


def compare_layouts(one: Messages, other: Messages, pairs: NDArray[np.int64], tally: Tally) -> None:
    """Compare the messages of two sets of one type, the first with the first and so on.

    Args:
        pairs: number under which each pair is told to the tally.
    """
    for group, other_group, chosen in _by_layout(one, other):
        _compare_group(one, group, other_group, pairs[chosen], tally)


def _by_layout(one: Messages, other: Messages) -> Iterator[tuple[LayoutGroup, LayoutGroup, NDArray[np.int64]]]:
    """Pairs of messages that have one layout in each set: the two groups' rows, and the pairs' numbers."""
    for group in one.groups:
        for other_group in other.groups:
            chosen, rows, other_rows = np.intersect1d(group.indices, other_group.indices, return_indices=True)
            if chosen.size:
                yield (
                    LayoutGroup(chosen, group.rows[rows], group.layout),
                    LayoutGroup(chosen, other_group.rows[other_rows], other_group.layout),
                    chosen,
                )


def _compare_group(
    messages: Messages, group: LayoutGroup, other: LayoutGroup, pairs: NDArray[np.int64], tally: Tally
) -> None:
    done: set[str] = set()
    columns = {path: group.layout.column(group.rows, path) for path in group.layout.numbers}
    others = {path: other.layout.column(other.rows, path) for path in other.layout.numbers}
    if messages.type == _CLOUD and _same_points(group, other, columns, others):
        for columns_of, from_group in ((columns, group), (others, other)):
            columns_of.update(points_of(from_group))
            del columns_of["data"]
    for prefix in _attitudes(columns, others):
        paths = [f"{prefix}.{axis}" for axis in _AXES]
        done.update(paths)
        left = np.stack([columns[path] for path in paths], axis=1)
        right = np.stack([others[path] for path in paths], axis=1)
        _compare_attitudes(messages.topic, prefix, left, right, pairs, tally)
    for path in [path for path in columns if path in others and path not in done]:
        left, right = columns[path], others[path]
        if left.shape != right.shape:
            lengths = (left.shape[1], right.shape[1])
            _compare_lengths(path, lengths, pairs, tally)
        else:
            _compare_numbers(messages.topic, path, left, right, pairs, tally)
    _compare_texts(group, other, pairs, tally)
    for base, lengths in _sequences(group, other).items():
        _compare_lengths(base, lengths, pairs, tally)


def _compare_numbers(
    topic: str, path: str, one: NDArray[Any], other: NDArray[Any], pairs: NDArray[np.int64], tally: Tally
) -> None:
    rule = rule_of(topic, path)
    unequal = ~_equal(one, other)
    if not unequal.any():
        return
    angle = is_angle(rule)
    differences = _differences(one, other, angle)

    def values(row: int, element: int) -> tuple[Any, Any]:
        if one.ndim == 1:
            return one[row].item(), other[row].item()
        return one[row, element].item(), other[row, element].item()

    tally.add(path, "angle" if angle else "number", pairs, unequal, differences, tolerance_of(rule), values)


def _compare_attitudes(
    topic: str, path: str, one: NDArray[Any], other: NDArray[Any], pairs: NDArray[np.int64], tally: Tally
) -> None:
    unequal: NDArray[np.bool_] = np.logical_not(_equal(one, other).all(axis=1))
    if not unequal.any():
        return
    opposite = (one * other).sum(axis=1) < 0.0
    turned = np.where(opposite[:, np.newaxis], -other, other)
    differences = _differences(one, turned, False).max(axis=1)
    rule = rule_of(topic, path)
    tally.add(
        path,
        "attitude",
        pairs,
        unequal,
        differences,
        tolerance_of(rule),
        lambda row, _element: (one[row].tolist(), other[row].tolist()),
    )


def _compare_texts(group: LayoutGroup, other: LayoutGroup, pairs: NDArray[np.int64], tally: Tally) -> None:
    for path in [path for path in group.layout.texts if path in other.layout.texts]:
        left, right = _texts(group, path), _texts(other, path)
        unequal = np.array([one != another for one, another in zip(left, right, strict=True)])
        infinite = np.full(len(pairs), np.inf)
        tally.add(path, "text", pairs, unequal, infinite, 0.0, _picker(left, right))


def _picker(one: list[str], other: list[str]) -> Callable[[int, int], tuple[Any, Any]]:
    return lambda row, _element: (one[row], other[row])


def _compare_lengths(path: str, lengths: tuple[int, int], pairs: NDArray[np.int64], tally: Tally) -> None:
    every = np.full(len(pairs), True)
    difference = np.full(len(pairs), float(abs(lengths[0] - lengths[1])))
    tally.add(f"{path} (length)", "length", pairs, every, difference, 0.0, lambda _row, _element: lengths)


def _texts(group: LayoutGroup, path: str) -> list[str]:
    text = group.layout.texts[path]
    cells = np.ascontiguousarray(group.rows[:, text.offset : text.offset + text.length])
    return [row.tobytes().decode(errors="replace") for row in cells]


def _sequences(group: LayoutGroup, other: LayoutGroup) -> dict[str, tuple[int, int]]:
    """Sequences of messages or texts that are not equally long: their lengths by path."""
    counts = [_counts(each) for each in (group, other)]
    lengths = {base: (counts[0].get(base, 0), counts[1].get(base, 0)) for base in counts[0] | counts[1]}
    return {base: pair for base, pair in lengths.items() if pair[0] != pair[1]}


def _counts(group: LayoutGroup) -> dict[str, int]:
    """Length of each sequence of messages or texts of the message itself."""
    found: dict[str, int] = {}
    for path in (*group.layout.numbers, *group.layout.texts):
        base, bracket, rest = path.partition("[")
        if bracket:
            found[base] = max(found.get(base, 0), int(rest.partition("]")[0]) + 1)
    return found


def _same_points(group: LayoutGroup, other: LayoutGroup, columns: dict[str, Any], others: dict[str, Any]) -> bool:
    """Whether two clouds have the same fields and the same number of points, so that these can be compared."""
    told = [path for path in columns if path != "data" and not path.startswith("header.")]
    same = columns.keys() == others.keys() and all(
        bool((columns[path] == others[path]).all() and (columns[path] == columns[path][0]).all()) for path in told
    )
    names = [path for path in group.layout.texts if path.startswith("fields[")]
    return same and all(path in other.layout.texts and _texts(group, path) == _texts(other, path) for path in names)


def _attitudes(columns: dict[str, Any], others: dict[str, Any]) -> list[str]:
    """Paths of the quaternions that both have."""
    prefixes = [path.removesuffix(".w") for path in columns if path.endswith(".w")]
    return [
        prefix
        for prefix in prefixes
        if prefix.rpartition(".")[2] in _ATTITUDES
        and all(f"{prefix}.{axis}" in columns and f"{prefix}.{axis}" in others for axis in _AXES)
    ]


def _equal(one: NDArray[Any], other: NDArray[Any]) -> NDArray[np.bool_]:
    same = one == other
    if one.dtype.kind == "f" and other.dtype.kind == "f":
        same &= np.signbit(one) == np.signbit(other)  # minus zero
        same |= np.isnan(one) & np.isnan(other)
    return same


def _differences(one: NDArray[Any], other: NDArray[Any], angle: bool) -> NDArray[np.float64]:
    left, right = one.astype(np.float64), other.astype(np.float64)
    with np.errstate(invalid="ignore", over="ignore"):
        differences = np.abs(left - right)
        if angle:
            around = np.abs(differences - _TURN * np.round(differences / _TURN))
            differences = np.where(differences > np.pi, around, differences)
    differences[np.isnan(differences)] = np.inf
    differences[_equal(one, other)] = 0.0
    return differences
