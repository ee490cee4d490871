"""What a comparison finds: by topic and field how many values differ, by how much at most, and where first.

A difference is never rounded away: every value that is not equal is counted, and those beyond the tolerance
are counted apart.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Any

from sojourn_contract.flow import place_of
from sojourn_contract.stamps import seconds


class Verdict(Enum):
    """How two sets of messages compare."""

    IDENTICAL = "identical"
    WITHIN_TOLERANCE = "within tolerance"
    DIFFERENT = "different"


@dataclass(frozen=True)
class UnequalValues:
    """A pair of values that are not equal.

    Args:
        stamp: of their messages [ns]. element: which one of an array, as `[wheel_front_left_joint]` or `[3]`; ""
            for a single value. one, other: the values. difference: infinite where it is no finite number.
    """

    stamp: int
    element: str
    one: Any
    other: Any
    difference: float

    def as_data(self) -> dict[str, Any]:
        """For JSON."""
        return {
            "stamp_ns": self.stamp,
            "element": self.element,
            "a": _plain(self.one),
            "b": _plain(self.other),
            "difference": _plain(self.difference),
        }


@dataclass(frozen=True)
class FieldDifference:
    """A field that is not equal everywhere.

    Args:
        topic, field: where. kind: "number", "angle", "attitude", "text", "length", "type" or "log time".
        messages: in how many messages it is not equal. beyond: in how many it is beyond the tolerance.
        compared: messages compared. tolerance: the contract's; 0 where it allows none.
        first: first place. largest: place of the largest difference. first_beyond: first place beyond the tolerance.
    """

    topic: str
    field: str
    kind: str
    messages: int
    beyond: int
    compared: int
    tolerance: float
    first: UnequalValues
    largest: UnequalValues
    first_beyond: UnequalValues | None

    @property
    def name(self) -> str:
        """topic.field"""
        return f"{self.topic}.{self.field}"

    def as_data(self) -> dict[str, Any]:
        """For JSON."""
        return {
            "topic": self.topic,
            "field": self.field,
            "kind": self.kind,
            "differ": self.messages,
            "beyond_tolerance": self.beyond,
            "compared": self.compared,
            "tolerance": self.tolerance,
            "first": self.first.as_data(),
            "largest": self.largest.as_data(),
            "first_beyond_tolerance": None if self.first_beyond is None else self.first_beyond.as_data(),
        }


@dataclass(frozen=True)
class TopicComparison:
    """One topic.

    Args:
        topic: name. one, other: messages in each set. matched: pairs compared.
        missing, extra: stamps [ns] of messages that only the first or only the second set holds.
        fields: fields that are not equal everywhere.
    """

    topic: str
    one: int
    other: int
    matched: int
    missing: tuple[int, ...] = ()
    extra: tuple[int, ...] = ()
    fields: tuple[FieldDifference, ...] = ()

    @property
    def verdict(self) -> Verdict:
        """Of this topic."""
        if self.missing or self.extra or any(field.beyond for field in self.fields):
            return Verdict.DIFFERENT
        return Verdict.WITHIN_TOLERANCE if self.fields else Verdict.IDENTICAL

    def as_data(self) -> dict[str, Any]:
        """For JSON."""
        return {
            "topic": self.topic,
            "verdict": self.verdict.value,
            "messages_a": self.one,
            "messages_b": self.other,
            "matched": self.matched,
            "missing": {"count": len(self.missing), "first_stamp_ns": min(self.missing, default=None)},
            "extra": {"count": len(self.extra), "first_stamp_ns": min(self.extra, default=None)},
            "fields": [field.as_data() for field in self.fields],
        }


@dataclass(frozen=True)
class Divergence:
    """Where two runs part: what, and at which stamp [ns]."""

    topic: str
    what: str
    stamp: int

    def as_data(self) -> dict[str, Any]:
        """For JSON."""
        return {"topic": self.topic, "what": self.what, "stamp_ns": self.stamp}


@dataclass(frozen=True)
class Comparison:
    """Two sets of messages.

    Args:
        topics: in the order of the data's flow. order_differs_at: (topic, stamp [ns]) of the first message that
            stands at another place of the file, None where all are in the same order or no order is known.
    """

    topics: tuple[TopicComparison, ...]
    order_differs_at: tuple[str, int] | None = None

    @property
    def verdict(self) -> Verdict:
        """Of everything. Messages in another order are within tolerance at best."""
        verdicts = [topic.verdict for topic in self.topics]
        if Verdict.DIFFERENT in verdicts:
            return Verdict.DIFFERENT
        same = Verdict.WITHIN_TOLERANCE not in verdicts and self.order_differs_at is None
        return Verdict.IDENTICAL if same else Verdict.WITHIN_TOLERANCE

    @property
    def matched(self) -> int:
        """Pairs of messages compared."""
        return sum(topic.matched for topic in self.topics)

    @property
    def fields(self) -> tuple[FieldDifference, ...]:
        """Every field that is not equal everywhere, in the order of the data's flow."""
        return tuple(field for topic in self.topics for field in topic.fields)

    def field(self, name: str) -> FieldDifference | None:
        """The difference of "topic.field", None where that field is equal everywhere."""
        return next((field for field in self.fields if field.name == name), None)

    def divergence(self, beyond_tolerance: bool = False) -> Divergence | None:
        """The first divergence upstream: of the earliest stamp, and among equals nearest the plant.

        Args:
            beyond_tolerance: pass over differences that the contract tolerates.
        """
        found: list[Divergence] = []
        for topic in self.topics:
            for words, stamps in (("message missing", topic.missing), ("message too many", topic.extra)):
                if stamps:
                    found.append(Divergence(topic.topic, words, min(stamps)))
            for field in topic.fields:
                place = field.first_beyond if beyond_tolerance else field.first
                if place is not None:
                    found.append(Divergence(topic.topic, field.field + place.element, place.stamp))
        return min(found, key=lambda each: (each.stamp, place_of(each.topic)), default=None)

    def as_data(self) -> dict[str, Any]:
        """For JSON."""
        first, beyond = self.divergence(), self.divergence(beyond_tolerance=True)
        order = self.order_differs_at
        return {
            "verdict": self.verdict.value,
            "messages_compared": self.matched,
            "first_divergence": None if first is None else first.as_data(),
            "first_divergence_beyond_tolerance": None if beyond is None else beyond.as_data(),
            "order_differs_at": None if order is None else {"topic": order[0], "stamp_ns": order[1]},
            "topics": [topic.as_data() for topic in self.topics],
        }


def _plain(value: Any) -> Any:
    """A value as JSON knows it: NaN and infinities as texts."""
    if isinstance(value, float) and value - value != 0.0:
        return str(value)
    if isinstance(value, Sequence) and not isinstance(value, str):
        return [_plain(item) for item in value]
    return value


def at(stamp: int) -> str:
    """A stamp in words, as the simulation's control period writes it."""
    return f"{seconds(stamp):.2f} s" if stamp % 10_000_000 == 0 else f"{seconds(stamp):.9f} s"
