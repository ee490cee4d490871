"""What tests ask of two records of one run, and of a verdict on a run in real time."""

from typing import Any

from sojourn_bags.comparison import compare
from sojourn_bags.comparison_result import Verdict
from sojourn_bags.comparison_words import comparison_lines
from sojourn_bags.reading import Bag

OF_TIME = {"rate", "answer", "heartbeat", "counter", "rate of change"}
"""Rules about when something came: a busy host gives a node no core when it would speak."""


def faults_of_nodes(verdict: dict[str, Any]) -> list[dict[str, Any]]:
    """Groups of a verdict (`Report.as_data`) that no host can be the reason of."""
    return [group for group in verdict["groups"] if not _may_be_of_the_host(group)]


def _may_be_of_the_host(group: dict[str, Any]) -> bool:
    """Whether it is about when something came, or a joint that makes up for commands which all came at once."""
    rule, field = group["rule"], group["first"][0]["field"]
    late = rule in OF_TIME or (rule == "stamp" and field == "age")
    return late or (rule == "limit" and field.startswith("velocity["))


def require_same(one: Bag, other: Bag) -> None:
    """Fail with what is not the same in two records, of all fields of all messages."""
    result = compare(one.topics, other.topics)
    assert result.verdict is Verdict.IDENTICAL, "\n".join(comparison_lines(result))
    assert result.matched == sum(len(messages) for messages in one.topics.values())
