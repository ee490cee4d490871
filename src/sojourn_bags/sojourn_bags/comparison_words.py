"""A comparison in words: one line a field, the verdict, and where the two part."""

from collections.abc import Iterator
from typing import Any

from sojourn_bags.comparison_result import Comparison, FieldDifference, TopicComparison, UnequalValues, Verdict, at
from sojourn_bags.comparison_text import ABSENT

MOST_FIELDS = 60
"""Fields told one by one; the JSON has them all."""
MOST_NAMES = 6
"""Fields that a side leaves out, told by name for each topic."""
_HEAD = ("topic.field", "differ", "beyond", "largest", "allowed", "first at")


def comparison_lines(comparison: Comparison, one: str = "A", other: str = "B") -> list[str]:
    """The comparison as lines of text.

    Args:
        one, other: what the two sets are called.
    """
    lines = [*_field_table(comparison, one, other), *_absent(comparison, one, other)]
    for topic in comparison.topics:
        lines += _gaps(topic, one, other)
    if comparison.order_differs_at is not None:
        name, stamp = comparison.order_differs_at
        lines.append(f"the messages are not in the same order, from {name} at {at(stamp)} on")
    lines.append(_verdict(comparison))
    first, beyond = comparison.divergence(), comparison.divergence(beyond_tolerance=True)
    if first is not None:
        lines.append(f"first divergence upstream: {first.topic} at {at(first.stamp)}: {first.what}")
    if beyond is not None and beyond != first:
        lines.append(f"first beyond tolerance: {beyond.topic} at {at(beyond.stamp)}: {beyond.what}")
    return lines


def _verdict(comparison: Comparison) -> str:
    topics = sum(1 for topic in comparison.topics if topic.matched)
    compared = f"{comparison.matched} pairs of messages on {topics} topics"
    if comparison.verdict is Verdict.IDENTICAL:
        return f"identical: {compared}, every field equal"
    fields = len(comparison.fields)
    if comparison.verdict is Verdict.WITHIN_TOLERANCE:
        return f"within tolerance: {compared}, {_count(fields, 'field')} not equal"
    beyond = sum(1 for field in comparison.fields if field.beyond)
    gaps = sum(len(topic.missing) + len(topic.extra) for topic in comparison.topics)
    missing = f", {_count(gaps, 'message')} without a partner" if gaps else ""
    return f"different: {compared}, {_count(beyond, 'field')} beyond tolerance{missing}"


def _field_table(comparison: Comparison, one: str, other: str) -> Iterator[str]:
    fields = [field for field in comparison.fields if ABSENT not in (field.first.one, field.first.other)]
    rows = [_row(field, one, other) for field in fields[:MOST_FIELDS]]
    if not rows:
        return
    widths = [max(len(row[column]) for row in (_HEAD, *rows)) for column in range(len(_HEAD))]
    for row in (_HEAD, *rows):
        cells = [
            row[0].ljust(widths[0]),
            *(cell.rjust(width) for cell, width in zip(row[1:6], widths[1:], strict=True)),
        ]
        yield "  ".join((*cells, *row[6:]))
    left_out = len(fields) - len(rows)
    if left_out > 0:
        yield f"and {_count(left_out, 'more field')}"


def _absent(comparison: Comparison, one: str, other: str) -> Iterator[str]:
    """One line for all that a side leaves out of a topic: told one by one they would hide what differs."""
    lacking: dict[tuple[str, str], list[str]] = {}
    for field in comparison.fields:
        if ABSENT in (field.first.one, field.first.other):
            topic, _, name = field.name.partition(".")
            lacking.setdefault((topic, one if field.first.one == ABSENT else other), []).append(name)
    for (topic, side), names in lacking.items():
        more = f" and {len(names) - MOST_NAMES} more" if len(names) > MOST_NAMES else ""
        yield f"{topic}: {side} has no " + ", ".join(names[:MOST_NAMES]) + more


def _row(field: FieldDifference, one: str, other: str) -> tuple[str, ...]:
    element = f" {field.first.element}" if field.first.element else ""
    left, right = _values(field.first)
    return (
        field.name,
        f"{field.messages} of {field.compared}",
        str(field.beyond),
        "-" if field.largest.difference == float("inf") else f"{field.largest.difference:.3g}",
        f"{field.tolerance:.3g}" if field.tolerance else "none",
        at(field.first.stamp),
        f"{element} {one} {left}, {other} {right}".strip(),
    )


def _gaps(topic: TopicComparison, one: str, other: str) -> list[str]:
    lines = []
    for stamps, who in ((topic.missing, other), (topic.extra, one)):
        if stamps:
            lines.append(
                f"{topic.topic}: {_count(len(stamps), 'message')} missing in {who}, first at {at(min(stamps))}"
            )
    return lines


def _values(place: UnequalValues) -> tuple[str, str]:
    """The two values with as many digits as tell them apart."""
    for digits in (6, 9, 12, 17):
        left, right = _text(place.one, digits), _text(place.other, digits)
        if left != right:
            break
    return left, right


def _text(value: Any, digits: int) -> str:
    if isinstance(value, float):
        return f"{value:.{digits}g}"
    if isinstance(value, list | tuple):
        return "(" + ", ".join(_text(item, digits) for item in value) + ")"
    return repr(value) if isinstance(value, str) else str(value)


def _count(number: int, what: str) -> str:
    return f"{number} {what}" + ("" if number == 1 else "s")
