"""Compares DiagnosticArrays by the keys of their values, as `status.values.distance_to_go`.

Where an array holds several statuses, the name of each stands in the path: `status[imu].values.bias`.
"""

from math import inf
from typing import Any

from sojourn_bags.comparison_tally import Tally
from sojourn_bags.messages import Messages
from sojourn_contract.tolerance import rule_of, text_difference, tolerance_of

ABSENT = "(absent)"
"""Stands for a key, a status or a text that only one of the two has."""


def compare_statuses(one: Messages, other: Messages, pairs: list[int], tally: Tally) -> None:
    """Compare DiagnosticArrays, the first with the first and so on.

    Args:
        pairs: number under which each pair is told to the tally.
    """
    for index, pair in enumerate(pairs):
        left, right = _flat(one.decode(index)), _flat(other.decode(index))
        for path in left | right:
            a, b = left.get(path, ABSENT), right.get(path, ABSENT)
            if a != b:
                _tell(one.topic, path, pair, a, b, tally)
        if list(left) != list(right) and left.keys() == right.keys():
            tally.add_single("status (order)", "text", pair, ", ".join(left), ", ".join(right), inf, 0.0)


def _tell(topic: str, path: str, pair: int, one: Any, other: Any, tally: Tally) -> None:
    rule = rule_of(topic, path)
    difference, step = inf, 0.0
    if isinstance(one, str) and isinstance(other, str):
        difference, step = text_difference(one, other)
    numbers = difference < inf
    allowed = max(tolerance_of(rule), step) if rule is not None and numbers else 0.0
    tally.add_single(path, "number" if numbers else "text", pair, one, other, difference, allowed)


def _flat(array: Any) -> dict[str, Any]:
    """Every field by path."""
    found: dict[str, Any] = {"header.frame_id": array.header.frame_id}
    for number, status in enumerate(array.status):
        prefix = "status" if len(array.status) == 1 else f"status[{status.name or number}]"
        found |= {
            f"{prefix}.level": int(status.level),
            f"{prefix}.name": status.name,
            f"{prefix}.message": status.message,
            f"{prefix}.hardware_id": status.hardware_id,
        }
        for pair in status.values:
            path = f"{prefix}.values.{pair.key}"
            while path in found:
                path += "'"  # a key that comes twice
            found[path] = pair.value
    return found
