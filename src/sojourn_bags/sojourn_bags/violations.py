"""Violations of the contract in a bag, for reports."""

from dataclasses import dataclass

from sojourn_bags.reading import Bag


@dataclass(frozen=True)
class Violation:
    """One message that breaks the contract: where and when [s], which field, its value, and what is allowed."""

    topic: str
    stamp_s: float
    field: str
    value: str
    allowed: str


def violations(bag: Bag) -> list[Violation] | None:
    """Violations in the order of time; None where nothing judges them."""
    return None
