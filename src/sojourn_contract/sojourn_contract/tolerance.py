"""Which rule of the topic table holds for a field of a message, and how far two of its values may lie apart.

A field without a rule has no tolerance: its values must be equal. So it is with every flag, count, name and
text. A number that is written as text (in a DiagnosticArray) may differ by its rule's tolerance or by one step of its
last written digit, where that is LARGEST_STEP or less: two values that are nearly equal can be rounded apart. Whole
numbers in texts count something and so are equal, or differ by more than any tolerance.
"""

import re
from decimal import Decimal, InvalidOperation
from functools import cache

from sojourn_contract.run_table import RECORDED_BESIDES, row_named
from sojourn_contract.topic_types import FieldRule

LARGEST_STEP = 1e-3
"""A number in a text with fewer decimals must be equal: 37.8 may as well stand for 37.8000."""
_INDEX = re.compile(r"\[[^\]]*\]")


@cache
def rule_of(topic: str, path: str) -> FieldRule | None:
    """Rule of a field, None where its row has none for it, or no run has the topic.

    Args:
        path: field, dotted, with or without indices: `poses[0].pose.position.x`. A rule for a message holds
            for all that is in it, and a rule for an array for each element.
    """
    plain = _INDEX.sub("", path)
    row = row_named(topic)
    for rule in RECORDED_BESIDES.get(topic, ()) if row is None else row.fields:
        if any(plain == name or plain.startswith(name + ".") for name in rule.path.split()):
            return rule
    return None


def tolerance_of(rule: FieldRule | None) -> float:
    """Largest difference that still counts as the same answer; zero without a rule."""
    return rule.tolerance if rule is not None else 0.0


def is_angle(rule: FieldRule | None) -> bool:
    """Whether values that lie a whole turn apart are the same direction."""
    return rule is not None and rule.unit == "rad"


def text_difference(one: str, other: str) -> tuple[float, float]:
    """Difference of two numbers written as texts, and how much of it rounding can explain.

    The difference is infinite where one of the texts is no finite number.
    """
    try:
        left, right = Decimal(one), Decimal(other)
        difference = abs(left - right)
    except InvalidOperation:
        return float("inf"), 0.0
    exponents = [number.as_tuple().exponent for number in (left, right)]
    last = min((place for place in exponents if isinstance(place, int)), default=0)
    step = Decimal(1).scaleb(last)
    rounding = last < 0 and step <= Decimal(str(LARGEST_STEP)) and difference <= step
    return float(difference) if difference.is_finite() else float("inf"), float(step) if rounding else 0.0
