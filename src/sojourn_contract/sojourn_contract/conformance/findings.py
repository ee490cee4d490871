"""What a rule finds, and the report that collects it: repeats are counted, not kept."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from math import isnan
from re import compile as compile_pattern
from typing import Any

from sojourn_contract.errors import RefusedMessageError

_INDEX = compile_pattern(r"\[[^\]]*\]")
KEPT = 3
"""Violations of one kind that are kept in full; of the rest their number and the worst."""


@dataclass(frozen=True)
class Finding:
    """One rule broken by one message.

    Args:
        field: dotted path. value: what it holds. allowed: what is allowed, in words.
        excess: how far out it is, in units of the field; infinite where there is no measure of it.
    """

    field: str
    value: Any
    allowed: str
    excess: float = float("inf")

    @classmethod
    def of_refusal(cls, refusal: RefusedMessageError) -> "Finding":
        """What a node would say on refusing the message."""
        return cls(refusal.field, refusal.value, refusal.allowed)


@dataclass(frozen=True)
class Violation:
    """A finding with its rule, topic and stamp.

    Args:
        rule: name of the rule. stamp: of the message [ns], None where it is about no single message.
    """

    rule: str
    topic: str
    stamp: int | None
    finding: Finding

    def __str__(self) -> str:
        when = "" if self.stamp is None else f" at {self.stamp / 1e9:.2f} s"
        return f"{self.topic}{when}: {self.finding.field} = {value_text(self.finding)}"

    def as_data(self) -> dict[str, Any]:
        """As JSON values."""
        found = self.finding
        return {
            "rule": self.rule,
            "topic": self.topic,
            "stamp_ns": self.stamp,
            "field": found.field,
            "value": found.value if isinstance(found.value, int) else number_text(found.value),
            "allowed": found.allowed,
        }


@dataclass
class Group:
    """Violations of one rule by one field of one topic.

    Attributes:
        first: those kept. count: all. last: newest stamp [ns]. worst: farthest out.
    """

    topic: str
    rule: str
    first: list[Violation] = field(default_factory=list)
    count: int = 0
    last: int | None = None
    worst: Violation | None = None

    def add(self, violation: Violation) -> None:
        """One more."""
        self.count += 1
        self.last = violation.stamp
        if len(self.first) < KEPT:
            self.first.append(violation)
        if self.worst is None or violation.finding.excess > self.worst.finding.excess:
            self.worst = violation


class Report:
    """All violations of a judgement."""

    def __init__(self) -> None:
        self.messages: dict[str, int] = {}
        """Messages judged, by topic."""
        self._groups: dict[tuple[str, str, str], Group] = {}

    def add(self, rule: str, topic: str, stamp: int | None, findings: Iterable[Finding]) -> None:
        """Add what a rule found."""
        for found in findings:
            key = (topic, rule, _INDEX.sub("", found.field))
            group = self._groups.setdefault(key, Group(topic, rule))
            group.add(Violation(rule, topic, stamp, found))

    @property
    def groups(self) -> list[Group]:
        """Groups in the order in which they began."""
        return list(self._groups.values())

    @property
    def violations(self) -> int:
        """How many there are in all."""
        return sum(group.count for group in self._groups.values())

    def of_topic(self, topic: str) -> list[Group]:
        """Groups of one topic, the largest first."""
        return sorted((group for group in self.groups if group.topic == topic), key=lambda group: -group.count)

    def lines(self) -> Iterator[str]:
        """One line a violation; what repeats is counted."""
        for group in self.groups:
            yield from (str(violation) for violation in group.first)
            left = group.count - len(group.first)
            if left:
                until = "" if group.last is None else f" until {group.last / 1e9:.2f} s"
                worst = "" if group.worst is None else f", worst: {number_text(group.worst.finding.value)}"
                yield f"{group.topic}: {left} more like the last{until}{worst}"

    def as_data(self) -> dict[str, Any]:
        """As JSON values."""
        return {
            "violations": self.violations,
            "topics": {
                name: {"messages": count, "violations": sum(group.count for group in self.of_topic(name))}
                for name, count in self.messages.items()
            },
            "groups": [
                {
                    "topic": group.topic,
                    "rule": group.rule,
                    "count": group.count,
                    "first": [violation.as_data() for violation in group.first],
                    "last_stamp_ns": group.last,
                    "worst": None if group.worst is None else group.worst.as_data(),
                }
                for group in self.groups
            ],
        }


def value_text(found: Finding) -> str:
    """Value and what is allowed."""
    return f"{number_text(found.value)} (allowed: {found.allowed})"


def number_text(value: Any) -> str:
    """A value for a person."""
    if isinstance(value, float):
        return "NaN" if isnan(value) else f"{value:.6g}"
    return str(value)
